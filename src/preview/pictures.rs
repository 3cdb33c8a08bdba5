//! The pictures of a plan that changes: a small one at once, a full one when the plan rests, and
//! then, if the plan has several samples, a fine one.
//!
//! Each of the three has its own render under way, so that none makes the buffers of another
//! again. A small picture is always finished, however fast the plan changes: else a flight would
//! show nothing. The others stop as soon as the plan changes.

use std::sync::Arc;

use crate::base::key::Redo;
use crate::gpu::RenderError;
use crate::gpu::device::Device;
use crate::gpu::render::Renderer;
use crate::pass::progress::Progress;
use crate::picture::frame::{Frame, Traffic};
use crate::plan::{Extras, Plan};
use crate::preview::draw::copy_blocks;
use crate::preview::picture::{Picture, redo};
use crate::scene::Assets;

/// Milliseconds of work that are submitted at once. What was submitted must end before another plan
/// begins, and a drawing of the window waits for it.
const SLICE_MS: f64 = 5.0;
/// The same of full pictures. Small slices cost them time.
const FULL_SLICE_MS: f64 = 9.0;
/// The time that a small picture should take, in milliseconds. Below the first it becomes larger,
/// above the second smaller.
const AIM_MS: [f64; 2] = [11.0, 36.0];
/// So many times decide about the size.
const RECENT: usize = 5;
/// Divisors of the size of a small picture.
const DIVISORS: [u32; 5] = [1, 2, 4, 6, 8];
/// A full picture that takes no longer than this needs no small one before it.
const AT_ONCE_MS: f64 = 14.0;
/// The same of a picture with another look, at rest: it keeps the rays.
const LOOK_AT_ONCE_MS: f64 = 700.0;
/// The fine picture is shown whenever so much more of it is done.
const FINER: f64 = 0.125;

/// A finished picture.
pub struct Finished<'a> {
    /// The number of its plan.
    pub wish: u64,
    /// Whether it is a full one.
    pub is_full: bool,
    /// Its bytes on the device.
    pub texture: Option<&'a wgpu::Texture>,
    /// Its layers.
    pub frame: &'a Frame,
    /// Its plan.
    pub plan: &'a Plan,
}

/// The pictures of a plan that changes.
pub struct Pictures {
    /// Renders them.
    pub renderer: Renderer,
    /// Heights, maps and textures.
    pub assets: Assets,
    extras: Extras,
    /// Whether nothing but colours is asked for.
    is_plain: bool,
    /// What is wanted, counted from 1.
    wish: u64,
    /// The wish that cannot be rendered.
    failed: Option<u64>,
    plan: Option<Plan>,
    /// Whether the plan goes on changing, so that only small pictures are made.
    pub moving: bool,
    divisor: usize,
    /// The last times of small pictures.
    recent: Vec<f64>,
    /// Whether small pictures are to be larger from the next rest on.
    larger: bool,
    small: Picture,
    full: Picture,
    fine: Picture,
    /// The share that is shown of a fine picture of one block, and the blocks of a larger one.
    fine_share: f64,
    fine_blocks: usize,
}

impl Pictures {
    /// No pictures yet.
    pub fn new(device: Arc<Device>) -> Self {
        Self {
            renderer: Renderer::sharing(device),
            assets: Assets::default(),
            extras: Self::extras_of(Extras::default()),
            is_plain: false,
            wish: 0,
            failed: None,
            plan: None,
            moving: false,
            divisor: 2,
            recent: Vec::new(),
            larger: false,
            small: Picture::default(),
            full: Picture::default(),
            fine: Picture::default(),
            fine_share: 0.0,
            fine_blocks: 0,
        }
    }

    fn extras_of(extras: Extras) -> Extras {
        Extras {
            shown: true,
            reuse: true,
            ..extras
        }
    }

    /// Keeps other layers from now on. If nothing but colours is asked for, the picture may have
    /// several samples.
    pub fn keep(&mut self, extras: Extras, is_plain: bool) {
        let extras = Self::extras_of(extras);
        self.is_plain = is_plain;
        if extras != self.extras {
            self.extras = extras;
            self.forget();
        }
    }

    /// Makes everything again: shader texts or files have changed.
    pub fn forget(&mut self) {
        for picture in [&mut self.small, &mut self.full, &mut self.fine] {
            picture.work = None;
            picture.under_way = None;
            picture.made = None;
        }
        self.wish += 1;
    }

    /// Asks for pictures of a plan that passes [`Plan::check`].
    pub fn want(&mut self, plan: &Plan) {
        if self.plan.as_ref() != Some(plan) {
            self.wish += 1;
            self.plan = Some(plan.clone());
        }
    }

    /// Makes no more of them until [`Pictures::want`] asks again.
    pub fn rest(&mut self) {
        self.fail();
        self.plan = None;
    }

    /// Makes the pictures again with other texts of shaders. Until they are compiled, the old
    /// programs stay.
    pub fn again(&mut self) {
        self.wish += 1;
    }

    /// The number of the plan that is wanted; it grows with every change.
    pub fn wish(&self) -> u64 {
        self.wish
    }

    /// Gives up what cannot be rendered, until another plan comes.
    fn fail(&mut self) {
        self.small.under_way = None;
        self.full.under_way = None;
        if self.fine.under_way.take().is_some() && self.fine_blocks > 0 {
            // A full picture with some blocks of the fine one is neither.
            self.full.made = None;
        }
        self.failed = Some(self.wish);
    }

    /// The small picture's plan. It has no cones where they are optional: so few pixels share few
    /// steps, and cones that come and go with the view would make other buffers.
    fn small_plan(&mut self, plan: &Plan) -> Plan {
        if !self.moving && std::mem::take(&mut self.larger) {
            self.divisor -= 1;
        }
        let mut small = plan.one_sample();
        let divisor = DIVISORS[self.divisor];
        small.size = plan.size.map(|n| n.div_ceil(divisor).max(1));
        let optional = plan.scene.formula().is_some() && plan.march.may_drop_cones();
        // Who looks at the levels wants to see some.
        if optional && !self.extras.levels {
            small.march.coarsest = Some(1);
        }
        small
    }

    /// The full picture's plan. If a fine one follows, it need not have its details. Layers but the
    /// colour are those of one sample.
    fn full_plan(&self, plan: &Plan) -> Plan {
        match plan.samples > 1 && self.is_plain {
            true => plan.one_sample(),
            false => Plan {
                samples: 1,
                ..plan.clone()
            },
        }
    }

    /// Whether the full picture of a plan comes at once.
    fn is_quick(&self, plan: &Plan) -> bool {
        let Some((_, made)) = self.full.made.as_ref() else {
            return false;
        };
        let within = |most| self.full.took_ms.is_some_and(|ms| ms <= most);
        // Only what a change makes again takes time.
        let is_quick = match redo(made, &self.full_plan(plan)) {
            Redo::Nothing | Redo::Tone => true,
            Redo::Color if !self.moving => within(LOOK_AT_ONCE_MS),
            _ => within(AT_ONCE_MS),
        };
        made.size == plan.size && is_quick
    }

    /// Submits some work and never waits. Returns whether a picture was finished, which
    /// [`Pictures::finished`] has then.
    ///
    /// # Errors
    /// As [`Work::advance`](crate::gpu::work::Work::advance). Nothing more is tried until another
    /// plan comes.
    pub fn advance(&mut self) -> Result<bool, RenderError> {
        let advanced = self.try_advance();
        if advanced.is_err() {
            self.fail();
        }
        advanced
    }

    fn try_advance(&mut self) -> Result<bool, RenderError> {
        let pictures = [&self.small, &self.full, &self.fine];
        if pictures.iter().all(|picture| picture.under_way.is_none()) {
            // Pictures ask as they go on.
            self.renderer.device.check()?;
        }
        let Some(plan) = self.plan.clone() else {
            return Ok(false);
        };
        if self.failed == Some(self.wish) {
            return Ok(false);
        }
        for picture in [&mut self.full, &mut self.fine] {
            picture.stop_preparing(self.wish, &plan);
            // What is in flight ends by itself.
            picture.under_way.take_if(|(of, _)| *of != self.wish);
        }
        // A flight over heights that are still made would have no end of them.
        if !self.moving || self.assets.serve(&plan) {
            self.small.stop_preparing(self.wish, &plan);
        }
        if self.small.under_way.is_some() {
            let finished = self.small.advance(SLICE_MS)?;
            if finished {
                self.follow_time();
            }
            return Ok(finished && !self.full.is_made(self.wish));
        }
        if self.full.is_made(self.wish) {
            return self.refine(&plan);
        }
        if self.full.under_way.is_none() {
            if !self.small.is_made(self.wish) && !self.is_quick(&plan) {
                let small = (self.wish, self.small_plan(&plan));
                let assets = &self.assets;
                // A slider that passes through zero must not wait for a compiler.
                let extras = Extras {
                    held: true,
                    ..self.extras
                };
                self.small
                    .begin(&mut self.renderer, assets, extras, small)?;
                return self.small.advance(SLICE_MS);
            }
            if self.moving && !self.is_quick(&plan) {
                return Ok(false);
            }
            let full = (self.wish, self.full_plan(&plan));
            let assets = &self.assets;
            self.full
                .begin(&mut self.renderer, assets, self.extras, full)?;
        }
        self.full.advance(FULL_SLICE_MS)
    }

    /// Whether the full picture of what is wanted is to be followed by a fine one, which is not
    /// there yet.
    fn is_coarse(&self) -> bool {
        let samples = self.plan.as_ref().map_or(1, |plan| plan.samples);
        // Layers but the colour are those of one sample, and so are the figures of passes.
        samples > 1 && self.is_plain && !self.moving && !self.fine.is_made(self.wish)
    }

    /// Goes on with the fine picture. Returns whether there is more of it to show.
    fn refine(&mut self, plan: &Plan) -> Result<bool, RenderError> {
        if !self.is_coarse() {
            return Ok(false);
        }
        if self.fine.under_way.is_none() {
            (self.fine_share, self.fine_blocks) = (0.0, 0);
            let fine = (self.wish, plan.clone());
            let assets = &self.assets;
            self.fine
                .begin(&mut self.renderer, assets, self.extras, fine)?;
        }
        let finished = self.fine.advance(FULL_SLICE_MS)?;
        // What the host reads, it reads at the end.
        if finished || !self.extras.unread {
            return Ok(finished);
        }
        Ok(self.show_finer(plan.samples).unwrap_or(false))
    }

    /// Shows more of the fine picture: all of it if it is of one block. Else the further blocks that have all
    /// their samples are copied into the full picture. Returns whether there is more, and `None` while
    /// the fine picture is still prepared.
    fn show_finer(&mut self, samples: u32) -> Option<bool> {
        let (fine, full) = (self.fine.work.as_ref()?, self.full.work.as_ref()?);
        let (blocks, finished) = fine.blocks()?;
        if blocks.len() > 1 {
            let more = blocks.get(self.fine_blocks..finished)?;
            let (from, to) = (fine.picture()?, full.picture()?);
            copy_blocks(&self.renderer.device, from, to, more);
            self.fine_blocks = finished;
            return Some(!more.is_empty());
        }
        let done = fine.progress().done;
        // A first sample off the centre is no better than the full picture.
        let is_finer = done >= self.fine_share + FINER && done * f64::from(samples) > 2.0;
        if is_finer {
            self.fine_share = done;
        }
        Some(is_finer)
    }

    /// Chooses the size of small pictures by the middle of the last times. Other sizes need other
    /// buffers, so the size grows at rest only. It shrinks too if a flight would stutter.
    fn follow_time(&mut self) {
        self.recent.extend(self.small.took_ms);
        if self.recent.len() < RECENT {
            return;
        }
        let mut times = std::mem::take(&mut self.recent);
        times.sort_by(f64::total_cmp);
        let ms = times[RECENT / 2];
        if ms > AIM_MS[1] && self.divisor + 1 < DIVISORS.len() {
            self.divisor += 1;
        } else if ms < AIM_MS[0] && self.divisor > 1 {
            // Until the next rest.
            self.larger = true;
        }
    }

    /// The best picture that there is: the full one of what is wanted, with as many samples as are
    /// made of the fine one, else the small one.
    pub fn finished(&self) -> Option<Finished<'_>> {
        let is_full = self.full.is_made(self.wish);
        let picture = if is_full { &self.full } else { &self.small };
        let (wish, plan) = picture.made.as_ref()?;
        let under_way = matches!(self.fine.under_way, Some((of, _)) if of == self.wish);
        let is_finer = (under_way && self.fine_share > 0.0) || self.fine.is_made(self.wish);
        let shown = match is_full && is_finer {
            true => &self.fine,
            false => picture,
        };
        Some(Finished {
            wish: *wish,
            is_full,
            texture: shown.work.as_ref()?.picture(),
            frame: shown.frame.as_ref().or(picture.frame.as_ref())?,
            plan,
        })
    }

    /// Whether the full picture of the plan is made, and nothing has failed since.
    pub fn is_right(&self) -> bool {
        self.full.is_made(self.wish) && self.failed != Some(self.wish)
    }

    /// Whether there is something to do.
    pub fn is_busy(&self) -> bool {
        let wanted = self.plan.is_some() && self.failed != Some(self.wish);
        let unmade = !self.full.is_made(self.wish) || self.is_coarse();
        self.small.under_way.is_some() || wanted && unmade && !self.rests()
    }

    /// Whether a flight waits for its next change.
    fn rests(&self) -> bool {
        self.moving && self.small.is_made(self.wish) && self.full.under_way.is_none()
    }

    /// Whether the full picture of what is wanted is there.
    pub fn is_full(&self) -> bool {
        self.full.is_made(self.wish)
    }

    /// What is under way.
    pub fn progress(&self) -> Option<Progress> {
        let under_way = [&self.fine, &self.full, &self.small].into_iter();
        let mut under_way = under_way.filter(|picture| picture.under_way.is_some());
        Some(under_way.next()?.work.as_ref()?.progress())
    }

    /// The times of the last small and of the last full picture, in milliseconds.
    pub fn times(&self) -> [Option<f64>; 2] {
        [self.small.took_ms, self.full.took_ms]
    }

    /// Buffers that were made and programs that were compiled so far, over all pictures.
    pub fn traffic(&self) -> Traffic {
        Traffic {
            allocations: self.sum(|picture| picture.allocations as usize) as u32,
            compilations: self.sum(|picture| picture.compilations),
            uploads: self.sum(|picture| picture.uploads),
            ..Traffic::default()
        }
    }

    fn sum(&self, of: fn(&Picture) -> usize) -> usize {
        [&self.small, &self.full, &self.fine].map(of).iter().sum()
    }
}
