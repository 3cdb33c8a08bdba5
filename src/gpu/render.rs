//! From a Plan to a Frame on a wgpu device.
//!
//! A [`Renderer`] keeps compiled kernels and buffers between calls. Large images are cut into
//! blocks, and a pass into dispatches of a bounded number of steps, each for the cells that
//! still move. Neither changes a bit of the picture.

use std::collections::HashMap;
use std::rc::Rc;
use std::time::Instant;

use bytemuck::bytes_of;

use crate::base::shader::Program;
use crate::gpu::buffer::{Buffer, uniform};
use crate::gpu::conemap::generate::Maker;
use crate::gpu::device::Device;
use crate::gpu::kernel::{Kernel, KernelError, Kernels};
use crate::pass::look::Light;
use crate::pass::prepare::prepare;
use crate::pass::progress::{Progress, Watch};
use crate::pass::queue::{COUNT_AT, Turn};
use crate::pass::{Before, outputs, program};
use crate::picture::frame::Frame;
use crate::plan::pyramid::Block;
use crate::plan::{Extras, Pass, Plan};
use crate::scene::{AnySolid, Assets};

use super::collect::{Bound, UNWRITTEN, collect};
use super::dispatch::{Dispatcher, Filled, clear_count};
pub use super::error::RenderError;
use super::error::check_room;
use super::job::{Job, Setup};

/// How work is cut. This never changes a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cutting {
    /// The largest edge of a block in pixels.
    pub block: u32,
    /// The step limit of the first dispatch of a pass. Each later one has four times as many.
    pub chunk: u32,
}

impl Default for Cutting {
    fn default() -> Self {
        Self {
            // The largest buffer has 16 MiB, and a dispatch takes far less than a second on
            // slow devices.
            block: 1024,
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

    /// A storage buffer. It is kept by its name and replaced if it is too small.
    fn storage(&mut self, name: &str, bytes: u64) -> Rc<wgpu::Buffer> {
        let bytes = bytes.max(16).next_multiple_of(16);
        if let Some((size, raw)) = self.pool.get(name)
            && *size >= bytes
        {
            return raw.clone();
        }
        let raw = Rc::new(Buffer::<u8>::new(&self.device, name, bytes as usize).raw);
        self.pool.insert(name.to_string(), (bytes, raw.clone()));
        raw
    }

    /// Renders a plan. It must pass [`Plan::check`]. The assets keep what is loaded and made for
    /// it.
    ///
    /// # Errors
    /// [`RenderError::Cancelled`] if `watch` returns `false`. The device fails, a named file
    /// cannot be read or does not fit, or a cone map cannot be made.
    pub fn render(
        &mut self,
        plan: &Plan,
        assets: &Assets,
        extras: Extras,
        watch: Watch<'_>,
    ) -> Result<Frame, RenderError> {
        let plan = &*plan.lean(extras);
        let mut maker = Maker::new(&self.device);
        let maker = &mut |generator,
                          heights: &_,
                          patches,
                          options: &_,
                          told: &mut dyn FnMut(f64) -> bool| {
            maker.generate(generator, heights, patches, options, told)
        };
        let prepared = prepare(plan, assets, maker, watch)?;
        let scene = plan.solid(assets)?;
        let passes = plan.passes(extras);
        // Compile everything before any time is measured.
        let kernel = |pass: &Pass| self.kernel(&program(plan, &scene, *pass, extras));
        let kernels: Vec<_> = passes.iter().map(kernel).collect::<Result<_, _>>()?;
        let blocks = Block::cut(plan.size, self.cutting.block, plan.coarsest());
        let mut frame = Frame::blank(plan, extras);
        let steps = (blocks.len() * passes.len()) as f64;
        let mut done = 0.0;
        for block in &blocks {
            let job = Job {
                plan,
                scene: &scene,
                light: Light::of(plan, assets),
                ray_steps: plan.ray_steps(assets),
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
        frame.finish(prepared);
        Ok(frame)
    }

    /// The parameters of a whole block.
    fn bind_frame(&mut self, job: &Job<'_>) -> Result<Bound, RenderError> {
        let mut bound = Bound::new();
        let most = self.device.most_bound();
        for (name, bytes) in job.scene.twin().uniforms() {
            check_room(&self.device.info.name, name, bytes.len() as u64, most)?;
            bound.insert(name.into(), Rc::new(uniform(&self.device, name, &bytes)));
        }
        let view = job.plan.view().uniform(job.block.origin, job.block.size);
        let look = job.light.uniform();
        let parameters = [
            ("view_parameters", bytes_of(&view)),
            ("look_parameters", bytes_of(&look)),
        ];
        for (name, bytes) in parameters {
            bound.insert(name.into(), Rc::new(uniform(&self.device, name, bytes)));
        }
        Ok(bound)
    }

    /// Runs one pass over one block until no cell moves. The pass before it listed `parents`
    /// cells. Returns the number of cells listed for the next pass.
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
        self.bind_pass(job, &setup, (at, pass), kernel, bound);
        let list = |cells: [u32; 2]| COUNT_AT + 4 + 4 * u64::from(cells[0]) * u64::from(cells[1]);
        // One queue is read while the other is filled.
        let queues = [0, 1].map(|i| self.storage(&format!("queue {i}"), list(setup.cells)));
        let next = self.storage(&format!("parents {at}"), list(setup.cells));
        bound.insert("next_parents".into(), next.clone());
        let gpu = &self.device.device;
        let mut encoder = gpu.create_command_encoder(&Default::default());
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
        figures.wall_ms += start.elapsed().as_secs_f64() * 1e3;
        Ok(listed)
    }

    /// Binds what a pass writes, by its name and by name and number, and the fronts of the pass
    /// before it.
    fn bind_pass(
        &mut self,
        job: &Job<'_>,
        setup: &Setup,
        (at, pass): (usize, Pass),
        kernel: &Kernel,
        bound: &mut Bound,
    ) {
        let cells = u64::from(setup.cells[0]) * u64::from(setup.cells[1]);
        let front = match setup.parent_width {
            0 => self.storage("no front", 4),
            _ => bound[&format!("front {}", at - 1)].clone(),
        };
        bound.insert("parent_front".into(), front);
        if let Some(level) = &setup.level {
            let raw = Rc::new(uniform(&self.device, "level", bytes_of(level)));
            bound.insert("level_parameters".into(), raw);
        }
        let walk = u64::from(kernel.stride("walks").unwrap_or(4));
        let marked = job.scene.twin().marks_hits();
        for output in outputs(pass, job.extras, marked, walk) {
            // The depth of a ray is collected as its front.
            let key = match output.name {
                "depth" => format!("front {at}"),
                name => format!("{name} {at}"),
            };
            let buffer = self.storage(&key, output.stride * cells);
            match output.before {
                Before::Anything => {}
                Before::Zero => self.device.clear(&buffer),
                Before::Unwritten => {
                    let blank = vec![0xFF_u8; (output.stride * cells) as usize];
                    debug_assert_eq!(UNWRITTEN.to_ne_bytes(), [0xFF; 4]);
                    self.device.queue.write_buffer(&buffer, 0, &blank);
                }
            }
            bound.insert(key, buffer.clone());
            bound.insert(output.name.into(), buffer);
        }
    }
}
