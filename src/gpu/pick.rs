//! What there is at a pixel or at a point, answered without waiting.

use std::sync::{Arc, PoisonError};

use bytemuck::{Zeroable, bytes_of};
use glam::DVec3;
use wgpu::{BindingResource, BufferUsages};

use crate::base::shader::{Program, Sources};
use crate::gpu::array::Array;
use crate::gpu::background::Background;
use crate::gpu::buffer::{create, uniform};
use crate::gpu::device::Device;
use crate::gpu::error::RenderError;
use crate::gpu::staging::Staging;
use crate::gpu::task_status::Panicked;
use crate::gpu::work::{Shared, marched, most_steps};
use crate::heightfield::tracer::settings::PrepareError;
use crate::pass::pick::{self, At, PickAnswer, PickQuestion, Picked};
use crate::pass::progress::{Progress, Watch};
use crate::plan::Plan;
use crate::scene::Assets;

/// A question to a device.
pub struct Pick {
    device: Arc<Device>,
    /// Until it has answered.
    task: Option<Background<Result<SubmittedPick, RenderError>>>,
    asked: Option<SubmittedPick>,
}

impl Pick {
    pub(super) fn new(
        device: Arc<Device>,
        task: Background<Result<SubmittedPick, RenderError>>,
    ) -> Self {
        Self {
            device,
            task: Some(task),
            asked: None,
        }
    }

    /// The answer, once the device has it. It never waits.
    ///
    /// # Errors
    /// The device failed, a named file cannot be read or does not fit, or a shader text is wrong;
    /// afterwards, [`RenderError::Cancelled`].
    pub fn poll(&mut self) -> Result<Option<Picked>, RenderError> {
        self.device.check()?;
        if let Some(task) = &self.task {
            let answer = task.poll();
            if matches!(answer, Ok(None)) {
                return Ok(None);
            }
            self.task = None;
            self.asked = answer
                .map_err(|Panicked| RenderError::Panicked)?
                .transpose()?;
        }
        let asked = self.asked.as_ref().ok_or(RenderError::Cancelled)?;
        if !asked.answer.is_mapped() {
            return Ok(None);
        }
        let answer: Vec<PickAnswer> = asked.answer.read(&self.device, 0, 1)?;
        let answer = answer.first().copied().unwrap_or(PickAnswer::zeroed());
        Ok(Some(answer.picked(asked.eye)))
    }
}

/// A question that was submitted.
pub struct SubmittedPick {
    answer: Staging,
    eye: DVec3,
}

impl SubmittedPick {
    /// Compiles the program if it is new, and submits the question.
    pub(super) fn new(
        shared: &Shared,
        sources: Option<&Sources>,
        (plan, assets): (&Plan, &Assets),
        at: At,
        tell: Watch<'_>,
    ) -> Result<Self, RenderError> {
        let gpu = &*shared.device;
        let mut own = assets.snapshot(false);
        if !plan.scene.has_assets(&own) {
            let _turn = shared.wait_to_prepare(tell)?;
            shared.make_maps(plan, assets, tell)?;
            plan.scene.load(assets).map_err(PrepareError::from)?;
            own = assets.snapshot(true);
        }
        let scene = plan.scene.solid(&plan.viewpoint(), &own)?;
        let steps = most_steps(&scene);
        let of_cones: u32 = plan.levels().iter().map(|level| level.steps).sum();
        let limit = plan.ray_steps(&scene).saturating_add(of_cones);
        let rounds = match at {
            At::Pixel(_) => limit.div_ceil(steps),
            At::Point(_) => 1,
        };
        let eye = plan.camera.eye;
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let bytes = size_of::<PickAnswer>() as u64;
        let answer = create(gpu, "pick_answer", bytes, usage);
        let question = PickQuestion::new(at, eye, [steps, limit]);
        let mut numbers = marched(plan, &scene);
        numbers.push(("pick_question", bytes_of(&question).to_vec()));
        let written = numbers.iter();
        let written = written.map(|(name, bytes)| (*name, uniform(gpu, name, bytes)));
        let written: Vec<_> = written.collect();
        let prepare = |program: &Program| -> Result<_, RenderError> {
            let kernel = shared.kernels.get(gpu, program)?;
            let walk = u64::from(kernel.stride("walks").unwrap_or(16));
            let walks = create(gpu, "walks", walk, usage);
            let more = [("pick_answer", answer.clone()), ("walks", walks)];
            let buffers: Vec<_> = written.iter().cloned().chain(more).collect();
            let arrays = shared.arrays.lock();
            let arrays = arrays.unwrap_or_else(PoisonError::into_inner);
            let kernels = std::slice::from_ref(&kernel);
            let arrays = arrays.find_or_make(gpu, kernels, scene.twin().arrays(), &mut 0)?;
            let groups = kernel.bind(gpu, |name| {
                let buffer = buffers.iter().find(|b| b.0 == name);
                let array = || arrays.iter().find(|a| a.name == name);
                let buffer =
                    buffer.map(|b| BindingResource::Buffer(b.1.as_entire_buffer_binding()));
                buffer.or_else(|| array().map(|a| Array::binding(&a.array)))
            })?;
            Ok((kernel, groups))
        };
        let (kernel, groups) = loop {
            let mut program = vec![pick::program(&plan.view(), &scene)];
            let texts = shared.texts.put(sources, &mut program);
            match (prepare(&program[0]), texts.edited(program.iter())) {
                (Err(RenderError::Kernel(error)), Some(edited)) => {
                    if !shared.texts.skips(&edited, &error) {
                        if !tell(&Progress::default()) {
                            return Err(RenderError::Cancelled);
                        }
                        shared.texts.failed(&edited, &error);
                        return Err(error.into());
                    }
                }
                (prepared, _) => break prepared?,
            }
        };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for _ in 0..rounds {
            kernel.dispatch(&mut pass, &groups, [1, 1]);
        }
        drop(pass);
        let staging = Staging::new(gpu, bytes);
        staging.copy(&mut encoder, &[(&answer, 0, bytes)]);
        gpu.submit(encoder);
        staging.map();
        Ok(Self {
            answer: staging,
            eye,
        })
    }
}
