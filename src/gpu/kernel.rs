//! A compiled program: its pipeline, its layouts, and its resources by name.
//!
//! Layouts are read from the WGSL, so a binding is declared in one place. Resources are bound
//! by the names of the WGSL variables, so they cannot be swapped.

use std::borrow::Cow;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use wgpu::naga::{self, AddressSpace, ImageClass, ScalarKind, StorageAccess};

use crate::base::shader::Program;
use crate::gpu::array::Array;
use crate::gpu::device::{Device, now};
use crate::gpu::error::RenderError;
use crate::gpu::kernel_error::KernelError;
use crate::gpu::target::new_picture;

/// One resource variable of a program.
struct Binding {
    group: u32,
    index: u32,
    name: String,
    kind: Kind,
    /// The least size of its buffer in bytes.
    bytes: u64,
    /// The file and the line that declare it.
    at: (&'static str, usize),
}

/// The format of a picture on the device: the bytes of sRGB.
pub const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// What a resource variable is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Storage {
        read_only: bool,
    },
    /// A texture of one channel, and whether its numbers are whole.
    Texture {
        whole: bool,
    },
    /// The picture, which is only written.
    Picture,
}

/// The compiled programs of a device. Each is kept once. Clones share them.
#[derive(Clone, Default)]
pub struct Kernels(Arc<Mutex<Compiled>>);

/// A program, and its kernel once a thread has compiled it.
type Compiled = Vec<(Program, Arc<Mutex<Option<Arc<Kernel>>>>)>;

impl Kernels {
    /// The kernel of a program, compiled now if it is new. Other threads that ask for it wait.
    ///
    /// # Errors
    /// The text is wrong, or the driver refuses it.
    pub fn get(&self, device: &Device, program: &Program) -> Result<Arc<Kernel>, KernelError> {
        let place = {
            let mut all = lock(&self.0);
            match all.iter().find(|(p, _)| p == program) {
                Some((_, place)) => place.clone(),
                None => {
                    let place = Arc::default();
                    all.push((program.clone(), Arc::clone(&place)));
                    place
                }
            }
        };
        let mut kept = lock(&place);
        if let Some(kernel) = &*kept {
            return Ok(kernel.clone());
        }
        match Kernel::new(device, program) {
            Ok(kernel) => {
                let mut all = lock(&self.0);
                // Who waited for a thread that failed comes back.
                if !all.iter().any(|(p, _)| p == program) {
                    all.push((program.clone(), Arc::clone(&place)));
                }
                Ok(kept.insert(Arc::new(kernel)).clone())
            }
            Err(error) => {
                lock(&self.0).retain(|(_, p)| !Arc::ptr_eq(p, &place));
                Err(error)
            }
        }
    }

    /// The kernel of a program that was compiled before. It never waits.
    pub fn known(&self, program: &Program) -> Option<Arc<Kernel>> {
        let all = lock(&self.0);
        let (_, place) = all.iter().find(|(p, _)| p == program)?;
        place.try_lock().ok()?.clone()
    }
}

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    // Nothing half-made is put there.
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A compiled program.
pub struct Kernel {
    entry: &'static str,
    pipeline: wgpu::ComputePipeline,
    layouts: Vec<wgpu::BindGroupLayout>,
    bindings: Vec<Binding>,
    /// The array strides of the storage variables in bytes, by name.
    strides: Vec<(String, u32)>,
}

impl Kernel {
    /// Validates and compiles a program.
    pub fn new(device: &Device, program: &Program) -> Result<Self, KernelError> {
        let gpu = &device.device;
        let mut capabilities = naga::valid::Capabilities::default();
        if gpu.features().contains(wgpu::Features::SHADER_F64) {
            capabilities |= naga::valid::Capabilities::FLOAT64;
        }
        let (module, info) = program.validate(capabilities)?;
        let bindings = bindings_of(program, &module, info.get_entry_point(0));
        let strides = strides_of(&module);
        let label = Some(program.entry);
        let groups = bindings.iter().map(|b| b.group + 1).max().unwrap_or(0);
        let most = gpu.limits().max_bind_groups;
        if let Some(b) = bindings.iter().find(|b| b.group >= most) {
            let message = format!(
                "`{}` is in group {}, and the last one is {}",
                b.name,
                b.group,
                most - 1
            );
            return Err(program.fault(b.at, message).into());
        }
        let scope = gpu.push_error_scope(wgpu::ErrorFilter::Validation);
        let layout_of = |group| {
            let of_group = bindings.iter().filter(|b| b.group == group);
            let entries: Vec<_> = of_group.map(layout_entry).collect();
            let entries = &entries;
            gpu.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries })
        };
        let layouts: Vec<_> = (0..groups).map(layout_of).collect();
        let refs: Vec<_> = layouts.iter().map(Some).collect();
        let layout = gpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &refs,
            immediate_size: 0,
        });
        let shader = gpu.create_shader_module(wgpu::ShaderModuleDescriptor {
            label,
            source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
        });
        let pipeline = gpu.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label,
            layout: Some(&layout),
            module: &shader,
            entry_point: label,
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &program.constants(),
                ..Default::default()
            },
            cache: None,
        });
        if let Some(error) = now(scope.pop()).flatten() {
            let (path, line) = program.entry_at();
            let why = error.to_string();
            let words: Vec<&str> = why.split_whitespace().collect();
            return Err(KernelError::Refused {
                path,
                line,
                device: device.info.name.clone(),
                entry: program.entry,
                why: words.join(" "),
            });
        }
        Ok(Self {
            entry: program.entry,
            pipeline,
            layouts,
            bindings,
            strides,
        })
    }

    /// Whether the program reads a variable.
    pub fn reads(&self, name: &str) -> bool {
        self.bindings.iter().any(|b| b.name == name)
    }

    /// An array of numbers for a variable, as the program reads it: in a buffer or in a texture.
    ///
    /// # Errors
    /// The device has no room.
    pub fn array(&self, device: &Device, name: &str, bytes: &[u8]) -> Result<Array, RenderError> {
        let binding = self.bindings.iter().find(|b| b.name == name);
        match binding.map(|b| b.kind) {
            Some(Kind::Texture { whole }) => Array::in_texture(device, name, bytes, whole),
            _ => Array::in_buffer(device, name, bytes),
        }
    }

    /// Bytes per element of a storage array; `None` if the program has no such array.
    pub fn stride(&self, name: &str) -> Option<u32> {
        let found = self.strides.iter().find(|(n, _)| n == name);
        found.map(|(_, s)| *s)
    }

    /// Binds every variable of the program by its name.
    pub fn bind<'a>(
        &self,
        device: &Device,
        resource: impl Fn(&str) -> Option<wgpu::BindingResource<'a>>,
    ) -> Result<Vec<wgpu::BindGroup>, KernelError> {
        let entry = |b: &Binding| {
            let ((path, line), entry, name) = (b.at, self.entry, &b.name);
            let resource = resource(name).ok_or_else(|| KernelError::Unbound {
                path,
                line,
                entry,
                name: name.clone(),
            })?;
            // Else the device would tell when the program runs, without a place.
            if let wgpu::BindingResource::Buffer(bound) = &resource {
                let rest = bound.buffer.size() - bound.offset;
                let bytes = bound.size.map_or(rest, |size| size.get());
                if bytes < b.bytes {
                    return Err(KernelError::Small {
                        path,
                        line,
                        entry,
                        name: name.clone(),
                        needed: b.bytes,
                        bytes,
                    });
                }
            }
            Ok(wgpu::BindGroupEntry {
                binding: b.index,
                resource,
            })
        };
        let group = |(group, layout)| {
            let of_group = self.bindings.iter().filter(|b| b.group == group);
            let entries = of_group.map(entry).collect::<Result<Vec<_>, _>>()?;
            let descriptor = wgpu::BindGroupDescriptor {
                label: Some(self.entry),
                layout,
                entries: &entries,
            };
            Ok(device.device.create_bind_group(&descriptor))
        };
        (0u32..).zip(&self.layouts).map(group).collect()
    }

    /// Has the driver compile what it compiles only when it meets a dispatch: Mesa's software Vulkan
    /// then takes up to a second for a program that its cache does not hold.
    ///
    /// # Errors
    /// The device has no room.
    pub fn warm(&self, device: &Device) -> Result<(), RenderError> {
        // One for each variable, as WebGPU lets no two variables that are written share a buffer.
        let buffer = |b: &Binding| Array::in_buffer(device, "warm", &vec![0; b.bytes as usize]);
        let buffers = self.bindings.iter().map(buffer);
        let buffers = buffers.collect::<Result<Vec<_>, _>>()?;
        let one = [0; 4];
        let numbers = Array::in_texture(device, "warm", &one, false)?;
        let whole_numbers = Array::in_texture(device, "warm", &one, true)?;
        let picture = new_picture(device, [1, 1]).create_view(&Default::default());
        let resource = |name: &str| {
            let at = self.bindings.iter().position(|b| b.name == name)?;
            Some(match self.bindings[at].kind {
                Kind::Storage { .. } => buffers[at].binding(),
                Kind::Texture { whole: false } => numbers.binding(),
                Kind::Texture { whole: true } => whole_numbers.binding(),
                Kind::Picture => wgpu::BindingResource::TextureView(&picture),
            })
        };
        let bound = self.bind(device, resource)?;
        let mut encoder = device.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        self.dispatch(&mut pass, &bound, [0, 0]);
        drop(pass);
        device.submit(encoder);
        Ok(())
    }

    /// Runs so many workgroups over buffers by the names of their variables. The device
    /// reports its failures when results are read.
    ///
    /// # Errors
    /// A variable of the program is not among the buffers.
    pub fn run(
        &self,
        device: &Device,
        bound: &[(&str, &wgpu::Buffer)],
        groups: [u32; 2],
    ) -> Result<(), KernelError> {
        let named = |name: &str| {
            let found = bound.iter().find(|b| b.0 == name);
            found.map(|b| b.1.as_entire_binding())
        };
        let bind = self.bind(device, named)?;
        let mut encoder = device.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        self.dispatch(&mut pass, &bind, groups);
        drop(pass);
        device.submit(encoder);
        Ok(())
    }

    /// Encodes one dispatch of so many workgroups.
    pub fn dispatch(
        &self,
        pass: &mut wgpu::ComputePass,
        groups: &[wgpu::BindGroup],
        count: [u32; 2],
    ) {
        self.set(pass, groups);
        pass.dispatch_workgroups(count[0], count[1], 1);
    }

    /// Encodes one dispatch of as many workgroups as a buffer holds.
    pub fn dispatch_indirect(
        &self,
        pass: &mut wgpu::ComputePass,
        groups: &[wgpu::BindGroup],
        count: &wgpu::Buffer,
    ) {
        self.set(pass, groups);
        pass.dispatch_workgroups_indirect(count, 0);
    }

    fn set(&self, pass: &mut wgpu::ComputePass, groups: &[wgpu::BindGroup]) {
        pass.set_pipeline(&self.pipeline);
        for (i, group) in (0u32..).zip(groups) {
            pass.set_bind_group(i, group, &[]);
        }
    }
}

/// The variables that an entry point reaches.
fn bindings_of(
    program: &Program,
    module: &naga::Module,
    entry: &naga::valid::FunctionInfo,
) -> Vec<Binding> {
    let source = program.source();
    let of = |(handle, v): (naga::Handle<naga::GlobalVariable>, &naga::GlobalVariable)| {
        let at = v.binding.filter(|_| !entry[handle].is_empty())?;
        let kind = match (&module.types[v.ty].inner, v.space) {
            (
                naga::TypeInner::Image {
                    class: ImageClass::Storage { .. },
                    ..
                },
                _,
            ) => Kind::Picture,
            (naga::TypeInner::Image { class, .. }, _) => Kind::Texture {
                whole: matches!(class, ImageClass::Sampled { kind, .. } if *kind == ScalarKind::Uint),
            },
            (_, AddressSpace::Storage { access }) => Kind::Storage {
                read_only: !access.contains(StorageAccess::STORE),
            },
            _ => Kind::Storage { read_only: true },
        };
        Some(Binding {
            group: at.group,
            index: at.binding,
            name: v.name.clone().unwrap_or_default(),
            kind,
            bytes: u64::from(module.types[v.ty].inner.size(module.to_ctx())),
            at: program.place(&source, module.global_variables.get_span(handle)),
        })
    };
    module.global_variables.iter().filter_map(of).collect()
}

fn strides_of(module: &naga::Module) -> Vec<(String, u32)> {
    let of = |(_, v): (_, &naga::GlobalVariable)| match module.types[v.ty].inner {
        naga::TypeInner::Array { stride, .. } => Some((v.name.clone()?, stride)),
        _ => None,
    };
    module.global_variables.iter().filter_map(of).collect()
}

fn layout_entry(b: &Binding) -> wgpu::BindGroupLayoutEntry {
    let ty = match b.kind {
        // Parameters are storage too, as lavapipe of Mesa 22 inlines uniform buffers that steer
        // branches, at times beyond its stack.
        Kind::Storage { read_only } => wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        Kind::Picture => wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: PICTURE,
            view_dimension: wgpu::TextureViewDimension::D2,
        },
        Kind::Texture { whole } => wgpu::BindingType::Texture {
            sample_type: if whole {
                wgpu::TextureSampleType::Uint
            } else {
                wgpu::TextureSampleType::Float { filterable: false }
            },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
    };
    wgpu::BindGroupLayoutEntry {
        binding: b.index,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty,
        count: None,
    }
}
