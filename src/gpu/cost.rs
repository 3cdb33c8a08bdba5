//! What is known about the dispatches of a stage. It decides the size of dispatches, and never
//! changes a pixel.

use wgpu::DeviceType;

use crate::pass::turn::Stage;

/// The longest time in milliseconds that a dispatch is made for. At the end of each, some threads of
/// a software device wait for others, so short dispatches cost it time.
pub const LONGEST_MS: f64 = 30.0;
/// The time that a dispatch of unknown cost is taken for.
const FIRST_MS: f64 = 8.0;
/// The product of workgroups and steps of a first dispatch. At 64 steps of a fractal with few
/// iterations it takes about `FIRST_MS` on two cores.
const FIRST_SLICE: u32 = 64 * 256;
/// The same where light is followed by rays: such a dispatch takes much longer.
const FIRST_SLICE_OF_PATHS: u32 = 64 * 16;
/// So many iterations are few. Most presets have up to twice as many.
const FEW_ITERATIONS: u32 = 32;
/// The largest change of a dispatch's size at once. The time of a small dispatch says little of a
/// large one.
const MOST_SHORTER: f64 = 1.0 / 16.0;
const MOST_LONGER: f64 = 4.0;
/// A dispatch over the dearest cells may take so many times as long as one is made for.
const PEAK: f64 = 1.5;
/// How much of the peak stays at each report.
const PEAK_STAYS: f64 = 0.95;
/// The most rounds that are encoded ahead.
const ROUNDS: u32 = 8;
/// The largest number of workgroups along an axis.
const MOST_GROUPS: u32 = 65_535;

/// The costs of a stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// The largest product of the workgroups and the step limit of a dispatch.
    pub slice: u32,
    /// Estimated milliseconds of a dispatch.
    pub dispatch_ms: f64,
    /// The most milliseconds that a unit of the slice took lately. Ground takes much longer than the
    /// sky before it. A first dispatch counts as twice `FIRST_MS`, so that what follows sky does not grow
    /// by the whole of `MOST_LONGER`.
    peak_ms: f64,
    /// Dispatches of the stage in the last block, cut as it is now.
    last: Option<u32>,
}

/// How many times as large the first dispatch is on a device of a kind as on two cores: a small one
/// would leave most of a large device idle. What goes through many iterations takes longer.
pub fn faster(device: DeviceType, iterations: u32) -> u32 {
    let times = match device {
        DeviceType::DiscreteGpu => 64,
        DeviceType::IntegratedGpu | DeviceType::VirtualGpu => 8,
        DeviceType::Cpu | DeviceType::Other => 1,
    };
    (times / iterations.div_ceil(FEW_ITERATIONS).max(1)).max(1)
}

impl Cost {
    /// What is known of a stage that has not run yet.
    pub fn first(follows_light: bool, faster: u32) -> Self {
        let slice = match follows_light {
            true => FIRST_SLICE_OF_PATHS,
            false => FIRST_SLICE,
        };
        let slice = slice * faster;
        Self {
            slice,
            dispatch_ms: FIRST_MS,
            peak_ms: 2.0 * FIRST_MS / f64::from(slice),
            last: None,
        }
    }

    /// The milliseconds that a dispatch of a stage may take.
    pub fn longest_ms(&self, stage: &Stage) -> f64 {
        let all = stage.tiles.saturating_mul(stage.chunk);
        let peak = self.peak_ms * f64::from(self.slice.min(all));
        self.dispatch_ms.max(peak)
    }

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
        // Later rounds visit few cells, each mostly in one dispatch. One more, as another view may
        // need it.
        let rounds = (stage.limit - stage.chunk).div_ceil(stage.most.max(1)) + 1;
        let ahead = self.last.map_or(first + rounds, |last| last + 1);
        ahead.min(ROUNDS * first)
    }

    /// Learns from a stage that so far took so many dispatches, `ran` of them in a submission, of so
    /// many milliseconds each, which should be about `aim_ms`.
    pub fn learn(&mut self, each_ms: f64, [dispatches, ran]: [u32; 2], stage: &Stage, aim_ms: f64) {
        // The last dispatch of a round is shorter than the others. Of several, it counts little.
        let weight = if ran > 2 { 0.8 } else { 0.3 };
        let slower = weight * each_ms + (1.0 - weight) * self.dispatch_ms;
        self.dispatch_ms = each_ms.max(slower).max(1e-3);
        self.last = Some(dispatches);
        let slice = f64::from(self.slice);
        self.peak_ms = (PEAK_STAYS * self.peak_ms).max(each_ms / slice);
        let shorter = each_ms > 1.33 * aim_ms && self.slice > stage.chunk;
        let more = dispatches > 1 && self.of_first_round(stage) > 1;
        let longer = self.dispatch_ms < 0.45 * aim_ms && more;
        if shorter {
            self.scale((aim_ms / each_ms).max(MOST_SHORTER));
        } else if longer {
            let factor = (0.7 * aim_ms / self.dispatch_ms).min(MOST_LONGER);
            let factor = factor.min(PEAK * aim_ms / (self.peak_ms * slice));
            if factor > 1.0 {
                self.scale(factor);
            }
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
