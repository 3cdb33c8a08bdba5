//! Choosing a device, losing it, and stopping on request: an error that says what was
//! lost and what would do, never a panic and never a frame.

use conemarch::gpu::RenderError;
use conemarch::gpu::adapters::{Adapters, Choice, kind};
use conemarch::gpu::device::DeviceError;
use conemarch::gpu::render::Renderer;
use conemarch::pass::progress::Watch;
use conemarch::plan::{Extras, Plan};
use conemarch::scene::Assets;

use super::common::folder::{Folder, holds, said, text};
use super::common::plans::sized;
use crate::adapter;

fn small() -> Plan {
    sized("mandelbox", [64, 36])
}

fn passes_of_small() -> usize {
    small().passes(Extras::default()).len()
}

/// Renders a small plan: how many pixels hit.
fn hits(renderer: &mut Renderer, watch: Watch<'_>) -> Result<usize, RenderError> {
    let frame = renderer.render(&small(), &Assets::default(), Extras::default(), watch)?;
    Ok(frame.census()[1])
}

/// Asserts that a loss is reported: what was lost, that nothing was written, what would do.
fn assert_lost(result: Result<usize, RenderError>, renderer: &Renderer) {
    let error = result.unwrap_err();
    let RenderError::Device(DeviceError::Lost { .. }) = error else {
        panic!("not a loss: {error:?}")
    };
    let said = error.to_string();
    let name = &renderer.device.info.name;
    holds(&said, &[name, "was lost", "nothing was written"]);
    holds(&said, &["--device cpu"]);
    assert!(!said.contains('\n'), "more than a line: {said}");
}

#[test]
fn a_device_lost_before_a_render_is_opened_again() {
    let all = |renderer: &mut Renderer| hits(renderer, &mut |_| true);
    let mut renderer = adapter::open();
    // The same renderer renders until it loses its device.
    let before = all(&mut renderer).unwrap();
    assert!(before > 500);
    renderer.device.device.destroy();
    assert_eq!(all(&mut renderer).unwrap(), before);
    // So is that of a renderer that has never rendered.
    let mut fresh = adapter::open();
    fresh.device.device.destroy();
    assert_eq!(all(&mut fresh).unwrap(), before);
}

#[test]
fn a_device_lost_between_any_two_passes_is_an_error() {
    for lose_at in 1..=passes_of_small() {
        let mut renderer = adapter::open();
        let device = renderer.device.device.clone();
        let mut done = 0;
        let result = hits(&mut renderer, &mut |_| {
            done += 1;
            if done == lose_at {
                device.destroy();
            }
            true
        });
        assert_lost(result, &renderer);
        assert!(done >= lose_at);
    }
}

#[test]
fn a_render_stops_on_request_after_any_pass() {
    let mut renderer = adapter::open();
    for stop_at in 1..=passes_of_small() {
        let mut done = Vec::new();
        let result = hits(&mut renderer, &mut |progress| {
            done.push(progress.done);
            done.len() < stop_at
        });
        assert!(matches!(result, Err(RenderError::Cancelled)), "{stop_at}");
        assert_eq!(done.len(), stop_at);
        let fits = done.is_sorted() && done.iter().all(|d| (0.0..=1.0).contains(d));
        assert!(fits, "{done:?}");
    }
    // It has lost nothing by that.
    let mut last = 0.0;
    let hits = hits(&mut renderer, &mut |progress| {
        last = progress.done;
        true
    });
    assert!(hits.unwrap() > 500);
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
        holds(&said, &[asked, "cpu"]);
        holds(&said, &names.iter().map(String::as_str).collect::<Vec<_>>());
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

/// An adapter by the name of its kind: software, or hardware where there is no other.
fn some_adapter() -> &'static str {
    let adapters = Adapters::find();
    let kinds = [("software", Choice::Software), ("gpu", Choice::Hardware)];
    let mut kinds = kinds.iter();
    let found = kinds.find(|(_, choice)| adapters.choose(choice).is_ok());
    found.expect(adapter::NO_ADAPTER).0
}

#[test]
fn the_program_renders_on_an_adapter_and_its_picture_renders_the_same_again() {
    let folder = Folder::new();
    let render = |args: &str, file: &str| {
        let device = some_adapter();
        let output = folder.done(&format!("render {args} --device {device} -o {file}"));
        // Who renders, and what has become of it; nothing else, the driver's talk included.
        let said = said(&output);
        let lines: Vec<&str> = said.lines().collect();
        assert_eq!((lines.len(), output.stdout.len()), (2, 0), "{said}");
        assert!(lines[0].starts_with("rendering on ") && lines[0].ends_with(" (as asked)"));
        let start = format!("{file}  64 x 36  ");
        assert!(lines[1].starts_with(&start), "{said}");
        folder.bytes(file)
    };
    let small = "mandelbox --size 64x36";
    let bytes = render(small, "f.png");
    assert!(bytes == render("f.png", "g.png"));
    // Another picture has other bytes.
    assert!(bytes != render(&format!("{small} --set look.key=1"), "h.png"));
}

#[test]
fn the_program_says_what_there_is_instead_of_a_device_it_has_not() {
    for device in ["no-such", "99"] {
        let line = format!("render mandelbox --device {device} -o f.png");
        Folder::new().fails(&line, 1, &format!("{device}|there is: "));
    }
}

/// Measurements of what f32 cannot hold say so in their tables, where f32 measures.
#[test]
fn measurements_under_the_floor_of_f32_are_marked() {
    let folder = Folder::new();
    let near = "[scene]\nkind = 'distance'\nformula = 'mandelbox'
        [camera]\neye = [0, 0, 6.001]\nup = [0, 1, 0]\nfov = 2\n";
    folder.write("near.toml", near);
    for verb in ["error", "steps --mode safe", "calibrate --rays 100"] {
        for (device, marked) in [(some_adapter(), true), ("cpu", false)] {
            let args = format!("bench {verb} near.toml --size 16x9 --device {device}");
            let table = text(&folder.done(&args));
            let found = table.contains("Precision: the finest footprint");
            assert_eq!(found, marked, "{args}: {table}");
        }
    }
}
