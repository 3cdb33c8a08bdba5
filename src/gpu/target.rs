//! What a frame is rendered into: buffers, and kernels with their resources bound.
//!
//! A [`Target`] is kept between frames. Another frame with the same programs and sizes only
//! rewrites parameters.

use std::sync::Arc;

use bytemuck::{Zeroable, bytes_of};
use wgpu::BufferUsages;

use crate::base::shader::Program;
use crate::gpu::array::{Array, DeviceArray};
use crate::gpu::buffer::{create, uniform};
use crate::gpu::device::Device;
use crate::gpu::error::{RenderError, check_room};
use crate::gpu::kernel::{Kernel, PICTURE};
use crate::pass::layout::{CellsHead, Layout};
use crate::pass::turn::{Stage, Turn};

/// What decides a target.
#[derive(Clone, Debug, PartialEq)]
pub struct Needs {
    /// The programs of the stages of a block, in order.
    pub programs: Vec<Program>,
    /// The largest block.
    pub layout: Layout,
    /// The size of the picture that is shown while it is made, if there is one.
    pub picture: Option<[u32; 2]>,
}

impl Needs {
    /// Whether sizes and the programs of so many stages are the same.
    fn like(&self, other: &Self, stages: usize) -> bool {
        self.programs.len() == other.programs.len()
            && self.programs[..stages] == other.programs[..stages]
            && self.layout == other.layout
            && self.picture == other.picture
    }

    /// The program of the last frame that can run in place of another, if a slider passed through
    /// zero since.
    pub fn held(&self, program: &Program) -> Option<Program> {
        let held = self.programs.iter().find(|held| held.serves(program));
        held.cloned()
    }
}

/// The parameters of a frame: bytes by the names of the WGSL variables.
pub type Parameters = Vec<(&'static str, Vec<u8>)>;

/// A buffer of parameters with what it holds.
struct Parameter {
    name: &'static str,
    bytes: Vec<u8>,
    buffer: wgpu::Buffer,
}

/// A stage: its kernel, and the resources of it and of `arrange`.
pub struct Bound {
    /// Resources of the program that arranges its dispatches.
    pub arrange: Vec<wgpu::BindGroup>,
    /// Its kernel.
    pub kernel: Arc<Kernel>,
    /// Its resources.
    pub groups: Vec<wgpu::BindGroup>,
}

/// What all stages share.
pub struct SharedBuffers {
    /// The turn.
    pub turn: wgpu::Buffer,
    /// The values and lists of cells.
    pub cells: wgpu::Buffer,
    /// The rays that still move.
    walks: wgpu::Buffer,
    /// Workgroups of the next dispatch.
    pub workgroups: wgpu::Buffer,
    /// The picture that is shown while it is made.
    pub picture: Option<wgpu::Texture>,
}

impl SharedBuffers {
    fn view(&self) -> Option<wgpu::TextureView> {
        let picture = self.picture.as_ref();
        picture.map(|p| p.create_view(&Default::default()))
    }

    /// The resource of a WGSL variable.
    fn named<'a>(
        &'a self,
        name: &str,
        parameters: &'a [Parameter],
        scene: &'a [DeviceArray],
        view: Option<&'a wgpu::TextureView>,
    ) -> Option<wgpu::BindingResource<'a>> {
        let shared = match name {
            "turn" | "turn_parameters" => Some(&self.turn),
            "cells" => Some(&self.cells),
            "walks" => Some(&self.walks),
            "workgroups" => Some(&self.workgroups),
            _ => None,
        };
        let own = || {
            let found = parameters.iter().find(|p| p.name == name);
            found.map(|p| &p.buffer)
        };
        let buffer = shared.or_else(own).map(wgpu::Buffer::as_entire_binding);
        let array = || {
            let found = scene.iter().find(|a| a.name == name);
            found.map(|a| a.array.binding())
        };
        let picture = || {
            let view = view.filter(|_| name == "picture");
            view.map(wgpu::BindingResource::TextureView)
        };
        buffer.or_else(array).or_else(picture)
    }
}

/// Buffers, kernels and bound resources of the frames of one kind.
pub struct Target {
    /// Programs and sizes.
    pub needs: Needs,
    parameters: Vec<Parameter>,
    arrays: Vec<Arc<Array>>,
    /// The number of the last block of the last frame. States contain it in 30 bits.
    generation: u32,
    /// What all stages share.
    pub shared: SharedBuffers,
    /// The program that arranges dispatches.
    pub arrange: Arc<Kernel>,
    /// The stages of a block.
    pub stages: Vec<Bound>,
    /// Their numbers, one stage every `stage_step` bytes, and what was written there last.
    numbers: wgpu::Buffer,
    stage_step: u64,
    written: Vec<Stage>,
}

impl Target {
    /// Compiles what is new, allocates and binds.
    ///
    /// # Errors
    /// A program is wrong, or the device has no room.
    pub fn new(
        device: &Device,
        compiled: Vec<Arc<Kernel>>,
        arrange: Arc<Kernel>,
        needs: Needs,
        parameters: Parameters,
        scene: &[DeviceArray],
    ) -> Result<Self, RenderError> {
        let most = device.most_bound();
        let room = |what: &str, bytes: u64| {
            check_room(&device.info.name, what, bytes, most)?;
            let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
            Ok::<_, RenderError>(create(
                device,
                what,
                bytes.max(16).next_multiple_of(16),
                usage,
            ))
        };
        let parameter = |(name, bytes): (&'static str, Vec<u8>)| Parameter {
            name,
            buffer: uniform(device, name, &bytes),
            bytes,
        };
        let parameters: Vec<Parameter> = parameters.into_iter().map(parameter).collect();
        let pixels = u64::from(needs.layout.count(1));
        let strides = compiled.iter().filter_map(|k| k.stride("walks"));
        let walk = u64::from(strides.max().unwrap_or(0));
        let turn = room("turn", size_of::<Turn>() as u64)?;
        let head = size_of::<CellsHead>() as u64;
        let cells = room("cells", head + 4 * u64::from(needs.layout.words()))?;
        let walks = room("walks", walk * pixels)?;
        let usage = BufferUsages::STORAGE | BufferUsages::INDIRECT;
        let workgroups = create(device, "workgroups", 16, usage);
        let picture = needs.picture.map(|size| new_picture(device, size));
        let shared = SharedBuffers {
            turn,
            cells,
            walks,
            workgroups,
            picture,
        };
        let view = shared.view();
        let named = |name: &str| shared.named(name, &parameters, scene, view.as_ref());
        let step = device.device.limits().min_storage_buffer_offset_alignment;
        let stage_step = (size_of::<Stage>() as u64).next_multiple_of(u64::from(step));
        let numbers = room("stages", stage_step * compiled.len() as u64)?;
        let bind = |(offset, kernel): (u64, Arc<Kernel>)| {
            let stage = wgpu::BufferBinding {
                buffer: &numbers,
                offset: offset * stage_step,
                size: wgpu::BufferSize::new(size_of::<Stage>() as u64),
            };
            let with_stage = |name: &str| match name {
                "stage_parameters" => Some(wgpu::BindingResource::Buffer(stage.clone())),
                other => named(other),
            };
            Ok::<_, RenderError>(Bound {
                arrange: arrange.bind(device, with_stage)?,
                groups: kernel.bind(device, named)?,
                kernel,
            })
        };
        Ok(Self {
            stages: (0..).zip(compiled).map(bind).collect::<Result<_, _>>()?,
            numbers,
            stage_step,
            written: Vec::new(),
            needs,
            parameters,
            arrays: scene.iter().map(|a| a.array.clone()).collect(),
            generation: 0,
            shared,
            arrange,
        })
    }

    /// Puts other kernels in the place of those whose programs differ.
    ///
    /// # Errors
    /// A variable of a program is unknown.
    pub fn rebind(
        &mut self,
        device: &Device,
        kernels: Vec<Arc<Kernel>>,
        needs: Needs,
        scene: &[DeviceArray],
    ) -> Result<(), RenderError> {
        let view = self.shared.view();
        let named = |name: &str| {
            self.shared
                .named(name, &self.parameters, scene, view.as_ref())
        };
        let olds = self.needs.programs.iter().zip(&needs.programs);
        let changed = kernels.into_iter().zip(olds).enumerate();
        let changed = changed.filter(|(_, (_, (old, new)))| old != new);
        let bind = |(stage, (kernel, _)): (usize, (Arc<Kernel>, _))| {
            Ok::<_, RenderError>((stage, kernel.bind(device, named)?, kernel))
        };
        // If one fails, all stay.
        let bound: Vec<_> = changed.map(bind).collect::<Result<_, _>>()?;
        for (stage, groups, kernel) in bound {
            let stage = &mut self.stages[stage];
            (stage.groups, stage.kernel) = (groups, kernel);
        }
        self.needs = needs;
        Ok(())
    }

    /// Whether the target serves a frame: its sizes, its arrays, and the programs of the first
    /// stages are the same. The others can be put in their places.
    pub fn serves(
        &self,
        needs: &Needs,
        arrange: &Arc<Kernel>,
        stages: usize,
        parameters: &Parameters,
        scene: &[DeviceArray],
    ) -> bool {
        let same = |own: &Parameter| {
            let found = parameters.iter().find(|(name, _)| *name == own.name);
            found.is_some_and(|(_, bytes)| own.bytes.len() == bytes.len())
        };
        let mut arrays = self.arrays.iter().zip(scene);
        self.generation < u32::MAX >> 3
            && Arc::ptr_eq(&self.arrange, arrange)
            && self.needs.like(needs, stages)
            && self.parameters.iter().all(same)
            && self.arrays.len() == scene.len()
            && arrays.all(|(own, kept)| Arc::ptr_eq(own, &kept.array))
    }

    /// Rewrites the parameters that differ. Returns the bytes written.
    pub fn rewrite(&mut self, device: &Device, parameters: Parameters) -> usize {
        let mut written = 0;
        for (name, bytes) in parameters {
            let mut own = self.parameters.iter_mut();
            if let Some(own) = own.find(|p| p.name == name && p.bytes != bytes) {
                device.queue.write_buffer(&own.buffer, 0, &bytes);
                written += bytes.len();
                own.bytes = bytes;
            }
        }
        written
    }

    /// Starts a frame of new blocks.
    pub fn begin(&mut self, device: &Device, blocks: usize) {
        self.generation += blocks as u32;
        self.resume(device, 0);
    }

    /// The number of the block that so many blocks follow.
    pub fn generation(&self, later: usize) -> u32 {
        self.generation - later as u32
    }

    /// Starts a frame of the last blocks with one of its stages.
    pub fn resume(&self, device: &Device, number: u32) {
        let turn = Turn {
            number,
            ..Turn::zeroed()
        };
        let head = CellsHead::zeroed();
        device
            .queue
            .write_buffer(&self.shared.turn, 0, bytes_of(&turn));
        device
            .queue
            .write_buffer(&self.shared.cells, 0, bytes_of(&head));
    }

    /// Writes the numbers of the stages of a block, if they differ from the last ones.
    pub fn write_stages(&mut self, device: &Device, stages: &[Stage]) {
        if self.written == stages {
            return;
        }
        let mut bytes = vec![0; self.stage_step as usize * stages.len()];
        for (to, stage) in bytes.chunks_mut(self.stage_step as usize).zip(stages) {
            to[..size_of::<Stage>()].copy_from_slice(bytes_of(stage));
        }
        device.queue.write_buffer(&self.numbers, 0, &bytes);
        self.written = stages.to_vec();
    }
}

pub fn new_picture(device: &Device, [width, height]: [u32; 2]) -> wgpu::Texture {
    let usage = wgpu::TextureUsages::STORAGE_BINDING
        | wgpu::TextureUsages::TEXTURE_BINDING
        | wgpu::TextureUsages::COPY_SRC
        | wgpu::TextureUsages::COPY_DST;
    device.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture"),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: PICTURE,
        usage,
        view_formats: &[],
    })
}
