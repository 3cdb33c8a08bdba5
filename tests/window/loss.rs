//! A device that its driver loses while the window is open.

use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::desktop::{Desktop, Preview};
use crate::folder::{Folder, output, said};
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

#[test]
fn a_lost_device_is_opened_again_and_nothing_is_lost() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let film = FILM.replace("length = 2\n", "length = 60\n");
    let film = film.replace("size = [320, 180]", "size = [1280, 720]");
    folder.write("film.toml", film);
    let mut command = Preview::command(&desktop, &folder.0, &format!("film.toml {SIZE}"));
    with_layer(&mut command, &folder.0);
    let view = Preview::start(&desktop, command);
    let lose = |what: &str| {
        folder.write(what, "");
        let began = Instant::now();
        while folder.0.join(what).exists() {
            assert!(began.elapsed() < Duration::from_secs(20), "no submission");
            sleep(Duration::from_millis(20));
        }
    };
    view.key("Tab");
    view.key("t");
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
    let began = Instant::now();
    while !folder.0.join("film-1.png").exists() {
        assert!(began.elapsed() < Duration::from_secs(60), "no still");
        sleep(Duration::from_millis(100));
    }
    folder.done(&format!("render film.toml --at {shown} -o b.png"));
    assert!(picture(&folder, "film-1.png") == picture(&folder, "b.png"));
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
        let ended = output(&mut command);
        assert_eq!(ended.status.code(), Some(1));
        let said = said(&ended);
        let begins = said.starts_with("error: no adapter can show pictures in this window (");
        assert!(begins && said.contains("`render`"), "{device}: {said}");
    }
}
