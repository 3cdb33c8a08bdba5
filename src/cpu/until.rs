//! Ends the samples of tiles whose error is small.

use crate::pass::tone_map::Tone;
use crate::pass::until::{bound, is_kept, squared};
use crate::picture::frame::Frame;
use crate::plan::{Plan, UNTIL_TILE};

/// What is kept of the pixels of an adaptive plan.
pub(super) struct Judge {
    tone: Tone,
    until: f64,
    samples: u32,
    /// The sums of the light when they were looked at last.
    halves: Vec<[f32; 3]>,
}

impl Judge {
    /// The judge of a frame; `None` if all pixels have all samples.
    pub fn of(plan: &Plan, frame: &Frame) -> Option<Self> {
        (!frame.samples.is_empty()).then(|| Self {
            tone: Tone::of(&plan.look),
            until: plan.until,
            samples: plan.samples,
            halves: vec![[0.0; 3]; frame.samples.len()],
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
        if !is_kept(samples, self.samples) {
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
                let error = |i| squared(&self.tone, self.halves[i], frame.radiance[i], samples);
                if bound >= 0.0 && pixels().map(error).sum::<f64>() < bound * numbers as f64 {
                    pixels().for_each(|i| frame.samples[i] = samples);
                }
            }
        }
        self.halves.clone_from(&frame.radiance);
    }
}
