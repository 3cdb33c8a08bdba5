//! What a frame needs before its first submission: assets, programs, and arrays on the device.
//!
//! If earlier frames have left everything that a [`FrameRequest`] needs, it becomes [`FrameInputs`]
//! at once. Otherwise a thread prepares them.

use std::sync::{Arc, MutexGuard, PoisonError};

use bytemuck::{bytes_of, cast_slice};

use super::job::{Job, Made};
use super::{Arrays, Shared};
use crate::base::array::SceneArray;
use crate::base::one_value_cache::last_or_new;
use crate::base::shader::{Program, Sources};
use crate::gpu::array::DeviceArray;
use crate::gpu::background::all_at_once;
use crate::gpu::error::RenderError;
use crate::gpu::kernel::Kernel;
use crate::gpu::render::Cutting;
use crate::gpu::target::{Needs, Parameters};
use crate::gpu::task_status::TaskStatus;
use crate::gpu::texts::{Edited, Texts};
use crate::heightfield::assets::Preparation;
use crate::heightfield::tracer::settings::PrepareError;
use crate::pass::layers;
use crate::pass::layout::Layout;
use crate::pass::look::Light;
use crate::pass::progress::{Progress, Watch};
use crate::pass::tone::tone_steps;
use crate::pass::tone_map::Tone;
use crate::pass::turn::{self, StageKind};
use crate::picture::frame::{Frame, Traffic};
use crate::plan::look::LightMode;
use crate::plan::march::Marching;
use crate::plan::{Extras, Pass, Plan, UNTIL_TILE};
use crate::scene::{AnySolid, Assets};

/// The largest step limit of a dispatch. With a block of a million pixels it stays far below
/// the time limit of drivers.
const MOST_STEPS_AT_ONCE: u32 = 256;

/// The largest number of loop rounds of an invocation in one dispatch. Mesa's software Vulkan
/// silently ends every loop after 65 535 rounds: at 287 iterations and 256 steps all pixels
/// were wrong. The rest is left to loops that are not counted.
const MOST_ROUNDS_AT_ONCE: u32 = 60_000;

/// The largest step limit of a dispatch over a scene.
pub fn most_steps(scene: &AnySolid) -> u32 {
    let rounds = scene.twin().rounds().saturating_add(1);
    (MOST_ROUNDS_AT_ONCE / rounds).clamp(1, MOST_STEPS_AT_ONCE)
}

/// The parameters of cones and rays by the names of the WGSL variables.
pub fn marched(plan: &Plan, scene: &AnySolid) -> Parameters {
    let view = bytes_of(&plan.view().uniform()).to_vec();
    let own = scene.twin().uniforms().into_iter();
    own.chain([("view_parameters", view)]).collect()
}

/// What a scene and its sky bring to the device.
fn arrays_of(scene: &AnySolid, light: &Light) -> Vec<SceneArray> {
    let mut all = scene.twin().arrays();
    all.extend(light.sky.iter().flat_map(|file| file.sky.arrays()));
    all
}

/// A frame that is asked for.
pub struct FrameRequest {
    pub plan: Plan,
    /// The march that was asked for, as that of the plan is resolved.
    pub march: Marching,
    /// Whether rays start without cones although the plan has cone levels.
    pub rays_alone: bool,
    /// A copy of what is there, which no other thread changes.
    pub assets: Assets,
    /// Where new assets go.
    pub all_assets: Assets,
    pub extras: Extras,
    pub cutting: Cutting,
    pub sources: Option<Sources>,
    /// What the last frame had. Its programs may stay.
    pub held: Option<Needs>,
    pub shared: Arc<Shared>,
}

/// A frame that can begin.
pub struct FrameInputs {
    pub job: Job,
    pub frame: Frame,
    pub needs: Needs,
    pub parameters: Parameters,
    pub kernels: Vec<Arc<Kernel>>,
    pub arrange: Arc<Kernel>,
    pub arrays: Vec<DeviceArray>,
    /// The shader texts of the host, and the programs if they have some.
    pub texts: Texts,
    pub edited: Option<Edited>,
}

/// The programs of a frame, and what follows from the plan besides.
struct Draft {
    scene: AnySolid,
    kinds: Vec<StageKind>,
    blocks: Vec<Layout>,
    needs: Needs,
    arrange: Program,
    texts: Texts,
}

impl FrameRequest {
    /// The inputs, unless an asset, an array on the device or a program is missing.
    ///
    /// # Errors
    /// A scene's settings do not fit.
    pub fn at_once(&self) -> Result<Option<FrameInputs>, RenderError> {
        // Another thread may be uploading arrays, which takes long.
        let Ok(arrays) = self.shared.arrays.try_lock() else {
            return Ok(None);
        };
        if !self.assets.serve(&self.plan) {
            return Ok(None);
        }
        let draft = self.draft()?;
        let known = |program| self.shared.kernels.known(program);
        let kernels: Option<Vec<_>> = draft.needs.programs.iter().map(known).collect();
        let (Some(kernels), Some(_)) = (kernels, known(&draft.arrange)) else {
            return Ok(None);
        };
        let light = self.light(&draft.scene)?;
        if arrays.lacks(&kernels, &arrays_of(&draft.scene, &light)) {
            return Ok(None);
        }
        let maps = self.plan.scene.preparations(&self.assets);
        let kept = maps.into_iter().map(|map| (map, 0.0)).collect();
        self.complete(draft, kept, Some(arrays), &mut |_| true)
            .map(Some)
    }

    /// Resolves the plan, as far as its assets are there.
    pub fn resolve(&mut self) {
        let extras = self.extras;
        let mut plan = self.plan.clone();
        plan.march = self.march.clone();
        let may_drop = plan.march.may_drop_cones();
        // Cones have too few cells to keep a large device busy, and save its rays little.
        let is_large = self.shared.device.is_discrete() && may_drop;
        if is_large {
            plan.march.coarsest = Some(1);
        }
        let mut resolved = plan.resolved(extras, &self.assets).into_owned();
        // Frames that follow each other keep the stages of cones if these may come and go, or a move of
        // the eye would make buffers and programs. The first picture is of cones too.
        let may_come = extras.reuse && may_drop && !is_large;
        self.rays_alone = (extras.sketched && may_drop || may_come)
            && !extras.levels
            && !resolved.march.may_drop_cones();
        if self.rays_alone {
            resolved.march.coarsest = None;
        }
        self.plan = resolved;
    }

    /// Loads and makes what is missing.
    ///
    /// # Errors
    /// The device fails, a named file cannot be read or does not fit, a cone map cannot be made, a
    /// shader text is wrong, or nobody waits any more. What was compiled and uploaded stays.
    pub fn prepare(mut self, told: &TaskStatus) -> Result<FrameInputs, RenderError> {
        let mut tell = |progress: &Progress| told.tell(progress);
        let shared = self.shared.clone();
        let now = self.all_assets.snapshot(false);
        if now.serve(&self.plan) {
            self.assets = now;
        }
        let maps = match self.assets.serve(&self.plan) {
            true => shared.make_maps(&self.plan, &self.assets, &mut tell)?,
            false => {
                // Only who has the turn changes what others share.
                let _turn = shared.wait_to_prepare(&mut tell)?;
                let maps = shared.make_maps(&self.plan, &self.all_assets, &mut tell)?;
                self.all_assets
                    .load(&self.plan)
                    .map_err(PrepareError::from)?;
                self.assets = self.all_assets.snapshot(true);
                maps
            }
        };
        // Heights decide about cones.
        self.resolve();
        loop {
            let draft = self.draft()?;
            let all = draft.needs.programs.iter().chain([&draft.arrange]);
            let edited = draft.texts.edited(all);
            let (error, edited) =
                match (self.complete(draft, maps.clone(), None, &mut tell), edited) {
                    (Err(RenderError::Kernel(error)), Some(edited)) => (error, edited),
                    (made, _) => return made,
                };
            if !shared.texts.skips(&edited, &error) {
                if !tell(&told.progress()) {
                    return Err(RenderError::Cancelled);
                }
                // Other threads know at once.
                shared.texts.failed(&edited, &error);
                return Err(error.into());
            }
        }
    }

    fn draft(&self) -> Result<Draft, RenderError> {
        let Self { plan, extras, .. } = self;
        let scene = plan.scene.solid(&plan.viewpoint(), &self.assets)?;
        let coarsest = plan.coarsest();
        // Tiles that end alone lie within a block.
        let step = match plan.is_adaptive() {
            true => coarsest.max(UNTIL_TILE),
            false => coarsest,
        };
        let blocks = plan.pixels().cut(self.cutting.edge(), step);
        let marked = scene.twin().marks_hits();
        let normals = extras.normals || plan.has_variance(*extras);
        let layers = match (extras.depth_only, normals) {
            (true, _) => 0,
            (false, normals) => 1 + u32::from(normals) + u32::from(plan.is_adaptive()),
        };
        let blocks = Layout::of_blocks(&blocks, coarsest, extras.count, marked, layers);
        let limits = self.shared.device.device.limits();
        let largest = limits.max_texture_dimension_2d;
        let fits = plan.window.is_none() && plan.size.iter().all(|n| *n <= largest);
        let shown = extras.shown && fits;
        let some = [shown, shown && extras.sketched, plan.is_adaptive()];
        let kinds = StageKind::all(&plan.passes(*extras), some);
        let programs = kinds.iter().map(|k| k.program(plan, &scene, *extras));
        let mut programs: Vec<Program> = [turn::arrange()].into_iter().chain(programs).collect();
        let texts = self.shared.texts.put(self.sources.as_ref(), &mut programs);
        let arrange = programs.remove(0);
        let held = self.held.as_ref().filter(|_| extras.held);
        let program = |lean: Program| {
            let held = held.and_then(|needs| needs.held(&lean));
            held.unwrap_or(lean)
        };
        let needs = Needs {
            programs: programs.into_iter().map(program).collect(),
            picture: shown.then_some(plan.size),
            // The first block is as large as any.
            layout: blocks[0].clone(),
        };
        Ok(Draft {
            scene,
            kinds,
            blocks,
            needs,
            arrange,
            texts,
        })
    }

    fn light(&self, scene: &AnySolid) -> Result<Light, RenderError> {
        let sky = self.assets.sky(&self.plan).map_err(PrepareError::from)?;
        Ok(Light::of(&self.plan, scene).with_sky(sky))
    }

    fn complete(
        &self,
        draft: Draft,
        map_times: Vec<(Preparation, f64)>,
        arrays: Option<MutexGuard<'_, Arrays>>,
        tell: Watch<'_>,
    ) -> Result<FrameInputs, RenderError> {
        let Self { plan, extras, .. } = self;
        let (scene, needs) = (draft.scene, draft.needs);
        let marched = marched(plan, &scene);
        let light = self.light(&scene)?;
        let mut look = bytes_of(&light.parameters()).to_vec();
        let mut parameters = marched.clone();
        parameters.push(("look_parameters", look.clone()));
        // They are there without layers too: a program with layers may follow.
        let over = bytes_of(&layers::uniform(&light)).to_vec();
        look.extend_from_slice(&over);
        parameters.push(("layers_parameters", over));
        if needs.picture.is_some() || plan.is_adaptive() {
            let tone = Tone::of(&plan.look);
            let made = |tone: &Tone| Ok::<_, RenderError>(tone_steps(tone));
            let steps = last_or_new(&self.shared.tone_steps, tone, made)?;
            parameters.push(("tone_steps", cast_slice(&steps).to_vec()));
            parameters.push(("tone_parameters", bytes_of(&tone.uniform()).to_vec()));
        }
        let mut traffic = Traffic::default();
        let device = &self.shared.device;
        let compile = |program: &Program| self.shared.kernels.get(device, program);
        let mut new: Vec<Program> = Vec::new();
        for program in needs.programs.iter().chain([&draft.arrange]) {
            if self.shared.kernels.known(program).is_none() && !new.contains(program) {
                new.push(program.clone());
            }
        }
        traffic.compilations = new.len();
        let compile_first = Progress {
            pass: "compile".into(),
            ..Progress::default()
        };
        if !new.is_empty() && !tell(&compile_first) {
            return Err(RenderError::Cancelled);
        }
        // Coarse levels are shown before all programs are compiled.
        let warms = !extras.sketched;
        for kernel in all_at_once(&new, compile) {
            let kernel = kernel?;
            if warms {
                kernel.warm(device)?;
            }
        }
        #[cfg(feature = "cli")]
        if warms && !new.is_empty() {
            device.wait_beside(|| tell(&compile_first))?;
            if !tell(&compile_first) {
                return Err(RenderError::Cancelled);
            }
        }
        let kernels = needs.programs.iter().map(compile);
        let kernels: Vec<_> = kernels.collect::<Result<_, _>>()?;
        let arrange = compile(&draft.arrange)?;
        let all = needs.programs.iter().chain([&draft.arrange]);
        let edited = draft.texts.edited(all);
        // What was given up leaves the arrays as they are.
        if !tell(&compile_first) {
            return Err(RenderError::Cancelled);
        }
        let lock = || self.shared.arrays.lock();
        let mut arrays = arrays.unwrap_or_else(|| lock().unwrap_or_else(PoisonError::into_inner));
        let uploads = &mut traffic.uploads;
        let read = arrays_of(&scene, &light);
        let arrays = arrays.keep(device, &kernels, read, uploads)?;
        let color = StageKind::Pass(Pass::Color);
        let colors = draft.kinds.iter().position(|kind| *kind == color);
        let colors = colors.unwrap_or(draft.kinds.len());
        let first_stages = match draft.blocks.len() {
            1 => 0,
            _ => StageKind::first_picture(&draft.kinds),
        };
        let firsts = match first_stages {
            0 => &[],
            _ => &draft.blocks[..],
        };
        let visits = draft.blocks.iter().flat_map(|block| {
            let block = block.clone();
            (0..plan.visits()).map(move |_| block.clone())
        });
        let most = most_steps(&scene);
        let mut frame = Frame::blank(plan, *extras);
        frame.traffic = Some(traffic);
        Ok(FrameInputs {
            job: Job {
                firsts: firsts.len(),
                first_stages,
                follows_light: plan.look.mode == LightMode::Path,
                iterations: plan.scene.iterations(&plan.viewpoint()),
                samples: plan.samples,
                visits: plan.visits(),
                until: plan.until,
                kinds: draft.kinds,
                colors_at: colors,
                made: Made {
                    rays_alone: self.rays_alone,
                    passes: plan.passes(*extras),
                    blocks: firsts.iter().cloned().chain(visits).collect(),
                    ray_steps: plan.ray_steps(&scene),
                    marched,
                    look,
                    colors: needs.programs[colors..].to_vec(),
                },
                steps: [self.cutting.chunk.clamp(1, most), most],
                extras: *extras,
                map_times,
            },
            frame,
            needs,
            parameters,
            kernels,
            arrange,
            arrays,
            texts: draft.texts,
            edited,
        })
    }
}
