//! The GPU executor: a Plan to a Frame on a wgpu device.
//!
//! A [`Renderer`] lives long and keeps compiled kernels and buffers between calls.
//! Large images are made in blocks on the pixel grid of the whole image, and every pass
//! in dispatches of a bounded number of steps, run again for what still moves. Neither
//! changes a bit of the picture.

use std::collections::HashMap;
use std::rc::Rc;
use std::time::Instant;

use bytemuck::bytes_of;

use crate::base::shader::Program;
use crate::gpu::buffer::{Buffer, uniform};
use crate::gpu::conemap::generate::Maker;
use crate::gpu::device::Device;
use crate::gpu::kernel::{Kernel, KernelError, Kernels};
use crate::heightfield::conemap::generate::generator::Generator;
use crate::heightfield::tracer::settings::Make;
use crate::pass::queue::{COUNT_AT, Turn};
use crate::picture::frame::{Frame, PassFigures};
use crate::plan::pyramid::Block;
use crate::plan::{Extras, PREPARE, Pass, Plan, Preparation};
use crate::scene::Scene;

pub(crate) use super::collect::blank;
use super::collect::{Bound, UNWRITTEN, collect};
use super::dispatch::{Dispatcher, Filled, clear_count};
pub use super::error::RenderError;
use super::error::check_room;
use super::job::{Job, Setup};

/// How the work is cut. It never changes a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cutting {
    /// Longest edge of a block in pixels.
    pub block: u32,
    /// Steps of the first dispatch of a pass; each later one does four times as many.
    pub chunk: u32,
}

impl Default for Cutting {
    fn default() -> Self {
        Self {
            // 16 MiB for the widest channel, and well under a second per dispatch on
            // slow devices.
            block: 1024,
            // Most rays end within 64 steps. What is left then is packed and runs on in
            // dispatches of 256; packing sooner costs a software device more in visits
            // than it saves in idle lanes.
            chunk: 64,
        }
    }
}

/// Where a render stands.
#[derive(Clone, Debug)]
pub struct Progress {
    /// The pass that has just come to an end, or on.
    pub pass: String,
    /// Share of passes over blocks that are done.
    pub done: f64,
}

/// Before the first pass, when so much of what the scene needs is made.
pub(crate) fn preparing(share: f64) -> Progress {
    Progress {
        pass: format!("cones {:.0} %", 100.0 * share),
        done: 0.0,
    }
}

/// Makes what a plan needs beforehand; what that took, map by map. One that is kept from an
/// earlier picture takes nothing.
pub(crate) fn prepare(plan: &Plan, make: Make<'_>) -> Result<Vec<PassFigures>, RenderError> {
    let mut taken = Vec::new();
    plan.prepare(&mut |generator, heights, patches, options| {
        let start = Instant::now();
        let made = make(generator, heights, patches, options);
        taken.push((generator, start.elapsed().as_secs_f64() * 1e3));
        made
    })?;
    let figures = |made: Preparation| {
        let of = |(by, _): &&(Generator, f64)| *by == made.generator;
        PassFigures {
            name: PREPARE.into(),
            cells: made.places.map(u64::from).iter().product(),
            wall_ms: taken.iter().find(of).map_or(0.0, |(_, ms)| *ms),
            ..PassFigures::default()
        }
    };
    Ok(plan.preparations().into_iter().map(figures).collect())
}

/// Told after every pass over a block (on the CPU, a band of rows); `false` cancels the
/// render.
pub type Watch<'a> = &'a mut dyn FnMut(&Progress) -> bool;

/// Steps of the longest dispatch: with a block of a million pixels still well under
/// the time after which drivers give a device up.
const MOST_STEPS_AT_ONCE: u32 = 256;

/// Rounds of all loops together that an invocation may take in one dispatch of a pass that
/// can be cut. Mesa's software Vulkan ends every loop after 65 535 of them, without a
/// word: at 287 iterations and 256 steps all pixels were wrong. Some are left for loops
/// that are not counted here.
const MOST_ROUNDS_AT_ONCE: u32 = 60_000;

/// Steps of the longest dispatch over a scene.
fn most_steps(scene: &Scene) -> u32 {
    let rounds = scene.twin().rounds().saturating_add(1);
    (MOST_ROUNDS_AT_ONCE / rounds).clamp(1, MOST_STEPS_AT_ONCE)
}

/// Renders plans on one device.
pub struct Renderer {
    /// The device.
    pub device: Device,
    /// How work is cut.
    pub cutting: Cutting,
    kernels: Kernels,
    pool: HashMap<String, (u64, Rc<wgpu::Buffer>)>,
    dispatcher: Dispatcher,
}

impl Renderer {
    /// A renderer on an open device.
    pub fn new(device: Device) -> Self {
        Self {
            dispatcher: Dispatcher::new(&device),
            device,
            cutting: Cutting::default(),
            kernels: Kernels::default(),
            pool: HashMap::new(),
        }
    }

    /// The compiled kernel of a program.
    pub fn kernel(&mut self, program: &Program) -> Result<Rc<Kernel>, KernelError> {
        self.kernels.get(&self.device, program)
    }

    /// A storage buffer of a name that is kept between calls while its size fits.
    fn storage(&mut self, name: &str, bytes: u64) -> Rc<wgpu::Buffer> {
        let bytes = bytes.max(16).next_multiple_of(16);
        if let Some((size, raw)) = self.pool.get(name)
            && *size >= bytes
        {
            return raw.clone();
        }
        let raw = Buffer::<u8>::new(&self.device, name, bytes as usize).raw;
        let raw = Rc::new(raw);
        self.pool.insert(name.to_string(), (bytes, raw.clone()));
        raw
    }

    /// Renders a plan that passes [`Plan::check`].
    pub fn render(
        &mut self,
        plan: &Plan,
        extras: Extras,
        watch: Watch<'_>,
    ) -> Result<Frame, RenderError> {
        let plan = &*plan.lean(extras);
        let mut maker = Maker::new(&self.device);
        let prepared = prepare(plan, &mut |generator, heights, patches, options| {
            let mut told = |share: f64| watch(&preparing(share));
            maker.generate(generator, heights, patches, options, &mut told)
        })?;
        let scene = plan.scene();
        let passes = plan.passes_for(extras);
        // Compile everything first, so that no time below contains compilation.
        let mut kernels = Vec::new();
        for &pass in &passes {
            kernels.push(self.kernel(&plan.program(&scene, pass, extras))?);
        }
        let blocks = Block::cut(plan.size, self.cutting.block, plan.pyramid().coarsest());
        let mut frame = blank(plan, &passes, extras);
        let steps = (blocks.len() * passes.len()) as f64;
        let mut done = 0.0;
        for block in &blocks {
            let job = Job {
                plan,
                scene: &scene,
                extras,
                block: *block,
            };
            let mut bound = self.bind_frame(&job)?;
            let mut parents = 0;
            for (i, (&pass, kernel)) in passes.iter().zip(&kernels).enumerate() {
                parents = self.run(&job, (i, pass), kernel, parents, &mut bound, &mut frame)?;
                done += 1.0;
                let progress = Progress {
                    pass: pass.name(),
                    done: done / steps,
                };
                if !watch(&progress) {
                    return Err(RenderError::Cancelled);
                }
            }
            collect(&self.device, &job, &passes, &bound, &mut frame)?;
        }
        frame.march_ms = frame
            .passes
            .iter()
            .filter(|p| p.marches())
            .map(|p| p.wall_ms)
            .sum();
        frame.lead(prepared);
        Ok(frame)
    }

    /// Uniforms that hold for a whole block.
    fn bind_frame(&mut self, job: &Job<'_>) -> Result<Bound, RenderError> {
        let mut bound = Bound::new();
        let most = self.device.most_bound();
        for (name, bytes) in job.scene.twin().uniforms() {
            check_room(&self.device.info.name, name, bytes.len() as u64, most)?;
            bound.insert(name.into(), Rc::new(uniform(&self.device, name, &bytes)));
        }
        let view = job.plan.view().uniform(job.block.origin, job.block.size);
        let look = job.plan.light().uniform();
        for (name, bytes) in [
            ("view_parameters", bytes_of(&view)),
            ("look_parameters", bytes_of(&look)),
        ] {
            bound.insert(name.into(), Rc::new(uniform(&self.device, name, bytes)));
        }
        Ok(bound)
    }

    /// Runs one pass over one block until nothing moves; `parents` cells were listed for
    /// it. The number of cells that it lists for the next.
    fn run(
        &mut self,
        job: &Job<'_>,
        (at, pass): (usize, Pass),
        kernel: &Kernel,
        parents: u32,
        bound: &mut Bound,
        frame: &mut Frame,
    ) -> Result<u32, RenderError> {
        let setup = job.setup(pass);
        self.bind_pass(&setup, pass, at, kernel, bound, job.extras);
        let list = |cells: [u32; 2]| COUNT_AT + 4 + 4 * u64::from(cells[0]) * u64::from(cells[1]);
        // Two queues take turns: one is read while the other is filled.
        let queues = [0, 1].map(|i| self.storage(&format!("queue {i}"), list(setup.cells)));
        let next = self.storage(&format!("parents {at}"), list(setup.cells));
        bound.insert("next_parents".into(), next.clone());
        let mut encoder = self
            .device
            .device
            .create_command_encoder(&Default::default());
        clear_count(&mut encoder, &next);
        self.device.queue.submit([encoder.finish()]);
        self.device.wait()?;
        let start = Instant::now();
        let figures = &mut frame.passes[at];
        let most = most_steps(job.scene);
        let mut now = Turn {
            chunk: self.cutting.chunk.clamp(1, most),
            done: 0,
            limit: setup.limit,
            row: 0,
            parent_width: setup.parent_width,
            visits: Turn::ALL,
        };
        let mut count = setup.cells.map(|c| c.div_ceil(8));
        let (mut read, mut filled) = (queues[0].clone(), queues[1].clone());
        if setup.parent_width > 0 {
            read = self.storage(&format!("parents {}", at - 1), 0);
            count = now.to_children_of(parents);
        }
        let mut listed = 0;
        while count[0] > 0 {
            bound.insert("listed".into(), read.clone());
            bound.insert("queue".into(), filled.clone());
            let groups = kernel.bind(&self.device, |name| bound.get(name).map(|b| &**b))?;
            self.device.queue.write_buffer(&read, 0, bytes_of(&now));
            let lists = Filled {
                moving: &filled,
                parents: &next,
            };
            let timed = job.extras.time;
            let told = self
                .dispatcher
                .run(&self.device, kernel, &groups, count, &lists, timed)?;
            if let Some(ns) = told.ns {
                *figures.gpu_ms.get_or_insert(0.0) += ns * 1e-6;
            }
            listed = told.parents;
            now.done = now.done.saturating_add(now.chunk);
            if now.done >= now.limit {
                break;
            }
            now.chunk = (now.chunk * 4).min(most);
            count = now.to_cells(told.moving);
            read = filled;
            filled = queues[usize::from(Rc::ptr_eq(&read, &queues[0]))].clone();
        }
        figures.cells += u64::from(setup.cells[0]) * u64::from(setup.cells[1]);
        figures.wall_ms += start.elapsed().as_secs_f64() * 1e3;
        Ok(listed)
    }

    /// Storage of a pass: its own channels, and its parent's under their parent names.
    fn bind_pass(
        &mut self,
        setup: &Setup,
        pass: Pass,
        at: usize,
        kernel: &Kernel,
        bound: &mut Bound,
        extras: Extras,
    ) {
        let cells = u64::from(setup.cells[0]) * u64::from(setup.cells[1]);
        let front = if setup.parent_width > 0 {
            self.storage(&format!("front {}", at - 1), 0)
        } else {
            self.storage("no front", 4)
        };
        bound.insert("parent_front".into(), front);
        if let Some(level) = &setup.level {
            let raw = Rc::new(uniform(&self.device, "level", bytes_of(level)));
            bound.insert("level_parameters".into(), raw);
        }
        if pass == Pass::Color {
            let normals = if extras.normals { 16 * cells } else { 16 };
            let radiance = self.storage("radiance", 16 * cells);
            bound.insert("radiance".into(), radiance);
            bound.insert("normals".into(), self.storage("normals", normals));
            return;
        }
        let front = self.storage(&format!("front {at}"), 4 * cells);
        let state = self.storage(&format!("state {at}"), 4 * cells);
        let blank = vec![0xFF_u8; 4 * cells as usize];
        debug_assert_eq!(UNWRITTEN.to_ne_bytes(), [0xFF; 4]);
        self.device.queue.write_buffer(&state, 0, &blank);
        let name = if pass == Pass::Trace {
            "depth"
        } else {
            "front"
        };
        bound.insert(name.into(), front.clone());
        bound.insert(format!("front {at}"), front);
        bound.insert("state".into(), state.clone());
        bound.insert(format!("state {at}"), state);
        if pass == Pass::Trace {
            let walks = u64::from(kernel.stride("walks").unwrap_or(4)) * cells;
            bound.insert("walks".into(), self.storage("walks", walks));
            let marked = self.scene_marks(kernel);
            let marks = if marked { 12 * cells } else { 16 };
            bound.insert("marks".into(), self.storage("marks", marks));
        }
        if extras.count {
            let tally = self.storage(&format!("tally {at}"), 8 * cells);
            let mut encoder = self
                .device
                .device
                .create_command_encoder(&Default::default());
            encoder.clear_buffer(&tally, 0, None);
            self.device.queue.submit([encoder.finish()]);
            bound.insert("tally".into(), tally.clone());
            bound.insert(format!("tally {at}"), tally);
        }
    }

    /// Whether the kernel's scene keeps marks of its hits.
    fn scene_marks(&self, kernel: &Kernel) -> bool {
        let program = self.kernels.program_of(kernel);
        program.is_some_and(|p| p.constants().contains(&("HIT_CARRIES_MARK", 1.0)))
    }
}
