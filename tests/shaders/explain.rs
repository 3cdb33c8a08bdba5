//! Which modules a plan joins, as `--explain` tells it: a snapshot, and one feature after
//! another.

use conemarch::pass::LookFeature;
use conemarch::plan::{Background, Extras, Pass, Plan};

use super::common::plans::{allow, explain, mandelbox_of, preset, program, solid, switch};
use super::has;
use super::programs::programs_of;

/// The explanation of a built-in preset with settings as `--set` takes them.
fn explained(name: &str, settings: &[&str]) -> String {
    explain(&preset(name, settings), Extras::default())
}

/// Asserts that a plan joins a module, or does not.
fn assert_joins(text: &str, on: bool, module: &str) {
    assert_eq!(text.contains(module), on, "{module}\n{text}");
}

#[test]
fn a_rotation_by_nothing_is_no_rotation() {
    let none = explained("mandelbox", &[]);
    let turned = |degrees: [f64; 3]| {
        let mut plan = preset("mandelbox", &[]);
        mandelbox_of(&mut plan).rotation = degrees.into();
        explain(&plan, Extras::default())
    };
    // Three half turns about three axes bring everything back.
    for turns in [[360.0, 0.0, -360.0], [180.0; 3], [-180.0, 540.0, 180.0]] {
        assert_eq!(none, turned(turns));
    }
    let degree = turned([0.0, 0.0, 1.0]);
    assert_ne!(none, degree);
    for (text, on) in [(&none, false), (&degree, true)] {
        assert_joins(text, on, "wgsl/formula/rotation.wgsl");
    }
}

#[test]
fn features_that_are_off_are_not_joined() {
    for feature in LookFeature::ALL {
        for on in [true, false] {
            let mut plan = preset("mandelbox", &[]);
            allow(&mut plan, *feature);
            let before = plan.look.clone();
            switch(&mut plan, *feature, on);
            // Its keys switch it, and no other feature.
            assert_eq!(feature.is_on(&plan.look), on, "{feature:?}");
            for other in LookFeature::ALL.iter().filter(|f| *f != feature) {
                let changes = other.is_on(&plan.look) != other.is_on(&before);
                assert!(!changes, "{feature:?}, {other:?}");
            }
            let text = explain(&plan, Extras::default());
            assert_joins(&text, on, feature.module(true).path);
            // A stand-in has nothing in it that a reader could want to know.
            assert_joins(&text, false, feature.module(false).path);
        }
    }
}

#[test]
fn a_background_is_joined_only_if_it_is_transparent() {
    for (background, on) in [(Background::Sky, false), (Background::Transparent, true)] {
        let mut plan = preset("mandelbox", &[]);
        plan.background = background;
        let text = explain(&plan, Extras::default());
        assert_joins(&text, on, "wgsl/pass/background.wgsl");
    }
}

/// The lines of a program in an explanation.
fn program_lines<'a>(text: &'a str, entry: &str) -> &'a str {
    let (_, programs) = text.split_once("\nprograms\n").unwrap();
    let (_, from) = programs.split_once(&format!("  {entry}\n")).unwrap();
    // Modules stand deeper than the names of programs.
    let mut ends = from.match_indices("\n  ");
    let end = ends.find(|(at, _)| from.as_bytes()[at + 3] != b' ');
    end.map_or(from, |(at, _)| &from[..at])
}

#[test]
fn what_is_asked_for_beside_the_picture_is_explained() {
    let plan = preset("mandelbox", &[]);
    let explain = |change: fn(&mut Extras)| {
        let mut extras = Extras::default();
        change(&mut extras);
        explain(&plan, extras)
    };
    let plain = explain(|_| ());
    let counted = explain(|e| e.count = true);
    for (entry, counts) in [("march", true), ("trace", true), ("color", false)] {
        for (text, on) in [(&plain, false), (&counted, counts)] {
            assert_joins(program_lines(text, entry), on, "wgsl/base/counters.wgsl");
        }
    }
    assert!(plain.contains("COLOR_KEEPS_NORMALS=0"));
    assert!(explain(|e| e.normals = true).contains("COLOR_KEEPS_NORMALS=1"));
    let depths = explain(|e| e.depth_only = true);
    assert!(
        plain.contains("  color ") && !depths.contains("color"),
        "{depths}"
    );
}

#[test]
fn what_is_prepared_for_a_heightfield_is_explained() {
    let text = explained("terrain", &[]);
    let first = text.lines().skip(2).take(2).collect::<Vec<_>>().join("\n");
    assert_eq!(first, "passes\n  prepare         511 x 511    steps -");
    let generate = program_lines(&text, "generate");
    assert!(generate.contains("wgsl/heightfield/conemap/generate/search.wgsl"));
    // What is explained is what is run, though no cones are made for it.
    let plan = preset("terrain", &[]);
    for program in programs_of(&plan, &solid(&plan)) {
        let listing = program.describe();
        let extras =
            listing.contains("base/counters.wgsl") || listing.contains("COLOR_KEEPS_NORMALS=1");
        let plain = format!("  {}\n{listing}", program.entry);
        assert_eq!(text.contains(&plain), !extras, "{plain}\n{text}");
    }
    // How many maps are prepared: a paint is a map of its own, but for that of the tracer.
    for (settings, painted, maps) in [
        (&["scene.tracer=max-mip"][..], false, 0),
        (&["scene.tracer=max-mip", "scene.paint=exact"], true, 1),
        (&["scene.tracer=walk", "scene.paint=exact"], true, 2),
        (&["scene.tracer=walk", "scene.paint=walk"], true, 1),
    ] {
        let text = explained("terrain", settings);
        let lines = text.lines().filter(|l| l.starts_with("  prepare"));
        assert_eq!(lines.count(), maps, "{settings:?}: {text}");
        assert_eq!(text.contains("generate"), maps > 0, "{settings:?}: {text}");
        assert_joins(&text, painted, "wgsl/heightfield/paint.wgsl");
        assert_joins(&text, !painted, "wgsl/heightfield/paint_height.wgsl");
    }
}

#[test]
fn work_is_counted_only_where_it_is_asked_for() {
    let plan = preset("mandelbox", &[]);
    let solid = solid(&plan);
    for pass in plan.passes(Extras::default()) {
        for count in [false, true] {
            let extras = Extras {
                count,
                ..Extras::default()
            };
            let program = program(&plan, &solid, pass, extras);
            let counted = count && pass != Pass::Color;
            assert_eq!(has(&program, "wgsl/base/counters.wgsl"), counted);
            assert_eq!(has(&program, "wgsl/base/counters_off.wgsl"), !counted);
        }
    }
}

#[test]
fn what_a_slider_moves_compiles_nothing_new() {
    let programs = |plan: &Plan| programs_of(plan, &solid(plan));
    let still = preset("mandelbox", &[]);
    let sliders = [
        "camera.eye=[3, -9, 1]",
        "camera.fov=70",
        "march.detail=0.3",
        "march.shell=0.7",
        "march.fudge=[0.9, 0.5]",
        "march.steps=77",
        "look.key=1",
        "look.occlusion=0.3",
        "look.palette=[[1, 1, 1], [1, 1, 1], [1, 1, 1]]",
        "image.size=[33, 17]",
        "scene.scale=2.7",
        "scene.min_radius=0.3",
        "scene.julia_constant=[1, 0, 0]",
    ];
    let mut moved = preset("mandelbox", &sliders);
    assert_eq!(programs(&still), programs(&moved));
    // But a feature does, and a scale of the other sign: the Jacobian is not followed there.
    moved.look.shadow = !moved.look.shadow;
    assert_ne!(programs(&still), programs(&moved));
    let negative = preset("mandelbox", &["scene.scale=-1.7"]);
    assert_ne!(programs(&still), programs(&negative));
}

#[test]
fn the_rule_of_the_slides_takes_the_place_of_the_exact_one() {
    for (mode, exact) in [("safe", true), ("slides-deep", false)] {
        let text = explained("mandelbox", &[&format!("march.mode={mode}")]);
        assert_joins(&text, exact, "wgsl/base/cone.wgsl");
        assert_joins(&text, !exact, "wgsl/base/cone_slides.wgsl");
    }
}

#[test]
fn the_mandelbox_is_explained() {
    insta::assert_snapshot!(explained("mandelbox", &[]), @r"
    1280 x 720, mode safe
    mandelbox: 15 iterations, lipschitz 1
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
        wgsl/scene/distance.wgsl  DISTANCE_ENOUGH=0.8  DISTANCE_TRIAL=1.5  DISTANCE_LEAST=0.1  DISTANCE_PROVEN=0  DISTANCE_SMOOTHING=0.3  DISTANCE_MOST_RELAXED=3  DISTANCE_WITHIN=0.99  HIT_CARRIES_MARK=0
        wgsl/formula/folds.wgsl  FOLDS_JULIA=0  FOLDS_FOLLOWED=1
        wgsl/formula/orbit.wgsl  ORBIT_ROTATED_SLOPE=1.25
        wgsl/formula/jacobian_diagonal.wgsl
        wgsl/formula/four_folds.wgsl
        wgsl/base/view.wgsl
        wgsl/base/perspective.wgsl
        wgsl/base/outcome.wgsl
        wgsl/scene/contract.wgsl
        wgsl/pass/shared.wgsl
        wgsl/pass/turn.wgsl
        wgsl/pass/queue.wgsl
        wgsl/pass/tally.wgsl
        wgsl/pass/march.wgsl
      trace
        wgsl/base/real.wgsl
        wgsl/base/cone.wgsl  CONE_TRUST=0.9999990463256836  CONE_ROUND_DOWN=0.9999997615814209
        wgsl/scene/distance.wgsl  DISTANCE_ENOUGH=0.8  DISTANCE_TRIAL=1.5  DISTANCE_LEAST=0.1  DISTANCE_PROVEN=0  DISTANCE_SMOOTHING=0.3  DISTANCE_MOST_RELAXED=3  DISTANCE_WITHIN=0.99  HIT_CARRIES_MARK=0
        wgsl/formula/folds.wgsl  FOLDS_JULIA=0  FOLDS_FOLLOWED=1
        wgsl/formula/orbit.wgsl  ORBIT_ROTATED_SLOPE=1.25
        wgsl/formula/jacobian_diagonal.wgsl
        wgsl/formula/four_folds.wgsl
        wgsl/base/view.wgsl
        wgsl/base/perspective.wgsl
        wgsl/base/outcome.wgsl
        wgsl/scene/contract.wgsl
        wgsl/pass/shared.wgsl
        wgsl/pass/turn.wgsl
        wgsl/pass/queue.wgsl
        wgsl/pass/tally.wgsl
        wgsl/pass/trace.wgsl
      color
        wgsl/base/real.wgsl
        wgsl/base/cone.wgsl  CONE_TRUST=0.9999990463256836  CONE_ROUND_DOWN=0.9999997615814209
        wgsl/scene/distance.wgsl  DISTANCE_ENOUGH=0.8  DISTANCE_TRIAL=1.5  DISTANCE_LEAST=0.1  DISTANCE_PROVEN=0  DISTANCE_SMOOTHING=0.3  DISTANCE_MOST_RELAXED=3  DISTANCE_WITHIN=0.99  HIT_CARRIES_MARK=0
        wgsl/formula/folds.wgsl  FOLDS_JULIA=0  FOLDS_FOLLOWED=1
        wgsl/formula/orbit.wgsl  ORBIT_ROTATED_SLOPE=1.25
        wgsl/formula/jacobian_diagonal.wgsl
        wgsl/formula/four_folds.wgsl
        wgsl/base/view.wgsl
        wgsl/base/perspective.wgsl
        wgsl/base/outcome.wgsl
        wgsl/scene/contract.wgsl
        wgsl/pass/shared.wgsl
        wgsl/pass/turn.wgsl
        wgsl/pass/queue.wgsl
        wgsl/pass/look.wgsl
        wgsl/pass/sky.wgsl
        wgsl/pass/shadow.wgsl
        wgsl/pass/occlusion.wgsl
        wgsl/pass/fog.wgsl
        wgsl/pass/material.wgsl
        wgsl/base/random.wgsl
        wgsl/pass/aim.wgsl
        wgsl/pass/quick.wgsl
        wgsl/pass/color.wgsl  COLOR_KEEPS_NORMALS=0  COLOR_KEEPS_VARIANCE=0  COLOR_IS_PIGMENT=0
    ");
}
