//! The renders of a measurement, with progress.

use crate::command::executor::Executor;
use crate::command::progress::Reporter;
use crate::gpu::RenderError;
use crate::pass::progress::Progress;
use crate::picture::frame::Frame;
use crate::plan::{Extras, Plan};
use crate::scene::Assets;

/// Warm runs that a median is taken of.
pub const RUNS: usize = 5;

/// Counts work and keeps the fronts of the levels; no colours.
pub const COUNTED: Extras = Extras {
    count: true,
    levels: true,
    depth_only: true,
    normals: false,
    variance: false,
    time: false,
    shown: false,
    sketched: false,
    unread: false,
    reuse: false,
    rays: None,
    held: false,
};
/// Asks the device for its times; no colours.
pub const TIMED: Extras = Extras {
    time: true,
    count: false,
    levels: false,
    ..COUNTED
};

/// Does a known number of renders.
pub struct Runner<'a> {
    executor: &'a mut Executor,
    assets: &'a Assets,
    progress: Reporter,
    done: usize,
    all: usize,
}

impl<'a> Runner<'a> {
    /// Begins so many renders; `what` is what they measure.
    pub fn new(executor: &'a mut Executor, assets: &'a Assets, what: &str, all: usize) -> Self {
        Self {
            executor,
            assets,
            progress: Reporter::start(&format!("measuring {what}")),
            done: 0,
            all,
        }
    }

    /// Does one of them; `detail` tells it from the others.
    ///
    /// # Errors
    /// The device failed, or an interrupt.
    pub fn render(
        &mut self,
        plan: &Plan,
        extras: Extras,
        detail: &str,
    ) -> Result<Frame, RenderError> {
        let (progress, done, all) = (&mut self.progress, self.done as f64, self.all as f64);
        let watch =
            &mut |now: &Progress| progress.report_part(now, (done + now.done) / all, detail);
        let frame = self.executor.render(plan, self.assets, extras, watch)?;
        self.done += 1;
        Ok(frame)
    }
}

/// The median of some values; sorts them.
pub fn median_of(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
