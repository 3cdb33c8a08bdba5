//! Films: tracks in presets, one moment of a film, and its frames.

use std::fs;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use conemarch::plan::Plan;
use conemarch::preset::{read, write};
use glam::DVec3;

use crate::folder::{Folder, output, said, signal};
use crate::images::pixels;

/// A film of 8 frames: a camera that circles, and a light that grows.
const FILM: &str = r#"
[scene]
kind = "slab"
[camera]
eye = [3, 0, 1]
[image]
size = [24, 16]
[time]
length = 4
bpm = 120
fps = 4
[[track]]
key = "camera.eye"
keys = [[0, [3, 0, 1]], [2, [0, 3, 1]], [4, [-3, 0, 1]]]
[[track]]
key = "look.key"
between = "linear"
keys = [[0, 0], [4, 2, "step"]]
[[track]]
key = "look.sky_high"
keys = [[0, [0, 0, 0]], [1, [1, 1, 1], "ramp"], [3, [0, 1, 0]]]
"#;

fn film() -> Plan {
    read(FILM, "film").unwrap()
}

#[test]
fn a_film_reads_back_as_it_was_written() {
    let plan = film();
    assert_eq!(plan.tracks.len(), 3);
    assert_eq!(read(&write(&plan), "again").unwrap(), plan);
    assert_eq!(plan.time.frames(), 8);
}

#[test]
fn a_moment_is_a_still_with_the_values_of_its_time() {
    let plan = film();
    let at = |beat: f64| plan.at(beat).unwrap();
    assert_eq!(at(2.0).look.key, 1.0);
    assert_eq!(at(4.0).look.key, 2.0);
    assert_eq!(at(0.5).look.sky_high, DVec3::splat(0.5));
    assert_eq!(at(2.0).look.sky_high, DVec3::new(0.75, 1.0, 0.75));
    assert_eq!(at(9.0), at(4.0));
    let still = at(1.0);
    assert!(still.tracks.is_empty());
    assert_eq!(read(&write(&still), "still").unwrap(), still);
    // The keys of the camera lie on a circle about the target, and so do the moments between.
    for beat in [0.0, 0.7, 2.0, 3.1, 4.0] {
        let camera = at(beat).camera;
        assert!((camera.eye.distance(camera.target) - 10f64.sqrt()).abs() < 1e-9);
        assert!((camera.eye.z - 1.0).abs() < 1e-9, "{beat} {camera:?}");
        assert!(camera.target.length() < 1e-9 && camera.up == DVec3::Z);
    }
    assert!(at(0.7).camera.eye != at(0.8).camera.eye);
}

#[test]
fn a_film_that_loops_goes_on_around_its_end() {
    let closed =
        "[[0, [3, 0, 1]], [1, [0, 3, 1]], [2, [-3, 0, 2]], [2.5, [0, -3, 1]], [4, [3, 0, 1]]]";
    let open = "[[0, [3, 0, 1]], [2, [0, 3, 1]], [4, [-3, 0, 1]]]";
    let text = FILM
        .replace("bpm = 120", "loop = true")
        .replace(open, closed);
    let plan = read(&text, "loop").unwrap();
    let eye = |beat: f64| plan.at(beat).unwrap().camera.eye;
    assert!(eye(4.5).distance(eye(0.5)) < 1e-12);
    let step = 1e-5;
    let (before, after) = (eye(0.0) - eye(4.0 - step), eye(step) - eye(0.0));
    assert!(before.distance(after) < 1e-3 * before.length());
    let still = read(&text.replace("loop = true", ""), "open").unwrap();
    let eye = |beat: f64| still.at(beat).unwrap().camera.eye;
    let (before, after) = (eye(4.0) - eye(4.0 - step), eye(step) - eye(0.0));
    assert!(before.distance(after) > 0.1 * before.length());
}

#[test]
fn tracks_of_one_camera_do_not_spoil_each_other() {
    let plan = |eye: &str, target: &str| {
        let tracks = format!(
            "[scene]\nkind = \"slab\"\n[[track]]\nkey = \"camera.eye\"\n{eye}\n[[track]]\nkey = \"camera.target\"\n{target}\n"
        );
        read(&tracks, "film").unwrap()
    };
    let camera = |plan: &Plan, beat: f64| plan.at(beat).unwrap().camera;
    // A zoom is even, with a key of the target in the middle too.
    let eye = "between = \"linear\"\nkeys = [[0, [100, 0, 0]], [10, [0.01, 0, 0]]]";
    let target = "between = \"linear\"\nkeys = [[0, [0, 0, 0]], [5, [0, 0, 0]], [7, [0, 0, 0]]]";
    let zoom = plan(eye, target);
    for (beat, x) in [
        (0.0, 100.0),
        (2.5, 10.0),
        (5.0, 1.0),
        (7.5, 0.1),
        (10.0, 0.01),
    ] {
        let there = camera(&zoom, beat).eye.x;
        assert!((there / x - 1.0).abs() < 1e-9, "{beat} {there}");
    }
    // An eye that is held is cut, while the target moves on.
    let eye = "between = \"step\"\nkeys = [[0, [9, 0, 0]], [4, [0, 9, 0]]]";
    let target = "keys = [[0, [0, 0, 0]], [8, [0, 0, 3]]]";
    let cut = plan(eye, target);
    for (beat, eye) in [
        (0.0, DVec3::X),
        (3.99, DVec3::X),
        (4.0, DVec3::Y),
        (7.0, DVec3::Y),
    ] {
        assert_eq!(camera(&cut, beat).eye, 9.0 * eye, "{beat}");
    }
    assert!(camera(&cut, 3.0).target.z < camera(&cut, 6.0).target.z);
    // Nor does the cut bend the way of the target before it.
    let eye = "between = \"step\"\nkeys = [[0, [9, 0, 0]], [4, [-9, 0, 0]]]";
    let target = "between = \"linear\"\nkeys = [[0, [0, 0, 0]], [4, [0, 0, 3]]]";
    let cut = plan(eye, target);
    for beat in [0.5, 2.0, 3.9] {
        let target = camera(&cut, beat).target;
        assert!(
            target.y.abs() < 1e-9 && target.x.abs() < 1.0,
            "{beat} {target}"
        );
    }
    // What has no track keeps every bit.
    let alone = "[scene]\nkind = \"slab\"\n[[track]]\nkey = \"camera.eye\"\nkeys = [[0, [9, 0, 1]], [4, [0, 8, 1]]]\n";
    let alone = read(alone, "film").unwrap();
    assert_eq!(camera(&alone, 1.7).target, DVec3::ZERO);
}

/// A film of a camera with tracks of these keys.
fn of_camera(tracks: &[(&str, &str)]) -> Plan {
    let tracks = tracks
        .iter()
        .map(|(key, lines)| format!("[[track]]\nkey = \"camera.{key}\"\n{lines}\n"));
    let text = format!("[scene]\nkind = \"slab\"\n{}", tracks.collect::<String>());
    read(&text, "film").unwrap()
}

#[test]
fn an_upward_direction_that_stays_keeps_the_horizon_level() {
    let eye = "keys = [[0, [9, 0, 1]], [4, [0, 8, 5]], [9, [-7, 0, 2]]]";
    let up = "keys = [[0, [0, 0, 1]], [4, [0, 0, 1]], [9, [1, 0, 2]]]";
    for way in ["linear", "smooth"] {
        let between = format!("between = \"{way}\"\n");
        let [eye, up] = [eye, up].map(|keys| format!("{between}{keys}"));
        let plan = of_camera(&[("eye", &eye), ("up", &up)]);
        let camera = |beat: f64| plan.at(beat).unwrap().camera;
        for beat in [0.0, 1.3, 2.0, 3.9, 4.0] {
            assert_eq!(camera(beat).up, DVec3::Z, "{way} {beat}");
        }
        // Other directions are those of the keys there, and turn without a jump between them.
        assert_eq!(camera(9.0).up, DVec3::new(1.0, 0.0, 2.0));
        for beat in [4.0, 9.0] {
            let side = |beat: f64| {
                let camera = camera(beat);
                let view = (camera.target - camera.eye).normalize();
                view.cross(camera.up).normalize()
            };
            let [before, after] = [-1e-6, 1e-6].map(|step| side(beat + step));
            assert!(before.distance(after) < 1e-4, "{way} {beat}");
        }
    }
    // A key of the eye does not roll it either.
    let up = "keys = [[0, [0, 0, 1]], [9, [0, 0, 1]]]";
    let plan = of_camera(&[("eye", eye), ("up", up)]);
    for beat in [2.0, 4.0, 6.0] {
        assert_eq!(plan.at(beat).unwrap().camera.up, DVec3::Z, "{beat}");
    }
}

#[test]
fn a_track_that_is_over_or_has_not_begun_says_nothing_of_the_way() {
    let eye = "between = \"linear\"\nkeys = [[0, [9, 0, 0]], [8, [9, 8, 0]]]";
    let over = "between = \"smooth\"\nkeys = [[0, [0, 0, 0]], [1, [0, 0, 0]]]";
    let later = "between = \"smooth\"\nkeys = [[7, [0, 0, 0]], [8, [0, 0, 0]]]";
    for (target, beats) in [(over, [1.5, 3.0, 7.5]), (later, [0.5, 3.0, 6.5])] {
        let [with, alone] = [
            of_camera(&[("eye", eye), ("target", target)]),
            of_camera(&[("eye", eye)]),
        ];
        for beat in beats {
            let eye = |plan: &Plan| plan.at(beat).unwrap().camera.eye;
            assert!(eye(&with).distance(eye(&alone)) < 1e-9, "{target} {beat}");
        }
    }
    // Between two tracks nothing moves.
    let eye = "keys = [[0, [9, 0, 0]], [2, [9, 8, 0]]]";
    let target = "keys = [[6, [0, 0, 0]], [8, [0, 0, 3]]]";
    let plan = of_camera(&[("eye", eye), ("target", target)]);
    assert_eq!(plan.at(4.0).unwrap().camera.eye, DVec3::new(9.0, 8.0, 0.0));
}

#[test]
fn a_cut_does_not_bend_the_ways_on_its_sides() {
    let before = "[0, [9, 0, 1]], [1, [9, 2, 1]], [3, [8, 4, 1], \"step\"]";
    let after = "[4, [-9, 3, 1]], [5, [-8, 2, 1]], [7, [-7, -2, 1]]";
    let film = |keys: &str| of_camera(&[("eye", &format!("keys = [{keys}]"))]);
    let both = film(&format!("{before}, {after}"));
    for (alone, beats) in [
        (film(before), [0.4, 1.5, 2.9]),
        (film(after), [4.1, 4.9, 6.0]),
    ] {
        for beat in beats {
            let eye = |plan: &Plan| plan.at(beat).unwrap().camera.eye;
            assert!(eye(&both).distance(eye(&alone)) < 1e-12, "{beat}");
        }
    }
    // A cut to the last key happens.
    let last = film(&format!("{before}, [4, [-9, 3, 1]]"));
    for (beat, x) in [(3.9, 8.0), (4.0, -9.0), (7.0, -9.0)] {
        assert!(
            (last.at(beat).unwrap().camera.eye.x - x).abs() < 1e-12,
            "{beat}"
        );
    }
    // Of a loop, too.
    let closed = |keys: &str| {
        let text = format!(
            "[scene]\nkind = \"slab\"\n[time]\nlength = 8\nloop = true\n[[track]]\nkey = \"camera.eye\"\nkeys = [{keys}]\n"
        );
        read(&text, "loop").unwrap()
    };
    let cut = closed(&format!(
        "[0, [9, 0, 1], \"step\"], {after}, [8, [9, 0, 1]]"
    ));
    let open = film(&format!("{after}, [8, [9, 0, 1]]"));
    for beat in [4.5, 6.0, 7.5] {
        let eye = |plan: &Plan| plan.at(beat).unwrap().camera.eye;
        assert!(eye(&cut).distance(eye(&open)) < 1e-12, "{beat}");
    }
}

#[test]
fn values_between_two_keys_may_not_fit() {
    let text = "[scene]\nkind = \"distance\"\nformula = \"mandelbox\"\n[[track]]\nkey = \"scene.scale\"\nkeys = [[0, 2], [10, -2]]\n";
    let plan = read(text, "film").unwrap();
    assert!(plan.at(1.0).is_ok());
    let fault = plan.at(5.0).unwrap_err();
    assert_eq!(fault.key, "scene.scale");
    let folder = Folder::new();
    folder.write("film.toml", text);
    let begins = "frame 98: at beat 3.2666666666666666: scene.scale: its absolute value";
    folder.fails("animate film.toml -o f-%03d.png --device cpu", 1, begins);
}

#[test]
fn frames_end_their_samples_as_stills_do() {
    let folder = Folder::new();
    folder.write("film.toml", FILM);
    let options = "--samples 16 --until 1 --device cpu";
    folder.done(&format!(
        "animate film.toml --frames 5..5 -o %d.png {options}"
    ));
    folder.done(&format!("render film.toml --at 2.5 -o still.png {options}"));
    assert_eq!(folder.bytes("5.png"), folder.bytes("still.png"));
    folder.done("render film.toml --at 2.5 -o all.png --device cpu --samples 16");
    let [some, all] = ["5.png", "all.png"].map(|name| pixels(folder.bytes(name)).1);
    assert!(some != all, "the frame did not end");
}

#[test]
fn a_frame_is_made_again_when_a_file_of_its_preset_has_changed() {
    let folder = Folder::new();
    let heights = |rise: u32| {
        let bump = |x, y| image::Luma([((x * rise) ^ y) as u8]);
        let heights = image::GrayImage::from_fn(16, 16, bump);
        heights.save(folder.0.join("h.png")).unwrap();
    };
    heights(3);
    let film = "[scene]\nkind = 'heightfield'\nfield = 'h.png'\n[image]\nsize = [32, 18]\n[time]\nlength = 1\nfps = 2\n[[track]]\nkey = 'look.key'\nkeys = [[0, 1], [1, 2]]\n";
    folder.write("film.toml", film);
    let line = "animate film.toml -o f-%d.png --device cpu";
    let made = |says: &str| {
        let said = said(&folder.done(line));
        assert!(said.ends_with(says), "{said}");
    };
    made("2 frames\n");
    made("0 frames; 2 there already\n");
    std::thread::sleep(std::time::Duration::from_millis(20));
    heights(5);
    made("2 frames\n");
    // A file that is moved into its place keeps the older time of its content.
    fs::rename(folder.0.join("h.png"), folder.0.join("5.png")).unwrap();
    heights(7);
    made("2 frames\n");
    std::thread::sleep(std::time::Duration::from_millis(20));
    fs::rename(folder.0.join("5.png"), folder.0.join("h.png")).unwrap();
    made("2 frames\n");
}

#[test]
fn frames_are_those_of_their_moments_and_are_rendered_once() {
    let folder = Folder::new();
    folder.write("film.toml", FILM);
    let line = "animate film.toml -o f-%03d.png --device cpu";
    let one = said(&folder.done(&format!("{line} --shard 2/3")));
    assert!(one.ends_with("3 frames\n"), "{one}");
    assert_eq!(
        folder.files(),
        ["f-001.png", "f-004.png", "f-007.png", "film.toml"]
    );
    let time = |name: &str| {
        fs::metadata(folder.0.join(name))
            .unwrap()
            .modified()
            .unwrap()
    };
    let first = time("f-004.png");
    // Damaged frames, and one with other settings.
    folder.write("f-001.png", &folder.bytes("f-001.png")[..200]);
    let mut damaged = folder.bytes("f-007.png");
    let at = damaged.len() - 40;
    damaged[at] ^= 1;
    folder.write("f-007.png", damaged);
    fs::copy(folder.0.join("f-004.png"), folder.0.join("f-000.png")).unwrap();
    let rest = said(&folder.done(line));
    assert!(rest.ends_with("7 frames; 1 there already\n"), "{rest}");
    assert_eq!(time("f-004.png"), first);
    for (frame, beat) in [(0, "0"), (1, "0.5"), (5, "2.5"), (7, "3.5")] {
        folder.done(&format!(
            "render film.toml --at {beat} -o still.png --device cpu"
        ));
        let frame = folder.bytes(&format!("f-{frame:03}.png"));
        assert!(frame == folder.bytes("still.png"), "{beat}");
    }
    // Other bits are another picture.
    let deep = said(&folder.done(&format!("{line} --frames 2..3 --depth 16")));
    assert!(deep.ends_with("2 frames\n"), "{deep}");
}

#[test]
fn wrong_films_are_refused_before_the_first_frame() {
    let folder = Folder::new();
    folder.write("film.toml", FILM);
    let long = FILM.replace("length = 4", "length = 1000000");
    folder.write("long.toml", long.replace("bpm = 120", "bpm = 1"));
    for (line, says) in [
        ("long.toml -o f-%03d.png", "--frames or --shard names some"),
        ("film.toml -o f.png", "%05d"),
        ("film.toml -o f-%5d.png", "%05d"),
        ("film.toml -o f-%03d.jpg", ".png files"),
        ("film.toml -o f-%03d.png --frames 3..8", "the frames 0..7"),
        (
            "film.toml -o f-%03d.png --frames 3..2",
            "the first and the last frame",
        ),
        ("film.toml -o f-%03d.png --shard 4/3", "from 1/4 to 4/4"),
        ("film.toml -o f-%03d.png --video f", "a file like film.mp4"),
        ("mandelbox -o f-%03d.png", "no [[track]]"),
    ] {
        folder.fails(&format!("animate {line} --device cpu"), 2, says);
    }
    folder.fails(
        "render film.toml --device cpu --at 4.1",
        2,
        "from 0 to 4 (time.length)",
    );
    folder.fails(
        "animate film.toml -o none/f-%03d.png --device cpu",
        1,
        "no folder",
    );
    // A still carries its film, and must not become one of the frames.
    let mut still = folder.command("render film.toml -o f-002.png --device cpu");
    assert_eq!(output(&mut still).status.code(), Some(0));
    let line = "animate f-002.png -o f-%03d.png --device cpu";
    folder.fails(line, 2, "a frame would overwrite the preset, `f-002.png`");
    fs::remove_file(folder.0.join("f-002.png")).unwrap();
    let line = "animate film.toml -o f-%03d.png --video f.mp4 --device cpu";
    let without = output(folder.command(line).env("PATH", ""));
    assert_eq!(without.status.code(), Some(1));
    assert!(
        said(&without).starts_with("error: --video needs ffmpeg"),
        "{}",
        said(&without)
    );
    assert_eq!(folder.files(), ["film.toml", "long.toml"]);
}

/// A program stands in for ffmpeg: it writes its last argument, or waits.
#[cfg(unix)]
#[test]
fn a_video_appears_whole_or_not_at_all() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    folder.write("film.toml", FILM);
    fs::create_dir(folder.0.join("bin")).unwrap();
    let joins = |how: &str| {
        let script = format!("#!/bin/sh\n[ $1 = -version ] && exit\nfor to; do :; done\n{how}\n");
        folder.write("bin/ffmpeg", script);
        let file = folder.0.join("bin/ffmpeg");
        fs::set_permissions(file, fs::Permissions::from_mode(0o755)).unwrap();
        let line = "animate film.toml -o f-%d.png --frames 0..1 --video v.mp4 --device cpu";
        let mut command = folder.command(line);
        let others = std::env::var("PATH").unwrap();
        let path = format!("{}:{others}", folder.0.join("bin").display());
        command.env("PATH", path);
        command
    };
    let frames = ["bin", "f-0.png", "f-1.png", "film.toml"];
    let broken = output(&mut joins("echo half >$to; echo no room >&2; exit 1"));
    assert_eq!(broken.status.code(), Some(1));
    assert!(said(&broken).ends_with("ffmpeg did not write `v.mp4`: no room\n"));
    assert_eq!(folder.files(), frames);
    let mut waits = joins("echo half >$to; echo $$ >bin/pid; exec sleep 30");
    let child = waits.stderr(Stdio::piped()).spawn().unwrap();
    while !folder.0.join("bin/pid").exists() {
        sleep(Duration::from_millis(20));
    }
    signal(child.id(), "TERM");
    let ended = child.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(143));
    let says = "error: cancelled; the frames are written; the same command joins them\n";
    assert!(said(&ended).ends_with(says), "{}", said(&ended));
    assert_eq!(folder.files(), frames);
    let mut runs_on = Command::new("sh");
    runs_on
        .args(["-c", "kill -0 $(cat bin/pid)"])
        .current_dir(&folder.0);
    assert!(!output(&mut runs_on).status.success());
    let joined = output(&mut joins("echo whole >$to"));
    assert_eq!(joined.status.code(), Some(0), "{}", said(&joined));
    assert_eq!(folder.bytes("v.mp4"), b"whole\n");
    let mode = |name: &str| folder.0.join(name).metadata().unwrap().permissions().mode();
    assert_eq!(mode("v.mp4"), mode("f-0.png"));
    assert_eq!(folder.files().len(), frames.len() + 1);
}

#[test]
fn a_setting_turns_beyond_360_degrees_and_a_camera_too_by_keys_on_its_way() {
    let folder = Folder::new();
    let film = r#"
[scene]
kind = "distance"
formula = "mandelbox"
[image]
size = [48, 32]
[time]
length = 4
fps = 1
[[track]]
key = "scene.rotation"
between = "linear"
keys = [[0, [0, 0, -90]], [4, [0, 0, 810]]]
"#;
    folder.write("film.toml", film);
    folder.done("animate film.toml -o f-%d.png");
    folder.write("still.toml", film.split("[time]").next().unwrap());
    for (frame, degrees) in [(2, 360), (3, 585)] {
        let set = format!("--set scene.rotation=[0,0,{degrees}]");
        folder.done(&format!("render still.toml {set} -o s.png"));
        let shown = pixels(folder.bytes(&format!("f-{frame}.png"))).1;
        assert!(shown == pixels(folder.bytes("s.png")).1, "{degrees}");
    }
    // Twice round the target, with a key after each 120 degrees.
    let eye = |i: u32| {
        let (sin, cos) = (f64::from(i) * 120.0).to_radians().sin_cos();
        format!("[{i}, [{}, {}, 1]]", 3.0 * cos, 3.0 * sin)
    };
    let keys = (0..=6).map(eye).collect::<Vec<_>>().join(", ");
    let text =
        format!("[scene]\nkind = \"slab\"\n[[track]]\nkey = \"camera.eye\"\nkeys = [{keys}]\n");
    let plan = read(&text, "film").unwrap();
    let angle = |beat: f64| {
        let eye = plan.at(beat).unwrap().camera.eye;
        assert!((eye.truncate().length() - 3.0).abs() < 1e-9);
        eye.y.atan2(eye.x)
    };
    let steps = (0..60).map(|i| angle(0.1 * f64::from(i + 1)) - angle(0.1 * f64::from(i)));
    let steps: Vec<f64> = steps.map(|d| d.rem_euclid(std::f64::consts::TAU)).collect();
    assert!(steps.iter().all(|step| *step < 0.3), "{steps:?}");
    let turns = steps.iter().sum::<f64>() / std::f64::consts::TAU;
    assert!((turns - 2.0).abs() < 1e-9, "{turns}");
}
