//! A picture that is made again and again.

use crate::base::clock::clock;
use crate::base::key::Redo;
use crate::gpu::RenderError;
use crate::gpu::render::Renderer;
use crate::gpu::work::Work;
use crate::picture::frame::Frame;
use crate::plan::{Extras, Plan};
use crate::scene::Assets;

/// The small, the full or the fine picture.
#[derive(Default)]
pub struct Picture {
    pub work: Option<Work>,
    /// What is rendered, and the number of the wish.
    pub under_way: Option<(u64, Plan)>,
    /// The wish that was finished last, and its plan.
    pub made: Option<(u64, Plan)>,
    pub began: f64,
    pub took_ms: Option<f64>,
    pub frame: Option<Frame>,
    /// Sums over all frames.
    pub uploads: usize,
    pub allocations: u32,
    pub compilations: usize,
}

impl Picture {
    /// Begins to render a plan.
    pub fn begin(
        &mut self,
        renderer: &mut Renderer,
        assets: &Assets,
        extras: Extras,
        wish: (u64, Plan),
    ) -> Result<(), RenderError> {
        self.began = clock();
        let plan = &wish.1;
        match &mut self.work {
            Some(work) => renderer.set(work, plan, assets)?,
            None => self.work = Some(renderer.begin(plan, assets, extras)?),
        }
        self.under_way = Some(wish);
        Ok(())
    }

    /// Goes on. Returns whether the picture is finished.
    pub fn advance(&mut self, budget_ms: f64) -> Result<bool, RenderError> {
        let Some(work) = self.work.as_mut().filter(|_| self.under_way.is_some()) else {
            return Ok(false);
        };
        work.advance(budget_ms)?;
        let Some(frame) = work.poll()? else {
            return Ok(false);
        };
        let traffic = frame.traffic.unwrap_or_default();
        self.uploads += traffic.uploads;
        self.allocations += traffic.allocations;
        self.compilations += traffic.compilations;
        self.took_ms = Some(clock() - self.began);
        self.made = self.under_way.take();
        self.frame = Some(frame);
        Ok(true)
    }

    /// Gives up another wish whose heights or maps are still made, which may take minutes, if this one
    /// needs others.
    pub fn stop_preparing(&mut self, wish: u64, plan: &Plan) {
        let Some((_, other)) = self.under_way.as_ref().filter(|(of, _)| *of != wish) else {
            return;
        };
        let prepares = self.work.as_ref().is_some_and(Work::is_preparing);
        if prepares && redo(other, plan) == Redo::Assets {
            self.under_way = None;
            if let Some(work) = &mut self.work {
                work.stop_preparing();
            }
            // Without a plan to go back to, the work is over.
            self.work.take_if(|work| work.picture().is_none());
        }
    }

    pub fn is_made(&self, wish: u64) -> bool {
        self.made.as_ref().is_some_and(|(made, _)| *made == wish)
    }
}

/// The most that the change from one plan to another makes again.
pub fn redo(from: &Plan, to: &Plan) -> Redo {
    if from.scene.kind() != to.scene.kind() || from.scene.formula() != to.scene.formula() {
        return Redo::Assets;
    }
    let (mut from, mut to) = (from.clone(), to.clone());
    let sections = crate::preset::SECTIONS.into_iter();
    let changes = sections.flat_map(|section| {
        // Keys hold their ranges and values as text. To write it takes much of the host's time in a
        // flight, which changes the camera alone.
        let same = match section {
            "scene" => from.scene == to.scene,
            "camera" => from.camera == to.camera,
            "march" => from.march == to.march,
            "look" => from.look == to.look,
            _ => false,
        };
        if same {
            return Vec::new();
        }
        let old = from.keys(section).unwrap_or_default();
        let new = to.keys(section).unwrap_or_default();
        let pairs = old.into_iter().zip(new);
        let changed = pairs.filter(|(old, new)| old.slot.get() != new.slot.get());
        let redo = changed.filter_map(|(old, _)| old.redo);
        redo.collect::<Vec<_>>()
    });
    changes.max().unwrap_or(Redo::Nothing)
}
