//! What there is at a pixel or at a point, answered without waiting.

use std::sync::Arc;

use bytemuck::{Zeroable, bytes_of};
use glam::DVec3;
use wgpu::{BindingResource, BufferUsages};

use crate::gpu::array::{Array, KeptArray};
use crate::gpu::buffer::{create, uniform};
use crate::gpu::device::{Device, DeviceError};
use crate::gpu::error::RenderError;
use crate::gpu::kernel::Kernel;
use crate::gpu::staging::Staging;
use crate::gpu::target::Parameters;
use crate::pass::pick::{PickAnswer, PickQuestion, Picked};

/// A question that a device is about to answer.
pub struct Pick {
    device: Arc<Device>,
    answer: Staging,
    eye: DVec3,
}

impl Pick {
    /// Submits a question in so many dispatches.
    pub(super) fn new(
        device: Arc<Device>,
        kernel: &Kernel,
        parameters: &Parameters,
        arrays: &[KeptArray],
        (question, rounds): (PickQuestion, u32),
        eye: DVec3,
    ) -> Result<Self, RenderError> {
        let gpu = &*device;
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let bytes = size_of::<PickAnswer>() as u64;
        let answer = create(gpu, "pick_answer", bytes, usage);
        let walk = u64::from(kernel.stride("walks").unwrap_or(16));
        let buffers = [
            ("pick_answer", answer.clone()),
            ("walks", create(gpu, "walks", walk, usage)),
        ];
        let numbers = [("pick_question", bytes_of(&question))];
        let own = parameters.iter().map(|(name, bytes)| (*name, &bytes[..]));
        let written = own.chain(numbers);
        let written = written.map(|(name, bytes)| (name, uniform(gpu, name, bytes)));
        let buffers: Vec<_> = written.chain(buffers).collect();
        let groups = kernel.bind(gpu, |name| {
            let buffer = buffers.iter().find(|b| b.0 == name);
            let array = || arrays.iter().find(|a| a.name == name);
            let buffer = buffer.map(|b| BindingResource::Buffer(b.1.as_entire_buffer_binding()));
            buffer.or_else(|| array().map(|a| Array::binding(&a.array)))
        })?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for _ in 0..rounds {
            kernel.dispatch(&mut pass, &groups, [1, 1]);
        }
        drop(pass);
        let staging = Staging::new(gpu, bytes);
        staging.copy(&mut encoder, &[(&answer, 0, bytes)]);
        gpu.queue.submit([encoder.finish()]);
        staging.map();
        Ok(Self {
            device,
            answer: staging,
            eye,
        })
    }

    /// The answer, once the device has it. It never waits.
    ///
    /// # Errors
    /// The device failed.
    pub fn poll(&self) -> Result<Option<Picked>, DeviceError> {
        self.device.check()?;
        if !self.answer.is_mapped() {
            return Ok(None);
        }
        let answer: Vec<PickAnswer> = self.answer.read(&self.device, 0, 1)?;
        let answer = answer.first().copied().unwrap_or(PickAnswer::zeroed());
        Ok(Some(answer.picked(self.eye)))
    }
}
