//! What events do to the open window.

use std::path::Path;
use std::time::{Duration, Instant};

use toml::Value;
use winit::dpi::PhysicalPosition;
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, WindowEvent};
use winit::keyboard::{KeyCode, PhysicalKey};
use winit::window::Fullscreen;

use crate::base::outcome::State;
use crate::picture::Layer;
use crate::plan::{Extras, Plan};
use crate::preset;
use crate::preview::command::command;
use crate::preview::document::Document;
use crate::preview::error::PreviewError;
use crate::preview::flight::{focus, look, orbit};
use crate::preview::gui::is_in;
use crate::preview::input::{Action, Drag, action, is_latin, letter, shortcut};
use crate::preview::live::Live;
use crate::preview::play::{last_key, set_view, with_still};
use crate::preview::probe;
use crate::preview::still::Still;
use crate::preview::views::ShownView;
use crate::scene::Assets;

/// Two clicks within this time are a double click.
const DOUBLE_CLICK: Duration = Duration::from_millis(350);
/// Radians of an orbit for a pixel.
const ORBIT: f64 = 0.006;
/// The factor on speed or field of view for a line of the wheel.
const WHEEL: f64 = 1.15;
/// Pixels of a touch pad for a line of a wheel.
const LINE: f64 = 40.0;

/// Said of a picture without cone passes.
pub const NO_PASSES: &str =
    "this picture has no cone passes: rays alone are faster here (march.coarsest)";

/// The number of cone passes of a plan; 0 of one that does not fit.
pub fn passes(plan: &Plan, assets: &Assets) -> usize {
    match plan.check() {
        Ok(()) => plan.resolved(Extras::default(), assets).levels().len(),
        Err(_) => 0,
    }
}

impl Live {
    /// Takes in an event.
    ///
    /// # Errors
    /// The surface is lost for good.
    pub fn event(&mut self, event: &WindowEvent) -> Result<(), PreviewError> {
        let mut taken = false;
        // A redraw is no input: the answer would ask for the next one.
        // Keys are for widgets only while text is typed: Tab would move egui's focus.
        let flies = matches!(event, WindowEvent::KeyboardInput { .. });
        let typed = !flies || self.ctx.text_edit_focused();
        if typed && !matches!(event, WindowEvent::RedrawRequested) {
            let response = self.gui.on_window_event(&self.stage.window, event);
            // What egui knows may be older than the pointer's way onto the panel, or off it.
            let is_over = self.ctx.egui_is_using_pointer() || is_in(&self.over, self.cursor);
            taken = response.consumed && is_over || is_in(&self.panels, self.cursor);
            if response.repaint && self.concerns_panel(event) {
                self.paint_now();
            }
        }
        match event {
            WindowEvent::CloseRequested => self.close(),
            WindowEvent::Resized(size) => {
                self.hidden = size.width == 0 || size.height == 0;
                if !self.hidden {
                    self.stage.screen.resize([size.width, size.height]);
                    self.paint_now();
                }
            }
            WindowEvent::Occluded(hidden) => self.hidden = *hidden,
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = *modifiers,
            WindowEvent::Focused(false) => self.held.clear(),
            // Of a key that was down before the window had the keyboard, only its end counts.
            WindowEvent::KeyboardInput {
                event,
                is_synthetic,
                ..
            } if !is_synthetic || event.state == ElementState::Released => {
                if let PhysicalKey::Code(code) = event.physical_key {
                    self.key(code, event);
                }
            }
            WindowEvent::CursorMoved { position, .. } => self.moved(*position),
            WindowEvent::MouseInput { state, button, .. } => self.button(*button, *state, taken),
            WindowEvent::MouseWheel { delta, .. } if !taken => {
                self.wheel(match delta {
                    MouseScrollDelta::LineDelta(_, y) => f64::from(*y),
                    MouseScrollDelta::PixelDelta(p) => p.y / LINE,
                });
            }
            WindowEvent::RedrawRequested => self.draw()?,
            _ => {}
        }
        Ok(())
    }

    /// Whether the panel may change by an event. Keys that fly and a pointer over the picture change
    /// nothing there, and a painted panel costs a software device as much as a small picture.
    fn concerns_panel(&self, event: &WindowEvent) -> bool {
        match event {
            WindowEvent::KeyboardInput { .. } => self.ctx.egui_wants_keyboard_input(),
            WindowEvent::CursorMoved { position, .. } => {
                self.ctx.egui_is_using_pointer()
                    || is_in(&self.over, *position)
                    || is_in(&self.over, self.cursor)
            }
            _ => true,
        }
    }

    fn key(&mut self, place: KeyCode, event: &KeyEvent) {
        if event.state == ElementState::Released {
            self.held.remove(&place);
            return;
        }
        let keys = self.modifiers.state();
        let ctrl = keys.control_key() || keys.super_key();
        let key = &event.logical_key;
        if let Some(letter) = letter(key).filter(|letter| letter.is_alphabetic()) {
            self.of_latin = is_latin(letter);
        }
        let action = match ctrl {
            true => shortcut(place, key, keys.shift_key(), self.of_latin),
            false => action(place),
        };
        // Text is typed into a field of the panel. What is done with the whole document takes it in.
        if self.ctx.text_edit_focused() {
            let whole = [
                Action::Save,
                Action::Quit,
                Action::Help,
                Action::FullScreen,
                Action::Still,
            ];
            if !action.is_some_and(|action| whole.contains(&action)) {
                return;
            }
            self.leave_field();
        }
        match action {
            Some(action) if !event.repeat || matches!(action, Action::Step(_)) => self.act(action),
            None if !ctrl => _ = self.held.insert(place),
            _ => {}
        }
    }

    /// Takes in what is typed into a field of the panel.
    pub fn leave_field(&mut self) {
        if self.ctx.text_edit_focused() {
            self.leaves_field = true;
            self.paint();
        }
    }

    fn act(&mut self, action: Action) {
        self.paint_now();
        let flip = |on: &mut bool| *on = !*on;
        match action {
            Action::Panel => flip(&mut self.visible.panel),
            Action::Timeline => flip(&mut self.visible.timeline),
            Action::Help => flip(&mut self.visible.help),
            Action::Figures => flip(&mut self.visible.figures),
            Action::FullScreen => {
                let window = &self.stage.window;
                let whole = window.fullscreen().is_none();
                window.set_fullscreen(whole.then_some(Fullscreen::Borderless(None)));
            }
            Action::Show(shot) => self.shot = shot,
            Action::NextPass(by) => self.next_pass(by),
            Action::Home => {
                let camera = self.document.saved().camera.clone();
                self.document.change(|plan| plan.camera = camera);
            }
            Action::Undo => self.go_back(Document::undo),
            Action::Redo => self.go_back(Document::redo),
            Action::Save => self.save(),
            Action::Still => self.begin_still(),
            Action::Copy => self.copy(),
            Action::Play => {
                let over = self.play.beat >= self.document.plan.time.length;
                self.play.playing = !self.play.playing;
                // What is flown so far is a step, and the time before it is none of the film's.
                self.document.end();
                self.ticked = Instant::now();
                if self.play.playing && over {
                    self.play.beat = 0.0;
                }
            }
            Action::Step(frames) => {
                self.play.step(&self.document.plan, frames);
                self.follow_playhead();
            }
            Action::Key => {
                let beat = self.play.beat;
                self.change_keys(|plan| set_view(plan, beat));
                self.visible.timeline = true;
            }
            Action::Overwrite => self.overwrite_key(),
            Action::Remove => self.remove_key(),
            Action::Quit => self.close(),
        }
    }

    /// Shows the passes one by one: the fronts of each cone level, and then the picture.
    fn next_pass(&mut self, by: i32) {
        let levels = passes(&self.shown(), &self.pictures.assets);
        if levels == 0 {
            self.tell(NO_PASSES, false);
            return;
        }
        let now = match self.shot {
            ShownView::Fronts(n) => n,
            _ => levels,
        };
        let next = now.saturating_add_signed(by as isize).min(levels);
        self.shot = match next {
            n if n == levels => ShownView::Layer(Layer::Color),
            n => ShownView::Fronts(n),
        };
    }

    fn save(&mut self) {
        // What another program has written since is read, not lost.
        let known = self.document.saved().clone();
        self.look_at_files();
        if *self.document.saved() != known {
            return;
        }
        if std::mem::take(&mut self.unread) {
            let text =
                "not saved: the file was changed and cannot be read; Ctrl+S again writes over it";
            self.tell(text, true);
            return;
        }
        let (name, was_at) = (self.document.name.clone(), self.document.path.clone());
        let Document { plan, beat, .. } = &self.document;
        let plan = with_still(plan, self.document.saved(), *beat);
        // A file that cannot be opened again would be no preset.
        let checked = plan.check().map_err(|f| format!("{}: {}", f.key, f.why));
        let read = || preset::read(&preset::write(&plan), &name);
        if let Err(why) = checked.and_then(|()| read().map_err(|e| e.to_string())) {
            self.tell(format!("not saved: {why}"), true);
            return;
        }
        match self.document.save(Path::new("."), plan) {
            Ok(path) => {
                self.drop_saved();
                if was_at != self.document.path {
                    // What is offered is of the other file, and is offered again when that opens.
                    self.offered = None;
                }
                self.watch_file();
                self.tell(format!("saved to {}", path.display()), false);
            }
            Err(e) => self.tell(e.to_string(), true),
        }
    }

    /// The plan that is shown, with the preset's own size.
    fn own_size(&self) -> Plan {
        Plan {
            size: self.document.plan.size,
            ..self.shown()
        }
    }

    fn begin_still(&mut self) {
        if self.still.is_some() {
            self.tell("a still is under way", false);
            return;
        }
        let plan = self.own_size();
        if let Err(fault) = plan.check() {
            self.tell(format!("{}: {}", fault.key, fault.why), true);
            return;
        }
        if let Err(why) = (self.options.fits)(&plan) {
            self.tell(why, true);
            return;
        }
        let name = self.document.name.clone();
        let assets = self.pictures.assets.clone();
        match Still::begin(&mut self.pictures.renderer, plan, &assets, name) {
            Ok(still) => self.still = Some(still),
            Err(why) => self.tell(why, true),
        }
    }

    /// Copies the command that makes the picture in the window.
    fn copy(&mut self) {
        let ShownView::Layer(layer) = self.shot else {
            self.tell("no command makes this view; 1 to 6 show layers", true);
            return;
        };
        let name = match &self.document.path {
            Some(path) => path.display().to_string(),
            None => self.document.name.clone(),
        };
        match command(&name, &self.shown(), layer) {
            Ok(command) => {
                self.ctx.copy_text(command.clone());
                let shaders = match self.options.wgsl {
                    Some(_) => "; it has the program's own shaders, and not those of --wgsl",
                    None => "",
                };
                self.tell(format!("copied: {command}{shaders}"), false);
            }
            Err(why) => self.tell(format!("{why}; Ctrl+S makes a preset of it"), true),
        }
    }

    /// The pixel under the cursor.
    pub fn pixel(&self) -> [u32; 2] {
        let [w, h] = self.stage.screen.size();
        [
            (self.cursor.x.max(0.0) as u32).min(w - 1),
            (self.cursor.y.max(0.0) as u32).min(h - 1),
        ]
    }

    fn button(&mut self, button: MouseButton, state: ElementState, taken: bool) {
        if state == ElementState::Released {
            if self.drag.take().is_some() {
                self.document.end();
            }
            return;
        }
        if taken {
            return;
        }
        let plan = self.shown();
        match button {
            MouseButton::Left if self.modifiers.state().alt_key() => self.ask(plan),
            MouseButton::Left => {
                let met = probe::pixel(&plan, self.assets(), self.pixel());
                let hit = met.filter(|met| met.state == State::Hit);
                let point = hit.map_or(plan.camera.target, |met| met.point);
                let now = Instant::now();
                let second = self.clicked.is_some_and(|at| now - at < DOUBLE_CLICK);
                self.clicked = (!second).then_some(now);
                if second && hit.is_some() {
                    self.document.change(|plan| focus(&mut plan.camera, point));
                } else {
                    self.document.begin();
                    self.drag = Some(Drag::Orbit(point));
                }
            }
            MouseButton::Right => {
                self.document.begin();
                self.drag = Some(Drag::Look);
            }
            _ => {}
        }
    }

    fn moved(&mut self, to: PhysicalPosition<f64>) {
        let (dx, dy) = (to.x - self.cursor.x, to.y - self.cursor.y);
        self.cursor = to;
        let Some(drag) = self.drag else { return };
        // An undo or a save in the middle has ended the step.
        self.document.begin();
        let pixel = self.shown().view().pixel;
        self.document.change(|plan| match drag {
            Drag::Look => look(&mut plan.camera, dx * pixel, -dy * pixel),
            // The scene follows the cursor.
            Drag::Orbit(about) => orbit(&mut plan.camera, about, -dx * ORBIT, dy * ORBIT),
        });
    }

    fn wheel(&mut self, lines: f64) {
        let factor = WHEEL.powf(lines);
        if self.modifiers.state().control_key() {
            self.document.change(|plan| {
                let fov = plan.camera.fov / factor;
                plan.camera.fov = fov.clamp(1.0, plan.camera.projection.widest());
            });
        } else {
            self.flight.speed = (self.flight.speed * factor).clamp(1e-3, 1e3);
            let speed = self.flight.speed;
            self.tell(format!("speed of flight {speed:.2}"), false);
        }
    }

    /// Sets a key as the panel asks.
    pub fn set(&mut self, section: &str, name: &str, value: &Value) {
        let mut said = None;
        if self.panel_drag || self.panel_typing {
            self.document.begin();
        }
        self.document.change(|plan| {
            let mut keys = plan.keys(section).unwrap_or_default();
            if let Some(key) = keys.iter_mut().find(|key| key.name == name) {
                said = key.slot.set(value).err();
            }
            drop(keys);
            let last = last_key(plan);
            if plan.time.length < last {
                plan.time.length = last;
                said = Some(format!(
                    "at least {last}, where the last key is; move that first"
                ));
            }
        });
        if let Some(expects) = said {
            self.tell(format!("{section}.{name} must be {expects}"), true);
        }
        self.play.fit(self.document.plan.time.length);
        self.paint_now();
    }
}
