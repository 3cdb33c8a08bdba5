//! What the window shows at rest: the pictures and layers of files, and what there is at a pixel.

use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

use conemarch::preset;

use crate::desktop::{Desktop, Preview};
use crate::folder::{Folder, output};
use crate::{SIZE, picture};

#[test]
fn at_rest_the_window_shows_the_picture_of_the_file() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let view = Preview::open(&desktop, &folder.0, &format!("mandelbox {SIZE}"));
    view.key("Tab");
    folder.done(&format!("render mandelbox {SIZE} -o a.png"));
    let first = picture(&folder, "a.png");
    view.wait_for("the picture of the file", |shot| *shot == first);
    // At rest nothing is drawn, and nearly no time is spent.
    sleep(Duration::from_millis(500));
    let before = view.processor_time();
    sleep(Duration::from_secs(2));
    let spent = view.processor_time() - before;
    assert!(spent <= 0.05, "{spent} s of 2 at rest");
    // A flight changes the picture, a step back brings it back.
    view.hold("w", 400);
    let flown = view.at_rest();
    assert!(flown != first);
    view.key("ctrl+z");
    view.wait_for("the picture before the flight", |shot| *shot == first);
    view.key("ctrl+shift+z");
    view.wait_for("the picture after the flight", |shot| *shot == flown);
    // The copied command makes it, and so does what is saved.
    view.key("ctrl+c");
    sleep(Duration::from_millis(500));
    let copied = view.copied();
    let mut command = Command::new("sh");
    let program = env!("CARGO_BIN_EXE_conemarch");
    command
        .args(["-c", &copied.replacen("conemarch", program, 1)])
        .current_dir(&folder.0);
    assert!(output(&mut command).status.success(), "{copied}");
    assert!(picture(&folder, "picture.png") == flown, "{copied}");
    view.save(&folder.0.join("mandelbox-1.toml"));
    folder.done(&format!("render mandelbox-1.toml {SIZE} -o b.png"));
    assert!(picture(&folder, "b.png") == flown);
    // The file is read again when it changes.
    folder.done(&format!(
        "render mandelbox {SIZE} --set look.fog=2 -o c.png"
    ));
    let text = String::from_utf8(folder.bytes("mandelbox-1.toml")).unwrap();
    let edited = preset::read(&text, "edited").unwrap();
    let mut foggy = preset::load("mandelbox", &[]).unwrap().plan;
    foggy.look.fog = 2.0;
    assert!(foggy != edited);
    sleep(Duration::from_millis(20));
    folder.write("mandelbox-1.toml", preset::write(&foggy));
    let foggy_plan = foggy;
    let foggy = picture(&folder, "c.png");
    view.wait_for("the edited preset", |shot| *shot == foggy);
    // A broken file is told over the last good picture.
    folder.write("mandelbox-1.toml", "[scene\n");
    view.wait_for("what is wrong", |shot| *shot != foggy);
    folder.write("mandelbox-1.toml", preset::write(&foggy_plan));
    view.wait_for("the mended preset", |shot| *shot == foggy);
    std::fs::remove_file(folder.0.join("mandelbox-1.toml")).unwrap();
    view.wait_for("that the preset is gone", |shot| *shot != foggy);
    folder.write("mandelbox-1.toml", preset::write(&foggy_plan));
    view.wait_for("the preset that is back", |shot| *shot == foggy);
    view.key("Home");
    view.wait_for("the camera of the preset", |shot| *shot == foggy);
    view.close();
}

#[test]
fn a_picture_of_many_samples_follows_at_rest() {
    // The light of a picture with bloom is spread on the host.
    for bloom in ["0", "0.3"] {
        let (desktop, folder) = (Desktop::new(), Folder::new());
        let look = format!("{SIZE} --set look.bloom={bloom}");
        let line = format!("mandelbox {look} --set image.samples=6");
        let view = Preview::open(&desktop, &folder.0, &line);
        view.key("Tab");
        for samples in [1, 6] {
            let file = format!("{samples}.png");
            folder.done(&format!(
                "render mandelbox {look} --samples {samples} -o {file}"
            ));
        }
        let [one, six] = ["1.png", "6.png"].map(|file| picture(&folder, file));
        assert!(one != six);
        view.wait_for("six samples", |shot| *shot == six);
        // Another look is shown at once, and refined again.
        view.hold("w", 300);
        view.key("Home");
        view.wait_for("six samples again", |shot| *shot == six);
        view.close();
    }
}

#[test]
fn a_slider_is_one_step_and_the_layers_are_those_of_files() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let view = Preview::open(&desktop, &folder.0, "mandelbox --size 960x540");
    view.at_rest();
    // The slider of `scene.scale`.
    view.drag(1, [792, 94], [812, 94]);
    view.at_rest();
    let saved = view.save(&folder.0.join("mandelbox-1.toml"));
    let before = preset::load("mandelbox", &[]).unwrap().plan;
    assert!(saved.scene != before.scene && saved.camera == before.camera);
    view.key("ctrl+z");
    let undone = view.save(&folder.0.join("mandelbox-1.toml"));
    assert_eq!(undone.scene, before.scene);
    // Its places are those of small scales too, and its number is dragged by hundredths of it.
    view.drag(1, [792, 94], [806, 94]);
    view.at_rest();
    let scale = || {
        view.save(&folder.0.join("mandelbox-1.toml"));
        let text = String::from_utf8(folder.bytes("mandelbox-1.toml")).unwrap();
        let table: toml::Table = text.parse().unwrap();
        table["scene"]["scale"].as_float().unwrap()
    };
    let dragged = scale();
    assert!((2.5..25.0).contains(&dragged), "{dragged}");
    view.key("ctrl+z");
    view.at_rest();
    view.drag(1, [876, 94], [896, 94]);
    view.at_rest();
    let dragged = scale();
    assert!((2.05..2.7).contains(&dragged), "{dragged}");
    view.key("ctrl+z");
    view.key("Tab");
    // Several layers come from the same render.
    for (key, layer) in [
        ("2", "depth"),
        ("4", "position"),
        ("3", "normal"),
        ("6", "state"),
        ("2", "depth"),
    ] {
        let file = format!("{layer}.png");
        folder.done(&format!(
            "render mandelbox --size 960x540 --layer {layer} -o {file}"
        ));
        let shown = picture(&folder, &file);
        view.key(key);
        view.wait_for(layer, |shot| *shot == shown);
    }
    // So do the views of passes.
    let mut before = view.at_rest();
    for key in ["bracketleft", "bracketleft", "7"] {
        view.key(key);
        view.wait_for("another pass", |shot| *shot != before);
        before = view.at_rest();
    }
    view.close();
}

#[test]
fn a_plan_that_does_not_fit_is_told_at_rest() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    // So many samples are not done before the plan no longer fits.
    let line = "mandelbox --size 960x540 --set image.samples=4096";
    let view = Preview::open(&desktop, &folder.0, line);
    // The number of `scene.scale`.
    view.type_into([858, 94], "0");
    view.at_rest();
    sleep(Duration::from_millis(500));
    let before = view.processor_time();
    sleep(Duration::from_secs(2));
    let spent = view.processor_time() - before;
    assert!(spent <= 0.05, "{spent} s of 2 at rest");
    view.key("ctrl+z");
    view.close();
}

#[test]
fn a_pixel_is_told_with_its_error_in_every_view() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let view = Preview::open(&desktop, &folder.0, "mandelbox --size 640x360");
    view.key("Tab");
    view.at_rest();
    // White letters on the dark box.
    let told = || {
        view.point(320, 150);
        view.xdotool("keydown alt click 1 keyup alt");
        sleep(Duration::from_millis(1500));
        let shot = view.at_rest();
        let rows = shot.rgb.chunks_exact(3 * 640).skip(318).take(15);
        // Farther to the right the sky is behind the box, which is white in layer 2.
        let letters = rows.flat_map(|row| row[3 * 16..3 * 400].iter().map(|x| *x > 250));
        letters.collect::<Vec<_>>()
    };
    let before = told();
    view.key("2");
    view.at_rest();
    let now = told();
    // The edges of letters mix with what is behind them.
    let letters = before.iter().filter(|on| **on).count();
    let other = before.iter().zip(&now).filter(|(a, b)| a != b).count();
    assert!(10 * other < letters, "{other} of {letters}");
    view.close();
}
