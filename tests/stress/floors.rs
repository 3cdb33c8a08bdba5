//! How far the estimate in f32 is to be trusted: against the same in f64, on the adapter
//! and on the CPU, by distance from the surface.

use std::sync::LazyLock;

use conemarch::base::shader::Program;
use conemarch::formula::mandelbox::Mandelbox;
use conemarch::gpu::kernel::Kernel;

use super::common::plans::mandelbox;
use super::common::precision::{Sample, asker, has_f64, quantiles, samples};
use super::common::probe::probe;
use crate::adapter;

/// Samples of two Mandelboxes, each with its scale.
static SAMPLES: LazyLock<[(f64, Vec<Sample>); 2]> =
    LazyLock::new(|| [2.0, -1.5].map(|scale| (scale, samples(&mandelbox(scale)))));

/// Asserts that the errors at a distance, a power of ten, have a median and a 99 % quantile
/// within the bounds.
fn assert_within(power: i32, error: fn(&Sample) -> f64, bounds: [f64; 2]) {
    for (scale, all) in SAMPLES.iter() {
        let here = all.iter().filter(|s| s.power == power);
        let [median, most] = quantiles(here.map(error));
        let held = median < bounds[0] && most < bounds[1];
        assert!(held, "{scale}: 1e{power} {median} {most}");
    }
}

#[test]
fn f32_holds_down_to_its_floor_and_not_below() {
    // The noise is 1e-7 at coordinates of 5: a ten-thousandth of a distance of 1e-3.
    for power in [-1, -2, -3] {
        assert_within(power, |s| s.in_all, [5e-4, 0.05]);
    }
    // At 1e-8 nothing is left of it, and the comparison sees that.
    for (scale, all) in SAMPLES.iter() {
        let here = all.iter().filter(|s| s.power == -8);
        let [median, _] = quantiles(here.map(|s| s.in_all));
        assert!(median > 0.5, "{scale}: {median}");
    }
}

#[test]
fn f64_on_an_adapter_is_f64() {
    if !has_f64() {
        // Such an adapter must refuse the program, not run it in something less.
        let mut program = Program::new("probe", asker(&Mandelbox::default(), true).modules);
        program.modules.push(probe!("frame"));
        let refused = adapter::with(move |r| Kernel::new(&r.device, &program).is_err());
        assert!(refused, "an adapter without f64 takes a program in f64");
        return;
    }
    for power in -9..=-1 {
        // Its parameters are read in f32, as ever: K is rounded, by 3e-8 of itself.
        assert_within(power, |s| s.doubled.unwrap(), [1e-7, 1e-5]);
    }
}
