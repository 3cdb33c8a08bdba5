//! A render under way.
//!
//! A frame is a stream of submissions. Each holds dispatches of one or more stages, in order,
//! and is estimated to take at most [`SUBMISSION_MS`]. The host encodes ahead of what it
//! knows: on the device, `wgsl/pass/arrange.wgsl` decides what a dispatch visits, and a
//! dispatch of a stage that is not under way visits nothing. After each submission the host
//! learns how far the frame has come, without waiting for it, and corrects what it encodes
//! next. So neither the length of a submission nor a wrong estimate changes a bit.
//!
//! - `inputs`: assets, programs and arrays, before the first submission
//! - `maps`: the heights and cone maps among them
//! - `job`: what a run is made of, and what it leaves to the next
//! - `run`: the submissions of a frame; `submit` encodes them, and `receive` takes in what comes
//!   back

mod inputs;
mod job;
mod maps;
mod receive;
mod run;
mod submit;

use std::sync::{Arc, Mutex, PoisonError};

use crate::base::one_value_cache::OneValueCache;
use crate::gpu::array::Arrays;
use crate::gpu::background::Background;
use crate::gpu::device::Device;
use crate::gpu::error::RenderError;
use crate::gpu::kernel::Kernels;
use crate::gpu::target::Needs;
use crate::gpu::task_status::Panicked;
use crate::gpu::texts::TextHistory;
#[cfg(feature = "cli")]
use crate::gpu::wait::read_picture;
use crate::heightfield::assets::AssetKeys;
use crate::pass::progress::Progress;
#[cfg(feature = "cli")]
use crate::pass::progress::Watch;
use crate::pass::tone_map::Tone;
use crate::picture::frame::{Frame, Traffic};
use crate::plan::Extras;
use crate::plan::pyramid::Block;
pub(super) use inputs::{FrameInputs, FrameRequest, marched, most_steps};
use job::Reusable;
use run::Run;
pub use run::SUBMISSION_MS;

/// What the renders of a device share.
pub(super) struct Shared {
    pub device: Arc<Device>,
    pub kernels: Kernels,
    pub arrays: Mutex<Arrays>,
    pub reusable: Mutex<Reusable>,
    /// The steps of the last tone: they take a millisecond.
    pub tone_steps: OneValueCache<Tone, Vec<f32>>,
    pub texts: TextHistory,
    /// Locked by the thread that loads and makes assets.
    pub preparing: Mutex<()>,
}

/// What a thread prepares, and what decides the assets of its scene.
struct Preparing {
    assets: Option<AssetKeys>,
    task: Background<Result<FrameInputs, RenderError>>,
}

/// A render under way on a device. Dropping it cancels it.
pub struct Work {
    shared: Arc<Shared>,
    extras: Extras,
    /// What is prepared, until a run begins: for the last plan, and for plans before it, to go back
    /// to if the last one fails.
    preparing: Vec<Preparing>,
    /// The run of the last plan that was prepared.
    run: Option<Run>,
}

/// A host may keep a render on another thread.
#[cfg(not(target_arch = "wasm32"))]
const _: () = {
    const fn sends<T: Send>() {}
    sends::<Work>();
    sends::<crate::gpu::render::Renderer>();
};

impl Work {
    pub(super) fn new(shared: Arc<Shared>, extras: Extras) -> Self {
        Self {
            shared,
            extras,
            preparing: Vec::new(),
            run: None,
        }
    }

    /// Begins a run in place of the one under way. If it cannot begin, the other one goes on.
    pub(super) fn start(&mut self, mut inputs: FrameInputs) -> Result<(), RenderError> {
        let texts = std::mem::take(&mut inputs.texts);
        let edited = inputs.edited.take();
        let shelf = self.shared.reusable.lock();
        let mut shelf = shelf.unwrap_or_else(PoisonError::into_inner);
        let reusable = match &mut self.run {
            Some(old) => &mut old.reusable,
            None => &mut *shelf,
        };
        let begun = Run::begin(self.shared.clone(), inputs, reusable);
        drop(shelf);
        let mut run = match begun {
            Ok(run) => run,
            Err(error) => {
                if let (RenderError::Kernel(error), Some(edited)) = (&error, &edited) {
                    self.shared.texts.failed(edited, error);
                }
                return Err(error);
            }
        };
        self.shared.texts.worked(texts);
        if let Some(old) = &mut self.run {
            old.discard_flights(&mut run.reusable.stagings);
        }
        self.run = Some(run);
        self.preparing.clear();
        Ok(())
    }

    /// Changes over to another device. What is under way on the old one is lost.
    pub(super) fn move_to(&mut self, shared: &Arc<Shared>) {
        if !Arc::ptr_eq(&self.shared, shared) {
            self.shared = shared.clone();
            self.run = None;
            self.preparing.clear();
        }
    }

    /// Begins a run once it is prepared. If it fails, the plan before it goes on: the one that runs, or
    /// else the first that is prepared, if its assets are the same: heights and maps take long, and are
    /// not made for a plan that is gone. The threads of all others stop.
    pub(super) fn start_when_ready(
        &mut self,
        assets: Option<AssetKeys>,
        task: Background<Result<FrameInputs, RenderError>>,
    ) {
        let first = self.preparing.first();
        let goes_on = first.is_some_and(|first| first.assets == assets);
        self.preparing.truncate(usize::from(goes_on));
        self.preparing.push(Preparing { assets, task });
    }

    /// Takes in an answer of the thread that prepares the run.
    fn answered(
        &mut self,
        answer: Result<Option<Result<FrameInputs, RenderError>>, Panicked>,
    ) -> Result<(), RenderError> {
        match answer {
            Ok(None) => Ok(()),
            Ok(Some(Ok(inputs))) => {
                let begun = self.start(inputs);
                if begun.is_err() {
                    self.preparing.pop();
                }
                begun
            }
            Ok(Some(Err(error))) => {
                self.preparing.pop();
                // On a lost device, programs fail too.
                self.shared.device.check()?;
                Err(error)
            }
            Err(Panicked) => {
                self.preparing.pop();
                Err(RenderError::Panicked)
            }
        }
    }

    fn receive(&mut self) -> Result<(), RenderError> {
        match self.preparing.last() {
            Some(last) => self.answered(last.task.poll()),
            None => Ok(()),
        }
    }

    /// Whether a thread still prepares the last plan.
    pub fn is_preparing(&self) -> bool {
        !self.preparing.is_empty()
    }

    /// Gives up what is prepared. The plan before goes on, if there is one.
    pub fn stop_preparing(&mut self) {
        self.preparing.clear();
    }

    /// How far the render has come.
    pub fn progress(&self) -> Progress {
        let prepared = self.preparing.last().map(|last| last.task.progress());
        let run = || self.run.as_ref().map(Run::progress);
        prepared.or_else(run).unwrap_or_default()
    }

    /// The picture as far as it is made: first the fronts of the coarse levels, then colours.
    /// `None` without [`Extras::shown`], before the first run, or if the image has a window or is
    /// larger than a texture can be. Its bytes are those of sRGB, as files hold them.
    pub fn picture(&self) -> Option<&wgpu::Texture> {
        self.run.as_ref()?.picture()
    }

    /// The blocks of the picture, row by row, and how many of them, from the first on, have all their
    /// samples. `None` before the run of the last plan.
    pub fn blocks(&self) -> Option<(Vec<Block>, usize)> {
        let run = self.run.as_ref().filter(|_| !self.is_preparing())?;
        Some((run.job.blocks().collect(), run.collected))
    }

    /// Waits for the device and reads the picture, row by row, four bytes to a pixel.
    ///
    /// # Errors
    /// The device failed.
    #[cfg(feature = "cli")]
    pub fn pixels(&self) -> Result<Vec<u8>, RenderError> {
        let picture = self.picture();
        let read = picture.map(|picture| read_picture(&self.shared.device, picture));
        Ok(read.transpose()?.unwrap_or_default())
    }

    /// How the host and the device worked together so far.
    pub fn traffic(&self) -> Traffic {
        self.run.as_ref().map(Run::traffic).unwrap_or_default()
    }

    /// Submits about so many milliseconds of work, but at most two submissions at once. It
    /// never waits.
    ///
    /// # Errors
    /// The device failed, a named file cannot be read or does not fit, a cone map cannot be made,
    /// or a shader text is wrong. The plan before goes on then, if there is one.
    pub fn advance(&mut self, budget_ms: f64) -> Result<(), RenderError> {
        self.receive()?;
        let advanced = match &mut self.run {
            Some(run) => run.advance(budget_ms),
            None => Ok(()),
        };
        self.seen(advanced)
    }

    /// The frame, once it is finished, and once only. It never waits.
    ///
    /// # Errors
    /// Those of [`Work::advance`], or the device left cells unvisited. A work that has failed and has no
    /// plan to go back to is cancelled.
    pub fn poll(&mut self) -> Result<Option<Frame>, RenderError> {
        self.receive()?;
        match (&mut self.run, self.preparing.last()) {
            (_, Some(_)) => Ok(None),
            (Some(run), None) => {
                let polled = run.poll();
                self.seen(polled)
            }
            (None, None) => Err(RenderError::Cancelled),
        }
    }

    /// A frame whose cells were left out never comes.
    fn seen<T>(&mut self, answer: Result<T, RenderError>) -> Result<T, RenderError> {
        if let Err(RenderError::Unwritten { .. }) = answer {
            self.run = None;
        }
        answer
    }

    /// Waits for the frame. `watch` is told of each pass that has ended, and of the progress in
    /// a long pass.
    ///
    /// # Errors
    /// [`RenderError::Cancelled`] if `watch` returns `false`, and those of [`Work::poll`].
    #[cfg(feature = "cli")]
    pub fn finish(mut self, watch: Watch<'_>) -> Result<Frame, RenderError> {
        let frame = self.wait_for_frame(watch);
        if let Err(RenderError::Device(_)) = frame {
            // A lost device reports other errors first.
            self.shared.device.trouble()?;
        }
        frame
    }

    #[cfg(feature = "cli")]
    fn wait_for_frame(&mut self, watch: Watch<'_>) -> Result<Frame, RenderError> {
        while let Some(last) = self.preparing.last() {
            if !watch(&last.task.progress()) {
                return Err(RenderError::Cancelled);
            }
            let answer = last.task.wait();
            self.answered(answer)?;
        }
        let (mut told, mut most) = (0, 0.0_f64);
        // A pass that has ended is told of after the progress beyond it.
        let mut tell = |mut now: Progress| {
            most = most.max(now.done);
            now.done = most;
            watch(&now)
        };
        loop {
            self.advance(SUBMISSION_MS)?;
            // Software Vulkan runs a submission before the next call returns: ask before that.
            if !tell(self.progress()) {
                return Err(RenderError::Cancelled);
            }
            if let Some(run) = &mut self.run {
                run.fill(SUBMISSION_MS);
            }
            let frame = self.poll()?;
            let Some(run) = &mut self.run else {
                return Err(RenderError::Cancelled);
            };
            for progress in run.news(told) {
                if !tell(progress) {
                    return Err(RenderError::Cancelled);
                }
                self.shared.device.check()?;
            }
            told = run.reached;
            if let Some(frame) = frame {
                return Ok(frame);
            }
            if run.is_delivered() {
                return Err(RenderError::Cancelled);
            }
            run.wait()?;
        }
    }

    /// The programs and sizes of the run under way.
    pub(super) fn needs(&self) -> Option<Needs> {
        self.run.as_ref()?.reusable.needs()
    }

    pub(super) fn extras(&self) -> Extras {
        self.extras
    }
}
