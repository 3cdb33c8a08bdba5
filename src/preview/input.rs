//! What keys and drags mean. Keys are places on the keyboard, so that every layout works. With Ctrl, they
//! are letters, as in other programs.

use std::collections::HashSet;

use glam::DVec3;
use winit::keyboard::{Key, KeyCode};

use crate::picture::Layer;
use crate::preview::flight::Thrust;
use crate::preview::views::ShownView;

/// The keys, and what they do. Two columns of them fit into 640 pixels.
pub const HELP: [(&str, &str); 30] = [
    ("W A S D, arrows", "fly forward, left, back, right"),
    ("E Q", "fly up, down"),
    ("Z X", "roll"),
    ("Shift", "faster"),
    ("right drag", "look around"),
    ("left drag", "orbit the point under the cursor"),
    ("double click", "look at the point under the cursor"),
    ("Alt+click", "what there is at the pixel"),
    ("wheel", "speed of flight"),
    ("Ctrl+wheel", "field of view"),
    ("Home", "back to the camera of the preset"),
    ("Tab, T", "hide or show the panel, the timeline"),
    ("1 2 3", "colour, depth, normal"),
    ("4 5 6", "position, steps, state"),
    ("7", "the pass that ended each way"),
    ("[ ]", "the passes one by one"),
    ("O", "time and work of the passes"),
    ("Space", "play, stop"),
    (", .", "a frame back, a frame on"),
    ("K", "set a key of the present view"),
    ("Ctrl+K", "overwrite the chosen key"),
    ("Delete", "take the chosen key away"),
    ("Alt+drag", "copy a key"),
    ("Ctrl+Z, Ctrl+Y", "undo, redo; also Ctrl+Shift+Z"),
    ("Ctrl+S", "save the preset"),
    ("F12", "a still of the size image.size"),
    ("Ctrl+C", "copy the command of this picture"),
    ("F11", "full screen"),
    ("F1", "these keys"),
    ("Ctrl+Q", "close the window"),
];

/// What a key asks for at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Hides or shows the panel.
    Panel,
    /// Hides or shows the timeline.
    Timeline,
    /// Full screen, or a window again.
    FullScreen,
    /// Hides or shows the list of keys.
    Help,
    /// Hides or shows the figures of the passes.
    Figures,
    /// Shows a layer or the ways of cones.
    Show(ShownView),
    /// Shows the fronts of another pass, so many later.
    NextPass(i32),
    /// The camera of the preset.
    Home,
    /// A step back.
    Undo,
    /// A step back again.
    Redo,
    /// Saves the preset.
    Save,
    /// Renders a still.
    Still,
    /// Copies the command line.
    Copy,
    /// Plays or stops.
    Play,
    /// Another frame, so many later.
    Step(i32),
    /// Sets a key of the present view.
    Key,
    /// Sets the chosen key to the present view.
    Overwrite,
    /// Takes the chosen key away.
    Remove,
    /// Closes the window.
    Quit,
}

/// The first letter or sign of a key.
pub fn letter(key: &Key) -> Option<char> {
    key.to_text().and_then(|text| text.chars().next())
}

/// Whether a letter is of a Latin alphabet.
pub fn is_latin(letter: char) -> bool {
    letter < '\u{250}'
}

/// What a key with Ctrl asks for. Layouts of other alphabets, which have signs too, have the letters of a
/// US keyboard. `of_latin` is whether the last letter was Latin.
pub fn shortcut(place: KeyCode, key: &Key, shift: bool, of_latin: bool) -> Option<Action> {
    let letter = match letter(key) {
        Some(letter) if letter.is_ascii_alphabetic() => Some(letter),
        Some(letter) if of_latin && is_latin(letter) => None,
        _ => of_us_keyboard(place),
    };
    match letter?.to_ascii_lowercase() {
        'z' if shift => Some(Action::Redo),
        'z' => Some(Action::Undo),
        'y' => Some(Action::Redo),
        's' => Some(Action::Save),
        'c' => Some(Action::Copy),
        'k' => Some(Action::Overwrite),
        'q' => Some(Action::Quit),
        _ => None,
    }
}

fn of_us_keyboard(place: KeyCode) -> Option<char> {
    match place {
        KeyCode::KeyZ => Some('z'),
        KeyCode::KeyY => Some('y'),
        KeyCode::KeyS => Some('s'),
        KeyCode::KeyC => Some('c'),
        KeyCode::KeyK => Some('k'),
        KeyCode::KeyQ => Some('q'),
        _ => None,
    }
}

/// What a key that goes down without Ctrl asks for at once.
pub fn action(key: KeyCode) -> Option<Action> {
    let layer = |layer| Some(Action::Show(ShownView::Layer(layer)));
    match key {
        KeyCode::Tab => Some(Action::Panel),
        KeyCode::KeyT => Some(Action::Timeline),
        KeyCode::F11 => Some(Action::FullScreen),
        KeyCode::F1 => Some(Action::Help),
        KeyCode::F12 => Some(Action::Still),
        KeyCode::KeyO => Some(Action::Figures),
        KeyCode::Home => Some(Action::Home),
        KeyCode::Digit1 => layer(Layer::Color),
        KeyCode::Digit2 => layer(Layer::Depth),
        KeyCode::Digit3 => layer(Layer::Normal),
        KeyCode::Digit4 => layer(Layer::Position),
        KeyCode::Digit5 => layer(Layer::Steps),
        KeyCode::Digit6 => layer(Layer::State),
        KeyCode::Digit7 => Some(Action::Show(ShownView::Ends)),
        KeyCode::BracketLeft => Some(Action::NextPass(-1)),
        KeyCode::BracketRight => Some(Action::NextPass(1)),
        KeyCode::Space => Some(Action::Play),
        KeyCode::Comma => Some(Action::Step(-1)),
        KeyCode::Period => Some(Action::Step(1)),
        KeyCode::KeyK => Some(Action::Key),
        KeyCode::Delete => Some(Action::Remove),
        _ => None,
    }
}

/// What the held keys ask for.
pub fn thrust(held: &HashSet<KeyCode>, fast: bool) -> Thrust {
    let any = |keys: &[KeyCode]| f64::from(u8::from(keys.iter().any(|key| held.contains(key))));
    let axis = |plus: &[KeyCode], minus: &[KeyCode]| any(plus) - any(minus);
    Thrust {
        way: DVec3::new(
            axis(
                &[KeyCode::KeyD, KeyCode::ArrowRight],
                &[KeyCode::KeyA, KeyCode::ArrowLeft],
            ),
            axis(&[KeyCode::KeyE], &[KeyCode::KeyQ]),
            axis(
                &[KeyCode::KeyW, KeyCode::ArrowUp],
                &[KeyCode::KeyS, KeyCode::ArrowDown],
            ),
        ),
        roll: axis(&[KeyCode::KeyX], &[KeyCode::KeyZ]),
        fast,
    }
}

/// A drag under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drag {
    /// Turns the camera in its place.
    Look,
    /// Turns it about a point.
    Orbit(DVec3),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shortcuts_are_letters_and_else_places() {
        let of = |place, text: &str, of_latin| {
            shortcut(place, &Key::Character(text.into()), false, of_latin)
        };
        for of_latin in [false, true] {
            assert_eq!(of(KeyCode::KeyZ, "z", of_latin), Some(Action::Undo));
            // A French keyboard.
            assert_eq!(of(KeyCode::KeyW, "Z", of_latin), Some(Action::Undo));
            assert_eq!(of(KeyCode::KeyQ, "a", of_latin), None);
            // A Russian one.
            assert_eq!(of(KeyCode::KeyQ, "й", of_latin), Some(Action::Quit));
            assert_eq!(of(KeyCode::KeyW, "ц", of_latin), None);
        }
        // A Dvorak one, and a Greek one.
        assert_eq!(of(KeyCode::KeyQ, "'", true), None);
        assert_eq!(of(KeyCode::KeyQ, ";", false), Some(Action::Quit));
    }
}
