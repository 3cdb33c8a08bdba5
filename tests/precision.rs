//! How far the estimate in f32 is to be trusted: against the same in f64, on the adapter
//! and on the CPU, by distance from the surface and by iterations.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test fails by panicking, and has no readers of its interface"
)]

mod adapter;
#[allow(dead_code, reason = "other files use the rest")]
mod common {
    pub mod precision;
    pub mod probe;
    pub mod random;
    pub mod setups;
}

use common::precision::{Sample, asker, has_f64, quantiles, samples};
use conemarch::base::shader::Program;
use conemarch::formula::mandelbox::Mandelbox;
use conemarch::gpu::kernel::Kernel;

fn of(scale: f64) -> Vec<Sample> {
    let m = Mandelbox {
        scale,
        ..Mandelbox::default()
    };
    samples(&m)
}

#[test]
fn f32_holds_down_to_its_floor_and_not_below() {
    for scale in [2.0, -1.5] {
        let all = of(scale);
        let at = |power: i32, error: fn(&Sample) -> f64| {
            quantiles(all.iter().filter(|s| s.power == power).map(error))
        };
        // The noise is 1e-7 at coordinates of 5: a ten-thousandth of a distance of 1e-3.
        for power in [-1, -2, -3] {
            let [median, most] = at(power, Sample::in_all);
            assert!(
                median < 5e-4 && most < 0.05,
                "{scale}: 1e{power} {median} {most}"
            );
        }
        // At 1e-8 nothing is left of it, and the comparison sees that.
        let [median, _] = at(-8, Sample::in_all);
        assert!(median > 0.5, "{scale}: {median}");
    }
}

#[test]
fn f64_on_an_adapter_is_f64() {
    if !has_f64() {
        // Such an adapter must refuse the program, not run it in something less.
        let mut program = Program::new("probe", asker(&Mandelbox::default(), true).modules);
        program.modules.push(common::probe::probe!("frame"));
        let refused = adapter::with(move |r| Kernel::new(&r.device, &program).is_err());
        assert!(refused, "an adapter without f64 takes a program in f64");
        return;
    }
    for scale in [2.0, -1.5] {
        let all = of(scale);
        for power in -9..=-1 {
            let here = all.iter().filter(|s| s.power == power);
            let [median, most] = quantiles(here.map(|s| s.doubled().unwrap()));
            // Its parameters are read in f32, as ever: K is rounded, by 3e-8 of itself.
            assert!(
                median < 1e-7 && most < 1e-5,
                "{scale}: 1e{power} {median} {most}"
            );
        }
    }
}
