//! From a Plan to a Frame on a wgpu device.
//!
//! A [`Renderer`] keeps compiled kernels and buffers between calls. Large images are cut into
//! blocks, and a pass into dispatches of a bounded number of steps, each for the cells that
//! still move. Neither changes a bit of the picture.

use std::sync::{Arc, Mutex, PoisonError};

use bytemuck::bytes_of;

use crate::base::shader::{Program, Sources};
use crate::gpu::conemap::generate::Maker;
use crate::gpu::cost::{Cost, LONGEST_MS};
use crate::gpu::device::Device;
pub use crate::gpu::error::RenderError;
use crate::gpu::pick::Pick;
use crate::gpu::stamps::Stamps;
use crate::gpu::target::{Needs, Parameters, Target};
use crate::gpu::work::{Job, Kept, Made, Shared, Work};
use crate::heightfield::assets::Preparation;
use crate::pass::look::Light;
use crate::pass::pick::{self, At, PickQuestion};
use crate::pass::prepare::prepare;
use crate::pass::progress::Watch;
use crate::pass::tone::tone_steps;
use crate::pass::turn::{self, StageKind};
use crate::picture::frame::{Frame, Traffic};
use crate::plan::pyramid::Block;
use crate::plan::{Extras, Plan};
use crate::scene::{AnySolid, Assets};

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

/// The largest step limit of a dispatch. With a block of a million pixels it stays far below
/// the time limit of drivers.
const MOST_STEPS_AT_ONCE: u32 = 256;

/// The largest number of loop rounds of an invocation in one dispatch. Mesa's software Vulkan
/// silently ends every loop after 65 535 rounds: at 287 iterations and 256 steps all pixels
/// were wrong. The rest is left to loops that are not counted.
const MOST_ROUNDS_AT_ONCE: u32 = 60_000;

/// The largest step limit of a dispatch over a scene.
fn most_steps(scene: &AnySolid) -> u32 {
    let rounds = scene.twin().rounds().saturating_add(1);
    (MOST_ROUNDS_AT_ONCE / rounds).clamp(1, MOST_STEPS_AT_ONCE)
}

/// Renders plans on one device.
pub struct Renderer {
    /// The device.
    pub device: Arc<Device>,
    /// How work is cut.
    pub cutting: Cutting,
    /// Texts of shader files that take precedence, for live editing. The makers of maps do not ask
    /// for them.
    pub sources: Option<Sources>,
    shared: Arc<Shared>,
}

impl Renderer {
    /// A renderer on an open device.
    pub fn new(device: Device) -> Self {
        let device = Arc::new(device);
        Self {
            cutting: Cutting::default(),
            sources: None,
            device: device.clone(),
            shared: Arc::new(Shared {
                device,
                kernels: Mutex::default(),
                arrays: Mutex::default(),
                kept: Mutex::default(),
            }),
        }
    }

    /// Loads and makes what a plan names, compiles what is new, and begins a render. The plan
    /// must pass [`Plan::check`]. The assets keep what is loaded and made for it. A device that was
    /// lost is opened again first, unless a host has lent it.
    ///
    /// # Errors
    /// [`RenderError::Cancelled`] if `watch` returns `false`. The device fails, a named file
    /// cannot be read or does not fit, a cone map cannot be made, or a shader text is wrong. What
    /// was compiled and uploaded before stays.
    pub fn begin(
        &mut self,
        plan: &Plan,
        assets: &Assets,
        extras: Extras,
        watch: Watch<'_>,
    ) -> Result<Work, RenderError> {
        self.reopen_if_lost()?;
        let plan = &*plan.lean(extras);
        let device = &*self.device;
        let prepared = self.prepare(plan, assets, watch)?;
        let scene = plan.scene.solid(&plan.viewpoint(), assets)?;
        let passes = plan.passes(extras);
        let coarsest = plan.coarsest();
        let blocks = Block::cut(plan.size, self.cutting.block.min(MOST_BLOCK), coarsest);
        let marked = scene.twin().marks_hits();
        let blocks = turn::Layout::of_blocks(&blocks, coarsest, extras.count, marked);
        let largest = device.device.limits().max_texture_dimension_2d;
        let shown = extras.shown && plan.size.iter().all(|n| *n <= largest);
        let kinds = StageKind::all(&passes, shown);
        let programs = {
            let kept = lock(&self.shared.kept);
            let held = kept.target.as_ref().filter(|_| extras.reuse);
            let program = |(stage, kind): (usize, &StageKind)| {
                let lean = self.text(kind.program(plan, &scene, extras));
                let held = held.and_then(|target| target.held(stage, &blocks[0], &lean));
                held.unwrap_or(lean)
            };
            kinds.iter().enumerate().map(program).collect()
        };
        let needs = Needs {
            programs,
            picture: shown.then_some(plan.size),
            // The first block is as large as any.
            layout: blocks[0].clone(),
            pixel_layers: match (extras.depth_only, extras.normals) {
                (true, _) => 0,
                (false, normals) => 1 + u32::from(normals),
            },
        };
        let mut parameters = parameters(plan, &scene);
        if shown {
            let steps = tone_steps(plan.look.exposure.exp2());
            parameters.push(("tone_steps", bytes_of(&steps).to_vec()));
        }
        let of_look = |p: &&(&str, Vec<u8>)| p.0 == "look_parameters";
        let look = parameters.iter().find(of_look).map(|p| p.1.clone());
        let look = look.unwrap_or_default();
        let of_march = |p: &&(&str, Vec<u8>)| !["look_parameters", "tone_steps"].contains(&p.0);
        let marched = parameters.iter().filter(of_march).cloned().collect();
        let mut traffic = Traffic::default();
        let kernels = &mut *lock(&self.shared.kernels);
        let known = kernels.count();
        let mut compile = |program| kernels.get(device, program);
        let compiled = needs.programs.iter().map(&mut compile);
        let compiled: Vec<_> = compiled.collect::<Result<_, _>>()?;
        let arrange = kernels.get(device, &self.text(turn::arrange()))?;
        traffic.compilations = kernels.count() - known;
        let arrays = &mut *lock(&self.shared.arrays);
        let arrays = arrays.keep(
            device,
            &compiled,
            scene.twin().arrays(),
            &mut traffic.uploads,
        )?;
        let mut kept = lock(&self.shared.kept);
        match &mut kept.target {
            Some(target) if target.serves(&needs, &parameters, arrays) => {
                traffic.uploads += target.rewrite(device, parameters);
            }
            _ => {
                traffic.uploads += parameters.iter().map(|(_, b)| b.len()).sum::<usize>();
                traffic.allocations = 1;
                let target = Target::new(device, compiled, arrange, needs, parameters, arrays)?;
                *kept = Kept {
                    target: Some(target),
                    costs: vec![Cost::default(); kinds.len()],
                    aim_ms: LONGEST_MS,
                    stamps: Stamps::new(device),
                    ..Kept::default()
                };
            }
        }
        let kept = std::mem::take(&mut *kept);
        let most = most_steps(&scene);
        let job = Job {
            kinds,
            made: Made {
                passes,
                blocks,
                ray_steps: plan.ray_steps(&scene),
                marched,
                look,
            },
            steps: [self.cutting.chunk.clamp(1, most), most],
            extras,
            prepared,
        };
        let mut frame = Frame::blank(plan, extras);
        frame.traffic = Some(traffic);
        Ok(Work::new(self.shared.clone(), kept, job, frame))
    }

    /// Puts another plan into a work, which goes on with it from the start. What was submitted of
    /// the old plan is discarded. The extras stay.
    ///
    /// # Errors
    /// Those of [`Renderer::begin`]; the work goes on with the old plan then.
    pub fn set(
        &mut self,
        work: &mut Work,
        plan: &Plan,
        assets: &Assets,
        watch: Watch<'_>,
    ) -> Result<(), RenderError> {
        work.lend();
        let begun = self.begin(plan, assets, work.extras(), watch);
        match begun {
            Ok(new) => *work = new,
            Err(error) => {
                work.take_back();
                return Err(error);
            }
        }
        Ok(())
    }

    /// Asks what there is at a place of a plan, for a cursor or for the speed of a flight. The work
    /// under way goes on.
    ///
    /// # Errors
    /// Those of [`Renderer::begin`].
    pub fn pick(&mut self, plan: &Plan, assets: &Assets, at: At) -> Result<Pick, RenderError> {
        self.reopen_if_lost()?;
        let scene = plan.scene.solid(&plan.viewpoint(), assets)?;
        let device = &*self.device;
        let program = self.text(pick::program(&scene));
        let kernel = lock(&self.shared.kernels).get(device, &program)?;
        let mut arrays = lock(&self.shared.arrays);
        let kernels = std::slice::from_ref(&kernel);
        let arrays = arrays.keep(device, kernels, scene.twin().arrays(), &mut 0)?;
        let steps = most_steps(&scene);
        let rounds = match at {
            At::Pixel(_) => plan.ray_steps(&scene).div_ceil(steps),
            At::Point(_) => 1,
        };
        let question = PickQuestion::new(at, plan.camera.eye, steps);
        Pick::new(
            self.device.clone(),
            &kernel,
            &parameters(plan, &scene),
            arrays,
            (question, rounds),
            plan.camera.eye,
        )
    }

    fn reopen_if_lost(&mut self) -> Result<(), RenderError> {
        if self.device.check().is_err() {
            let fresh = Self::new(self.device.reopen()?);
            self.device = fresh.device;
            self.shared = fresh.shared;
        }
        Ok(())
    }

    /// A program with the texts of `sources`.
    fn text(&self, program: Program) -> Program {
        match &self.sources {
            Some(sources) => program.with_sources(sources),
            None => program,
        }
    }

    /// Makes the cone maps of a plan on the device. Their programs are kept.
    fn prepare(
        &self,
        plan: &Plan,
        assets: &Assets,
        watch: Watch<'_>,
    ) -> Result<Vec<(Preparation, f64)>, RenderError> {
        let mut maker = Maker::new(&self.device);
        maker.kernels = std::mem::take(&mut *lock(&self.shared.kernels));
        let make = &mut |generator,
                         heights: &_,
                         patches,
                         options: &_,
                         told: &mut dyn FnMut(f64) -> bool| {
            maker.generate(generator, heights, patches, options, told)
        };
        let prepared = prepare(plan, assets, make, watch);
        *lock(&self.shared.kernels) = maker.kernels;
        Ok(prepared?)
    }

    /// Renders a plan: [`Renderer::begin`] and [`Work::finish`].
    ///
    /// # Errors
    /// Those of both.
    pub fn render(
        &mut self,
        plan: &Plan,
        assets: &Assets,
        extras: Extras,
        watch: Watch<'_>,
    ) -> Result<Frame, RenderError> {
        self.begin(plan, assets, extras, watch)?.finish(watch)
    }
}

/// The parameters of a frame by the names of the WGSL variables.
fn parameters(plan: &Plan, scene: &AnySolid) -> Parameters {
    let view = plan.view().uniform();
    let look = Light::of(plan, scene).uniform();
    let frame = [
        ("view_parameters", bytes_of(&view).to_vec()),
        ("look_parameters", bytes_of(&look).to_vec()),
    ];
    scene.twin().uniforms().into_iter().chain(frame).collect()
}

/// What a lock holds, also after a panic: nothing half-made is put there.
fn lock<T>(of: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}
