//! What stands around a render: explanations of the command that is given, standard output
//! that is closed too early, presets that are no files, and folders that stay empty.
//!
//! Pictures are tiny and made by the CPU executor, so that no adapter is needed.
#![allow(missing_docs, reason = "tests are read by their names")]

use std::process::Stdio;

#[allow(dead_code, reason = "other files use the rest")]
mod common {
    pub mod folder;
}
use common::folder::{Folder, interrupt, said, text};

/// A tiny render by the CPU executor, with more arguments.
fn tiny<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let mut args = vec!["render", "mandelbox", "--device", "cpu", "--size", "24x16"];
    args.extend(more);
    args
}

#[test]
fn the_command_that_is_given_is_explained() {
    let folder = Folder::new();
    let explain = |more: &[&str]| text(&folder.done(&[&tiny(more)[..], &["--explain"]].concat()));
    let counters = "wgsl/base/counters.wgsl";
    // Nothing is counted that nobody asked for.
    assert!(!explain(&[]).contains(counters));
    assert!(!explain(&["--layer", "normal"]).contains(counters));
    assert!(explain(&["--stats", "s.json"]).contains(counters));
    assert!(explain(&["--layer", "steps"]).contains(counters));
    // Nor is what no layer shows.
    let color = "wgsl/pass/color.wgsl";
    assert!(explain(&[]).contains(color));
    assert!(!explain(&["--layer", "depth"]).contains(color));
    let keeps = "COLOR_KEEPS_NORMALS=1";
    assert!(!explain(&[]).contains(keeps));
    assert!(explain(&["--layer", "normal"]).contains(keeps));
    assert!(explain(&["-o", "a.exr"]).contains(keeps));
    assert!(folder.files().is_empty());
}

#[test]
fn what_cannot_be_rendered_is_not_explained() {
    let folder = Folder::new();
    let cases: [(&[&str], i32, &[&str]); 6] = [
        (&["-o", "x.jpg"], 2, &["`x.jpg`", ".png"]),
        (&["-o", "x.exr", "--layer", "depth"], 2, &["--layer"]),
        (&["-o", "a.png", "--stats", "a.png"], 2, &["--stats"]),
        (&["-o", "a.png", "--stats", "./a.png"], 2, &["--stats"]),
        (&["-o", "no/x.png"], 1, &["no folder `no`"]),
        (&["--stats", "no/s.json"], 1, &["no folder `no`"]),
    ];
    for (more, code, words) in cases {
        for end in [&["--explain"][..], &[]] {
            folder.fails(&[&tiny(more)[..], end].concat(), code, words);
        }
    }
    let nobody = ["render", "mandelbox", "--explain", "--device"];
    for (device, code, words) in [
        ("foo", 1, ["there is no", "foo"]),
        (" ", 2, ["--device", "auto"]),
    ] {
        folder.fails(&[&nobody[..], &[device]].concat(), code, &words);
    }
}

#[test]
fn a_device_of_blanks_is_refused() {
    let folder = Folder::new();
    for device in ["--device=", "--device= ", "--device=\t"] {
        folder.fails(&["render", "mandelbox", device], 2, &["--device", "auto"]);
        folder.fails(&["bench", "steps", device], 2, &["--device", "auto"]);
    }
}

/// A picture of which a reader took nothing is no picture, and must not pass for one.
#[test]
fn a_picture_that_nobody_reads_is_a_failure() {
    let folder = Folder::new();
    for more in [&["-o", "-"][..], &["-o", "a.png", "--stats", "-"]] {
        let mut command = folder.command(&tiny(more));
        let mut child = command
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("an end");
        let said = said(&output);
        assert_eq!(output.status.code(), Some(1), "{more:?}: {said}");
        let last = said.lines().last().unwrap_or_default();
        assert!(
            last.starts_with("error: the reader of standard output"),
            "{said}"
        );
        assert!(folder.files().is_empty(), "{:?}", folder.files());
    }
}

/// Nobody writes into the pipe: opening it would wait for ever.
#[cfg(unix)]
#[test]
fn a_preset_that_is_no_file_is_refused_at_once() {
    use std::process::Command;
    let folder = Folder::new();
    let made = Command::new("mkfifo")
        .arg(folder.0.join("pipe.toml"))
        .status();
    assert!(made.expect("mkfifo").success());
    for preset in ["/dev/zero", "/dev/null", "pipe.toml"] {
        let args = ["render", preset, "--device", "cpu", "--size", "24x16"];
        folder.fails(&args, 1, &[preset, "no regular file"]);
    }
    // The program's own input is open already, and is read to its end.
    let toml = text(&folder.done(&["presets", "mandelbox"]));
    folder.write("in.toml", toml);
    let read = std::fs::File::open(folder.0.join("in.toml")).expect("written above");
    let mut cat = Command::new("cat");
    let mut cat = cat.stdin(read).stdout(Stdio::piped()).spawn().expect("cat");
    let mut command = folder.command(&["render", "/dev/stdin", "--explain"]);
    let pipe = cat.stdout.take().expect("a pipe");
    let output = command.stdin(pipe).output().expect("the program starts");
    assert!(cat.wait().expect("an end").success());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let named = text(&folder.done(&["render", "mandelbox", "--explain"]));
    assert_eq!(text(&output), named);
}

/// An interrupt takes away the folder that was made for the heat maps, and only that.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_no_empty_folder() {
    use std::process::Stdio;
    use std::time::{Duration, Instant};
    for (given, made) in [("h/i", "h"), ("was/i", "was/i")] {
        let folder = Folder::new();
        std::fs::create_dir(folder.0.join("was")).expect("a folder");
        // Far more than a test may take.
        let args = [
            "bench",
            "steps",
            "bench-far",
            "--device",
            "cpu",
            "--size",
            "3000x3000",
            "--heat",
            given,
        ];
        let mut child = folder
            .command(&args)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program starts");
        let start = Instant::now();
        let late = || {
            assert!(
                start.elapsed() < Duration::from_secs(20),
                "it takes too long"
            )
        };
        while !folder.0.join(made).exists() {
            late();
            std::thread::sleep(Duration::from_millis(5));
        }
        std::thread::sleep(Duration::from_millis(200));
        interrupt(child.id());
        assert_eq!(child.wait().expect("an end").code(), Some(1));
        late();
        assert_eq!(folder.files(), ["was"]);
        assert!(!folder.0.join("was/i").exists());
    }
}
