//! Standard output and error, full disks, pipes, signals, progress, and what is left behind.

use std::fs;
use std::process::{Child, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use png::{BitDepth, ColorType};

use crate::folder::{Folder, output, said, signal, text};
use crate::images::png;
use crate::tools::{rendered, tiny};

#[test]
fn standard_output_gets_the_same_bytes_as_a_file() {
    let folder = Folder::new();
    rendered(&folder, "mandelbox", "-o a.png");
    let piped = folder.done(&tiny("mandelbox", "-o -"));
    assert_eq!(piped.stdout, folder.bytes("a.png"));
    assert_eq!(folder.files(), ["a.png"]);
}

/// Starts a command whose standard output is closed at once.
fn unread(folder: &Folder, args: &str) -> Output {
    let mut command = folder.command(args);
    let command = command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    drop(child.stdout.take());
    child.wait_with_output().expect("an end")
}

#[test]
fn a_reader_that_stops_is_no_error() {
    let output = unread(&Folder::new(), "completions zsh");
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(output.stderr.is_empty());
}

/// A picture that was not read to its end is none, and must not pass for one.
#[test]
fn a_picture_that_nobody_reads_is_a_failure() {
    let folder = Folder::new();
    for more in ["-o -", "-o a.png --stats -"] {
        let output = unread(&folder, &tiny("mandelbox", more));
        let said = said(&output);
        assert_eq!(output.status.code(), Some(1), "{more:?}: {said}");
        let last = said.lines().last().unwrap_or_default();
        let unread = "error: the reader of standard output";
        assert!(last.starts_with(unread), "{said}");
        assert!(folder.files().is_empty(), "{:?}", folder.files());
    }
}

#[cfg(target_os = "linux")]
mod full {
    use super::*;

    fn full() -> fs::File {
        let full = fs::OpenOptions::new().write(true).open("/dev/full");
        full.expect("/dev/full")
    }

    #[test]
    fn a_full_disk_is_an_error_that_names_the_file_and_loses_no_picture() {
        let folder = Folder::new();
        std::os::unix::fs::symlink("/dev/full", folder.0.join("full.png")).expect("a link");
        for name in ["kept", "out"] {
            fs::create_dir(folder.0.join(name)).expect("a folder");
        }
        let fails = |args: &str, kept: &str| {
            let mut command = folder.command(&tiny("mandelbox", args));
            let command = command.env("TMPDIR", folder.0.join(kept)).stdout(full());
            let output = output(command);
            assert_eq!(output.status.code(), Some(1), "{}", said(&output));
            let told = said(&output);
            told.lines().last().expect("an error").to_string()
        };
        // The picture is whole without its figures.
        let told = fails("-o out/a.png --stats /dev/full", "kept");
        assert!(
            told.starts_with("error: /dev/full: cannot be written"),
            "{told}"
        );
        for (args, start) in [
            ("-o full.png", "error: full.png: cannot be written"),
            ("-o -", "error: standard output cannot be written"),
        ] {
            let told = fails(args, "kept");
            assert!(
                told.starts_with(start) && told.contains("No space left"),
                "{told}"
            );
            let kept = told.rsplit('`').nth(1).expect("where the picture is");
            assert_eq!(
                fs::read(kept).expect("the picture"),
                folder.bytes("out/a.png")
            );
            fs::remove_file(kept).expect("it was there");
            let told = fails(args, "nowhere");
            assert!(told.contains("does not take the picture either"), "{told}");
        }
        let left = |name| fs::read_dir(folder.0.join(name)).expect("a folder").count();
        assert_eq!([left("kept"), left("out")], [0, 1]);
        let output = output(folder.command("presets").stdout(full()));
        assert_eq!(output.status.code(), Some(1), "{}", said(&output));
        assert!(said(&output).starts_with("error: standard output cannot be written"));
    }

    #[test]
    fn nobody_need_listen_to_standard_error() {
        let folder = Folder::new();
        let deaf = |args: &str| {
            let mut command = folder.command(args);
            let status = command.stderr(full()).stdout(Stdio::null()).status();
            status.expect("the program starts").code()
        };
        assert_eq!(deaf(&tiny("mandelbox", "-o a.png")), Some(0));
        assert_eq!(folder.files(), ["a.png"]);
        assert_eq!(deaf(&tiny("nothing", "")), Some(2));
        assert_eq!(deaf("render"), Some(2));
        assert_eq!(deaf(&tiny("mandelbox", "-o no/a.png")), Some(1));
    }
}

/// Nobody writes into the pipe: opening it would wait for ever.
#[cfg(unix)]
#[test]
fn a_preset_that_is_no_file_is_refused_at_once() {
    use std::process::Command;
    let folder = Folder::new();
    let pipe = folder.0.join("pipe.toml");
    let made = Command::new("mkfifo").arg(pipe).status();
    assert!(made.expect("mkfifo").success());
    for preset in ["/dev/zero", "/dev/null", "pipe.toml"] {
        let says = format!("{preset}|no regular file");
        folder.fails(&tiny(preset, ""), 1, &says);
    }
    // The program's own input is open already, and is read to its end.
    folder.write("in.toml", text(&folder.done("presets mandelbox")));
    let read = fs::File::open(folder.0.join("in.toml")).expect("written above");
    let mut cat = Command::new("cat");
    let mut cat = cat.stdin(read).stdout(Stdio::piped()).spawn().expect("cat");
    let mut command = folder.command("render /dev/stdin --explain");
    let pipe = cat.stdout.take().expect("a pipe");
    let output = output(command.stdin(pipe));
    assert!(cat.wait().expect("an end").success());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert_eq!(
        text(&output),
        text(&folder.done("render mandelbox --explain"))
    );
}

/// A command that runs far longer than a test may, once it has begun.
fn begun(folder: &Folder, args: &str, stderr: Stdio, is_begun: impl Fn() -> bool) -> Child {
    let mut command = folder.command(args);
    // One thread, so that work is long enough on a machine of many cores too.
    command.env("RAYON_NUM_THREADS", "1");
    let command = command.stdout(Stdio::null()).stderr(stderr);
    let mut child = command.spawn().expect("the program starts");
    let start = Instant::now();
    while !is_begun() {
        let end = child.try_wait().expect("a state");
        assert!(end.is_none(), "{args}: ended too soon, {end:?}");
        assert!(start.elapsed() < Duration::from_secs(60), "{args}: stuck");
        sleep(Duration::from_millis(5));
    }
    child
}

/// Sends signals to a process. Returns its exit code and what it said.
#[cfg(unix)]
fn ended(child: Child, signals: &[&str]) -> (Option<i32>, String) {
    for name in signals {
        signal(child.id(), name);
        sleep(Duration::from_millis(50));
    }
    let sent = Instant::now();
    let output = child.wait_with_output().expect("an end");
    let soon = sent.elapsed() < Duration::from_secs(20);
    assert!(soon, "the signal was ignored");
    (output.status.code(), said(&output))
}

#[cfg(unix)]
const LONG: &str = "render mandelbox --device cpu --size 3000x3000 --set march.mode=truth";

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_no_file_and_its_own_exit_code() {
    for (signals, code) in [
        (&["INT"][..], 130),
        (&["INT", "INT"], 130),
        (&["TERM"], 143),
    ] {
        let folder = Folder::new();
        let args = format!("{LONG} -o a.png --stats s.json");
        let child = begun(&folder, &args, Stdio::piped(), || folder.files().len() == 2);
        sleep(Duration::from_millis(100));
        let (found, said) = ended(child, signals);
        assert_eq!(found, Some(code), "{said}");
        let last = said.lines().last();
        assert_eq!(last, Some("error: cancelled; nothing was written"));
        assert!(folder.files().is_empty(), "{:?}", folder.files());
    }
}

/// An interrupt takes away the folder that was made for the heat maps, and only that.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_no_empty_folder() {
    for (given, made) in [("h/i", "h"), ("was/i", "was/i")] {
        let folder = Folder::new();
        fs::create_dir(folder.0.join("was")).expect("a folder");
        let steps = "bench steps bench-far --device cpu --size 3000x3000 --heat";
        let args = format!("{steps} {given}");
        let made = folder.0.join(made);
        let child = begun(&folder, &args, Stdio::piped(), || made.exists());
        sleep(Duration::from_millis(200));
        assert_eq!(ended(child, &["INT"]).0, Some(130));
        assert_eq!(folder.files(), ["was"]);
        assert!(!folder.0.join("was/i").exists());
    }
}

/// Off a terminal, work over two seconds says how much of it is done and left.
#[cfg(unix)]
#[test]
fn long_work_tells_its_progress_in_lines() {
    let of_map =
        "render terrain --device cpu --set scene.field=fbm:4096x4096 --set scene.tracer=walk";
    let error = "render mandelbox --device cpu --size 800x600 --layer error";
    let steps = "bench steps bench-far terrain --mode truth --device cpu --size 3000x3000";
    let convert = "conemap convert map.png --from dummer -o m.exr";
    let (rgba, zeros) = (ColorType::Rgba, vec![0; 1 << 28]);
    let map = png([8192, 8192], rgba, BitDepth::Eight, &zeros);
    for (args, says, part) in [
        (format!("{LONG} -o a.png").as_str(), "rendering: ", " % ("),
        (
            of_map,
            "rendering: cone map by walk, ",
            " s left of this step",
        ),
        (error, "rendering the truth: round 1 of at most 5, ", " %, "),
        (
            "conemap inspect fbm:8192x4096",
            "inspecting: heights, ",
            " %",
        ),
        (convert, "converting (step ", " s so far"),
        (
            steps,
            "measuring bench-far (1 of 2), truth (1 of 1): ",
            " %",
        ),
    ] {
        let folder = Folder::new();
        folder.write("map.png", &map);
        let heard = folder.0.join("heard");
        let stderr = fs::File::create(&heard).expect("a file");
        let line = |l: &str| l.starts_with(says) && l.contains(part);
        let told = || fs::read_to_string(&heard).is_ok_and(|said| said.lines().any(line));
        let child = begun(&folder, args, stderr.into(), told);
        let code = ended(child, &["INT"]).0;
        // The second half of `inspect` and `convert` may be done before the signal arrives.
        let is_short = args.starts_with("conemap") && code == Some(0);
        assert!(code == Some(130) || is_short, "{args}: {code:?}");
    }
}

/// A driver that compiles a program must not meet its own destructors.
#[cfg(unix)]
#[test]
fn an_interrupt_while_a_driver_compiles_ends_with_its_own_exit_code() {
    for nth in 0..10 {
        let folder = Folder::new();
        let mut command = folder.command("render stones --size 64x36 -o a.png");
        command.env("MESA_SHADER_CACHE_DISABLE", "true");
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        let child = command.spawn().expect("the program starts");
        sleep(Duration::from_millis(300 + 40 * nth));
        let (found, said) = ended(child, &["INT", "INT"]);
        assert!(matches!(found, Some(130 | 0)), "{found:?}: {said}");
    }
}
