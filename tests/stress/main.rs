//! What is hard on numbers: cameras at the surface, inside it and a million lengths away,
//! every parameter at the ends of its range, rods thinner than a pixel, a single step.
//!
//! Each plan is rendered on both executors. Whatever it asks for, no layer holds a number
//! that is none, no render hangs, and the picture is within a stated bound of the truth
//! and of the other executor. Where f32 cannot hold that bound, the program says so.
//! `docs/accuracy.md` shows what was measured, and `common/groups.rs` has the tests of most
//! plans.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test fails by panicking, and has no readers of its interface"
)]

#[path = "../adapter/mod.rs"]
mod adapter;
mod any_plan;
#[path = "../common"]
#[allow(dead_code, reason = "other crates use the rest")]
mod common {
    pub mod exact;
    pub mod groups;
    pub mod hard;
    pub mod plans;
    pub mod precision;
    pub mod probe;
    pub mod programs;
    pub mod random;
    pub mod setups;
    pub mod solved;
    pub mod strain;
}
mod floors;
mod paths;

use std::cell::Cell;

use adapter::{HIT, SKY, UNCONVERGED, both};
use any_plan::any_plan;
use common::hard::{self, SIZE};
use common::plans::{boxed, camera, distance_solid, mandelbox, mandelbox_of, sized};
use common::solved::rays;
use common::strain;
use conemarch::base::projection::Projection;
use conemarch::formula::DistanceEstimate;
use conemarch::formula::mandelbox::Mandelbox;
use conemarch::picture::frame::Frame;
use conemarch::plan::Plan;
use conemarch::plan::march::Mode;
use conemarch::preset::{read, write};
use conemarch::scene::stepping::Relaxation;
use glam::DVec3;
use proptest::test_runner::{Config, TestRng, TestRunner};

/// Least of `distance to the rod - radius`, in hit thresholds, along a ray: where it is
/// under 1, a short enough step finds a hit. The distance to a rod is convex along a line
/// and the threshold grows evenly, so their quotient has one minimum.
fn nearest_to_rod(plan: &Plan, axis: DVec3, grain: f64, radius: f64) -> f64 {
    let excess = |t: f64| {
        let p = plan.camera.eye + t * axis;
        let on = DVec3::new(0.4, -2.0, p.z.clamp(-1.8, 1.8));
        (p.distance(on) - radius, plan.march.detail * grain * t)
    };
    let (mut low, mut high) = (0.1, 30.0);
    for _ in 0..200 {
        let (one, two) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        let share = |t| excess(t).0 / excess(t).1;
        if share(one) < share(two) {
            high = two;
        } else {
            low = one;
        }
    }
    let (d, eps) = excess(low);
    d / eps
}

/// A thin rod is seen by the rays that come within the hit threshold of it: by all that
/// come within the share of it that steps keep clear of, and by none that stay out.
#[test]
fn a_thin_rod_has_no_gaps_and_no_fringe() {
    for shell in [0.3, 0.9] {
        for (name, mut plan) in hard::rods() {
            plan.march.shell = Some(shell);
            let radius: f64 = name.strip_prefix("radius ").unwrap().parse().unwrap();
            // The rod stands before the sky, and aslant: it crosses pixels at all places.
            plan.camera = camera([2.4, -7.0, 0.5], [0.4, -2.0, 0.2]);
            plan.camera.up = DVec3::new(0.2, 0.1, 1.0);
            let frames = both(&plan);
            let (mut through, mut past) = (0, 0);
            for (i, ray) in rays(&plan).enumerate() {
                let share = nearest_to_rod(&plan, ray.axis, ray.grain, radius);
                for frame in &frames {
                    let hit = frame.state[i] == HIT;
                    // Thresholds are thousandths and more: f32 is off by 1e-4 of one.
                    if share < shell - 1e-3 {
                        assert!(hit, "{name}, shell {shell}: a gap at pixel {i}, {share}");
                        through += 1;
                    }
                    let p = plan.camera.eye + f64::from(frame.depth[i]) * ray.axis;
                    if hit && (p - DVec3::new(0.4, -2.0, p.z)).length() < 0.1 {
                        assert!(share < 1.0 + 1e-3, "{name}: pixel {i} sees it at {share}");
                        past += 1;
                    }
                }
            }
            assert!(through > 10 && past >= through / 2, "{through} {past}");
        }
    }
}

/// Deep in the set every difference of the estimate is lost: such a point has no gradient,
/// and still a normal of length 1, on both executors.
#[test]
fn normals_where_the_field_is_flat() {
    let m = Mandelbox {
        scale: -1.025_864_342_052_547_7,
        min_radius: 0.000_240_441_218_161_666_9,
        fixed_radius: 1.438_843_127_544_697_3,
        fold_limit: 0.928_414_247_033_647_4,
        ..Mandelbox::default()
    };
    let eye = [
        0.638_620_022_163_400_7,
        -1.340_407_182_638_302_2,
        -0.751_712_268_458_604,
    ];
    let mut plan = hard::from(m, eye, DVec3::ZERO);
    plan.march.detail = 0.180_946_275_089_425_98;
    for frame in both(&plan) {
        assert_eq!(strain::faults(&plan, &frame), Vec::<String>::new());
    }
}

/// The estimate at the hits of a Mandelbox, in hit thresholds: its quantiles at 10, 50, 99 and 100 %.
fn at_hits(plan: &Plan, frame: &Frame) -> [f64; 4] {
    let m = mandelbox_of(&mut plan.clone()).clone();
    let iterations = distance_solid(plan).iterations;
    let hits = rays(plan)
        .enumerate()
        .filter(|(i, _)| frame.state[*i] == HIT);
    let shares = hits.map(|(i, ray)| {
        let t = f64::from(frame.depth[i]);
        let p = plan.camera.eye + t * ray.axis;
        let (inside, _) = m.estimate(p, iterations);
        inside.max(m.bounds().distance(p)) / (plan.march.detail * ray.grain * t)
    });
    let mut values: Vec<f64> = shares.collect();
    values.sort_by(f64::total_cmp);
    let hits = values.len();
    assert!(hits > 500, "{hits} hits");
    [0.1, 0.5, 0.99, 1.0].map(|share| values[((hits - 1) as f64 * share) as usize])
}

/// A hit is where the estimate itself meets the threshold: not the estimate that steps divide by the
/// Lipschitz constant, nor the one that they keep clear of the shell. The place is on a line between two
/// values, so a curved estimate may be a little more there.
#[test]
fn hits_are_where_the_estimate_meets_the_threshold() {
    for (name, scale) in [("bench-inside", -1.5), ("bench-graze", 2.0)] {
        let mut plan = sized(name, SIZE);
        plan.march.shell = Some(0.9);
        plan.march.steps = Some(2000);
        plan.march.relaxation = Relaxation::Off;
        let mut m = mandelbox(scale);
        m.lipschitz = Some(3.0);
        plan.scene = boxed(m, None);
        for frame in both(&plan) {
            // Depths are kept in f32, six digits of a threshold of thousandths.
            let at = at_hits(&plan, &frame);
            println!("{name}: {at:?} of it");
            let [low, middle, high, most] = at;
            // Rays that hit where they enter the bounds begin at 0.99 of the threshold.
            assert!(low > 0.97 && middle > 0.98, "{name}: {at:?}");
            assert!(high < 1.01 && most < 1.5, "{name}: {at:?}");
        }
    }
}

/// With the usual steps, behind cones or without, with proven ones and in Julia mode, hits are near it.
#[test]
fn default_hits_are_near_the_threshold() {
    for name in ["bench-inside", "bench-graze", "mandelbox-julia"] {
        for (mode, coarsest) in [(Mode::Safe, 16), (Mode::Safe, 1), (Mode::Proven, 16)] {
            let mut plan = sized(name, SIZE);
            (plan.march.mode, plan.march.coarsest) = (mode, Some(coarsest));
            for frame in both(&plan) {
                let at = at_hits(&plan, &frame);
                let what = format!("{name}, {}, from 1/{coarsest}: {at:?}", mode.name());
                println!("{what}");
                let [_, middle, _, most] = at;
                assert!((0.9..1.1).contains(&middle) && most <= 2.02, "{what}");
            }
        }
    }
}

/// A cone whose front lies in the shell has no ball, and stops instead of asking again.
#[test]
fn a_cone_without_a_ball_stops_at_once() {
    let (_, plan) = hard::shelled(hard::scales()).swap_remove(0);
    for frame in both(&plan) {
        for level in &frame.levels {
            let most = level.work.iter().map(|w| w.evaluations).max().unwrap();
            assert!(!level.state.contains(&UNCONVERGED), "1/{}", level.divisor);
            // Measured: 3; a cone that asks again does so 256 times.
            assert!(most <= 10, "1/{}: {most} evaluations", level.divisor);
        }
    }
}

/// Random plans of every kind: no layer holds what it may not, the executors agree where
/// no warning is due, solids are where their equations say, and the text of the plan is
/// the plan.
#[test]
fn any_plan_renders_alike_on_both_executors() {
    // Of 735 random plans those without a warning had at most one pixel apart, of 1200; in
    // the smallest pictures one pixel is all.
    const APART: f64 = 0.003;
    let config = Config {
        cases: 96,
        failure_persistence: None,
        ..Config::default()
    };
    let rng = TestRng::deterministic_rng(config.rng_algorithm);
    let mut runner = TestRunner::new_with_rng(config, rng);
    let [warned_plans, solid_plans, hit_plans] = [0; 3].map(Cell::new);
    let count = |counter: &Cell<u32>, counts: bool| counter.set(counter.get() + u32::from(counts));
    let nth = Cell::new(0_u32);
    let ran = runner.run(&any_plan(), |mut plan| {
        // Every fourth plan has samples, and most of these a lens.
        if nth.replace(nth.get() + 1).is_multiple_of(4) {
            plan.samples = 2 + nth.get() / 4 % 2;
            plan.reference = Some(90);
            plan.camera.aperture = 0.05 * f64::from(nth.get() % 5);
            plan.camera.blades = nth.get().is_multiple_of(3).then_some(5);
        }
        // Every third plan has another projection.
        if nth.get().is_multiple_of(3) {
            let projection = Projection::WORDS[1 + nth.get() as usize / 3 % 3].1;
            plan.camera.projection = projection;
            plan.camera.aperture *= f64::from(u8::from(projection.has_lens()));
        }
        let text = write(&plan);
        assert_eq!(read(&text, "a random plan").unwrap(), plan);
        let frames = both(&plan);
        for frame in &frames {
            assert_eq!(strain::faults(&plan, frame), [""; 0], "{text}");
        }
        let warned = plan.precision_warning().is_some();
        let pixels = frames[0].state.len() as f64;
        let apart = strain::apart(&plan, &frames[0], &frames[1]) * pixels;
        let allowed = (APART * pixels).max(1.0);
        assert!(warned || apart <= allowed, "{apart} pixels, {text}");
        let solid = common::solved::solids(&plan).is_some();
        let inexact = plan.march.mode.name().starts_with("slides");
        if solid && !inexact && !warned {
            let truth = strain::reference(&plan);
            for frame in &frames {
                assert_eq!(strain::wrong(&plan, frame, &truth), 0.0, "{text}");
            }
        }
        count(&warned_plans, warned);
        count(&solid_plans, solid);
        count(&hit_plans, frames[1].census()[1] > 0);
        Ok(())
    });
    ran.unwrap_or_else(|e| panic!("{e}"));
    // What the bounds are for did occur: plans without a warning, solids, hits.
    let [warned, solid, hit] = [warned_plans, solid_plans, hit_plans].map(Cell::into_inner);
    assert!(
        warned < 72 && solid > 10 && hit > 40,
        "{warned} {solid} {hit}"
    );
}

/// Each measure finds what it is there for.
#[test]
fn the_measures_see_what_is_wrong() {
    let (_, plan) = hard::scales().swap_remove(9);
    let [frame, _] = both(&plan);
    let at = frame.state.iter().position(|s| *s == HIT).unwrap();
    let spoilt = |spoil: &dyn Fn(&mut Frame)| {
        let mut other = frame.clone();
        spoil(&mut other);
        strain::faults(&plan, &other).join(", ")
    };
    assert_eq!(spoilt(&|_| ()), "");
    assert_eq!(spoilt(&|f| f.state[at] = 7), "1 in state");
    assert!(spoilt(&|f| f.depth[at] = f32::NAN).starts_with("1 in depth, 1 in position"));
    assert!(spoilt(&|f| f.depth[at] = f32::INFINITY).starts_with("1 in depth"));
    assert_eq!(spoilt(&|f| f.radiance[at][1] = f32::NAN), "1 in radiance");
    assert_eq!(spoilt(&|f| f.radiance[at][2] = -0.1), "1 in radiance");
    assert_eq!(spoilt(&|f| f.normal[at] = [f32::NAN; 3]), "1 in normal");
    assert_eq!(spoilt(&|f| f.normal[at] = [0.5, 0.0, 0.0]), "1 in normal");
    assert_eq!(
        spoilt(&|f| f.levels[1].front[0] = f32::NAN),
        "1 in fronts of 1/8"
    );
    assert_eq!(
        spoilt(&|f| f.work[at].evaluations = 1 << 20),
        "1 in evaluations"
    );
    // One pixel behind, one missing, and a picture moved by a few pixels.
    let one = 1.0 / frame.state.len() as f64;
    let mut behind = frame.clone();
    behind.depth[at] *= 1.1;
    let mut missing = frame.clone();
    missing.state[at] = SKY;
    for other in [&behind, &missing] {
        assert_eq!(strain::wrong(&plan, other, &frame), one);
        assert_eq!(strain::apart(&plan, other, &frame), one);
    }
    let mut moved = frame.clone();
    moved.depth.rotate_left(3);
    moved.state.rotate_left(3);
    assert!(strain::apart(&plan, &moved, &frame) > 0.1);
    assert!(frame.state.iter().filter(|s| **s == HIT).count() > 500);
}

/// Settings past the ends of their ranges are refused, by name.
#[test]
fn what_cannot_be_rendered_is_refused() {
    let refused = [
        ("scene", "scale = 1.0", "scale"),
        ("scene", "scale = -1.0005", "scale"),
        ("scene", "scale = 0", "scale"),
        ("scene", "scale = nan", "scale"),
        ("scene", "min_radius = 0", "min_radius"),
        ("scene", "min_radius = 1.1", "min_radius"),
        ("scene", "fold_limit = 0", "fold_limit"),
        ("scene", "lipschitz = 0", "lipschitz"),
        ("scene", "iterations = 0", "iterations"),
        ("scene", "iterations = 1001", "iterations"),
        ("camera", "fov = 0.5", "fov"),
        ("camera", "fov = 180", "fov"),
        ("camera", "eye = [inf, 0, 0]", "eye"),
        ("camera", "eye = [0, 0, 0]", "target"),
        ("camera", "eye = [0, 0, 5]", "up"),
        ("march", "steps = 0", "steps"),
        ("march", "shell = 1.0", "shell"),
        ("march", "detail = 0", "detail"),
        ("image", "size = [0, 10]", "size"),
        ("image", "size = [10, 65537]", "size"),
    ];
    for (section, line, key) in refused {
        let mut text = "[scene]\nkind = \"distance\"\nformula = \"mandelbox\"\n".to_string();
        if section != "scene" {
            text += &format!("[{section}]\n");
        }
        let error = read(&(text + line), "hard.toml")
            .expect_err(line)
            .to_string();
        let named = error.contains("hard.toml") && error.contains(key);
        assert!(named, "{line}: {error}");
    }
}
