//! Sizes, events and machines that could do harm.

use std::thread::sleep;
use std::time::Duration;

use crate::desktop::{Desktop, Preview};
use crate::folder::{Folder, output, said};
use crate::random::Random;
use crate::{SIZE, picture};

#[test]
fn a_window_may_be_tiny_large_or_hidden() {
    let (desktop, folder) = (Desktop::of("4096x2400"), Folder::new());
    let view = Preview::open(&desktop, &folder.0, &format!("bench-far {SIZE}"));
    view.key("Tab");
    for size in [[1, 1], [3840, 2160], [320, 180]] {
        let [w, h] = size;
        folder.done(&format!("render bench-far --size {w}x{h} -o a.png"));
        let wanted = picture(&folder, "a.png");
        view.resize(w, h);
        view.hold("w", 200);
        view.key("Home");
        view.wait_for(&format!("{w} x {h}"), |shot| *shot == wanted);
    }
    let wanted = picture(&folder, "a.png");
    view.hide(true);
    sleep(Duration::from_millis(500));
    let before = view.processor_time();
    sleep(Duration::from_secs(2));
    let spent = view.processor_time() - before;
    assert!(spent <= 0.05, "{spent} s of 2 while hidden");
    // A key that went down elsewhere means nothing here.
    view.xdotool("keydown 2");
    view.hide(false);
    view.xdotool("keyup 2");
    view.wait_for("the picture after it was hidden", |shot| *shot == wanted);
    view.at_rest();
    assert!(view.shot().is_some_and(|shot| shot == wanted));
    view.close();
}

#[test]
fn any_size_and_any_events_do_no_harm() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let line = format!("terrain {SIZE} --stats stats.json");
    let view = Preview::open(&desktop, &folder.0, &line);
    let mut random = Random::new(7);
    let keys =
        "w a s d e q z x Home Tab t o 1 2 3 5 6 7 bracketleft bracketright k space comma ctrl+z F1";
    let keys: Vec<&str> = keys.split(' ').collect();
    for _ in 0..300 {
        let mut to = |most: f64| (random.between(0.0, 1.0) * most) as u32;
        match to(4.0) {
            0 => view.resize(1 + to(900.0), 1 + to(600.0)),
            1 => view.drag_at_once(
                1 + 2 * to(2.0),
                [to(300.0), to(150.0)],
                [to(300.0), to(150.0)],
            ),
            _ => view.key(keys[to(keys.len() as f64) as usize]),
        }
    }
    view.resize(320, 180);
    view.wait_for("its size again", |shot| shot.size == [320, 180]);
    view.close();
    let stats = String::from_utf8(folder.bytes("stats.json")).unwrap();
    assert!(stats.contains("answer_ms"), "{stats}");
}

#[test]
fn without_a_display_a_sentence_tells_what_would_do() {
    let folder = Folder::new();
    let mut command = folder.command("preview mandelbox");
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    let ended = output(&mut command);
    assert_eq!(ended.status.code(), Some(1));
    let said = said(&ended);
    assert!(
        said.starts_with("error: no window opens") && said.contains("render"),
        "{said}"
    );
    folder.fails("preview mandelbox --wgsl none", 2, "`none` is no folder");
    folder.fails("preview --size 8200x40", 2, "at most 8192x8192 pixels");
}
