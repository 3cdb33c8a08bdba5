//! Arrays of the host on the device: in a storage buffer, or in a texture of 4 bytes per texel.
//!
//! WebGPU promises eight storage buffers to a stage, of 128 MiB each. Textures are more, and a
//! texture of 8192 x 8192 numbers has 256 MiB.

use std::any::Any;
use std::sync::Arc;

use crate::base::array::SceneArray;
use crate::gpu::buffer::uniform;
use crate::gpu::device::Device;
use crate::gpu::error::{RenderError, check_room};
use crate::gpu::kernel::Kernel;

/// Numbers in a row of a texture. `wgsl/heightfield/heights.wgsl` counts on it.
const ROW: u32 = 8192;

/// An array on the device.
pub enum Array {
    /// Bytes as they are.
    Buffer(wgpu::Buffer),
    /// Numbers of 4 bytes, row by row.
    Texture(wgpu::Texture, wgpu::TextureView),
}

impl Array {
    /// An array in a storage buffer.
    ///
    /// # Errors
    /// The device has no room.
    pub fn in_buffer(device: &Device, name: &str, bytes: &[u8]) -> Result<Self, RenderError> {
        let most = device.most_bound();
        check_room(&device.info.name, name, bytes.len() as u64, most)?;
        Ok(Self::Buffer(uniform(device, name, bytes)))
    }

    /// An array of f32, or of u32, in a texture.
    ///
    /// # Errors
    /// The device has no room.
    pub fn in_texture(
        device: &Device,
        name: &str,
        bytes: &[u8],
        whole: bool,
    ) -> Result<Self, RenderError> {
        let row = 4 * ROW as usize;
        let most = row as u64 * u64::from(device.device.limits().max_texture_dimension_2d);
        check_room(&device.info.name, name, bytes.len() as u64, most)?;
        let texture = device.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(name),
            size: wgpu::Extent3d {
                width: ROW,
                height: bytes.len().div_ceil(row).max(1) as u32,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: if whole {
                wgpu::TextureFormat::R32Uint
            } else {
                wgpu::TextureFormat::R32Float
            },
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&Default::default());
        let array = Self::Texture(texture, view);
        array.write(device, bytes);
        Ok(array)
    }

    /// Overwrites the array with as many bytes as it was made of.
    pub fn write(&self, device: &Device, bytes: &[u8]) {
        match self {
            Self::Buffer(buffer) => device.queue.write_buffer(buffer, 0, bytes),
            Self::Texture(texture, _) => {
                let row = 4 * ROW as usize;
                let full = bytes.len() / row;
                let (rows, rest) = bytes.split_at(full * row);
                write_rows(device, texture, 0, rows, ROW);
                write_rows(device, texture, full as u32, rest, rest.len() as u32 / 4);
            }
        }
    }

    /// What a variable is bound to.
    pub fn binding(&self) -> wgpu::BindingResource<'_> {
        match self {
            Self::Buffer(buffer) => buffer.as_entire_binding(),
            Self::Texture(_, view) => wgpu::BindingResource::TextureView(view),
        }
    }
}

/// Writes rows of a texture, from row `y` on.
fn write_rows(device: &Device, texture: &wgpu::Texture, y: u32, bytes: &[u8], width: u32) {
    if bytes.is_empty() {
        return;
    }
    let to = wgpu::TexelCopyTextureInfo {
        origin: wgpu::Origin3d { x: 0, y, z: 0 },
        ..texture.as_image_copy()
    };
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(4 * width),
        rows_per_image: None,
    };
    let size = wgpu::Extent3d {
        width,
        height: bytes.len() as u32 / 4 / width,
        depth_or_array_layers: 1,
    };
    device.queue.write_texture(to, bytes, layout, size);
}

/// The arrays of the last scene, kept as long as the scene's assets stay the same.
#[derive(Default)]
pub struct Arrays(Vec<DeviceArray>);

/// An array with what it was made of.
#[derive(Clone)]
pub struct DeviceArray {
    /// The WGSL variable.
    pub name: &'static str,
    origin: Arc<dyn Any + Send + Sync>,
    /// The array.
    pub array: Arc<Array>,
}

impl Arrays {
    /// The arrays of a scene: the kept ones, or new ones as the kernels read them. Others are
    /// dropped. Adds the bytes written to `uploads`.
    ///
    /// # Errors
    /// The device has no room.
    pub fn keep(
        &mut self,
        device: &Device,
        kernels: &[Arc<Kernel>],
        scene: Vec<SceneArray>,
        uploads: &mut usize,
    ) -> Result<Vec<DeviceArray>, RenderError> {
        self.0 = self.find_or_make(device, kernels, scene, uploads)?;
        Ok(self.0.clone())
    }

    /// Whether kernels read an array of a scene that is not kept.
    pub fn lacks(&self, kernels: &[Arc<Kernel>], scene: &[SceneArray]) -> bool {
        scene.iter().any(|asked| {
            let reads = kernels.iter().any(|k| k.reads(asked.name));
            reads && self.kept(asked).is_none()
        })
    }

    fn kept(&self, asked: &SceneArray) -> Option<&DeviceArray> {
        let same = |kept: &&DeviceArray| {
            kept.name == asked.name && Arc::ptr_eq(&kept.origin, &asked.origin)
        };
        self.0.iter().find(same)
    }

    /// As [`Arrays::keep`], without a change of what is kept.
    ///
    /// # Errors
    /// The device has no room.
    pub fn find_or_make(
        &self,
        device: &Device,
        kernels: &[Arc<Kernel>],
        scene: Vec<SceneArray>,
        uploads: &mut usize,
    ) -> Result<Vec<DeviceArray>, RenderError> {
        let mut found = Vec::new();
        for asked in scene {
            if let Some(kept) = self.kept(&asked) {
                found.push(kept.clone());
                continue;
            }
            let reader = kernels.iter().find(|k| k.reads(asked.name));
            // No program may read it: a depth picture has no colours.
            let Some(reader) = reader else { continue };
            let bytes = asked.bytes();
            *uploads += bytes.len();
            found.push(DeviceArray {
                name: asked.name,
                array: Arc::new(reader.array(device, asked.name, &bytes)?),
                origin: asked.origin,
            });
        }
        Ok(found)
    }
}
