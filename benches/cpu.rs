//! Times of what runs on the CPU: `cargo bench --bench cpu`.
//!
//! These functions make up the CPU executor, the truth and the comparisons.

use conemarch::scene::Assets;
use std::hint::black_box;

use conemarch::base::cone::ConeRule;
use conemarch::formula::{DistanceEstimate as _, mandelbox::Mandelbox};
use conemarch::measure::flip::flip;
use conemarch::measure::{compare, truth};
use conemarch::plan::march::Mode;
use conemarch::plan::{Extras, Plan};
use conemarch::{cpu, preset};
use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec3;

fn plan(mode: Mode) -> Plan {
    let mut plan = preset::load("bench-outside", &[])
        .expect("a built-in preset")
        .plan;
    plan.size = [160, 90];
    plan.march.mode = mode;
    plan
}

fn depth(mode: Mode) -> conemarch::picture::frame::Frame {
    let extras = Extras {
        depth_only: true,
        ..Extras::default()
    };
    cpu::render(&plan(mode), &Assets::default(), extras, &mut |_| true).expect("nothing cancels it")
}

fn estimates(c: &mut Criterion) {
    for scale in [2.0, -1.5] {
        let shape = Mandelbox {
            scale,
            ..Mandelbox::default()
        };
        for (place, p) in [
            ("outside", DVec3::splat(4.0)),
            ("inside", DVec3::splat(0.3)),
        ] {
            c.bench_function(&format!("estimate, scale {scale}, {place}"), |b| {
                b.iter(|| shape.estimate(black_box(p), 16));
            });
        }
    }
    c.bench_function("exact cone step", |b| {
        b.iter(|| ConeRule::Exact.cone_front(black_box(3.0), 3.0, 0.4, 0.05));
    });
}

fn passes(c: &mut Criterion) {
    let mut group = c.benchmark_group("160 x 90 of bench-outside");
    group.sample_size(10);
    for mode in [Mode::Safe, Mode::Ray] {
        group.bench_function(mode.name(), |b| b.iter(|| depth(mode)));
    }
    group.bench_function("truth", |b| {
        b.iter(|| {
            truth::truth(&plan(Mode::Safe), &Assets::default(), &mut |_| true)
                .expect("nothing cancels it")
        });
    });
    group.finish();
}

fn comparisons(c: &mut Criterion) {
    let (one, two) = (depth(Mode::Safe), depth(Mode::Ray));
    let plan = plan(Mode::Safe);
    c.bench_function("compare, 160 x 90", |b| {
        b.iter(|| {
            compare::compare(
                black_box(&one),
                &two,
                &plan,
                &plan
                    .scene
                    .solid(&plan.viewpoint(), &Assets::default())
                    .expect("no files are named"),
            )
        });
    });
    let ramp: Vec<DVec3> = (0..160 * 90)
        .map(|i| DVec3::splat(f64::from(i) / 14_400.0))
        .collect();
    let grey = vec![DVec3::splat(0.5); ramp.len()];
    c.bench_function("flip, 160 x 90", |b| {
        b.iter(|| flip([160, 90], black_box(&ramp), &grey));
    });
}

criterion_group!(benches, estimates, passes, comparisons);
criterion_main!(benches);
