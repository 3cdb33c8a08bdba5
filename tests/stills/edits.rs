//! Texts of shaders that change while a program runs.

use std::sync::{Arc, Mutex};

use conemarch::gpu::render::Renderer;
use conemarch::plan::Extras;
use conemarch::scene::Assets;

use super::common::plans::sized;
use super::live::whole;
use super::work::bits;
use crate::adapter::{self, EVERYTHING};

#[test]
fn a_shader_text_changes_and_a_wrong_one_is_told_once_and_keeps_the_old() {
    const COLOR: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/wgsl/pass/color.wgsl"));
    let mut renderer = adapter::open();
    let plan = sized("mandelbox", [64, 36]);
    let old = whole(&mut renderer, &plan).unwrap();
    let text = Arc::new(Mutex::new(COLOR.to_string()));
    let now = text.clone();
    renderer.sources = Some(Arc::new(move |path| {
        (path == "wgsl/pass/color.wgsl").then(|| now.lock().unwrap().clone())
    }));
    assert!(whole(&mut renderer, &plan).unwrap() == old);
    let line = "        let behind = sky(ray.axis);";
    let at = COLOR.lines().position(|l| l == line).unwrap() + 1;
    let edit = |new: &str| *text.lock().unwrap() = COLOR.replace(line, new);
    edit("        let behind = vec3<f32>(7.0);");
    assert!(whole(&mut renderer, &plan).unwrap() != old);
    edit("        let behind = skye(ray.axis);");
    let error = whole(&mut renderer, &plan).unwrap_err().to_string();
    assert!(
        error.contains(&format!("wgsl/pass/color.wgsl:{at}: ")),
        "{error}"
    );
    // The last text that worked stays, in the programs of other plans too.
    let stays = whole(&mut renderer, &plan).unwrap();
    assert!(stays != old);
    let mut foggy = plan.clone();
    foggy.look.fog = 0.3;
    let changed = whole(&mut renderer, &foggy).unwrap();
    // Whoever comes back to a wrong text hears of it again.
    edit("        let behind = vec3<f32>(7.0);");
    assert!(whole(&mut renderer, &plan).unwrap() == stays);
    assert!(whole(&mut renderer, &foggy).unwrap() == changed);
    edit("        let behind = skye(ray.axis);");
    assert!(whole(&mut renderer, &foggy).is_err());
    edit(line);
    let frame = renderer.render(&plan, &Assets::default(), EVERYTHING, &mut |_| true);
    let frame = frame.unwrap();
    assert!(bits(&frame) == old);
    let traffic = frame.traffic.unwrap();
    assert_eq!((traffic.compilations, traffic.drains), (0, 0));
}

/// The program that arranges dispatches belongs to no stage.
#[test]
fn the_text_of_what_arranges_dispatches_changes_too() {
    const TEXT: &str = include_str!(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/wgsl/pass/arrange.wgsl"
    ));
    let mut renderer = adapter::open();
    let plan = sized("mandelbox", [64, 36]);
    let old = whole(&mut renderer, &plan).unwrap();
    let line = "return turn.stage.tiles;";
    for (text, same) in [
        (TEXT.replace(line, "return turn.stage.tiles / 2u;"), false),
        (TEXT.into(), true),
    ] {
        renderer.sources = Some(Arc::new(move |path| {
            (path == "wgsl/pass/arrange.wgsl").then(|| text.clone())
        }));
        let mut other = plan.clone();
        other.camera.fov += 1e-9;
        let made = whole(&mut renderer, &other);
        assert_eq!(made.is_ok_and(|made| made == old), same);
    }
}

/// What a text asks of a device can be wrong too.
#[test]
fn a_shader_text_that_no_device_can_run_is_told_with_its_file_and_line() {
    const COLOR: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/wgsl/pass/color.wgsl"));
    let used = "        let behind = sky(ray.axis) + extra[0];";
    let line = "        let behind = sky(ray.axis);";
    let declared = |at: &str| {
        format!(
            "{}\n{at} var<storage, read> extra: array<f32>;",
            COLOR.replace(line, used)
        )
    };
    let end = COLOR.lines().count() + 2;
    let entry = COLOR
        .lines()
        .position(|l| l.starts_with("fn color("))
        .unwrap()
        + 1;
    for (text, at, says) in [
        (
            declared("@group(2) @binding(13)"),
            end,
            "needs a buffer for `extra`",
        ),
        (
            declared("@group(9) @binding(0)"),
            end,
            "`extra` is in group 9",
        ),
        (format!("{COLOR}\noverride EXTRA: f32;"), end, "`EXTRA`"),
        (
            COLOR.replace("@workgroup_size(64)", "@workgroup_size(4096)"),
            entry,
            "refused",
        ),
        (
            COLOR.replace("fn color(", "fn other("),
            1,
            "the entry point is missing",
        ),
    ] {
        let mut renderer = adapter::open();
        let plan = sized("mandelbox", [64, 36]);
        let old = whole(&mut renderer, &plan).unwrap();
        let edited = Arc::new(Mutex::new(true));
        let now = edited.clone();
        renderer.sources = Some(Arc::new(move |path| {
            let is_edited = path == "wgsl/pass/color.wgsl" && *now.lock().unwrap();
            is_edited.then(|| text.clone())
        }));
        let said = whole(&mut renderer, &plan).unwrap_err().to_string();
        let place = format!("wgsl/pass/color.wgsl:{at}: ");
        assert!(
            said.starts_with(&place) && said.contains(says),
            "{place}{says}: {said}"
        );
        assert!(!said.contains('\n'), "{said}");
        *edited.lock().unwrap() = false;
        assert!(whole(&mut renderer, &plan).unwrap() == old, "{says}");
    }
}

/// A struct of another size than its buffer is found before a frame begins.
#[test]
fn a_struct_that_is_larger_than_its_twin_is_told_and_the_old_plan_goes_on() {
    const TURN: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/wgsl/pass/turn.wgsl"));
    let text = TURN.replace(
        "struct Turn {",
        "struct Turn {\n    extra: array<vec4<u32>, 99>,",
    );
    let mut renderer = adapter::open();
    let plan = sized("mandelbox", [64, 36]);
    let old = whole(&mut renderer, &plan).unwrap();
    let edited = Arc::new(Mutex::new(false));
    let now = edited.clone();
    renderer.sources = Some(Arc::new(move |path| {
        let is_edited = path == "wgsl/pass/turn.wgsl" && *now.lock().unwrap();
        is_edited.then(|| text.clone())
    }));
    let assets = Assets::default();
    let mut work = renderer.begin(&plan, &assets, EVERYTHING).unwrap();
    *edited.lock().unwrap() = true;
    renderer.set(&mut work, &plan, &assets).unwrap();
    let said = loop {
        if let Err(error) = work.advance(1.0) {
            break error.to_string();
        }
    };
    assert!(
        said.starts_with("wgsl/pass/arrange.wgsl:7: ") && said.contains("bytes for `turn`"),
        "{said}"
    );
    // The old plan goes on.
    assert!(bits(&work.finish(&mut |_| true).unwrap()) == old);
    *edited.lock().unwrap() = false;
    assert!(whole(&mut renderer, &plan).unwrap() == old);
}

/// A driver that drops work leaves no picture.
#[test]
fn cells_that_a_device_leaves_out_are_an_error() {
    const TRACE: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/wgsl/pass/trace.wgsl"));
    let line = "    let ray = view_ray_from(";
    let text = TRACE.replace(line, &format!("    if local.x < 10u {{ return; }}\n{line}"));
    assert_ne!(text, TRACE);
    let mut renderer = adapter::open();
    renderer.sources = Some(Arc::new(move |path| {
        (path == "wgsl/pass/trace.wgsl").then(|| text.clone())
    }));
    let said = whole(&mut renderer, &sized("mandelbox-hall", [96, 54])).unwrap_err();
    assert!(
        said.to_string().contains("left 540 cells unwritten"),
        "{said}"
    );
}

/// Of several programs that change, all or none take the places of the old.
#[test]
fn a_program_that_cannot_be_bound_leaves_the_others_as_they_were() {
    let plan = sized("mandelbox", [64, 36]);
    let shown = Extras {
        shown: true,
        ..EVERYTHING
    };
    let mut renderer = adapter::open();
    let render = |renderer: &mut Renderer| {
        let frame = renderer.render(&plan, &Assets::default(), shown, &mut |_| true);
        frame.map(|frame| bits(&frame))
    };
    let old = render(&mut renderer).unwrap();
    let text = |path: &str| {
        let root = env!("CARGO_MANIFEST_DIR");
        std::fs::read_to_string(format!("{root}/{path}")).unwrap()
    };
    renderer.sources = Some(Arc::new(move |path| match path {
        "wgsl/pass/color.wgsl" => Some(text(path).replace("= sky(ray.axis);", "= vec3<f32>(7.0);")),
        "wgsl/pass/develop.wgsl" => {
            let reads = "{\n    if extra[0] > 1e30 { return; }\n";
            let declared = "@group(2) @binding(13) var<storage, read> extra: array<f32>;\n";
            Some(text(path).replacen("{\n", reads, 1) + declared)
        }
        _ => None,
    }));
    let said = render(&mut renderer).unwrap_err().to_string();
    assert!(said.contains("needs a buffer for `extra`"), "{said}");
    renderer.sources = None;
    assert!(render(&mut renderer).unwrap() == old);
}

/// What lacks its end is noticed in a later file, or at the end of the program.
#[test]
fn a_shader_text_that_lacks_an_end_is_told_with_its_own_file_and_line() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let plan = sized("mandelbox", [64, 36]);
    let without_last = |text: &str| text[..text.rfind('}').unwrap()].to_string();
    let file = |path: &str| std::fs::read_to_string(root.join(path)).unwrap();
    // The line of the last bracket at the start of a function or struct.
    let of_last = |text: &str| {
        let at = text.lines().enumerate();
        let opens = at.filter(|(_, l)| l.ends_with('{') && !l.starts_with(' '));
        opens.last().unwrap().0 + 1
    };
    let brackets = [
        "wgsl/pass/quick.wgsl",
        "wgsl/pass/look.wgsl",
        "wgsl/pass/color.wgsl",
        "wgsl/pass/trace.wgsl",
        "wgsl/scene/distance.wgsl",
        "wgsl/base/view.wgsl",
    ];
    let mut cases: Vec<(&str, String, usize, &str)> = Vec::new();
    for path in brackets {
        let text = file(path);
        cases.push((path, without_last(&text), of_last(&text), "`{` has no end"));
    }
    let look = file(brackets[1]);
    let lines = look.lines().count();
    for (added, says) in [
        ("\nconst EXTRA = 3 // none", "no `;`"),
        ("\n/* a /* b */", "block comment"),
        ("\n}", "expected global item"),
    ] {
        cases.push((
            brackets[1],
            format!("{}{added}", look.trim_end()),
            lines + 1,
            says,
        ));
    }
    for (path, text, line, says) in cases {
        let mut renderer = adapter::open();
        renderer.sources = Some(Arc::new(move |asked| (asked == path).then(|| text.clone())));
        let said = whole(&mut renderer, &plan).unwrap_err().to_string();
        let place = format!("{path}:{line}: ");
        assert!(
            said.starts_with(&place) && said.contains(says),
            "{place}{says}: {said}"
        );
    }
}
