//! Choosing a device, losing it, and stopping on request: an error that says what was
//! lost and what would do, never a panic and never a frame.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test fails by panicking, and has no readers of its interface"
)]

mod adapter;

use conemarch::scene::Assets;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use conemarch::gpu::RenderError;
use conemarch::gpu::device::{Adapters, Choice, DeviceError, kind};
use conemarch::gpu::render::Renderer;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::load;

fn small() -> Plan {
    let mut plan = load("mandelbox", &[]).unwrap().plan;
    plan.size = [64, 36];
    plan
}

/// Asserts that a loss is told: what was lost, that nothing was written, what would do.
fn assert_lost(error: &RenderError, name: &str) {
    let RenderError::Device(DeviceError::Lost { .. }) = error else {
        panic!("not a loss: {error:?}")
    };
    let said = error.to_string();
    for part in [name, "was lost", "nothing was written", "--device cpu"] {
        assert!(said.contains(part), "`{part}` not in: {said}");
    }
    assert!(!said.contains('\n'), "more than a line: {said}");
}

fn name(renderer: &Renderer) -> String {
    renderer.device.info.name.clone()
}

fn all(renderer: &mut Renderer) -> Result<usize, RenderError> {
    let frame = renderer.render(&small(), &Assets::default(), Extras::default(), &mut |_| {
        true
    })?;
    Ok(frame.census()[1])
}

#[test]
fn a_device_lost_before_a_render_is_an_error_and_a_fresh_one_works() {
    let mut renderer = adapter::open();
    // The same renderer renders until it loses its device.
    let hits = all(&mut renderer).unwrap();
    assert!(hits > 500);
    renderer.device.device.destroy();
    for _ in 0..2 {
        assert_lost(&all(&mut renderer).unwrap_err(), &name(&renderer));
    }
    // A renderer that has never rendered has kernels to compile, too.
    let mut fresh = adapter::open();
    fresh.device.device.destroy();
    assert_lost(&all(&mut fresh).unwrap_err(), &name(&fresh));
    assert_eq!(all(&mut adapter::open()).unwrap(), hits);
}

#[test]
fn a_device_lost_between_any_two_passes_is_an_error() {
    let passes = small().passes(Extras::default()).len();
    for lose_at in 1..=passes {
        let mut renderer = adapter::open();
        let device = renderer.device.device.clone();
        let mut done = 0;
        let result = renderer.render(&small(), &Assets::default(), Extras::default(), &mut |_| {
            done += 1;
            if done == lose_at {
                device.destroy();
            }
            true
        });
        // After the last pass too: what it made has not been read yet.
        assert_lost(&result.unwrap_err(), &name(&renderer));
        assert_eq!(done, lose_at, "a pass ran on a lost device");
    }
}

#[test]
fn a_render_stops_on_request_after_any_pass() {
    let mut renderer = adapter::open();
    let passes = small().passes(Extras::default()).len();
    for stop_at in 1..=passes {
        let mut done = Vec::new();
        let result = renderer.render(
            &small(),
            &Assets::default(),
            Extras::default(),
            &mut |progress| {
                done.push(progress.done);
                done.len() < stop_at
            },
        );
        assert!(matches!(result, Err(RenderError::Cancelled)), "{stop_at}");
        assert_eq!(done.len(), stop_at);
        assert!(done.is_sorted() && done.iter().all(|d| (0.0..=1.0).contains(d)));
    }
    // It has lost nothing by that.
    let mut last = 0.0;
    let frame = renderer.render(
        &small(),
        &Assets::default(),
        Extras::default(),
        &mut |progress| {
            last = progress.done;
            true
        },
    );
    assert!(frame.unwrap().census()[1] > 500);
    assert!((last - 1.0).abs() < 1e-12);
}

#[test]
fn a_choice_that_matches_nothing_lists_what_there_is() {
    let adapters = Adapters::find();
    let names: Vec<String> = adapters.iter().map(|a| a.get_info().name).collect();
    let hardware = adapters.iter().any(|a| kind(&a.get_info()) != "software");
    let mut wrong = vec![
        (Choice::Name("no-such".into()), "no-such"),
        (Choice::Index(99), "99"),
    ];
    if !hardware {
        wrong.push((Choice::Hardware, "hardware"));
    }
    for (choice, asked) in wrong {
        let Err(error) = adapters.choose(&choice) else {
            panic!("{choice:?} matches something")
        };
        let said = error.to_string();
        assert!(said.contains(asked), "{said}");
        for name in names.iter().map(String::as_str).chain(["cpu"]) {
            assert!(said.contains(name), "`{name}` not in: {said}");
        }
    }
}

#[test]
fn every_adapter_can_be_chosen_by_index_and_by_part_of_its_name() {
    let adapters = Adapters::find();
    adapter::open();
    for (i, wanted) in adapters.iter().enumerate() {
        let info = wanted.get_info();
        let chosen = |choice| {
            let found = adapters.choose(&choice).unwrap();
            found.map(|(a, _)| a.get_info().name)
        };
        assert_eq!(chosen(Choice::Index(i)), Some(info.name.clone()));
        let part = info.name.to_uppercase().chars().take(6).collect();
        let found = chosen(Choice::Name(part)).unwrap();
        assert_eq!(found[..6], info.name[..6]);
    }
    assert!(adapters.choose(&Choice::Cpu).unwrap().is_none());
    let (auto, why) = adapters.choose(&Choice::Auto).unwrap().unwrap();
    let software = kind(&auto.get_info()) == "software";
    assert_eq!(why.contains("no hardware adapter"), software, "{why}");
}

#[test]
fn choices_are_read_from_words() {
    let cases = [
        ("auto", Choice::Auto),
        (" gpu ", Choice::Hardware),
        ("software", Choice::Software),
        ("cpu", Choice::Cpu),
        ("0", Choice::Index(0)),
        ("17", Choice::Index(17)),
        ("-1", Choice::Name("-1".into())),
        ("RTX 40", Choice::Name("RTX 40".into())),
        ("gpus", Choice::Name("gpus".into())),
    ];
    for (text, choice) in cases {
        assert_eq!(Choice::read(text), Some(choice), "`{text}`");
    }
    for blank in ["", " ", "\t"] {
        assert_eq!(Choice::read(blank), None, "`{blank}`");
    }
}

/// A folder of its own, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let name = format!("conemarch-device-{name}-{}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn render(&self, args: &[&str]) -> Output {
        self.run(&[&["render"], args].concat())
    }

    fn run(&self, args: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_conemarch"));
        command.args(args).current_dir(&self.0);
        command.stdin(Stdio::null()).output().unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn said(output: &Output) -> Vec<String> {
    let text = String::from_utf8_lossy(&output.stderr);
    text.lines().map(str::to_string).collect()
}

fn assert_done(output: &Output, path: &Path) {
    let said = said(output);
    assert_eq!(output.status.code(), Some(0), "{said:?}");
    // Who renders, and what has become of it; nothing else, the driver's talk included.
    assert_eq!(said.len(), 2, "{said:?}");
    assert!(said[0].starts_with("rendering on "), "{said:?}");
    assert!(said[0].ends_with(" (as asked)"), "{said:?}");
    let file = path.file_name().unwrap().to_string_lossy();
    assert!(
        said[1].starts_with(&format!("{file}  64 x 36  ")),
        "{said:?}"
    );
    assert!(output.stdout.is_empty());
}

/// An adapter by the name of its kind: software, or hardware where there is no other.
fn some_adapter() -> &'static str {
    let adapters = Adapters::find();
    let found = [("software", Choice::Software), ("gpu", Choice::Hardware)]
        .into_iter()
        .find(|(_, choice)| adapters.choose(choice).is_ok());
    found.map(|(name, _)| name).expect(
        "this test needs a GPU adapter; any will do, and `apt-get install mesa-vulkan-drivers` installs a software one",
    )
}

#[test]
fn the_program_renders_on_an_adapter_and_its_picture_renders_the_same_again() {
    let folder = Folder::new("adapter");
    let device = some_adapter();
    let (first, second) = (folder.0.join("f.png"), folder.0.join("g.png"));
    let size = ["--size", "64x36", "--device", device, "-o"];
    let output = folder.render(&[&["mandelbox"], &size[..], &["f.png"]].concat());
    assert_done(&output, &first);
    let output = folder.render(&["f.png", "--device", device, "-o", "g.png"]);
    assert_done(&output, &second);
    let bytes = std::fs::read(&first).unwrap();
    assert!(bytes == std::fs::read(&second).unwrap());
    // Another picture has other bytes.
    let other = [&["mandelbox", "--set", "look.key=1"], &size[..], &["h.png"]].concat();
    assert_eq!(folder.render(&other).status.code(), Some(0));
    assert!(bytes != std::fs::read(folder.0.join("h.png")).unwrap());
}

#[test]
fn the_program_says_what_there_is_instead_of_a_device_it_has_not() {
    let folder = Folder::new("nothing");
    for device in ["no-such", "99"] {
        let output = folder.render(&["mandelbox", "--device", device, "-o", "f.png"]);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(1), "{said:?}");
        let errors: Vec<&String> = said.iter().filter(|l| l.starts_with("error: ")).collect();
        assert_eq!(errors.len(), 1, "{said:?}");
        assert!(errors[0].contains(device) && errors[0].contains("there is: "));
        assert!(!folder.0.join("f.png").exists());
    }
}

/// Measurements of what f32 cannot hold say so in their tables, where f32 measures.
#[test]
fn measurements_under_the_floor_of_f32_are_marked() {
    let folder = Folder::new("floor");
    let near = "[scene]\nkind = \"distance\"\nformula = \"mandelbox\"\n[camera]\neye = [0, 0, 6.001]\nup = [0, 1, 0]\nfov = 2\n";
    std::fs::write(folder.0.join("near.toml"), near).unwrap();
    let verbs: [&[&str]; 3] = [
        &["error"],
        &["steps", "--mode", "safe"],
        &["calibrate", "--rays", "100"],
    ];
    for verb in verbs {
        for (device, marked) in [(some_adapter(), true), ("cpu", false)] {
            let preset = ["near.toml", "--size", "16x9", "--device", device];
            let output = folder.run(&[&["bench"], verb, &preset].concat());
            assert_eq!(output.status.code(), Some(0), "{:?}", said(&output));
            let table = String::from_utf8_lossy(&output.stdout).into_owned();
            let found = table.contains("Precision: the finest footprint");
            assert_eq!(found, marked, "{verb:?} on {device}: {table}");
        }
    }
}
