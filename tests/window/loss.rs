//! A device that its driver loses while the window is open.

use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::desktop::{Desktop, Preview};
use crate::folder::{Folder, said};
use crate::{FILM, SIZE, picture};

/// Makes the layer of `lost.c` in a folder, and a command use it.
fn with_layer(command: &mut Command, folder: &Path) {
    let library = folder.join("lost.so");
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/window/lost.c");
    let mut compiler = Command::new("cc");
    compiler.args(["-shared", "-fPIC", source, "-o"]);
    let made = compiler.arg(&library).status();
    assert!(made.expect("cc, which links Rust programs").success());
    let manifest = format!(
        r#"{{"file_format_version": "1.0.0", "layer": {{"name": "VK_LAYER_lost", "type": "GLOBAL",
        "library_path": "{}", "api_version": "1.3.0", "implementation_version": "1",
        "description": "loses devices", "functions": {{"vkGetInstanceProcAddr": "find_of_instance",
        "vkGetDeviceProcAddr": "find_of_device"}}}}}}"#,
        library.display()
    );
    std::fs::write(folder.join("lost.json"), manifest).expect("written");
    command
        .env("VK_LAYER_PATH", folder)
        .env("VK_INSTANCE_LAYERS", "VK_LAYER_lost")
        .env("LOSE", folder);
}

/// A window whose device can be lost.
fn open<'a>(desktop: &'a Desktop, folder: &Folder, line: &str) -> Preview<'a> {
    let mut command = Preview::command(desktop, &folder.0, line);
    with_layer(&mut command, &folder.0);
    Preview::start(desktop, command)
}

/// Loses the device at the next submission.
fn lose(folder: &Folder, what: &str) {
    folder.write(what, "");
    wait_until_lost(folder, what);
}

fn wait_until_lost(folder: &Folder, what: &str) {
    let began = Instant::now();
    while folder.0.join(what).exists() {
        assert!(began.elapsed() < Duration::from_secs(20), "no submission");
        sleep(Duration::from_millis(20));
    }
}

fn wait_for_still(folder: &Folder, name: &str) {
    let began = Instant::now();
    while !folder.0.join(name).exists() {
        assert!(began.elapsed() < Duration::from_secs(60), "no still");
        sleep(Duration::from_millis(100));
    }
}

#[test]
fn a_lost_device_is_opened_again_and_nothing_is_lost() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let film = FILM.replace("length = 2\n", "length = 60\n");
    let film = film.replace("size = [320, 180]", "size = [1280, 720]");
    folder.write("film.toml", film);
    let view = open(&desktop, &folder, &format!("film.toml {SIZE}"));
    view.key("Tab");
    view.key("t");
    let lose = |what: &str| lose(&folder, what);
    folder.done(&format!("render film.toml {SIZE} --at 0 -o a.png"));
    let first = picture(&folder, "a.png");
    let is_first = || view.wait_for("the first moment", |shot| *shot == first);
    is_first();
    // A flight goes on, and is a step that can be taken back. Nothing of a lost device is kept.
    let shown = ["lose-shown"; 4];
    let mut memory = Vec::new();
    for what in ["lose"].into_iter().chain(shown) {
        view.xdotool("keydown w");
        lose(what);
        sleep(Duration::from_millis(100));
        view.xdotool("keyup w");
        assert!(view.at_rest() != first);
        view.key("ctrl+z");
        is_first();
        memory.push(view.memory());
    }
    // One that is kept has some 35 MiB here.
    assert!(memory[4] < memory[0] + 50.0, "{memory:?} MiB");
    // So does a film, and no time is dropped.
    let began = Instant::now();
    view.key("space");
    sleep(Duration::from_millis(500));
    lose("lose-shown");
    sleep(Duration::from_millis(1500));
    view.key("space");
    let played = began.elapsed().as_secs_f64();
    view.key("k");
    let saved = view.save(&folder.0.join("film.toml"));
    let shown = saved.tracks[1].keys[0].time;
    assert!((shown - played).abs() < 0.3, "{shown} of {played} s");
    // A still begins again.
    view.at_rest();
    view.key("F12");
    lose("lose");
    wait_for_still(&folder, "film-1.png");
    folder.done(&format!("render film.toml --at {shown} -o b.png"));
    assert!(picture(&folder, "film-1.png") == picture(&folder, "b.png"));
    view.close();
}

#[test]
fn a_hidden_window_notices_a_lost_device() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    // The still takes long enough to hide the window in the middle.
    let film = FILM.replace("[320, 180]\nsamples = 1", "[1280, 720]\nsamples = 64");
    folder.write("film.toml", film);
    let view = open(&desktop, &folder, &format!("film.toml {SIZE}"));
    view.key("F12");
    view.hide(true);
    sleep(Duration::from_millis(500));
    lose(&folder, "lose");
    wait_for_still(&folder, "film-1.png");
    view.hide(false);
    view.close();
}

#[test]
fn a_lost_device_and_a_question_are_answered_over_settings_that_do_not_fit() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let view = open(&desktop, &folder, "mandelbox --size 960x540");
    view.key("Tab");
    let first = view.at_rest();
    view.key("Tab");
    view.at_rest();
    // The number of `scene.scale`.
    view.type_into([858, 94], "0.5");
    view.point(200, 300);
    let unfit = view.at_rest();
    view.xdotool("keydown alt click 1 keyup alt");
    let told = view.wait_for("an answer", |shot| *shot != unfit);
    folder.write("lose-shown", "");
    view.key("F1");
    view.wait_for("the keys", |shot| *shot != told);
    wait_until_lost(&folder, "lose-shown");
    view.key("F1");
    view.key("ctrl+z");
    view.key("Tab");
    view.wait_for("the settings before", |shot| *shot == first);
    view.close();
}

#[test]
fn without_an_adapter_for_the_window_a_sentence_tells_what_would_do() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    folder.write("blind", "");
    for device in ["auto", "0", "cpu"] {
        let line = format!("mandelbox --device {device}");
        let mut command = Preview::command(&desktop, &folder.0, &line);
        with_layer(&mut command, &folder.0);
        command.stderr(Stdio::piped());
        let mut process = command.spawn().expect("the program");
        let began = Instant::now();
        while process.try_wait().expect("a process").is_none() {
            if began.elapsed() > Duration::from_secs(60) {
                process.kill().expect("a process");
                panic!("{device}: a window is open");
            }
            sleep(Duration::from_millis(50));
        }
        let ended = process.wait_with_output().expect("what it said");
        assert_eq!(ended.status.code(), Some(1));
        let said = said(&ended);
        let begins = said.starts_with("error: no adapter can show pictures in this window (");
        assert!(begins && said.contains("`render`"), "{device}: {said}");
    }
}
