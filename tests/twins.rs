//! The shaders and their twins in Rust agree: the layout of every struct that both read,
//! and the values of their functions, f32 on the GPU against f64 on the CPU.
//!
//! Values are compared by quantile, never by the largest error: next to a fold or a
//! threshold f32 may well take the other side. Each comparison is made once more with
//! one constant moved by a ten-thousandth, and must then fail.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test may panic, and is read by its name"
)]

mod adapter;
mod common {
    pub mod layout;
    pub mod plans;
    pub mod probe;
    pub mod random;
    pub mod setups;
    pub mod twin_beams;
    pub mod twin_layouts;
    pub mod twin_looks;
}

use common::probe::{Allowed, Errors, Numbers, Probe, agree_unless_moved, probe};
use common::random::Random;
use common::setups::{
    MOVED, balls, four, mandelboxes, narrow, points, probe_of, shape_plan, slab_plan, three,
};
use conemarch::base::cone::ConeRule;
use conemarch::formula::Formula;
use conemarch::formula::mandelbox::Mandelbox;
use conemarch::plan::Plan;
use conemarch::scene::slab::SlabSettings;
use glam::DVec3;

/// What a formula's estimate and traps may be off by, from its shaders' and its own.
fn formula_errors(gpu: &Formula, cpu: &Formula) -> [Errors; 2] {
    const ITERATIONS: u32 = 6;
    let asked = points(&**cpu, ITERATIONS, 1);
    let plan = shape_plan(gpu.clone(), ITERATIONS, DVec3::new(9.0, 0.0, 0.0));
    let told = probe_of(&plan, probe!("formula")).ask(&asked);
    let mut estimates = Vec::new();
    let mut traps = Vec::new();
    for (q, a) in asked.iter().zip(&told) {
        let p = three(q[0]);
        estimates.push((a[0][0], cpu.estimate(p, ITERATIONS).0));
        let trap = cpu.trap(p, ITERATIONS);
        traps.extend((0..3).map(|i| (a[1][i], trap[i])));
    }
    [Errors::of(estimates, 0.01), Errors::of(traps, 0.01)]
}

#[test]
fn mandelboxes_agree() {
    for (name, own) in mandelboxes() {
        let own = Formula::Mandelbox(own);
        let scaled = |f: &dyn Fn(&mut Mandelbox)| {
            let Formula::Mandelbox(mut m) = own.clone() else {
                unreachable!("made above");
            };
            f(&mut m);
            Formula::Mandelbox(m)
        };
        let [e, t] = formula_errors(&own, &own);
        let moved = scaled(&|m| m.scale *= MOVED);
        let [em, _] = formula_errors(&moved, &own);
        let allowed = Allowed {
            median: 2e-6,
            p99: 6e-5,
        };
        agree_unless_moved(&format!("estimate, {name}"), allowed, e, em);
        let moved = scaled(&|m| m.fold_limit *= MOVED);
        let [_, tm] = formula_errors(&moved, &own);
        let allowed = Allowed {
            median: 6e-7,
            p99: 6e-4,
        };
        agree_unless_moved(&format!("trap, {name}"), allowed, t, tm);
    }
}

#[test]
fn balls_agree() {
    let [e, t] = formula_errors(&balls(1.0), &balls(1.0));
    let [em, _] = formula_errors(&balls(MOVED), &balls(1.0));
    let allowed = Allowed {
        median: 2e-7,
        p99: 2e-6,
    };
    agree_unless_moved("estimate, balls", allowed, e, em);
    // Their traps read no parameter: nothing to move, but still nothing to get wrong.
    assert!(t.within(allowed), "{t:?}");
}

/// Fronts, samples, balls and chords, most of them near the edge of progress.
fn cones(count: usize, near: f64, seed: u64) -> Vec<Numbers> {
    let mut random = Random::new(seed);
    let of = |i: usize| {
        let t = narrow(10.0_f64.powf(random.between(-2.0, 2.0)));
        let k = narrow(2.0 * random.unit().powi(2)).max(1e-4);
        // Every other sample is taken ahead of the front.
        let front = if i.is_multiple_of(2) {
            t
        } else {
            t * random.between(0.7, 1.0)
        };
        let d = k * t * (1.0 + near * random.between(-1.0, 1.0));
        [four(DVec3::new(front, t, d), k), [0.0; 4], [0.0; 4]]
    };
    (0..count).map(of).collect()
}

fn cone_probe() -> Probe {
    Probe {
        modules: vec![ConeRule::Exact.module(), probe!("cone")],
        parameters: Vec::new(),
    }
}

#[test]
fn the_cone_step_agrees() {
    let asked = cones(8192, 0.9, 2);
    let errors = |probe: Probe| {
        let told = probe.ask(&asked);
        let want = |q: &Numbers| {
            let [front, t, d, k] = q[0].map(f64::from);
            ConeRule::Exact.cone_front(front, t, d, k)
        };
        Errors::of(
            told.iter().zip(&asked).map(|(a, q)| (a[0][0], want(q))),
            1e-9,
        )
    };
    let allowed = Allowed {
        median: 2e-7,
        p99: 1e-6,
    };
    let own = errors(cone_probe());
    for name in ["CONE_TRUST", "CONE_ROUND_DOWN"] {
        let moved = errors(cone_probe().with_constant_scaled(name, 1.0 / MOVED));
        agree_unless_moved(&format!("cone_front, {name}"), allowed, own, moved);
    }
    let mut slides = cone_probe();
    slides.modules[0] = ConeRule::Slides.module();
    assert!(!errors(slides).within(allowed));
}

/// The front that one empty ball proves, without regard to rounding.
fn exact_front(front: f64, t: f64, d: f64, k: f64) -> f64 {
    let q = d * d - t * t * (k * k - 0.25 * k.powi(4));
    let middle = t * (1.0 - 0.5 * k * k);
    if d <= 0.0 || q < 0.0 || middle - q.sqrt() > front {
        return front;
    }
    front.max(middle + q.sqrt())
}

#[test]
fn f32_never_claims_more_than_the_exact_front() {
    // The ball's radius within a hundred-thousandth of k t, the edge of progress.
    let asked = cones(100_000, 1e-5, 3);
    let beyond = |probe: Probe| {
        let told = probe.ask(&asked);
        let past = told.iter().zip(&asked).filter(|(a, q)| {
            let [front, t, d, k] = q[0].map(f64::from);
            f64::from(a[0][0]) > exact_front(front, t, d, k)
        });
        past.count()
    };
    assert_eq!(beyond(cone_probe()), 0);
    // Without its two factors f32 does claim more.
    let mut raw = cone_probe();
    for constant in &mut raw.modules[0].constants {
        constant.1 = 1.0;
    }
    assert!(beyond(raw) > 10);
}

#[test]
fn rays_and_cones_of_the_view_agree() {
    let of = |fov: f64| {
        let mut plan = slab_plan(SlabSettings::default());
        plan.camera.fov = fov;
        plan.size = [1366, 768];
        plan
    };
    let mut random = Random::new(4);
    let question = |i: u32| {
        let x = random.between(0.0, 1366.0).floor();
        let y = random.between(0.0, 768.0).floor();
        let divisor = f64::from(2_u32 << (i % 5));
        [four(DVec3::new(x, y, divisor), 0.0), [0.0; 4], [0.0; 4]]
    };
    let asked: Vec<Numbers> = (0..8192).map(question).collect();
    for fov in [1.0, 48.5, 170.0] {
        let view = of(fov).view();
        let errors = |gpu: &Plan| {
            let told = probe_of(gpu, probe!("view")).ask(&asked);
            let (mut axes, mut chords, mut grains) = (vec![], vec![], vec![]);
            for (q, a) in asked.iter().zip(&told) {
                let [x, y, d, _] = q[0].map(|n| n as u32);
                let (ray, cone) = (view.view_ray([x, y]), view.view_cone([x / d, y / d], d));
                axes.extend((0..3).flat_map(|i| [(a[0][i], ray.axis[i]), (a[1][i], cone.axis[i])]));
                chords.push((a[2][0], cone.k));
                grains.extend([(a[0][3], ray.grain), (a[1][3], cone.grain)]);
                assert_eq!((a[2][1], a[2][2]), (0.0, 0.0));
            }
            [
                Errors::of(axes, 1.0),
                Errors::of(chords, 0.0),
                Errors::of(grains, 0.0),
            ]
        };
        let own = errors(&of(fov));
        let moved = errors(&of(fov * MOVED));
        let allowed = Allowed {
            median: 3e-7,
            p99: 1e-6,
        };
        let names = ["axes", "chords", "grains"];
        for (i, name) in names.iter().enumerate() {
            let name = format!("{name} at {fov} degrees");
            // In so narrow a view all axes are nearly one.
            if fov > 1.0 || i > 0 {
                agree_unless_moved(&name, allowed, own[i], moved[i]);
            }
            assert!(own[i].within(allowed), "{name}: {:?}", own[i]);
        }
    }
}
