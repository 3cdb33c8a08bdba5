//! The variance of each pixel.

use conemarch::base::srgb::LUMA;
use conemarch::picture::frame::Frame;
use conemarch::plan::Plan;
use glam::DVec3;

use super::common::plans::preset;
use crate::adapter::{EVERYTHING, on_cpu, render};

/// Without shadows: those of a single sample are hard.
fn plan(samples: u32) -> Plan {
    let changes = ["image.size=[96, 64]", "march.mode=ray", "look.shadow=false"];
    let mut plan = preset("mandelbox", &changes);
    plan.samples = samples;
    plan
}

/// The luminance of a pixel.
fn luminance(frame: &Frame, i: usize) -> f64 {
    LUMA.dot(DVec3::from(frame.radiance[i].map(f64::from)))
}

/// Without cones, the first samples of a picture are those of a picture of fewer samples, so sums of
/// pictures tell each sample.
#[test]
fn the_variance_is_that_of_the_samples() {
    const SAMPLES: u32 = 6;
    for executor in [render, on_cpu] {
        let frames: Vec<Frame> = (1..=SAMPLES)
            .map(|n| executor(&plan(n), EVERYTHING))
            .collect();
        assert!(frames[0].variance.is_empty());
        let last = &frames[SAMPLES as usize - 1];
        let mut noisy = 0;
        for (i, found) in last.variance.iter().enumerate() {
            let mut before = 0.0;
            let of_each = frames.iter().zip(1..).map(|(frame, n)| {
                let sum = f64::from(n) * luminance(frame, i);
                let own = sum - before;
                before = sum;
                own
            });
            let each: Vec<f64> = of_each.collect();
            let n = each.len() as f64;
            let mean = each.iter().sum::<f64>() / n;
            let squares = each.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            let wanted = squares / (n * (n - 1.0));
            let off = (f64::from(*found) - wanted).abs();
            assert!(off < 1e-4 * wanted + 1e-7, "{i}: {found} for {wanted}");
            noisy += usize::from(wanted > 1e-4);
        }
        assert!(noisy > 500, "{noisy}");
    }
}

/// A tile that ends has the variance of the samples that it has.
#[test]
fn tiles_that_end_have_the_variance_of_their_samples() {
    let mut ends = plan(32);
    // Every tile ends as soon as it may.
    ends.until = 1.0;
    for executor in [render, on_cpu] {
        let (ended, all) = (executor(&ends, EVERYTHING), executor(&plan(8), EVERYTHING));
        assert!(ended.samples.iter().all(|n| *n == 8));
        let sum = |frame: &Frame| frame.variance.iter().map(|v| f64::from(*v)).sum::<f64>();
        // They are other eight samples of the same pixels.
        let ratio = sum(&ended) / sum(&all);
        assert!((0.8..1.25).contains(&ratio), "{ratio}");
    }
}
