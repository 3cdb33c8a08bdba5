//! Every program that can be made is valid WGSL, in f32 and in f64, with exactly the
//! constants that it declares; faults are named by file and line; no shader file lies
//! unused; and a feature that a plan lacks is not in its programs. Needs no adapter.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test may panic, and is read by its name"
)]

mod common {
    pub mod plans;
}

use conemarch::pass;
use conemarch::scene::Assets;
use conemarch::scene::Scene;
use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use common::plans::{distance, every_program, preset, programs_of};
use conemarch::base::shader::{Module, Program, ShaderError};
use conemarch::formula::Formula;
use conemarch::formula::mandelbox::Mandelbox;
use conemarch::gpu::device::{PROMISED_BUFFERS, STORAGE_BUFFERS};
use conemarch::heightfield::conemap::generate::generator::Generator;
use conemarch::heightfield::conemap::generate::task as generate;
use conemarch::heightfield::conemap::{ConeMap, MapKind};
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::texture::Texture;
use conemarch::heightfield::tracer::cones::{Cones, Manner};
use conemarch::heightfield::tracer::linear::LinearBinary;
use conemarch::heightfield::tracer::max_mip::MaxMipTracer;
use conemarch::heightfield::tracer::relaxed::WalkRelaxed;
use conemarch::heightfield::tracer::walk::Walk;
use conemarch::heightfield::tracer::walk_mip::WalkMip;
use conemarch::heightfield::tracer::{AnyTracer, Tracer};
use conemarch::plan::{Extras, Pass, Plan};
use glam::DVec3;
use wgpu::naga::valid::Capabilities;

/// A program known to be good, for tests that break a copy of it.
fn good() -> Program {
    let plan = preset("mandelbox");
    pass::program(
        &plan,
        &plan.solid(&Assets::default()).unwrap(),
        Pass::Trace,
        Extras::default(),
    )
}

fn paths(program: &Program) -> BTreeSet<&'static str> {
    program.modules.iter().map(|m| m.path).collect()
}

fn has(program: &Program, path: &str) -> bool {
    paths(program).contains(path)
}

#[test]
fn every_program_is_valid_in_f32_and_sets_its_constants() {
    let all = every_program();
    // Three entries, two cone rules, ten scenes, eight looks: a small number would
    // mean that the list above has lost something.
    assert!(all.len() > 150, "only {} programs", all.len());
    for (listing, program) in &all {
        let result = program.validate(Capabilities::default());
        assert!(result.is_ok(), "{}\n{listing}", result.unwrap_err());
    }
}

#[test]
fn every_program_with_real_numbers_is_valid_in_f64() {
    let mut tried = 0;
    for (listing, program) in every_program() {
        let wide = program.in_f64();
        if !has(&program, "wgsl/base/real.wgsl") {
            assert_eq!(wide, program, "{listing}");
            continue;
        }
        assert!(!has(&wide, "wgsl/base/real.wgsl") && has(&wide, "wgsl/base/real64.wgsl"));
        let result = wide.validate(Capabilities::FLOAT64);
        assert!(result.is_ok(), "{}\n{listing}", result.unwrap_err());
        tried += 1;
        // Without the capability f64 is refused: the text has really changed.
        if tried == 1 {
            assert!(wide.validate(Capabilities::default()).is_err());
        }
    }
    assert!(tried > 100, "only {tried} programs in f64");
}

#[test]
fn no_name_is_given_a_constant_twice() {
    for (listing, program) in every_program() {
        let names: Vec<_> = program.constants().iter().map(|c| c.0).collect();
        let different: BTreeSet<_> = names.iter().collect();
        assert_eq!(different.len(), names.len(), "{listing}");
    }
}

#[test]
fn a_missing_and_an_unknown_constant_are_errors() {
    let mut missing = good();
    let module = missing
        .modules
        .iter_mut()
        .find(|m| !m.constants.is_empty())
        .unwrap();
    let (gone, _) = module.constants.remove(0);
    let error = missing.validate(Capabilities::default()).unwrap_err();
    match &error {
        ShaderError::Constant { name, fault, entry } => {
            assert_eq!((name.as_str(), *fault, *entry), (gone, "missing", "trace"));
        }
        other => panic!("{other}"),
    }
    assert!(error.to_string().contains(gone), "{error}");

    let mut unknown = good();
    unknown.modules[0].constants.push(("NOBODY_ASKED", 1.0));
    let error = unknown.validate(Capabilities::default()).unwrap_err();
    match error {
        ShaderError::Constant { name, fault, .. } => {
            assert_eq!((name.as_str(), fault), ("NOBODY_ASKED", "unknown"));
        }
        other => panic!("{other}"),
    }
}

const PATH: &str = "tests/broken.wgsl";

/// Texts with one fault each, and the lines that may be named for it. Parsing knows the
/// line; validation, which works on whole functions, may name any from the function's
/// first.
const BROKEN: &[(&str, RangeInclusive<usize>)] = &[
    // A syntax error.
    ("// one\n// two\nfn broken( {\n}\n", 3..=3),
    // A name that nothing declares.
    ("fn broken() -> f32 {\n    return nowhere;\n}\n", 2..=2),
    // An assignment to a value.
    (
        "\n\nfn broken() {\n    let a = 1.0;\n    a = 2.0;\n}\n",
        5..=5,
    ),
    // A type that does not fit, which only validation finds.
    (
        "\nfn broken() -> f32 {\n    let a = 1u;\n    return a;\n}\n\n",
        2..=4,
    ),
];

#[test]
fn a_fault_points_to_its_file_and_line_wherever_the_module_is_joined() {
    for (source, expected) in BROKEN {
        for at in [0, 3, good().modules.len()] {
            let mut program = good();
            let module = Module {
                path: PATH,
                source,
                constants: Vec::new(),
            };
            program.modules.insert(at, module);
            let error = program.validate(Capabilities::default()).unwrap_err();
            let shown = error.to_string();
            let ShaderError::Text { path, line, .. } = error else {
                panic!("{shown}");
            };
            assert_eq!(path, PATH, "{shown}");
            assert!(expected.contains(&line), "{shown}");
            assert!(shown.starts_with(&format!("{PATH}:{line}: ")), "{shown}");
        }
    }
}

#[test]
fn every_line_of_a_joined_text_is_located_in_its_file() {
    let program = good();
    let source = program.source();
    let mut expected = Vec::new();
    for module in &program.modules {
        for (i, text) in module.source.lines().enumerate() {
            expected.push((module.path, i + 1, text));
        }
    }
    assert_eq!(source.lines().count(), expected.len());
    for (i, (text, want)) in source.lines().zip(&expected).enumerate() {
        let (path, line) = program.locate(i + 1);
        assert_eq!((path, line, text), *want);
    }
}

fn files_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files_below(&path, found);
        } else {
            found.push(path);
        }
    }
}

/// Files of heightfields: those that make cone maps, and those of every tracer.
fn heightfield_paths() -> BTreeSet<&'static str> {
    let mut all = BTreeSet::from([Texture::module().path]);
    for program in generate::every_program() {
        all.extend(paths(&program));
    }
    let heights = Heights::new([2, 2], [false; 2], vec![0.5; 4]).unwrap();
    let relief = Arc::new(HeightSurface::new(heights, Patches::Bilinear, [1, 1]).unwrap());
    let map = |kind, size: [u32; 2]| {
        let cones = if kind == MapKind::Quad { 4 } else { 1 };
        Arc::new(ConeMap {
            kind,
            size,
            wrap: [false; 2],
            offset: 1.0,
            ratios: vec![1.0; (size[0] * size[1] * cones) as usize],
        })
    };
    let walk = Walk::new(relief.clone(), map(MapKind::Walk, [1, 1])).unwrap();
    let relaxed = WalkRelaxed::new(relief.clone(), map(MapKind::WalkRelaxed, [1, 1])).unwrap();
    let distant = WalkMip::new(relief.clone(), map(MapKind::Walk, [1, 1]), 1.0).unwrap();
    let mut tracers = vec![
        AnyTracer::Walk(walk),
        AnyTracer::WalkRelaxed(relaxed),
        AnyTracer::WalkMip(distant),
        AnyTracer::MaxMip(MaxMipTracer::new(relief.clone())),
        AnyTracer::LinearBinary(LinearBinary::new(relief.clone(), 1, 1)),
    ];
    for manner in Manner::ALL {
        let cones = Cones::new(relief.clone(), map(manner.kinds()[0], [2, 2]), manner);
        tracers.push(AnyTracer::Cones(cones.unwrap()));
    }
    for tracer in tracers {
        all.extend(tracer.modules().iter().map(|m| m.path));
    }
    all
}

#[test]
fn every_file_of_shaders_is_joined_by_some_program() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    files_below(&root.join("wgsl"), &mut found);
    assert!(found.len() > 20, "only {} files below wgsl", found.len());
    let mut joined = BTreeSet::new();
    for program in every_program().values() {
        joined.extend(paths(program));
        joined.extend(paths(&program.in_f64()));
    }
    joined.extend(heightfield_paths());
    for file in &found {
        let path = file.strip_prefix(root).unwrap().to_str().unwrap();
        let path = path.replace('\\', "/");
        assert!(joined.contains(path.as_str()), "no program joins {path}");
        // Joining is concatenation: a last line without its end would run on.
        let text = std::fs::read_to_string(file).unwrap();
        assert!(text.ends_with('\n'), "{path} does not end its last line");
        assert!(text.starts_with("// "), "{path} does not say what it is");
    }
    assert_eq!(joined.len(), found.len());
}

/// The `mandelbox` preset with its Mandelbox changed.
fn changed(change: impl FnOnce(&mut Mandelbox)) -> Plan {
    let mut formula = Mandelbox::default();
    change(&mut formula);
    let mut plan = preset("mandelbox");
    plan.scene = distance(Formula::Mandelbox(formula));
    plan
}

#[test]
fn a_rotation_by_nothing_is_no_rotation() {
    let none = pass::explain(&changed(|_| {}), &Assets::default(), Extras::default()).unwrap();
    let whole_turns = pass::explain(
        &changed(|m| m.rotation = DVec3::new(360.0, 0.0, -360.0)),
        &Assets::default(),
        Extras::default(),
    )
    .unwrap();
    assert_eq!(none, whole_turns);
    // Three half turns about three axes bring everything back.
    for turns in [DVec3::splat(180.0), DVec3::new(-180.0, 540.0, 180.0)] {
        assert_eq!(
            none,
            pass::explain(
                &changed(|m| m.rotation = turns),
                &Assets::default(),
                Extras::default()
            )
            .unwrap()
        );
    }
    assert!(none.contains("wgsl/formula/rotation_none.wgsl"));
    assert!(!none.contains("wgsl/formula/rotation.wgsl"));
    let turned = pass::explain(
        &changed(|m| m.rotation = DVec3::new(0.0, 0.0, 1.0)),
        &Assets::default(),
        Extras::default(),
    )
    .unwrap();
    assert_ne!(none, turned);
    assert!(turned.contains("wgsl/formula/rotation.wgsl"));
    assert!(!turned.contains("wgsl/formula/rotation_none.wgsl"));
}

/// How a feature is switched, the file that serves it, and the one that stands in.
type Feature = (fn(&mut Plan, bool), &'static str, &'static str);

#[test]
fn features_that_are_off_are_not_joined() {
    let cases: [Feature; 3] = [
        (
            |p, on| p.look.shadow = on,
            "wgsl/pass/shadow.wgsl",
            "wgsl/pass/shadow_off.wgsl",
        ),
        (
            |p, on| p.look.occlusion = f64::from(u8::from(on)),
            "wgsl/pass/occlusion.wgsl",
            "wgsl/pass/occlusion_off.wgsl",
        ),
        (
            |p, on| p.look.fog = f64::from(u8::from(on)),
            "wgsl/pass/fog.wgsl",
            "wgsl/pass/fog_off.wgsl",
        ),
    ];
    for (set, real, stand_in) in cases {
        for on in [true, false] {
            let mut plan = preset("mandelbox");
            set(&mut plan, on);
            let text = pass::explain(&plan, &Assets::default(), Extras::default()).unwrap();
            assert_eq!(text.contains(real), on, "{real}\n{text}");
            assert_eq!(text.contains(stand_in), !on, "{stand_in}\n{text}");
        }
    }
}

/// The lines of a program in an explanation.
fn explained<'a>(text: &'a str, entry: &str) -> &'a str {
    let (_, programs) = text.split_once("\nprograms\n").unwrap();
    let (_, from) = programs.split_once(&format!("  {entry}\n")).unwrap();
    // Modules stand deeper than the names of programs.
    let end = from
        .match_indices("\n  ")
        .find(|(at, _)| from.as_bytes()[at + 3] != b' ');
    end.map_or(from, |(at, _)| &from[..at])
}

#[test]
fn what_is_asked_for_beside_the_picture_is_explained() {
    let plan = preset("mandelbox");
    let explain = |extras| pass::explain(&plan, &Assets::default(), extras).unwrap();
    let plain = explain(Extras::default());
    let counted = explain(Extras {
        count: true,
        ..Extras::default()
    });
    for (entry, counts) in [("march", true), ("trace", true), ("color", false)] {
        assert!(!explained(&plain, entry).contains("wgsl/base/counters.wgsl"));
        let text = explained(&counted, entry);
        assert_eq!(text.contains("wgsl/base/counters.wgsl"), counts, "{text}");
        assert_eq!(
            text.contains("wgsl/base/counters_off.wgsl"),
            !counts,
            "{text}"
        );
    }
    let normals = explain(Extras {
        normals: true,
        ..Extras::default()
    });
    assert!(plain.contains("COLOR_KEEPS_NORMALS=0"));
    assert!(normals.contains("COLOR_KEEPS_NORMALS=1"));
    let shapes = explain(Extras {
        depth_only: true,
        ..Extras::default()
    });
    assert!(
        plain.contains("  color ") && !shapes.contains("color"),
        "{shapes}"
    );
}

#[test]
fn what_is_prepared_for_a_heightfield_is_explained() {
    let mut plan = preset("terrain");
    let text = pass::explain(&plan, &Assets::default(), Extras::default()).unwrap();
    let first = text.lines().skip(2).take(2).collect::<Vec<_>>().join("\n");
    assert_eq!(first, "passes\n  prepare         511 x 511    steps -");
    assert!(explained(&text, "generate").contains("wgsl/heightfield/conemap/generate/search.wgsl"));
    // What is explained is what is run, though no cones are made for it.
    for program in programs_of(&plan) {
        let listing = program.describe();
        let extras =
            listing.contains("base/counters.wgsl") || listing.contains("COLOR_KEEPS_NORMALS=1");
        let plain = format!("  {}\n{listing}", program.entry);
        assert_eq!(text.contains(&plain), !extras, "{plain}\n{text}");
    }
    // Nothing is prepared where nothing is needed.
    let Scene::Heightfield(shape) = &mut plan.scene else {
        unreachable!("the terrain");
    };
    shape.tracing.tracer = "max-mip";
    let text = pass::explain(&plan, &Assets::default(), Extras::default()).unwrap();
    assert!(
        !text.contains("prepare") && !text.contains("generate"),
        "{text}"
    );
    assert!(text.contains("paint_height.wgsl") && !text.contains("/paint.wgsl"));
    // A paint is a map of its own, but for that of the tracer.
    for (tracer, paint, maps) in [
        ("max-mip", Generator::Exact, 1),
        ("walk", Generator::Exact, 2),
        ("walk", Generator::Walk, 1),
    ] {
        let Scene::Heightfield(shape) = &mut plan.scene else {
            unreachable!("the terrain");
        };
        shape.tracing.tracer = tracer;
        shape.paint = Some(paint);
        let text = pass::explain(&plan, &Assets::default(), Extras::default()).unwrap();
        let lines = text.lines().filter(|l| l.starts_with("  prepare"));
        assert_eq!(lines.count(), maps, "{tracer}, {paint:?}: {text}");
        assert!(text.contains("/paint.wgsl") && !text.contains("paint_height.wgsl"));
    }
}

#[test]
fn work_is_counted_only_where_it_is_asked_for() {
    let plan = preset("mandelbox");
    let scene = plan.solid(&Assets::default()).unwrap();
    for pass in plan.passes(Extras::default()) {
        for count in [false, true] {
            let extras = Extras {
                count,
                ..Extras::default()
            };
            let program = pass::program(&plan, &scene, pass, extras);
            let counted = count && pass != Pass::Color;
            assert_eq!(has(&program, "wgsl/base/counters.wgsl"), counted);
            assert_eq!(has(&program, "wgsl/base/counters_off.wgsl"), !counted);
        }
    }
}

#[test]
fn what_a_slider_moves_compiles_nothing_new() {
    let still = preset("mandelbox");
    let mut moved = still.clone();
    moved.camera.eye = DVec3::new(3.0, -9.0, 1.0);
    moved.camera.fov = 70.0;
    moved.march.detail = 0.3;
    moved.march.shell = 0.7;
    moved.march.fudge = vec![0.9, 0.5];
    moved.march.steps = Some(77);
    moved.look.key = 1.0;
    moved.look.occlusion *= 0.5;
    moved.look.palette = vec![DVec3::ONE; 3];
    moved.size = [33, 17];
    moved.scene = distance(Formula::Mandelbox(Mandelbox {
        scale: -1.7,
        min_radius: 0.3,
        julia_constant: DVec3::X,
        ..Mandelbox::default()
    }));
    assert_eq!(programs_of(&still), programs_of(&moved));
    // But a feature does.
    moved.look.shadow = !moved.look.shadow;
    assert_ne!(programs_of(&still), programs_of(&moved));
}

#[test]
fn the_rule_of_the_slides_takes_the_place_of_the_exact_one() {
    use conemarch::plan::march::Mode;
    let mut plan = preset("mandelbox");
    for (mode, exact) in [(Mode::Safe, true), (Mode::SlidesDeep, false)] {
        plan.march.mode = mode;
        let text = pass::explain(&plan, &Assets::default(), Extras::default()).unwrap();
        assert_eq!(text.contains("wgsl/base/cone.wgsl"), exact);
        assert_eq!(text.contains("wgsl/base/cone_slides.wgsl"), !exact);
    }
}

#[test]
fn the_mandelbox_is_explained() {
    insta::assert_snapshot!(pass::explain(&preset("mandelbox"), &Assets::default(), Extras::default()).unwrap(), @r"
    1280 x 720, mode safe
    mandelbox: 14 iterations, lipschitz 1
    passes
      march 1/16       80 x 45     steps 256
      march 1/8       160 x 90     steps 256
      march 1/4       320 x 180    steps 256
      march 1/2       640 x 360    steps 256
      trace          1280 x 720    steps 256
      color          1280 x 720    steps -
    programs
      march
        wgsl/base/real.wgsl
        wgsl/base/cone.wgsl  CONE_TRUST=0.9999990463256836  CONE_ROUND_DOWN=0.9999997615814209
        wgsl/scene/distance.wgsl  DISTANCE_ENOUGH=0.8  DISTANCE_SMOOTHING=0.3  DISTANCE_MOST_RELAXED=3  DISTANCE_WITHIN=0.99  HIT_CARRIES_MARK=0
        wgsl/formula/mandelbox.wgsl  MANDELBOX_JULIA=0  MANDELBOX_CLASSIC=0
        wgsl/formula/rotation_none.wgsl
        wgsl/base/view.wgsl
        wgsl/pass/shared.wgsl
        wgsl/base/counters_off.wgsl
        wgsl/pass/queue.wgsl
        wgsl/pass/march.wgsl
      trace
        wgsl/base/real.wgsl
        wgsl/base/cone.wgsl  CONE_TRUST=0.9999990463256836  CONE_ROUND_DOWN=0.9999997615814209
        wgsl/scene/distance.wgsl  DISTANCE_ENOUGH=0.8  DISTANCE_SMOOTHING=0.3  DISTANCE_MOST_RELAXED=3  DISTANCE_WITHIN=0.99  HIT_CARRIES_MARK=0
        wgsl/formula/mandelbox.wgsl  MANDELBOX_JULIA=0  MANDELBOX_CLASSIC=0
        wgsl/formula/rotation_none.wgsl
        wgsl/base/view.wgsl
        wgsl/pass/shared.wgsl
        wgsl/base/counters_off.wgsl
        wgsl/pass/queue.wgsl
        wgsl/pass/trace.wgsl
      color
        wgsl/base/real.wgsl
        wgsl/base/cone.wgsl  CONE_TRUST=0.9999990463256836  CONE_ROUND_DOWN=0.9999997615814209
        wgsl/scene/distance.wgsl  DISTANCE_ENOUGH=0.8  DISTANCE_SMOOTHING=0.3  DISTANCE_MOST_RELAXED=3  DISTANCE_WITHIN=0.99  HIT_CARRIES_MARK=0
        wgsl/formula/mandelbox.wgsl  MANDELBOX_JULIA=0  MANDELBOX_CLASSIC=0
        wgsl/formula/rotation_none.wgsl
        wgsl/base/view.wgsl
        wgsl/pass/shared.wgsl
        wgsl/base/counters_off.wgsl
        wgsl/pass/look.wgsl
        wgsl/pass/shadow.wgsl
        wgsl/pass/occlusion.wgsl
        wgsl/pass/fog_off.wgsl
        wgsl/pass/color.wgsl  COLOR_KEEPS_NORMALS=0  COLOR_IS_PIGMENT=0
    ");
}

#[test]
fn no_program_binds_more_buffers_than_are_asked_for() {
    let mut plan = preset("terrain");
    let Scene::Heightfield(shape) = &mut plan.scene else {
        unreachable!("the terrain");
    };
    shape.source.field = "fbm:16x16".into();
    shape.tracing.tracer = "quad";
    shape.paint = Some(Generator::Exact);
    let mut programs: Vec<Program> = every_program().into_values().collect();
    programs.extend(programs_of(&plan));
    let bound = |program: &Program| {
        let (module, _) = program.validate(Capabilities::all()).unwrap();
        let space = |v: &wgpu::naga::GlobalVariable| v.space;
        let storage =
            |s: &wgpu::naga::AddressSpace| matches!(s, wgpu::naga::AddressSpace::Storage { .. });
        let all = module.global_variables.iter().map(|(_, v)| space(v));
        all.filter(storage).count()
    };
    let most = programs.iter().map(bound).max();
    assert_eq!(most, Some(STORAGE_BUFFERS as usize));
    // To make maps what every device has is enough.
    let most = generate::every_program().iter().map(bound).max();
    assert!(most <= Some(PROMISED_BUFFERS as usize), "{most:?}");
}
