//! From a Plan to a Frame on a wgpu device.
//!
//! A [`Renderer`] keeps compiled kernels and buffers between calls. Large images are cut into
//! blocks, and a pass into dispatches of a bounded number of steps, each for the cells that
//! still move. Neither changes a bit of the picture.

use std::sync::{Arc, Mutex, PoisonError};

use crate::base::one_value_cache::OneValueCache;
use crate::base::shader::Sources;
use crate::gpu::background::{Background, Threads};
use crate::gpu::device::Device;
pub use crate::gpu::error::RenderError;
use crate::gpu::kernel::Kernels;
use crate::gpu::pick::{Pick, SubmittedPick};
use crate::gpu::target::Needs;
use crate::gpu::task_status::TaskStatus;
use crate::gpu::texts::TextHistory;
use crate::gpu::work::{FrameRequest, Shared, Work};
use crate::pass::pick::At;
#[cfg(feature = "cli")]
use crate::pass::progress::Watch;
#[cfg(feature = "cli")]
use crate::picture::frame::Frame;
use crate::plan::{Extras, Plan};
use crate::scene::Assets;

/// The largest edge of a block in pixels. `queue_divide` in `wgsl/pass/queue.wgsl` is exact for so
/// many pixels.
const MOST_BLOCK: u32 = 1024;

/// How work is cut. This never changes a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cutting {
    /// The largest edge of a block in pixels. More than 1024 counts as 1024.
    pub block: u32,
    /// The step limit of the first dispatch of a pass. Each later one has four times as many.
    pub chunk: u32,
}

impl Default for Cutting {
    fn default() -> Self {
        Self {
            block: MOST_BLOCK,
            // Most rays end within 64 steps. The rest are packed and run in dispatches of
            // 256. Packing sooner costs a software device more in visits than it saves in
            // idle lanes.
            chunk: 64,
        }
    }
}

impl Cutting {
    /// The edge of a block.
    pub(super) fn edge(&self) -> u32 {
        self.block.min(MOST_BLOCK)
    }
}

/// Renders plans on one device.
pub struct Renderer {
    /// The device.
    pub device: Arc<Device>,
    /// How work is cut.
    pub cutting: Cutting,
    /// Texts of shader files that take precedence, for live editing. If programs cannot be made of
    /// them, one frame fails and says why; until a text changes, those that follow take the last
    /// texts that worked, or else the program's own. The makers of maps do not ask for them.
    pub sources: Option<Sources>,
    shared: Arc<Shared>,
    threads: Threads,
}

impl Renderer {
    /// A renderer on an open device.
    pub fn new(device: Device) -> Self {
        Self::sharing(Arc::new(device))
    }

    /// A renderer on an open device that a window draws with too.
    pub fn sharing(device: Arc<Device>) -> Self {
        Self {
            cutting: Cutting::default(),
            sources: None,
            device: device.clone(),
            shared: Arc::new(Shared {
                device,
                kernels: Kernels::default(),
                arrays: Mutex::default(),
                reusable: Mutex::default(),
                tone_steps: OneValueCache::default(),
                texts: TextHistory::default(),
                preparing: Mutex::default(),
            }),
            threads: Threads::default(),
        }
    }

    /// Begins a render without waiting. The plan must pass [`Plan::check`]. If an asset or a
    /// program is missing, a thread loads, makes and compiles it first; the assets keep it. A
    /// device that was lost is opened again, unless a host has lent it.
    ///
    /// # Errors
    /// The device failed, or has no room. Other errors come from [`Work::advance`].
    pub fn begin(
        &mut self,
        plan: &Plan,
        assets: &Assets,
        extras: Extras,
    ) -> Result<Work, RenderError> {
        // It may be an error of the host, and the device still works. Only here: a work under way
        // must not miss its own error because another plan is set or a pixel is picked.
        if !self.device.is_opened_here() {
            self.device.forget_reported();
        }
        self.reopen_if_lost()?;
        let mut work = Work::new(self.shared.clone(), extras);
        let kept = self.shared.reusable.lock();
        let held = kept.unwrap_or_else(PoisonError::into_inner).needs();
        self.start(&mut work, plan, assets, held)?;
        Ok(work)
    }

    /// Puts another plan into a work. Once it is prepared, what was submitted of the old plan is
    /// discarded; until then the old plan goes on. The extras stay. A device that was lost is opened
    /// again, unless a host has lent it.
    ///
    /// # Errors
    /// Those of [`Renderer::begin`]; the work goes on with the old plan then.
    pub fn set(
        &mut self,
        work: &mut Work,
        plan: &Plan,
        assets: &Assets,
    ) -> Result<(), RenderError> {
        self.reopen_if_lost()?;
        work.move_to(&self.shared);
        let held = work.needs();
        self.start(work, plan, assets, held)
    }

    fn start(
        &mut self,
        work: &mut Work,
        plan: &Plan,
        assets: &Assets,
        held: Option<Needs>,
    ) -> Result<(), RenderError> {
        let mut request = FrameRequest {
            plan: plan.clone(),
            march: plan.march.clone(),
            rays_alone: false,
            assets: assets.snapshot(false),
            all_assets: assets.clone(),
            extras: work.extras(),
            cutting: self.cutting,
            sources: self.sources.clone(),
            held,
            shared: self.shared.clone(),
        };
        request.resolve();
        if let Some(inputs) = request.at_once()? {
            return work.start(inputs);
        }
        let keys = request.plan.scene.asset_keys();
        let prepare = move |told: &_| request.prepare(told);
        let first = "heights, maps and programs";
        work.start_when_ready(keys, Background::start(&mut self.threads, first, prepare));
        Ok(())
    }

    /// Asks what there is at a place of a plan, for a cursor or for the speed of a flight. The work
    /// under way goes on.
    ///
    /// # Errors
    /// The device failed. Other errors come from [`Pick::poll`].
    pub fn pick(&mut self, plan: &Plan, assets: &Assets, at: At) -> Result<Pick, RenderError> {
        self.reopen_if_lost()?;
        let (shared, sources) = (self.shared.clone(), self.sources.clone());
        let (plan, assets) = (plan.clone(), assets.clone());
        let ask = move |told: &TaskStatus| {
            let tell = &mut |progress: &_| told.tell(progress);
            SubmittedPick::new(&shared, sources.as_ref(), (&plan, &assets), at, tell)
        };
        let asked = Background::start(&mut self.threads, "pick", ask);
        Ok(Pick::new(self.device.clone(), asked))
    }

    /// The last error of [`Renderer::sources`], as long as no text that was asked for has changed since.
    /// Frames are made of other texts meanwhile.
    pub fn shader_error(&self) -> Option<String> {
        self.shared.texts.error()
    }

    fn reopen_if_lost(&mut self) -> Result<(), RenderError> {
        #[cfg(feature = "cli")]
        if self.device.check_well().is_err() && self.device.is_opened_here() {
            let fresh = Self::new(self.device.reopen()?);
            self.device = fresh.device;
            self.shared = fresh.shared;
        }
        Ok(self.device.check_well()?)
    }

    /// Renders a plan: [`Renderer::begin`] and [`Work::finish`]. It waits.
    ///
    /// # Errors
    /// Those of both.
    #[cfg(feature = "cli")]
    pub fn render(
        &mut self,
        plan: &Plan,
        assets: &Assets,
        extras: Extras,
        watch: Watch<'_>,
    ) -> Result<Frame, RenderError> {
        self.begin(plan, assets, extras)?.finish(watch)
    }
}
