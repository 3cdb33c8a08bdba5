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
use thiserror::Error;

use crate::frame::{Frame, LevelLayer, PassFigures, State, Work};
use crate::gpu::buffer::{Buffer, uniform};
use crate::gpu::device::{Device, DeviceError};
use crate::gpu::kernel::{Kernel, KernelError};
use crate::pass::march::LevelUniform;
use crate::pass::queue::{COUNT_AT, Turn};
use crate::plan::{Extras, Pass, Plan};
use crate::pyramid::Block;
use crate::scene::Scene;
use crate::shader::Program;

/// Why there is no frame.
#[derive(Debug, Error)]
pub enum RenderError {
    /// The device failed.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A program failed.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// The device claims to be done, but pixels were never written.
    #[error(
        "the device `{device}` left {pixels} pixels unwritten and reported no error; try a smaller --size, another --device, or --device cpu"
    )]
    Unwritten {
        /// Its name.
        device: String,
        /// How many.
        pixels: usize,
    },
}

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
    /// The pass that has just ended.
    pub pass: String,
    /// Share of passes over blocks that are done.
    pub done: f64,
}

/// Told after every pass over a block; `false` cancels the render.
pub type Watch<'a> = &'a mut dyn FnMut(&Progress) -> bool;

/// Steps of the longest dispatch: with a block of a million pixels still well under
/// the time after which drivers give a device up.
const MOST_STEPS_AT_ONCE: u32 = 256;
/// A state that no shader writes: what unwritten pixels are found by.
const UNWRITTEN: u32 = u32::MAX;

/// Renders plans on one device.
pub struct Renderer {
    /// The device.
    pub device: Device,
    /// How work is cut.
    pub cutting: Cutting,
    kernels: Vec<(Program, Rc<Kernel>)>,
    pool: HashMap<String, (u64, Rc<wgpu::Buffer>)>,
    queries: Option<(wgpu::QuerySet, wgpu::Buffer)>,
    /// Pixels that the last trace pass visited; all others are sky.
    traced: usize,
}

/// The buffers of one block.
type Bound = HashMap<String, Rc<wgpu::Buffer>>;

impl Renderer {
    /// A renderer on an open device.
    pub fn new(device: Device) -> Self {
        let queries = device.tick_ns.map(|_| {
            let count = 2;
            let set = device.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("passes"),
                ty: wgpu::QueryType::Timestamp,
                count,
            });
            let buffer = device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size: u64::from(count) * 8,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            });
            (set, buffer)
        });
        Self {
            device,
            cutting: Cutting::default(),
            kernels: Vec::new(),
            pool: HashMap::new(),
            queries,
            traced: 0,
        }
    }

    /// The compiled kernel of a program.
    pub fn kernel(&mut self, program: &Program) -> Result<Rc<Kernel>, KernelError> {
        if let Some((_, kernel)) = self.kernels.iter().find(|(p, _)| p == program) {
            return Ok(kernel.clone());
        }
        let kernel = Rc::new(Kernel::new(&self.device, program)?);
        self.kernels.push((program.clone(), kernel.clone()));
        Ok(kernel)
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
        let scene = plan.scene();
        let passes: Vec<Pass> = plan
            .passes()
            .into_iter()
            .filter(|p| !(extras.depth_only && *p == Pass::Color))
            .collect();
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
            let mut bound = self.bind_frame(&job);
            for (i, (&pass, kernel)) in passes.iter().zip(&kernels).enumerate() {
                self.run(&job, pass, i, kernel, &mut bound, &mut frame)?;
                done += 1.0;
                let progress = Progress {
                    pass: pass.name(),
                    done: done / steps,
                };
                if !watch(&progress) {
                    return Err(RenderError::Cancelled);
                }
            }
            self.collect(&job, &passes, &bound, &mut frame)?;
        }
        frame.march_ms = frame
            .passes
            .iter()
            .filter(|p| p.name != "color")
            .map(|p| p.wall_ms)
            .sum();
        Ok(frame)
    }

    /// Uniforms that hold for a whole block.
    fn bind_frame(&mut self, job: &Job<'_>) -> Bound {
        let mut bound = Bound::new();
        for (name, bytes) in job.scene.twin().uniforms() {
            bound.insert(name.into(), Rc::new(uniform(&self.device, name, &bytes)));
        }
        let view = job.plan.view().uniform(&job.block);
        let look = job.plan.light().uniform();
        for (name, bytes) in [("view", bytes_of(&view)), ("look", bytes_of(&look))] {
            bound.insert(name.into(), Rc::new(uniform(&self.device, name, bytes)));
        }
        bound
    }

    /// Runs one pass over one block until nothing moves.
    fn run(
        &mut self,
        job: &Job<'_>,
        pass: Pass,
        at: usize,
        kernel: &Kernel,
        bound: &mut Bound,
        frame: &mut Frame,
    ) -> Result<(), RenderError> {
        let setup = Setup::new(job, pass);
        self.bind_pass(&setup, pass, at, kernel, bound, job.extras);
        if let Some(level) = &setup.level {
            let raw = Rc::new(uniform(&self.device, "level", bytes_of(level)));
            bound.insert("level".into(), raw);
        }
        let list = |cells: [u32; 2]| COUNT_AT + 4 + 4 * u64::from(cells[0]) * u64::from(cells[1]);
        // Two queues take turns: one is read while the other is filled.
        let queues = [0, 1].map(|i| self.storage(&format!("queue {i}"), list(setup.cells)));
        let children = self.storage(&format!("children {at}"), list(setup.children()));
        clear_count(&self.device, &children);
        bound.insert("next_cells".into(), children.clone());
        self.device.wait()?;
        let start = Instant::now();
        let mut gpu_ns = None;
        let mut now = Turn {
            chunk: self.cutting.chunk.clamp(1, MOST_STEPS_AT_ONCE),
            done: 0,
            limit: setup.limit,
            row: 0,
            parent_width: setup.parent_width,
            listed: 0,
        };
        let mut count = setup.cells.map(|c| c.div_ceil(8));
        let (mut read, mut filled) = (queues[0].clone(), queues[1].clone());
        let mut visited = setup.cells[0] as usize * setup.cells[1] as usize;
        if setup.parent_width > 0 {
            read = self.storage(&format!("children {}", at - 1), 0);
            let left = list_length(&self.device, &read)?;
            visited = left as usize;
            count = now.spread(left);
        }
        while count[0] > 0 {
            bound.insert("turn".into(), read.clone());
            bound.insert("queue".into(), filled.clone());
            let groups = kernel.bind(&self.device, |name| bound.get(name).map(|b| &**b))?;
            self.device.queue.write_buffer(&read, 0, bytes_of(&now));
            clear_count(&self.device, &filled);
            self.dispatch(kernel, &groups, count, job.extras.time)?;
            if job.extras.time {
                let ns = self.read_timestamps()?;
                gpu_ns = ns.map(|ns| gpu_ns.unwrap_or(0.0) + ns);
            }
            now.done = now.done.saturating_add(now.chunk);
            if now.done >= now.limit {
                break;
            }
            now.chunk = (now.chunk * 4).min(MOST_STEPS_AT_ONCE);
            count = now.spread(list_length(&self.device, &filled)?);
            read = filled;
            filled = queues[usize::from(Rc::ptr_eq(&read, &queues[0]))].clone();
        }
        if pass == Pass::Trace {
            self.traced = visited;
        }
        let figures = &mut frame.passes[at];
        figures.cells += u64::from(setup.cells[0]) * u64::from(setup.cells[1]);
        figures.wall_ms += start.elapsed().as_secs_f64() * 1e3;
        if let Some(ns) = gpu_ns {
            *figures.gpu_ms.get_or_insert(0.0) += ns * 1e-6;
        }
        Ok(())
    }

    /// One dispatch, and the wait for it.
    fn dispatch(
        &self,
        kernel: &Kernel,
        groups: &[wgpu::BindGroup],
        count: [u32; 2],
        timed: bool,
    ) -> Result<(), DeviceError> {
        let mut encoder = self
            .device
            .device
            .create_command_encoder(&Default::default());
        let queries = self.queries.as_ref().filter(|_| timed);
        let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: None,
            timestamp_writes: queries.map(|(set, _)| wgpu::ComputePassTimestampWrites {
                query_set: set,
                beginning_of_pass_write_index: Some(0),
                end_of_pass_write_index: Some(1),
            }),
        });
        kernel.dispatch(&mut compute, groups, count);
        drop(compute);
        self.device.queue.submit([encoder.finish()]);
        self.device.wait()
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
        let of = |(program, k): &(Program, Rc<Kernel>)| {
            let same = std::ptr::eq(&raw const **k, kernel);
            same && program.constants().contains(&("HIT_CARRIES_MARK", 1.0))
        };
        self.kernels.iter().any(of)
    }

    /// Device time of the last dispatch in nanoseconds.
    fn read_timestamps(&self) -> Result<Option<f64>, DeviceError> {
        let (Some((set, buffer)), Some(tick)) = (&self.queries, self.device.tick_ns) else {
            return Ok(None);
        };
        let mut encoder = self
            .device
            .device
            .create_command_encoder(&Default::default());
        encoder.resolve_query_set(set, 0..2, buffer, 0);
        self.device.queue.submit([encoder.finish()]);
        let stamps: Vec<u64> = read_raw(&self.device, buffer, 2)?;
        let ticks = stamps[1].saturating_sub(stamps[0]);
        #[allow(clippy::cast_precision_loss, reason = "a time for reading")]
        Ok(Some(ticks as f64 * f64::from(tick)))
    }

    /// Copies a block's channels into the frame.
    fn collect(
        &self,
        job: &Job<'_>,
        passes: &[Pass],
        bound: &Bound,
        frame: &mut Frame,
    ) -> Result<(), RenderError> {
        let device = &self.device;
        let area = job.block.area();
        let get = |name: &str| bound.get(name).map(|b| &**b);
        for (at, pass) in passes.iter().enumerate() {
            let (Some(front), Some(state)) =
                (get(&format!("front {at}")), get(&format!("state {at}")))
            else {
                continue;
            };
            let divisor = match pass {
                Pass::March(level) => level.divisor,
                _ => 1,
            };
            let cells = job.block.size.map(|n| n.div_ceil(divisor));
            let count = cells[0] as usize * cells[1] as usize;
            let mut work = Vec::new();
            if let Some(tally) = get(&format!("tally {at}")) {
                work = read_raw::<[u32; 2]>(device, tally, count)?
                    .into_iter()
                    .map(|[evaluations, iterations]| Work {
                        evaluations,
                        iterations,
                    })
                    .collect();
                let figures = &mut frame.passes[at];
                let sum = |f: fn(&Work) -> u32| work.iter().map(|w| u64::from(f(w))).sum::<u64>();
                *figures.evaluations.get_or_insert(0) += sum(|w| w.evaluations);
                *figures.iterations.get_or_insert(0) += sum(|w| w.iterations);
            }
            let tracing = *pass == Pass::Trace;
            if !tracing && !job.extras.levels && !job.extras.count {
                continue;
            }
            let to = Target {
                origin: job.block.origin.map(|o| o / divisor),
                cells,
                width: job.plan.size[0].div_ceil(divisor),
            };
            if tracing {
                let states: Vec<u32> = read_raw(device, state, count)?;
                let unknown = states.iter().filter(|s| State::from_code(**s).is_none());
                // What no cone listed is sky; what was listed must have been written.
                let pixels = unknown.count().abs_diff(area - self.traced);
                if pixels > 0 {
                    return Err(RenderError::Unwritten {
                        device: device.info.name.clone(),
                        pixels,
                    });
                }
                let mut depth: Vec<f32> = read_raw(device, front, count)?;
                for (t, s) in depth.iter_mut().zip(&states) {
                    if *s == State::Sky as u32 || *s == UNWRITTEN {
                        *t = f32::INFINITY;
                    }
                }
                let states: Vec<u8> = states.into_iter().map(seen).collect();
                to.copy(&depth, &mut frame.depth);
                to.copy(&states, &mut frame.state);
                to.copy(&work, &mut frame.work);
                continue;
            }
            let layer = &mut frame.levels[at];
            to.copy(&work, &mut layer.work);
            if job.extras.levels {
                let states: Vec<u32> = read_raw(device, state, count)?;
                let mut fronts: Vec<f32> = read_raw(device, front, count)?;
                for (f, _) in fronts
                    .iter_mut()
                    .zip(&states)
                    .filter(|(_, s)| **s == UNWRITTEN)
                {
                    *f = f32::MAX;
                }
                let states: Vec<u8> = states.into_iter().map(seen).collect();
                to.copy(&fronts, &mut layer.front);
                to.copy(&states, &mut layer.state);
            }
        }
        let to = Target {
            origin: job.block.origin,
            cells: job.block.size,
            width: job.plan.size[0],
        };
        let rgb = |v: Vec<[f32; 4]>| v.into_iter().map(|[r, g, b, _]| [r, g, b]);
        if let Some(raw) = get("radiance") {
            let pixels: Vec<_> = rgb(read_raw(device, raw, area)?).collect();
            to.copy(&pixels, &mut frame.radiance);
            if job.extras.normals
                && let Some(raw) = get("normals")
            {
                let normals: Vec<_> = rgb(read_raw(device, raw, area)?).collect();
                to.copy(&normals, &mut frame.normal);
            }
        }
        Ok(())
    }
}

/// What a block is rendered from.
struct Job<'a> {
    plan: &'a Plan,
    scene: &'a Scene,
    extras: Extras,
    block: Block,
}

/// Numbers of one pass over one block.
struct Setup {
    cells: [u32; 2],
    limit: u32,
    /// Cells per row of the parent level, 0 without one.
    parent_width: u32,
    level: Option<LevelUniform>,
}

impl Setup {
    /// Cells of the next level, none after the last.
    fn children(&self) -> [u32; 2] {
        self.level.map_or([0, 0], |level| level.children)
    }

    fn new(job: &Job<'_>, pass: Pass) -> Self {
        let cells_of = |divisor: u32| job.block.size.map(|n| n.div_ceil(divisor));
        let parents = |divisor: u32| {
            if divisor < job.plan.pyramid().coarsest() {
                cells_of(2 * divisor)[0]
            } else {
                0
            }
        };
        match pass {
            Pass::March(level) => {
                let cells = cells_of(level.divisor);
                Self {
                    cells,
                    limit: level.steps,
                    parent_width: parents(level.divisor),
                    level: Some(LevelUniform {
                        divisor: level.divisor,
                        fudge: level.fudge as f32,
                        origin: job.block.origin.map(|o| o / level.divisor),
                        cells,
                        children: cells_of(level.divisor / 2),
                    }),
                }
            }
            Pass::Trace => Self {
                cells: job.block.size,
                limit: job.plan.march.ray_steps(),
                parent_width: parents(1),
                level: None,
            },
            Pass::Color => Self {
                cells: job.block.size,
                limit: 1,
                parent_width: 0,
                level: None,
            },
        }
    }
}

/// Where a block's rows go in a layer of the whole image.
struct Target {
    origin: [u32; 2],
    cells: [u32; 2],
    width: u32,
}

impl Target {
    fn copy<T: Copy>(&self, from: &[T], to: &mut [T]) {
        if from.is_empty() || to.is_empty() {
            return;
        }
        let width = self.cells[0] as usize;
        for (y, row) in (self.origin[1] as usize..).zip(from.chunks(width)) {
            let start = y * self.width as usize + self.origin[0] as usize;
            to[start..start + width].copy_from_slice(row);
        }
    }
}

/// A state as it goes into a frame: cells that were never visited have a sky parent.
fn seen(state: u32) -> u8 {
    if state == UNWRITTEN {
        State::Sky as u8
    } else {
        state as u8
    }
}

/// Empties a list.
fn clear_count(device: &Device, list: &wgpu::Buffer) {
    device.queue.write_buffer(list, COUNT_AT, &[0; 4]);
}

/// Number of cells in a list.
fn list_length(device: &Device, list: &wgpu::Buffer) -> Result<u32, DeviceError> {
    const WORDS: usize = COUNT_AT as usize / 4 + 1;
    let head: Vec<[u32; WORDS]> = read_raw(device, list, 1)?;
    Ok(head.first().map_or(0, |head| head[WORDS - 1]))
}

/// A frame of the right sizes, with nothing in it yet.
pub(crate) fn blank(plan: &Plan, passes: &[Pass], extras: Extras) -> Frame {
    let area = plan.size[0] as usize * plan.size[1] as usize;
    let mut frame = Frame {
        size: plan.size,
        depth: vec![f32::INFINITY; area],
        state: vec![State::Unconverged as u8; area],
        ..Frame::default()
    };
    if !extras.depth_only {
        frame.radiance = vec![[0.0; 3]; area];
    }
    if extras.normals {
        frame.normal = vec![[0.0; 3]; area];
    }
    if extras.count {
        frame.work = vec![Work::default(); area];
    }
    for pass in passes {
        frame.passes.push(PassFigures {
            name: pass.name(),
            ..PassFigures::default()
        });
        if let Pass::March(level) = pass {
            let cells = level.cells(plan.size);
            let count = cells[0] as usize * cells[1] as usize;
            let kept = if extras.levels { count } else { 0 };
            frame.levels.push(LevelLayer {
                divisor: level.divisor,
                cells,
                front: vec![0.0; kept],
                state: vec![0; kept],
                work: vec![Work::default(); if extras.count { count } else { 0 }],
            });
        }
    }
    frame
}

fn read_raw<T: bytemuck::Pod>(
    device: &Device,
    raw: &wgpu::Buffer,
    count: usize,
) -> Result<Vec<T>, DeviceError> {
    Buffer::<T>::over(raw.clone(), count).read(device, count)
}
