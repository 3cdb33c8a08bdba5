//! Whole pictures: the two executors against each other on every built-in preset, every mode
//! against the truth, the work that modes do, and devices that are chosen, lost or stopped.
//!
//! The GPU computes in f32, the CPU in f64; both run the same passes.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test fails by panicking, and has no readers of its interface"
)]

#[path = "../adapter/mod.rs"]
mod adapter;
#[path = "../common"]
#[allow(dead_code, reason = "other crates use the rest")]
mod common {
    pub mod exact;
    pub mod filtered;
    pub mod folder;
    pub mod plans;
    pub mod random;
}
mod background;
mod device;
mod edits;
mod glow;
mod lamps;
mod live;
mod paths;
mod samples;
mod shafts;
mod sky;
mod slow_maps;
mod tone;
mod unhurried;
mod until;
mod variance;
mod windows;
mod work;

use adapter::{COUNTED, LEVELS, on_cpu, render};
use common::plans::{allow, bench_views, compared, preset, sized, switch, switch_all_off};
use conemarch::base::outcome::State;
use conemarch::base::projection::Projection;
use conemarch::base::srgb::srgb;
use conemarch::measure::compare::{DepthError, Report, quantile};
use conemarch::measure::flip::flip;
use conemarch::measure::truth::truth;
use conemarch::pass::LookFeature;
use conemarch::pass::look::tone;
use conemarch::pass::tone_map::Tone;
use conemarch::picture::frame::Frame;
use conemarch::plan::look::LightMode;
use conemarch::plan::march::Mode;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::{BUILTIN, load};
use conemarch::scene::Assets;
use glam::DVec3;

/// Two frames of a plan side by side: depth, the shown picture in steps of 1/255, median and
/// 95 %, and what an eye sees of it.
#[derive(Debug)]
struct Apart {
    report: Report,
    shade: [f64; 2],
    flip: f64,
}

/// How far apart the shown pixels of two frames are, in steps of 1/255.
fn shades(plan: &Plan, frame: &Frame, reference: &Frame) -> Vec<f64> {
    let exposure = plan.look.exposure.exp2();
    let shown = |c: [f32; 3]| srgb(tone(exposure, DVec3::from_array(c.map(f64::from))));
    let pairs = frame.radiance.iter().zip(&reference.radiance);
    let apart = pairs.map(|(a, b)| 255.0 * (shown(*a) - shown(*b)).abs().max_element());
    apart.collect()
}

/// The median of shades, and what 95 % of them do not exceed.
fn median_and_most(mut shades: Vec<f64>) -> [f64; 2] {
    shades.sort_by(f64::total_cmp);
    [0.5, 0.95].map(|q| quantile(&shades, q))
}

fn apart(plan: &Plan, frame: &Frame, reference: &Frame) -> Apart {
    Apart {
        report: compared(frame, reference, plan),
        shade: median_and_most(shades(plan, frame, reference)),
        flip: flip(frame.size, &shown(plan, reference), &shown(plan, frame)),
    }
}

/// The pixels of a file.
fn shown(plan: &Plan, frame: &Frame) -> Vec<DVec3> {
    let tone = Tone::of(&plan.look);
    let light = frame.radiance.iter().map(|c| c.map(f64::from));
    light.map(|c| tone.shown(DVec3::from_array(c))).collect()
}

/// Share of pixels that may be a hit on one side only. f32 decides otherwise than f64
/// where a ray grazes the hit threshold within a rounding: a matter of silhouettes, and
/// measured as none at all on twelve presets.
const MASK: f64 = 1e-3;
/// Footprints between the depths of the median pixel. The noise of the f32 estimate is
/// about 1e-7, footprints are 1e-4 and more: measured up to 0.004.
const DEPTH: f64 = 0.05;
/// Steps of 1/255 in the median pixel; measured up to 0.01.
const SHADE: f64 = 0.25;
/// Steps of 1/255 in 95 of 100 pixels: under what an eye sees; measured up to 0.7. The
/// rest are edges of shadows and folds, where a rounding decides.
const SHADE_MOST: f64 = 2.0;
/// The mean FLIP difference.
const FLIP: f64 = 0.03;
/// The same of several samples, which average what is on edges.
const SAMPLED_FLIP: f64 = 0.01;

/// Which bounds two frames break.
fn faults(apart: &Apart) -> Vec<&'static str> {
    let bounds = [
        ("mask", apart.report.mask, MASK),
        ("depth", apart.report.depth_error.median, DEPTH),
        ("shade", apart.shade[0], SHADE),
        ("most shades", apart.shade[1], SHADE_MOST),
        ("flip", apart.flip, FLIP),
    ];
    // A NaN breaks every bound.
    let broken = bounds
        .iter()
        .filter(|(_, v, bound)| v.is_nan() || v >= bound);
    broken.map(|(name, _, _)| *name).collect()
}

#[test]
fn the_two_executors_agree_on_every_preset() {
    for (name, _) in BUILTIN {
        let plan = sized(name, [240, 135]);
        let frame = render(&plan, Extras::default());
        let reference = on_cpu(&plan, Extras::default());
        let apart = apart(&plan, &frame, &reference);
        assert_eq!(faults(&apart), [""; 0], "{name}: {apart:?}");
        // A picture, and not an empty one that agrees with another.
        let [_, hit, unconverged] = frame.census();
        assert!(hit > 5_000, "{name}: {hit} hits");
        // More than a few rays that end nowhere is a fault of the preset.
        assert!(unconverged < 60, "{name}: {unconverged} unconverged");
        // Several samples have soft shadows, a lens, and the details of a larger picture.
        let mut plan = load(name, &[]).unwrap().plan;
        (plan.size, plan.samples, plan.until) = ([128, 72], 4, 0.0);
        // A GPU has no cones by itself, and other rays see other details.
        plan.march.coarsest = Some(16);
        plan.look.mode = LightMode::Quick;
        let [gpu, cpu] = [render, on_cpu].map(|on| shown(&plan, &on(&plan, Extras::default())));
        let sampled = flip(plan.size, &cpu, &gpu);
        println!("{name}: {:.4}, sampled {sampled:.4}", apart.flip);
        assert!(sampled < SAMPLED_FLIP, "{name}: {sampled}");
        let black = vec![DVec3::ZERO; cpu.len()];
        assert!(flip(plan.size, &cpu, &black) > FLIP, "{name} is black");
    }
}

#[test]
fn the_two_executors_agree_in_every_projection() {
    for (word, projection) in &Projection::WORDS[1..] {
        for (name, samples) in [("mandelbox", 1), ("mandelbox-hall", 2), ("terrain", 1)] {
            let mut plan = sized(name, [112, 63]);
            plan.camera.projection = *projection;
            plan.samples = samples;
            plan.look.fog = 0.7;
            plan.look.fog_height = 0.3;
            let frame = render(&plan, Extras::default());
            let reference = on_cpu(&plan, Extras::default());
            let apart = apart(&plan, &frame, &reference);
            assert_eq!(faults(&apart), [""; 0], "{word}, {name}: {apart:?}");
            let [_, hit, unconverged] = frame.census();
            assert!(hit > 100, "{word}, {name}: {hit} hits");
            assert!(
                unconverged < 60,
                "{word}, {name}: {unconverged} unconverged"
            );
        }
    }
}

/// The same comparison of plans that differ a little: each bound can be broken.
#[test]
fn the_comparison_notices_small_changes() {
    let size = [160, 90];
    let plan = sized("mandelbox", size);
    let frame = render(&plan, Extras::default());
    let against = |plan: &Plan, frame: &Frame, other: &Plan| {
        faults(&apart(plan, frame, &on_cpu(other, Extras::default())))
    };
    let scaled = preset("mandelbox", &["scene.scale=2.001", "image.size=[160, 90]"]);
    assert_eq!(against(&plan, &frame, &scaled), ["depth", "most shades"]);
    let mut moved = plan.clone();
    moved.camera.eye *= 1.01;
    assert!(against(&plan, &frame, &moved).contains(&"mask"));
    // A little more light, where no sky covers half the picture.
    let plan = sized("bench-inside", size);
    let frame = render(&plan, Extras::default());
    let mut lit = plan.clone();
    lit.look.fill *= 1.05;
    let found = against(&plan, &frame, &lit);
    assert_eq!(found[0], "shade", "{found:?}");
}

/// Each feature alone, as another one could hide a fault, and only the pixels that it changes.
#[test]
fn the_two_executors_agree_on_every_feature_of_the_look() {
    // Here every feature changes many pixels, and many lie in a half shadow. Rays that go on from
    // surface to surface would differ by chance.
    let mut bare = preset(
        "mandelbox-gate",
        &[
            "image.size=[320, 180]",
            "look.light_size=20",
            "look.bounces=0",
        ],
    );
    // Shadow rays go to different points of the light.
    bare.samples = 2;
    switch_all_off(&mut bare);
    for feature in LookFeature::ALL {
        let mut plan = bare.clone();
        allow(&mut plan, *feature);
        let without = on_cpu(&plan, Extras::default());
        switch(&mut plan, *feature, true);
        let reference = on_cpu(&plan, Extras::default());
        let changes = shades(&plan, &reference, &without);
        let frame = render(&plan, Extras::default());
        let pairs = shades(&plan, &frame, &reference).into_iter().zip(changes);
        // Changes are larger than what is allowed. So a feature that one executor lacks breaks
        // the bounds.
        let changed = pairs.filter(|(_, change)| *change > SHADE_MOST);
        let changed: Vec<f64> = changed.map(|(shade, _)| shade).collect();
        let count = changed.len();
        let [median, most] = median_and_most(changed);
        let what = format!("{feature:?}: {count} pixels, {median} {most}");
        // Of fewer pixels, 5 % would be too few to judge by.
        assert!(count > 500, "{what}");
        assert!(median < SHADE && most < SHADE_MOST, "{what}");
    }
}

/// Cones, and rays with a shell, err no more than rays without either do, and the slides' rule errs
/// more: on every bench view.
#[test]
fn safe_is_no_worse_than_the_rival_and_the_slides_are() {
    // Room for three pixels of 32 400 that f32 decides otherwise.
    let allowed = 1e-4;
    // A share that nobody overlooks, and no rounding makes.
    let plain = 0.01;
    for name in bench_views() {
        let mut plan = sized(name, [240, 135]);
        plan.march.clip = Some(true);
        let truth = truth(&plan, &Assets::default(), &mut |_| true).unwrap();
        let mut wrong = |mode| {
            plan.march.mode = mode;
            let frame = render(&plan, LEVELS);
            let report = compared(&frame, &truth.frame, &plan);
            let starts: u64 = report.start_violations.iter().sum();
            let starts = starts as f64 / frame.state.len() as f64;
            (report.behind + report.holes, starts)
        };
        let (safe, safe_starts) = wrong(Mode::Safe);
        let (rival, _) = wrong(Mode::RayRelaxed);
        let (slides, slides_starts) = wrong(Mode::SlidesDeep);
        println!("{name}: safe {safe}, rival {rival}, slides {slides}");
        assert!(
            safe <= rival + allowed,
            "{name}: safe {safe}, rival {rival}"
        );
        assert!(
            slides > rival + plain,
            "{name}: slides {slides}, rival {rival}"
        );
        // No pixel starts behind the skin of the truth; with the slides' rule, many do.
        assert_eq!(safe_starts, 0.0, "{name}");
        assert!(slides_starts > plain, "{name}: {slides_starts}");
    }
}

/// The truth's steps are short, so its rays to the light need many more of them.
#[test]
fn shadow_rays_of_the_truth_reach_the_light() {
    // Shadow rays alone, and rays from the fog alone.
    for (name, shadow) in [("mandelbox-gate", true), ("mandelbox-avenue", false)] {
        let mut plan = sized(name, [96, 54]);
        plan.march.mode = Mode::Ray;
        (plan.look.mode, plan.look.shadow) = (LightMode::Quick, shadow);
        let plain = on_cpu(&plan, Extras::default()).undecided;
        let truth = truth(&plan, &Assets::default(), &mut |_| true).unwrap();
        let own = truth.frame.undecided;
        println!("{name}: {own} and {plain}");
        assert!(
            own <= plain,
            "{name}: {own} and {plain} of {}",
            truth.frame.state.len()
        );
    }
}

/// Where rays start at the eye, no pixel has a width yet.
#[test]
fn rays_alone_leave_an_eye_within_the_bounds() {
    let mut plan = sized("mandelbox-hall", [96, 54]);
    plan.march.coarsest = Some(1);
    let middle = |frame: &Frame| {
        let mut depths = frame.depth.clone();
        depths.sort_by(f32::total_cmp);
        quantile(&depths, 0.5)
    };
    plan.march.mode = Mode::Ray;
    let said = middle(&on_cpu(&plan, Extras::default()));
    for mode in [Mode::RayRelaxed, Mode::Safe, Mode::Proven] {
        plan.march.mode = mode;
        for frame in [
            render(&plan, Extras::default()),
            on_cpu(&plan, Extras::default()),
        ] {
            let seen = middle(&frame);
            // A ray that stays at the eye has depth 0. Modes that leave it end at slightly different depths.
            assert!(
                (seen / said - 1.0).abs() < 0.01,
                "{mode:?}: {seen} and {said}"
            );
        }
    }
}

#[test]
fn every_mode_renders_on_both_executors() {
    let mut plan = sized("bench-outside", [96, 54]);
    for (name, mode) in &Mode::WORDS {
        plan.march.mode = *mode;
        let pair = [
            render(&plan, Extras::default()),
            on_cpu(&plan, Extras::default()),
        ];
        for frame in &pair {
            let known = |s: &u8| State::from_code(u32::from(*s)).is_some();
            assert!(frame.state.iter().all(known));
            assert!(frame.census()[1] > 1000, "{name}: {:?}", frame.census());
            let mut light = frame.radiance.iter().flatten();
            assert!(light.all(|x| x.is_finite() && *x >= 0.0));
        }
        // The modes differ; the executors do not, whatever the mode.
        assert_eq!(faults(&apart(&plan, &pair[0], &pair[1])), [""; 0], "{name}");
    }
}

#[test]
fn a_comparison_with_itself_is_nothing_and_with_a_shift_is_not() {
    let plan = sized("bench-outside", [160, 90]);
    let frame = render(&plan, LEVELS);
    let same = compared(&frame, &frame, &plan);
    assert_eq!(same.depth_error, DepthError::default());
    let shares = |r: &Report| {
        let sides = [r.behind, r.front, r.behind8, r.front8];
        [&sides[..], &[r.holes, r.false_hits, r.mask]].concat()
    };
    assert_eq!((shares(&same), same.unconverged), (vec![0.0; 7], 0.0));
    assert_eq!(same.start_violations, [0; 4]);
    // A few pixels to the side: every kind of error occurs.
    let mut shifted = frame.clone();
    shifted.depth.rotate_left(4);
    shifted.state.rotate_left(4);
    let other = compared(&shifted, &frame, &plan);
    assert!(other.depth_error.median > 0.1, "{other:?}");
    assert!(shares(&other).iter().all(|x| *x > 0.0), "{other:?}");
    // The shares of holes and false hits add up to that of the mask.
    assert!((other.holes + other.false_hits - other.mask).abs() < 1e-12);
}

/// What the program claims of its work, on the benchmarks at their own size. Counts of
/// evaluations are the same on every machine but for the rounding of its arithmetic.
#[test]
fn cones_need_far_fewer_evaluations_than_rays() {
    let mut logs = [0.0, 0.0];
    for name in bench_views() {
        let mut plan = preset(name, &[]);
        let [ray, relaxed, safe] = [Mode::Ray, Mode::RayRelaxed, Mode::Safe].map(|mode| {
            plan.march.mode = mode;
            render(&plan, COUNTED).work_per_pixel().unwrap().0
        });
        let what = format!("{name}: {ray} {relaxed} {safe}");
        assert!(relaxed < 0.97 * ray, "{what}");
        assert!(ray > 1.5 * safe && relaxed > 1.5 * safe, "{what}");
        logs[0] += (ray / safe).ln();
        logs[1] += (relaxed / safe).ln();
    }
    let count = bench_views().count() as f64;
    let [ray, relaxed] = logs.map(|sum: f64| (sum / count).exp());
    assert!(ray > 2.5 && relaxed > 2.0, "{ray} {relaxed}");
}

/// Presets as they are shipped, whose plan decides about cones, against the strongest rays alone.
#[test]
fn no_preset_needs_more_work_than_the_strongest_rays() {
    let mut logs = Vec::new();
    for name in BUILTIN.iter().map(|(name, _)| name) {
        let mut plan = preset(name, &["march.coarsest=auto", "image.size=[320, 180]"]);
        let own = render(&plan, COUNTED).work_per_pixel().unwrap().0;
        (plan.march.mode, plan.march.clip) = (Mode::RayRelaxed, Some(true));
        let rays = render(&plan, COUNTED).work_per_pixel().unwrap().0;
        let ratio = own / rays;
        println!("{name}: {ratio:.3}");
        assert!(ratio < 1.02, "{name}: {own} {rays}");
        logs.push(ratio.ln());
    }
    let mean = (logs.iter().sum::<f64>() / logs.len() as f64).exp();
    assert!(mean < 0.8, "{mean}");
}
