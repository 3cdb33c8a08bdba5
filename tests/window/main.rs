//! The preview in a real window: what it shows at rest is what the other commands write.
#![cfg(all(target_os = "linux", feature = "preview"))]
#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "tests are read by their names, and one that panics has failed"
)]

mod desktop;
#[path = "../common/folder.rs"]
#[allow(dead_code, reason = "other files use the rest")]
mod folder;
mod loss;
#[path = "../common/random.rs"]
#[allow(dead_code, reason = "other files use the rest")]
mod random;

use std::thread::sleep;
use std::time::{Duration, Instant};

use conemarch::preset;
use desktop::{Desktop, Preview, Shot};
use folder::{Folder, output, said};
use random::Random;

/// A picture in a file.
fn picture(folder: &Folder, name: &str) -> Shot {
    let decoded = image::open(folder.0.join(name)).unwrap().into_rgb8();
    Shot {
        size: [decoded.width(), decoded.height()],
        rgb: decoded.into_raw(),
    }
}

const SIZE: &str = "--size 320x180";

/// A film whose first moment is not its still.
const FILM: &str = r#"
[scene]
kind = "distance"
formula = "mandelbox"
[camera]
eye = [12, -14, 3]
[image]
size = [320, 180]
[time]
length = 2
fps = 10
[[track]]
key = "camera.eye"
keys = [[0, [10, -17, 12]], [2, [17, 10, 12]]]
"#;

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
    // What is saved is what was seen.
    view.key("ctrl+s");
    sleep(Duration::from_millis(500));
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
    view.key("ctrl+s");
    sleep(Duration::from_millis(500));
    let saved = preset::load(folder.0.join("mandelbox-1.toml"), &[])
        .unwrap()
        .plan;
    let before = preset::load("mandelbox", &[]).unwrap().plan;
    assert!(saved.scene != before.scene && saved.camera == before.camera);
    view.key("ctrl+z");
    view.key("ctrl+s");
    sleep(Duration::from_millis(500));
    let undone = preset::load(folder.0.join("mandelbox-1.toml"), &[])
        .unwrap()
        .plan;
    assert_eq!(undone.scene, before.scene);
    view.key("Tab");
    for (key, layer) in [("2", "depth"), ("3", "normal"), ("6", "state")] {
        let file = format!("{layer}.png");
        folder.done(&format!(
            "render mandelbox --size 960x540 --layer {layer} -o {file}"
        ));
        let shown = picture(&folder, &file);
        view.key(key);
        view.wait_for(layer, |shot| *shot == shown);
    }
    view.close();
}

#[test]
fn the_timeline_shows_the_frames_of_the_film() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    folder.write("film.toml", FILM);
    folder.done("animate film.toml -o f-%02d.png --frames 0..7");
    folder.done("animate film.toml -o f-%02d.png --frames 19..19");
    let view = Preview::open(&desktop, &folder.0, &format!("film.toml {SIZE}"));
    view.key("Tab");
    view.key("t");
    let shows = |frame: u32| {
        let wanted = picture(&folder, &format!("f-{frame:02}.png"));
        view.wait_for(&format!("frame {frame}"), |shot| *shot == wanted);
    };
    shows(0);
    for _ in 0..7 {
        view.key("period");
    }
    shows(7);
    view.key("comma");
    shows(6);
    // To the end, and it stops there.
    view.key("space");
    folder.done(&format!("render film.toml {SIZE} --at 2 -o end.png"));
    let end = picture(&folder, "end.png");
    view.wait_for("the end of the film", |shot| *shot == end);
    // A key of another view at the end.
    view.hold("d", 300);
    let flown = view.at_rest();
    view.key("k");
    // It shows the timeline.
    view.key("t");
    view.key("ctrl+s");
    sleep(Duration::from_millis(500));
    let saved = preset::load(folder.0.join("film.toml"), &[]).unwrap().plan;
    assert_eq!(saved.tracks.len(), 3);
    assert!(saved.tracks[0].keys[1].value != [17.0, 10.0, 12.0]);
    // The still of the file stays.
    assert_eq!(saved.camera.eye.to_array(), [12.0, -14.0, 3.0]);
    // A step back takes the key away, and another one the flight. Both come back.
    let shows_flown = || view.wait_for("the view of the flight", |shot| *shot == flown);
    view.key("ctrl+z");
    shows_flown();
    view.key("ctrl+z");
    view.wait_for("the end of the film again", |shot| *shot == end);
    view.key("ctrl+shift+z");
    shows_flown();
    view.key("ctrl+shift+z");
    // Under another playhead they go back to the moment there, not to that of the steps.
    folder.done("animate film.toml -o g-%02d.png --frames 19..19");
    let keyed = picture(&folder, "g-19.png");
    view.key("comma");
    view.wait_for("a frame before the key", |shot| *shot == keyed);
    view.key("ctrl+z");
    view.key("ctrl+z");
    shows(19);
    view.close();
}

#[test]
fn a_still_and_unsaved_work_outlive_the_window() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    folder.write("film.toml", FILM);
    let view = Preview::open(&desktop, &folder.0, &format!("film.toml {SIZE}"));
    view.at_rest();
    view.key("F12");
    for _ in 0..100 {
        if folder.files().contains(&"film-1.png".to_string()) {
            break;
        }
        sleep(Duration::from_millis(100));
    }
    folder.done("render film.toml --at 0 -o a.png");
    assert_eq!(
        folder.files(),
        ["a.png", "cache", "film-1.png", "film.toml"]
    );
    assert!(picture(&folder, "film-1.png") == picture(&folder, "a.png"));
    view.hold("w", 400);
    sleep(Duration::from_millis(2500));
    // A crash.
    drop(view);
    let kept = std::fs::read_dir(folder.0.join("cache/conemarch")).unwrap();
    let kept: Vec<_> = kept.map(|file| file.unwrap().path()).collect();
    assert_eq!(kept.len(), 1, "{kept:?}");
    let before = preset::load(folder.0.join("film.toml"), &[]).unwrap().plan;
    let plan = preset::load(&kept[0], &[]).unwrap().plan;
    assert!(plan.camera != before.camera && plan.scene == before.scene);
}

/// The first rows of a picture.
fn upper(shot: &Shot, rows: usize) -> &[u8] {
    &shot.rgb[..rows * 3 * shot.size[0] as usize]
}

#[test]
fn what_is_wrong_with_a_file_is_told_over_the_last_good_picture() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    folder.write("film.toml", FILM);
    let view = Preview::open(&desktop, &folder.0, "film.toml --size 640x360");
    view.key("Tab");
    view.key("t");
    folder.done("render film.toml --size 640x360 --at 0 -o a.png");
    let good = picture(&folder, "a.png");
    let is_good = |shot: &Shot| *shot == good;
    let is_told = |shot: &Shot| *shot != good && upper(shot, 240) == upper(&good, 240);
    view.wait_for("the good picture", is_good);
    let heights = "[scene]\nkind = 'heightfield'\nfield = 'none.png'\n";
    for (what, wrong) in [
        ("broken text", FILM.replace("[time]", "[time")),
        (
            "a track of no key",
            FILM.replace("\"camera.eye\"", "\"camera.eyes\""),
        ),
        ("a key beyond the end", FILM.replace("[2, [", "[2.5, [")),
        ("heights that are gone", heights.into()),
    ] {
        sleep(Duration::from_millis(20));
        folder.write("film.toml", wrong);
        view.wait_for(what, is_told);
        sleep(Duration::from_millis(20));
        folder.write("film.toml", FILM);
        view.wait_for("the mended film", is_good);
    }
    // The same file goes and comes back.
    let [file, aside] = ["film.toml", "aside.toml"].map(|name| folder.0.join(name));
    std::fs::rename(&file, &aside).unwrap();
    view.wait_for("that the film is gone", is_told);
    std::fs::rename(&aside, &file).unwrap();
    view.wait_for("the film that is back", is_good);
    view.close();
}

#[test]
fn another_preset_keeps_unsaved_work_and_none_is_lost() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let kept = || {
        let files = std::fs::read_dir(folder.0.join("cache/conemarch"));
        let names = files.map(|all| all.map(|f| f.unwrap().file_name().into_string().unwrap()));
        let mut names: Vec<String> = names.map(|all| all.collect()).unwrap_or_default();
        names.sort();
        names
    };
    let view = Preview::open(&desktop, &folder.0, "mandelbox --size 960x540");
    let first = view.at_rest();
    view.hold("w", 400);
    let flown = view.at_rest();
    // The list of presets, and in it `bench-far` and `mandelbox`.
    let choose = |row: u32| {
        view.click(700, 16);
        sleep(Duration::from_millis(700));
        view.click(680, 43 + 23 * row);
    };
    choose(0);
    view.at_rest();
    assert_eq!(kept(), ["unsaved-mandelbox.toml"]);
    let left = |shot: &Shot| {
        let rows = shot.rgb.chunks_exact(3 * 960).skip(140).take(340);
        rows.flat_map(|row| &row[..3 * 600])
            .copied()
            .collect::<Vec<_>>()
    };
    // It is offered over the preset as it is.
    choose(6);
    let same = |shot: &Shot, wanted: &Shot| left(shot) == left(wanted);
    view.wait_for("the preset again", |shot| same(shot, &first));
    // Whoever goes on without an answer loses neither the old nor the new work.
    view.hold("d", 300);
    sleep(Duration::from_millis(2500));
    assert_eq!(
        kept(),
        ["unsaved-mandelbox-1.toml", "unsaved-mandelbox.toml"]
    );
    // Restore.
    view.click(RESTORE[0], RESTORE[1]);
    view.wait_for("the work again", |shot| same(shot, &flown));
    view.close();
}

/// The button that takes unsaved work, in a window of 960 x 540.
const RESTORE: [u32; 2] = [346, 89];

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
        let letters = rows.flat_map(|row| row[3 * 16..3 * 500].iter().map(|x| *x > 250));
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

#[test]
fn playing_drops_pictures_and_never_time() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    // No machine that these tests run on shows so many pictures.
    let film = FILM.replace("length = 2\nfps = 10", "length = 60\nfps = 1000");
    folder.write("film.toml", film);
    let view = Preview::open(&desktop, &folder.0, "film.toml --size 960x540");
    let mut played = 0.0;
    for _ in 0..8 {
        let began = Instant::now();
        view.key("space");
        sleep(Duration::from_millis(600));
        view.key("space");
        played += began.elapsed().as_secs_f64();
        // Long enough to rest.
        sleep(Duration::from_millis(900));
    }
    view.key("k");
    view.key("ctrl+s");
    sleep(Duration::from_millis(1000));
    let saved = preset::load(folder.0.join("film.toml"), &[]).unwrap().plan;
    let times = saved.tracks[1].keys.iter().map(|key| key.time);
    let shown = times.fold(0.0, f64::max);
    assert!((shown - played).abs() < 0.6, "{shown} of {played} s");
    view.close();
}

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
    view.hide(false);
    view.wait_for("the picture after it was hidden", |shot| *shot == wanted);
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
}
