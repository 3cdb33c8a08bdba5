//! Big pictures: bands, what is kept of them, and going on after a kill.

use std::fs::{self, OpenOptions};
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::folder::{Folder, holds, said};
use crate::sky::even;

/// A picture of ten bands, 64 rows each but the last.
const PICTURE: &str = "render mandelbox --device cpu --size 90x600 --set look.shadow=false";
/// One that takes less time.
const QUICK: &str = "--set camera.fov=120 --set look.occlusion=0";
/// What is kept of it.
const PART: &str = "a.png.part";

/// The picture made at once.
fn whole(folder: &Folder, more: &str) -> Vec<u8> {
    made_at_once(folder, &format!("{PICTURE} {more}"), "png")
}

fn made_at_once(folder: &Folder, line: &str, format: &str) -> Vec<u8> {
    let name = format!("whole.{format}");
    folder.done(&format!("{line} -o {name}"));
    let bytes = folder.bytes(&name);
    fs::remove_file(folder.0.join(name)).expect("written above");
    bytes
}

/// Starts the picture, and waits until some bands are kept.
fn begun(folder: &Folder, more: &str, bytes: u64) -> Child {
    begun_as(folder, &format!("{PICTURE} {more}"), "a.png", bytes)
}

fn begun_as(folder: &Folder, line: &str, name: &str, bytes: u64) -> Child {
    let mut command = folder.command(&format!("{line} -o {name} --resume"));
    command.env("RAYON_NUM_THREADS", "1");
    let command = command.stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    let start = Instant::now();
    let part = folder.0.join(format!("{name}.part"));
    let length = || fs::metadata(&part).map_or(0, |m| m.len());
    while length() < bytes {
        let end = child.try_wait().expect("a state");
        assert!(end.is_none(), "ended too soon, {end:?}");
        assert!(start.elapsed() < Duration::from_secs(60), "stuck");
        sleep(Duration::from_millis(1));
    }
    child
}

/// Bytes of a band in the file: its rows, its tally and its hash.
const BAND: u64 = 64 * 90 * 3 + 36 + 32;
/// Those of an EXR, whose pixels have 14 numbers.
const EXR_BAND: u64 = 64 * 90 * 14 * 4 + 36 + 32;

#[test]
fn bands_give_the_bytes_of_the_picture_made_at_once() {
    let folder = Folder::new();
    let cases = [
        (
            "mandelbox",
            "90x140 --depth 16 --samples 2 --set camera.aperture=0.02",
        ),
        (
            "mandelbox",
            "90x140 --samples 32 --until 0.04 --set camera.aperture=0.02",
        ),
        ("mandelbox", "131x139 --set march.coarsest=64"),
        (
            "mandelbox",
            "90x140 --depth 16 --set look.bloom=0.3 --set image.background=transparent",
        ),
        (
            "mandelbox",
            "90x140 --set look.bloom=0.3 --set camera.stereo=pair",
        ),
        ("mandelbox", "90x200 --layer state"),
        (
            "terrain",
            "90x130 --layer normal --set scene.field=fbm:64x64",
        ),
        ("terrain", "90x130 --set scene.field=fbm:64x64"),
    ];
    for (preset, more) in cases {
        let is_of_png = more.contains("--depth") || more.contains("--layer");
        let formats = ["png", "exr"].into_iter();
        for format in formats.filter(|format| *format == "png" || !is_of_png) {
            let line = format!("render {preset} --device cpu --size {more}");
            let [one, other] = ["a", "b"].map(|name| format!("{name}.{format}"));
            let at_once = said(&folder.done(&format!("{line} -o {one}")));
            let in_bands = said(&folder.done(&format!("{line} -o {other} --resume")));
            assert!(
                folder.bytes(&one) == folder.bytes(&other),
                "{line} {format}"
            );
            // Shares of hits and sky are those of all bands.
            let share = |said: &str| {
                said.lines()
                    .last()
                    .and_then(|l| l.split_once("hit "))
                    .map(|s| s.1.to_string())
            };
            assert_eq!(share(&at_once), share(&in_bands), "{line}");
            assert!(!folder.files().iter().any(|name| name.ends_with(".part")));
        }
    }
}

/// Bands of a device too, in a picture that is big enough for them without being asked.
#[test]
fn a_big_picture_has_bands_and_all_the_figures_on_a_device() {
    let folder = Folder::new();
    let sky = "--set camera.target=[20,-34,24] --layer state";
    // Wider than four blocks, and of more pixels than are made at once.
    let line = format!("render mandelbox --size 4100x4100 {sky} -o a.png");
    let said = said(&folder.done(&format!("{line} --stats s.json")));
    holds(&said, &["4100 x 4100", "sky 100.0 %"]);
    assert_eq!(folder.files(), ["a.png", "s.json"]);
    let stats = crate::tools::json(&folder.bytes("s.json"));
    let trace = stats["passes"].as_array().expect("passes").iter();
    let trace = trace.filter(|p| p["name"] == "trace");
    let pixels: Vec<u64> = trace.map(|p| p["cells"].as_u64().expect("cells")).collect();
    assert_eq!(pixels, [4100 * 4100]);
    assert!(
        stats["evaluations_per_pixel"]
            .as_f64()
            .is_some_and(|n| n >= 0.0),
        "{stats}"
    );
    let (info, rows) = crate::images::pixels(folder.bytes("a.png"));
    assert_eq!([info.width, info.height], [4100; 2]);
    assert_eq!(rows.len(), 3 * 4100 * 4100);
}

#[cfg(unix)]
#[test]
fn a_killed_picture_goes_on_to_the_same_bytes() {
    let folder = Folder::new();
    let view = "--set camera.projection=equirectangular --set camera.fov=180";
    folder.done(&format!(
        "render valley-mist --size 32x16 --samples 1 {view} -o sky.exr"
    ));
    // Bands of light, from which the bytes are made at the end.
    let light = BAND + 64 * 90 * 9;
    let until = "--samples 16 --until 0.05 --set camera.fov=120 --set look.occlusion=0";
    // Some moments: after one band, within one, and shortly before the end; each kill is real. Also
    // where tiles have their own numbers of samples, under a sky from a file, and on a device.
    for (device, format, more, bands, wait, band) in [
        ("cpu", "png", "", 1, 0, BAND),
        ("cpu", "png", "", 4, 30, BAND),
        ("cpu", "png", "", 8, 0, BAND),
        ("cpu", "png", until, 2, 0, BAND),
        ("cpu", "png", "--set look.sky_file=sky.exr", 3, 0, BAND),
        ("cpu", "png", "--set look.bloom=0.3", 8, 0, light),
        ("cpu", "exr", "", 5, 10, EXR_BAND),
        ("cpu", "exr", "--set look.bloom=0.3", 8, 0, EXR_BAND),
        ("auto", "png", "--samples 256", 3, 0, BAND),
        ("auto", "exr", "--samples 256", 5, 0, EXR_BAND),
    ] {
        let line = PICTURE.replace("--device cpu", &format!("--device {device} {more}"));
        let name = format!("a.{format}");
        let expected = made_at_once(&folder, &line, format);
        let mut child = begun_as(&folder, &line, &name, bands * band);
        sleep(Duration::from_millis(wait));
        child.kill().expect("it runs");
        child.wait().expect("an end");
        assert!(!folder.files().contains(&name));
        let part = folder.0.join(format!("{name}.part"));
        let kept = fs::metadata(part).expect("kept").len();
        let again = said(&folder.done(&format!("{line} -o {name} --resume")));
        assert!(
            folder.bytes(&name) == expected,
            "{line} as {name} after {bands} bands: {again}"
        );
        assert!(kept >= bands * band, "{kept}");
        fs::remove_file(folder.0.join(name)).expect("made");
        // The killed process leaves its temporary file.
        for name in folder.files().iter().filter(|name| *name != "sky.exr") {
            assert!(name.ends_with(".tmp"), "{name}");
            fs::remove_file(folder.0.join(name)).expect("left");
        }
    }
}

/// A torn or broken band is made again, wherever the file ends.
#[test]
fn what_is_torn_is_made_again() {
    let folder = Folder::new();
    let expected = whole(&folder, QUICK);
    let mut child = begun(&folder, QUICK, 4 * BAND);
    child.kill().expect("it runs");
    child.wait().expect("an end");
    let bytes = folder.bytes(PART);
    let head = bytes.iter().position(|b| *b == b'\n').expect("a line") + 1;
    let band = BAND as usize;
    let broken = |at: usize| {
        let mut bytes = bytes.clone();
        bytes[at] ^= 1;
        bytes
    };
    for left in [
        bytes[..head].to_vec(),
        bytes[..head + 5].to_vec(),
        bytes[..head + 3 * band - 1].to_vec(),
        bytes[..head + 3 * band].to_vec(),
        broken(head + 7),
        broken(head + 2 * band + 3),
        broken(head + 2 * band - 1),
    ] {
        folder.write(PART, left);
        folder.done(&format!("{PICTURE} -o a.png --resume {QUICK}"));
        assert!(folder.bytes("a.png") == expected);
        assert!(!folder.files().contains(&PART.into()));
    }
}

#[cfg(unix)]
#[test]
fn an_interrupt_keeps_the_bands_and_says_so() {
    let folder = Folder::new();
    let expected = whole(&folder, "");
    let child = begun(&folder, "", 2 * BAND);
    crate::folder::signal(child.id(), "INT");
    let ended = child.wait_with_output().expect("an end");
    let told = said(&ended);
    assert_eq!(ended.status.code(), Some(130), "{told}");
    let last = told.lines().last().unwrap_or_default();
    assert!(
        last.starts_with("error: cancelled; `a.png.part` keeps "),
        "{told}"
    );
    holds(last, &[" of 10 bands", "--resume"]);
    assert_eq!(folder.files(), [PART]);
    folder.done(&format!("{PICTURE} -o a.png --resume"));
    assert!(folder.bytes("a.png") == expected);
    assert_eq!(folder.files(), ["a.png"]);
}

/// Nothing is overwritten that may be wanted, and each refusal says what would do.
#[test]
fn bands_of_another_picture_program_or_device_are_refused() {
    let folder = Folder::new();
    let mut child = begun(&folder, "", 3 * BAND);
    child.kill().expect("it runs");
    child.wait().expect("an end");
    for name in folder.files().iter().filter(|n| n.ends_with(".tmp")) {
        fs::remove_file(folder.0.join(name)).expect("left");
    }
    let kept = folder.bytes(PART);
    let resumed = format!("{PICTURE} -o a.png --resume");
    for (more, says) in [
        ("--set camera.fov=41", "other settings"),
        ("--depth 16", "other settings"),
        ("--layer state", "other settings"),
        ("--size 90x601", "other settings"),
    ] {
        // The last option counts.
        let line = resumed.replace(
            "--size 90x600",
            if more.contains("--size") {
                ""
            } else {
                "--size 90x600"
            },
        );
        folder.fails(
            &format!("{line} {more}"),
            1,
            &format!("`{PART}`|{says}|remove it"),
        );
        assert!(folder.bytes(PART) == kept, "{more}");
    }
    let text = String::from_utf8_lossy(&kept[..200]).into_owned();
    let line = text.lines().next().expect("a line");
    let changed = |from: &str, to: &str| {
        let mut bytes = line.replace(from, to).into_bytes();
        assert_ne!(bytes, line.as_bytes(), "{from}");
        bytes.extend(&kept[line.len()..]);
        bytes
    };
    let version = env!("CARGO_PKG_VERSION");
    for (left, says) in [
        (
            changed(version, "0.0.7"),
            "begun by conemarch 0.0.7|with that version",
        ),
        (
            changed("(build ", "(build 1"),
            "begun by conemarch 0|(build |with that version",
        ),
        (
            changed("the CPU, f64", "some GPU"),
            "begun on some GPU|the CPU, f64|--device",
        ),
        (b"my holidays\n".to_vec(), "in the way|remove it|-o"),
        (changed("part 1", "part 9"), "in the way|remove it"),
    ] {
        folder.write(PART, &left);
        folder.fails(&resumed, 1, &format!("`{PART}`|{says}"));
        assert!(folder.bytes(PART) == left);
    }
    folder.write(PART, &kept);
    // A big picture has bands without being asked, and does not begin anew over what is kept.
    let big = "render mandelbox --device cpu --size 4100x4100 -o a.png";
    folder.fails(big, 1, &format!("`{PART}`|--resume|remove it"));
    // A small one has none. It tells what is left.
    let small = said(&folder.done(&format!("{PICTURE} -o a.png")));
    holds(&small, &[&format!("note: `{PART}`"), "--resume goes on"]);
    assert!(folder.bytes(PART) == kept);
    for (left, name) in [(&b"junk"[..], "j.png"), (&kept, "j.jpg")] {
        folder.write(&format!("{name}.part"), left);
        let other = said(&folder.done(&format!("{PICTURE} -o {name}")));
        assert!(!other.contains("note"), "{name}: {other}");
    }
    let file = OpenOptions::new()
        .read(true)
        .open(folder.0.join(PART))
        .expect("kept");
    file.lock().expect("a lock");
    folder.fails(&resumed, 1, "in use|another process");
    for wrong in ["-o a.webp", "-o a.jpg", "-o -", "-o a.png --layer depth"] {
        folder.fails(&format!("{PICTURE} {wrong} --resume"), 2, "--resume|.png");
    }
    folder.fails(&format!("{resumed} --stats s.json"), 2, "--stats");
}

/// A sky whose file has changed is another one. When the file is as before, the picture goes on.
#[test]
fn bands_under_another_sky_of_the_same_name_are_refused() {
    let folder = Folder::new();
    let more = format!("{QUICK} --set look.sky_file=sky.hdr");
    let sky = even([16, 8]);
    folder.write("sky.hdr", &sky);
    let expected = whole(&folder, &more);
    let mut child = begun(&folder, &more, 2 * BAND);
    child.kill().expect("it runs");
    child.wait().expect("an end");
    let kept = folder.bytes(PART);
    let mut other = sky.clone();
    // The red of the last texel.
    other[sky.len() - 4] ^= 64;
    folder.write("sky.hdr", other);
    let resumed = format!("{PICTURE} -o a.png --resume {more}");
    folder.fails(&resumed, 1, &format!("`{PART}`|other settings|remove it"));
    assert!(folder.bytes(PART) == kept);
    folder.write("sky.hdr", sky);
    folder.done(&resumed);
    assert!(folder.bytes("a.png") == expected);
}

/// The disk is full at the last band: the bands before it stay, and the picture goes on later.
#[cfg(unix)]
#[test]
fn a_full_disk_loses_nothing() {
    for (format, band) in [("png", BAND), ("exr", EXR_BAND)] {
        let folder = Folder::new();
        let name = format!("a.{format}");
        let expected = made_at_once(&folder, PICTURE, format);
        // Nine bands and a little more.
        let limit = 9 * band + band / 8;
        let ended = folder.limited(&format!("{PICTURE} -o {name} --resume"), limit);
        let told = said(&ended);
        assert_eq!(ended.status.code(), Some(1), "{told}");
        let error = told.lines().last().unwrap_or_default();
        let keeps = format!("error: `{name}.part` keeps 9 of 10 bands");
        holds(
            error,
            &[&keeps, "--resume", "cannot be written", "free some space"],
        );
        assert_eq!(folder.files(), [format!("{name}.part")], "{told}");
        folder.done(&format!("{PICTURE} -o {name} --resume"));
        assert!(folder.bytes(&name) == expected);
        assert_eq!(folder.files(), [name]);
    }
}
