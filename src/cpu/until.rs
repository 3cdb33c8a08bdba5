//! Ends the samples of tiles whose error is small.

use crate::pass::tone_map::Tone;
use crate::pass::until::{bound, is_judged, squared, squared_alpha};
use crate::pass::variance::variance_of;
use crate::picture::frame::Frame;
use crate::plan::{Plan, UNTIL_TILE};

/// What is kept of the pixels of an adaptive plan.
pub(super) struct Judge {
    tone: Tone,
    until: f64,
    samples: u32,
    /// The sums of the light when they were looked at last.
    halves: Vec<[f32; 3]>,
    /// The hits then, if the background is transparent.
    hits: Vec<f32>,
}

impl Judge {
    /// The judge of a frame; `None` if all pixels have all samples.
    pub fn of(plan: &Plan, frame: &Frame) -> Option<Self> {
        (!frame.samples.is_empty()).then(|| Self {
            tone: Tone::of(&plan.look),
            until: plan.until,
            samples: plan.samples,
            halves: vec![[0.0; 3]; frame.samples.len()],
            hits: frame.alpha.clone(),
        })
    }

    /// Whether a pixel has ended.
    fn has_ended(&self, frame: &Frame, i: usize) -> bool {
        frame.samples[i] < self.samples
    }

    /// Whether each pixel has ended.
    pub fn ended(&self, frame: &Frame) -> Vec<bool> {
        frame.samples.iter().map(|n| *n < self.samples).collect()
    }

    /// Looks at all tiles after so many samples.
    pub fn judge(&mut self, frame: &mut Frame, samples: u32) {
        if !is_judged(samples, self.samples) {
            return;
        }
        let bound = bound(self.until, samples);
        let [width, height] = frame.size.map(|n| n as usize);
        let tile = UNTIL_TILE as usize;
        for y in (0..height).step_by(tile) {
            for x in (0..width).step_by(tile) {
                if self.has_ended(frame, y * width + x) {
                    continue;
                }
                let rows = y..(y + tile).min(height);
                let columns = x..(x + tile).min(width);
                let numbers = 3 * rows.len() * columns.len();
                let pixels = || {
                    rows.clone()
                        .flat_map(|y| columns.clone().map(move |x| y * width + x))
                };
                let error = |i| {
                    let hits = self.hits.get(i).zip(frame.alpha.get(i));
                    squared(&self.tone, self.halves[i], frame.radiance[i], samples)
                        + hits.map_or(0.0, |(half, all)| squared_alpha(*half, *all, samples))
                };
                if bound >= 0.0 && pixels().map(error).sum::<f64>() < bound * numbers as f64 {
                    pixels().for_each(|i| frame.samples[i] = samples);
                }
            }
        }
        self.halves.clone_from(&frame.radiance);
        self.hits.clone_from(&frame.alpha);
    }
}

/// Makes means of the sums over the samples of each pixel, of which there are so many unless its
/// tile ended before.
pub(super) fn average(frame: &mut Frame, samples: u32) {
    let counts = &frame.samples;
    let count = |i: usize| counts.get(i).copied().unwrap_or(samples);
    let shares = |i: usize| 1.0 / count(i) as f32;
    for (i, sum) in frame.radiance.iter_mut().enumerate() {
        *sum = sum.map(|light| light * shares(i));
    }
    for (i, hits) in frame.alpha.iter_mut().enumerate() {
        *hits *= shares(i);
    }
    for (i, spread) in frame.variance.iter_mut().enumerate() {
        *spread = variance_of(*spread, count(i));
    }
}
