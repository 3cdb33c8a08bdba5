//! What is known about the dispatches of a stage. It decides the size of dispatches, and never
//! changes a pixel.

use crate::pass::turn::Stage;

/// The longest time in milliseconds that a dispatch is made for. At the end of each, some threads of
/// a software device wait for others, so short dispatches cost it time.
pub const LONGEST_MS: f64 = 30.0;
/// The time that a dispatch of unknown cost is taken for.
const FIRST_MS: f64 = 5.0;
/// The product of workgroups and steps of a first dispatch. At 64 steps of a fractal with few
/// iterations it takes about `FIRST_MS` on a slow device.
const FIRST_SLICE: u32 = 64 * 512;
/// Rounds beyond the first that are expected of a stage with a step limit.
const ROUNDS: u32 = 2;
/// The largest number of workgroups along an axis.
const MOST_GROUPS: u32 = 65_535;

/// The costs of a stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// The largest product of the workgroups and the step limit of a dispatch.
    pub slice: u32,
    /// Estimated milliseconds of a dispatch.
    pub dispatch_ms: f64,
    /// Dispatches of the stage in the last block, cut as it is now.
    last: Option<u32>,
}

impl Default for Cost {
    fn default() -> Self {
        Self {
            slice: FIRST_SLICE,
            dispatch_ms: FIRST_MS,
            last: None,
        }
    }
}

impl Cost {
    /// Dispatches that visit every cell once.
    fn of_first_round(&self, stage: &Stage) -> u32 {
        let groups = (self.slice / stage.chunk.max(1)).clamp(1, MOST_GROUPS);
        stage.tiles.div_ceil(groups).max(1)
    }

    /// How many dispatches of a stage to encode.
    pub fn dispatches(&self, stage: &Stage) -> u32 {
        let first = self.of_first_round(stage);
        if stage.limit <= stage.chunk {
            return first;
        }
        // One more, as another view may need it.
        self.last.map_or(first + ROUNDS, |last| last + 1)
    }

    /// Learns from a stage that so far took so many dispatches of so many milliseconds, which
    /// should be about `aim_ms`.
    pub fn learn(&mut self, each_ms: f64, dispatches: u32, stage: &Stage, aim_ms: f64) {
        // The last dispatch of a round is shorter than the others.
        let slower = 0.3 * each_ms + 0.7 * self.dispatch_ms;
        self.dispatch_ms = each_ms.max(slower).max(1e-3);
        self.last = Some(dispatches);
        let shorter = each_ms > 1.33 * aim_ms && self.slice > stage.chunk;
        let more = dispatches > 1 && self.of_first_round(stage) > 1;
        let longer = self.dispatch_ms < 0.45 * aim_ms && more;
        if shorter || longer {
            self.scale(if shorter { 0.5 } else { 2.0 });
        }
    }

    /// Makes dispatches longer by a factor.
    pub fn scale(&mut self, factor: f64) {
        self.slice = (f64::from(self.slice) * factor).max(1.0) as u32;
        self.dispatch_ms *= factor;
        let last = self.last.map(|n| (f64::from(n) / factor).ceil() as u32);
        self.last = last;
    }
}
