//! What the program claims of its work, on the five benchmarks at their own size. Counts of
//! evaluations are the same on every machine but for the rounding of its arithmetic.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

mod adapter;

use conemarch::plan::Extras;
use conemarch::plan::march::Mode;
use conemarch::preset::load;

const BENCHMARKS: [&str; 5] = [
    "bench-far",
    "bench-graze",
    "bench-inside",
    "bench-outside",
    "bench-thin",
];

#[test]
fn cones_need_far_fewer_evaluations_than_rays() {
    let extras = Extras {
        count: true,
        depth_only: true,
        ..Extras::default()
    };
    let mut logs = [0.0, 0.0];
    for name in BENCHMARKS {
        let mut plan = load(name, &[]).unwrap().plan;
        let [ray, relaxed, safe] = [Mode::Ray, Mode::RayRelaxed, Mode::Safe].map(|mode| {
            plan.march.mode = mode;
            let frame = adapter::render(&plan, extras);
            frame.work_per_pixel().unwrap().0
        });
        assert!(relaxed < 0.97 * ray, "{name}: {relaxed} {ray}");
        assert!(
            ray > 1.5 * safe && relaxed > 1.5 * safe,
            "{name}: {ray} {relaxed} {safe}"
        );
        logs[0] += (ray / safe).ln();
        logs[1] += (relaxed / safe).ln();
    }
    let [ray, relaxed] = logs.map(|sum: f64| (sum / 5.0).exp());
    assert!(ray > 2.5 && relaxed > 2.0, "{ray} {relaxed}");
}
