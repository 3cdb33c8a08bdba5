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
use crate::pass::trace::TraceUniform;
use crate::plan::{Extras, Pass, Plan};
use crate::pyramid::{Block, Level};
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
    /// Steps per dispatch.
    pub chunk: u32,
}

impl Default for Cutting {
    fn default() -> Self {
        Self {
            // 16 MiB for the widest channel, and well under a second per dispatch on
            // slow devices.
            block: 1024,
            // One dispatch holds the default step limit; a second costs a software
            // device as much as a sixth of a whole picture.
            chunk: 256,
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
        let level = setup.level.map(|bytes| {
            let raw = Rc::new(uniform(
                &self.device,
                "level",
                &bytes(self.cutting.chunk, 0),
            ));
            bound.insert("level".into(), raw.clone());
            (raw, bytes)
        });
        let groups = kernel.bind(&self.device, |name| bound.get(name).map(|b| &**b))?;
        let count = setup.cells.map(|c| c.div_ceil(8));
        let moving = bound.get("moving").cloned();
        self.device.wait()?;
        let start = Instant::now();
        let mut gpu_ns = None;
        let mut done = 0;
        loop {
            if let Some((raw, bytes)) = &level {
                let data = bytes(self.cutting.chunk, done);
                self.device.queue.write_buffer(raw, 0, &data);
            }
            let mut encoder = self
                .device
                .device
                .create_command_encoder(&Default::default());
            if let Some(moving) = &moving {
                encoder.clear_buffer(moving, 0, None);
            }
            let timed = self.queries.as_ref().filter(|_| job.extras.time);
            let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: None,
                timestamp_writes: timed.map(|(set, _)| wgpu::ComputePassTimestampWrites {
                    query_set: set,
                    beginning_of_pass_write_index: Some(0),
                    end_of_pass_write_index: Some(1),
                }),
            });
            kernel.dispatch(&mut compute, &groups, count);
            drop(compute);
            self.device.queue.submit([encoder.finish()]);
            self.device.wait()?;
            if job.extras.time {
                let ns = self.read_timestamps()?;
                gpu_ns = ns.map(|ns| gpu_ns.unwrap_or(0.0) + ns);
            }
            done = done.saturating_add(self.cutting.chunk);
            if done >= setup.limit {
                break;
            }
            let Some(moving) = &moving else { break };
            if read_u32(&self.device, moving)? == 0 {
                break;
            }
        }
        let figures = &mut frame.passes[at];
        figures.cells += u64::from(setup.cells[0]) * u64::from(setup.cells[1]);
        figures.wall_ms += start.elapsed().as_secs_f64() * 1e3;
        if let Some(ns) = gpu_ns {
            *figures.gpu_ms.get_or_insert(0.0) += ns * 1e-6;
        }
        Ok(())
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
        let parent = |what: &str| format!("{what} {}", at.wrapping_sub(1));
        let (front, state) = if setup.has_parent {
            (
                self.storage(&parent("front"), 0),
                self.storage(&parent("state"), 0),
            )
        } else {
            (self.storage("none front", 4), self.storage("none state", 4))
        };
        bound.insert("parent_front".into(), front);
        bound.insert("parent_state".into(), state);
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
        bound.insert("moving".into(), self.storage("moving", 16));
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
                let wrong = states.iter().filter(|s| State::from_code(**s).is_none());
                let pixels = wrong.count();
                if pixels > 0 {
                    return Err(RenderError::Unwritten {
                        device: device.info.name.clone(),
                        pixels,
                    });
                }
                let mut depth: Vec<f32> = read_raw(device, front, count)?;
                for (t, s) in depth.iter_mut().zip(&states) {
                    if *s == State::Sky as u32 {
                        *t = f32::INFINITY;
                    }
                }
                let states: Vec<u8> = states.into_iter().map(|s| s as u8).collect();
                to.copy(&depth, &mut frame.depth);
                to.copy(&states, &mut frame.state);
                to.copy(&work, &mut frame.work);
                continue;
            }
            let layer = &mut frame.levels[at];
            to.copy(&work, &mut layer.work);
            if job.extras.levels {
                let states: Vec<u32> = read_raw(device, state, count)?;
                let states: Vec<u8> = states.into_iter().map(|s| s.min(255) as u8).collect();
                to.copy(&read_raw::<f32>(device, front, count)?, &mut layer.front);
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

/// Makes the bytes of a pass's uniform, from chunk and steps done.
type LevelBytes = Box<dyn Fn(u32, u32) -> Vec<u8>>;

/// Numbers of one pass over one block.
struct Setup {
    cells: [u32; 2],
    limit: u32,
    has_parent: bool,
    level: Option<LevelBytes>,
}

impl Setup {
    fn new(job: &Job<'_>, pass: Pass) -> Self {
        let pyramid = job.plan.pyramid();
        let cells_of = |divisor: u32| job.block.size.map(|n| n.div_ceil(divisor));
        match pass {
            Pass::March(level) => {
                let has_parent = level.divisor < pyramid.coarsest();
                Self {
                    cells: cells_of(level.divisor),
                    limit: level.steps,
                    has_parent,
                    level: Some(level_bytes(job.block, level, has_parent)),
                }
            }
            Pass::Trace => {
                let has_parent = !pyramid.levels.is_empty();
                let width = if has_parent { cells_of(2)[0] } else { 0 };
                let limit = job.plan.march.ray_steps();
                Self {
                    cells: job.block.size,
                    limit,
                    has_parent,
                    level: Some(Box::new(move |chunk, done| {
                        let uniform = TraceUniform {
                            chunk,
                            limit,
                            done,
                            parent_width: width,
                        };
                        bytes_of(&uniform).to_vec()
                    })),
                }
            }
            Pass::Color => Self {
                cells: job.block.size,
                limit: 1,
                has_parent: false,
                level: None,
            },
        }
    }
}

fn level_bytes(block: Block, level: Level, has_parent: bool) -> LevelBytes {
    let cells = block.size.map(|n| n.div_ceil(level.divisor));
    let parents = block.size[0].div_ceil(2 * level.divisor);
    Box::new(move |chunk, done| {
        let uniform = LevelUniform {
            divisor: level.divisor,
            chunk,
            limit: level.steps,
            done,
            origin: block.origin.map(|o| o / level.divisor),
            cells,
            parent_width: if has_parent { parents } else { 0 },
            fudge: level.fudge as f32,
            pad0: 0,
            pad1: 0,
        };
        bytes_of(&uniform).to_vec()
    })
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

fn read_u32(device: &Device, raw: &wgpu::Buffer) -> Result<u32, DeviceError> {
    Ok(read_raw(device, raw, 1)?.first().copied().unwrap_or(0))
}

fn read_raw<T: bytemuck::Pod>(
    device: &Device,
    raw: &wgpu::Buffer,
    count: usize,
) -> Result<Vec<T>, DeviceError> {
    Buffer::<T>::over(raw.clone(), count).read(device, count)
}
