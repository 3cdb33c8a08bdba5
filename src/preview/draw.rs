//! How a picture and the panel are drawn: pipelines and what they bind.
//! Twin: `wgsl/preview/draw.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec3, Vec4};
use wgpu::{BindingResource, TextureFormat, TextureUsages, TextureView};

use crate::base::projection::Projection;
use crate::base::shader::Module;
use crate::base::view::View;
use crate::gpu::device::Device;
use crate::plan::pyramid::Block;
use crate::wgsl;

/// The format of pictures and of the panel: bytes as files hold them.
pub const BYTES: TextureFormat = TextureFormat::Rgba8Unorm;

/// The shader.
pub fn module() -> Module {
    wgsl!("preview/draw.wgsl")
}

/// The parameters of the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ScreenParameters {
    to_picture: [Vec4; 3],
    size: [f32; 2],
    exact: u32,
    pad: u32,
}

impl ScreenParameters {
    /// Those that show a picture of a view to another one.
    pub fn new(picture: &View, now: &View) -> Self {
        let map = turned(now, picture);
        let columns = [map.x_axis, map.y_axis, map.z_axis];
        Self {
            to_picture: columns.map(|c: DVec3| c.as_vec3().extend(0.0)),
            size: picture.size.map(|n| n as f32),
            exact: u32::from(picture == now),
            pad: 0,
        }
    }
}

/// A texture that shaders read.
pub fn texture(device: &Device, name: &str, size: [u32; 2], usage: TextureUsages) -> wgpu::Texture {
    device.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(name),
        size: wgpu::Extent3d {
            width: size[0],
            height: size[1],
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: BYTES,
        usage: usage | TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })
}

/// Copies blocks of a picture to the same places of another one.
pub fn copy_blocks(device: &Device, from: &wgpu::Texture, to: &wgpu::Texture, blocks: &[Block]) {
    if blocks.is_empty() {
        return;
    }
    let mut encoder = device.device.create_command_encoder(&Default::default());
    for block in blocks {
        let at = |texture| wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: 0,
            origin: wgpu::Origin3d {
                x: block.origin[0],
                y: block.origin[1],
                z: 0,
            },
            aspect: wgpu::TextureAspect::All,
        };
        let size = wgpu::Extent3d {
            width: block.size[0],
            height: block.size[1],
            depth_or_array_layers: 1,
        };
        encoder.copy_texture_to_texture(at(from), at(to), size);
    }
    device.submit(encoder);
}

/// All of a texture.
pub fn view_of(texture: &wgpu::Texture) -> TextureView {
    texture.create_view(&Default::default())
}

/// The map from pixels of one view to pixels of another with the same eye. Only even image planes
/// have one. Any other picture stays in its place.
fn turned(from: &View, to: &View) -> DMat3 {
    let even = |view: &View| view.projection == Projection::Perspective;
    if !even(from) || !even(to) {
        let factor = |i: usize| f64::from(to.size[i]) / f64::from(from.size[i]);
        return DMat3::from_diagonal(DVec3::new(factor(0), factor(1), 1.0));
    }
    // The pixel on the view axis.
    let middle = |view: &View| {
        let shift = [-view.shift.x, view.shift.y].map(|s| s / view.pixel);
        [0, 1].map(|i| 0.5 * f64::from(view.size[i]) + shift[i])
    };
    let [w, h] = middle(from);
    // Directions of pixels.
    let ways = DMat3::from_cols(
        from.pixel * from.right,
        -from.pixel * from.up,
        from.forward + from.pixel * (h * from.up - w * from.right),
    );
    let [w, h] = middle(to);
    let pixels = DMat3::from_cols(
        to.right / to.pixel + w * to.forward,
        -to.up / to.pixel + h * to.forward,
        to.forward,
    );
    pixels.transpose() * ways
}

/// A texture that is cleared and drawn to.
pub fn attachment(
    view: &TextureView,
    clear: wgpu::Color,
) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Clear(clear),
            store: wgpu::StoreOp::Store,
        },
    })
}

/// A pass over attachments.
pub fn render_pass<'a>(
    attachments: &'a [Option<wgpu::RenderPassColorAttachment<'a>>],
) -> wgpu::RenderPassDescriptor<'a> {
    wgpu::RenderPassDescriptor {
        color_attachments: attachments,
        ..Default::default()
    }
}

/// What both shaders bind: parameters, the texture that is shown, and a sampler.
pub fn layout(gpu: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty,
        count: None,
    };
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    gpu.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("screen"),
        entries: &[entry(0, uniform), entry(1, texture), entry(2, sampler)],
    })
}

/// The bound resources of one texture.
pub fn bind(
    device: &Device,
    layout: &wgpu::BindGroupLayout,
    parameters: &wgpu::Buffer,
    source: &TextureView,
    sampler: &wgpu::Sampler,
) -> wgpu::BindGroup {
    let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
    device.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("screen"),
        layout,
        entries: &[
            entry(0, parameters.as_entire_binding()),
            entry(1, BindingResource::TextureView(source)),
            entry(2, BindingResource::Sampler(sampler)),
        ],
    })
}

/// The pipeline of a fragment shader.
pub fn pipeline(
    gpu: &wgpu::Device,
    shader: &wgpu::ShaderModule,
    layout: &wgpu::BindGroupLayout,
    entry: &str,
    format: TextureFormat,
    blend: Option<wgpu::BlendState>,
) -> wgpu::RenderPipeline {
    let layouts = [Some(layout)];
    let layout = gpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        bind_group_layouts: &layouts,
        ..Default::default()
    });
    gpu.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(entry),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: shader,
            entry_point: Some("cover"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: shader,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format,
                blend,
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn a_pixel_is_turned_to_the_pixel_of_the_same_direction() {
        let view = |target: DVec3, fov, size| {
            View::new(DVec3::new(0.0, -5.0, 1.0), target, DVec3::Z, fov, size)
        };
        let now = View {
            shift: DVec2::new(0.3, -0.2),
            ..view(DVec3::new(0.3, 0.0, 0.9), 50.0, [640, 360])
        };
        let then = view(DVec3::ZERO, 40.0, [160, 90]);
        let map = turned(&now, &then);
        for (x, y) in [(0.5, 0.5), (300.0, 200.0), (639.5, 12.5)] {
            let to = map * DVec3::new(x, y, 1.0);
            let (a, b) = (
                now.view_direction(x, y).normalize(),
                then.view_direction(to.x / to.z, to.y / to.z).normalize(),
            );
            assert!(a.distance(b) < 1e-12, "{a} {b}");
        }
    }
}
