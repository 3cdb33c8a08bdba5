//! The window's surface: the last picture, turned to the view of now, under the panel.

use std::sync::Arc;

use egui::{ClippedPrimitive, TexturesDelta};
use egui_wgpu::{RendererOptions, ScreenDescriptor};
use wgpu::{SurfaceTexture, TextureFormat, TextureUsages};
use winit::window::Window;

use crate::base::view::View;
use crate::gpu::buffer::create;
use crate::gpu::device::Device;
use crate::preview::draw::{
    BYTES, ScreenParameters, attachment, bind, layout, module, pipeline, render_pass, texture,
    view_of,
};
use crate::preview::error::PreviewError;

/// A finished picture.
struct FinishedPicture {
    texture: wgpu::Texture,
    bound: wgpu::BindGroup,
    view: View,
}

/// The panel's texture.
struct Panel {
    painter: egui_wgpu::Renderer,
    texture: wgpu::Texture,
    bound: wgpu::BindGroup,
}

/// The surface of a window.
pub struct Screen {
    device: Arc<Device>,
    config: wgpu::SurfaceConfiguration,
    layout: wgpu::BindGroupLayout,
    show_picture: wgpu::RenderPipeline,
    show_panel: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
    parameters: wgpu::Buffer,
    held: Option<FinishedPicture>,
    panel: Panel,
    surface: wgpu::Surface<'static>,
}

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// It is on the screen.
    Yes,
    /// The window is hidden.
    Hidden,
    /// The surface was made again; try once more.
    Again,
}

/// Width and height of the largest window: WebGPU's default limit, with which devices are opened.
pub const MOST_SIDE: u32 = 8192;

impl Screen {
    /// Takes over a window's surface.
    ///
    /// # Errors
    /// The device cannot show pictures on it.
    pub fn new(
        surface: wgpu::Surface<'static>,
        device: Device,
        adapter: &wgpu::Adapter,
        size: [u32; 2],
    ) -> Result<Self, PreviewError> {
        let size = size.map(|n| n.min(MOST_SIDE));
        let can = surface.get_capabilities(adapter);
        // Its bytes go to the screen as they are.
        let plain = |f: &&TextureFormat| matches!(**f, TextureFormat::Bgra8Unorm | BYTES);
        let first = can.formats.iter().find(plain).or(can.formats.first());
        let format = *first.ok_or_else(|| PreviewError::Surface(device.info.name.clone()))?;
        let written = format.remove_srgb_suffix();
        // Neither waits for the screen, so that a key is answered at once.
        let quick = [wgpu::PresentMode::Mailbox, wgpu::PresentMode::Immediate];
        let quick = quick.into_iter().find(|m| can.present_modes.contains(m));
        let config = wgpu::SurfaceConfiguration {
            usage: TextureUsages::RENDER_ATTACHMENT,
            format,
            color_space: wgpu::SurfaceColorSpace::default(),
            width: size[0],
            height: size[1],
            present_mode: quick.unwrap_or(wgpu::PresentMode::AutoVsync),
            desired_maximum_frame_latency: 1,
            alpha_mode: can.alpha_modes.first().copied().unwrap_or_default(),
            view_formats: match written == format {
                true => Vec::new(),
                false => vec![written],
            },
        };
        let device = Arc::new(device);
        device.alone(|| surface.configure(&device.device, &config));
        let gpu = &device.device;
        let layout = layout(gpu);
        let shader = gpu.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("screen"),
            source: wgpu::ShaderSource::Wgsl(module().source),
        });
        let pipeline = |entry: &str, blend| pipeline(gpu, &shader, &layout, entry, written, blend);
        let sampler = gpu.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let usage = wgpu::BufferUsages::UNIFORM;
        let bytes = size_of::<ScreenParameters>() as u64;
        let parameters = create(&device, "screen_parameters", bytes, usage);
        let painter = egui_wgpu::Renderer::new(
            gpu,
            BYTES,
            RendererOptions {
                dithering: false,
                ..Default::default()
            },
        );
        let texture = texture(&device, "panel", size, TextureUsages::RENDER_ATTACHMENT);
        let bound = bind(&device, &layout, &parameters, &view_of(&texture), &sampler);
        Ok(Self {
            show_picture: pipeline("show_picture", None),
            show_panel: pipeline(
                "show_panel",
                Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            ),
            surface,
            config,
            layout,
            sampler,
            parameters,
            held: None,
            panel: Panel {
                painter,
                texture,
                bound,
            },
            device,
        })
    }

    /// The device that draws.
    pub fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// Whether the device takes commands. If not, the next picture fails and tells why; egui's painter
    /// would panic.
    pub fn works(&self) -> bool {
        let bytes = wgpu::BufferSize::new(size_of::<ScreenParameters>() as u64);
        // They are written again before each drawing.
        let write = |bytes| {
            self.device
                .queue
                .write_buffer_with(&self.parameters, 0, bytes)
        };
        bytes.and_then(write).is_some()
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// Follows the window's size. Both sides are at least 1.
    pub fn resize(&mut self, size: [u32; 2]) {
        let size = size.map(|n| n.min(MOST_SIDE));
        if size == self.size() {
            return;
        }
        [self.config.width, self.config.height] = size;
        self.configure();
        let usage = TextureUsages::RENDER_ATTACHMENT;
        self.panel.texture = texture(&self.device, "panel", size, usage);
        self.panel.bound = self.bind(&self.panel.texture);
    }

    fn configure(&self) {
        let device = &self.device;
        device.alone(|| self.surface.configure(&device.device, &self.config));
    }

    fn bind(&self, texture: &wgpu::Texture) -> wgpu::BindGroup {
        let view = view_of(texture);
        bind(
            &self.device,
            &self.layout,
            &self.parameters,
            &view,
            &self.sampler,
        )
    }

    /// The texture for a picture of a size: the last one, if it fits.
    fn room(&mut self, view: View) -> &wgpu::Texture {
        let size = view.size;
        let fits = |held: &FinishedPicture| [held.texture.width(), held.texture.height()] == size;
        let held = self.held.take().filter(fits);
        let held = held
            .map(|held| FinishedPicture { view, ..held })
            .unwrap_or_else(|| {
                let texture = texture(&self.device, "shown", size, TextureUsages::COPY_DST);
                let bound = self.bind(&texture);
                FinishedPicture {
                    texture,
                    bound,
                    view,
                }
            });
        &self.held.insert(held).texture
    }

    /// Keeps a picture of a view, so that the next one can be made in its place.
    pub fn hold(&mut self, picture: &wgpu::Texture, view: View) {
        let device = self.device.clone();
        let to = self.room(view);
        let mut encoder = device.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_texture(
            picture.as_image_copy(),
            to.as_image_copy(),
            picture.size(),
        );
        device.submit(encoder);
    }

    /// Keeps a picture that the host made: four bytes to a pixel, row by row.
    pub fn hold_pixels(&mut self, pixels: &[u8], view: View) {
        let device = self.device.clone();
        let to = self.room(view);
        let layout = wgpu::TexelCopyBufferLayout {
            bytes_per_row: Some(4 * view.size[0]),
            ..Default::default()
        };
        device
            .queue
            .write_texture(to.as_image_copy(), pixels, layout, to.size());
    }

    /// Paints the panel anew.
    pub fn paint_panel(
        &mut self,
        mut textures: TexturesDelta,
        primitives: &[ClippedPrimitive],
        pixels_per_point: f32,
    ) {
        let device = self.device.clone();
        let gpu = &device.device;
        let screen = ScreenDescriptor {
            size_in_pixels: self.size(),
            pixels_per_point,
        };
        let Panel {
            painter, texture, ..
        } = &mut self.panel;
        for (id, deltas) in &textures.set {
            for delta in deltas {
                painter.update_texture(gpu, &device.queue, *id, delta);
            }
        }
        let mut encoder = gpu.create_command_encoder(&Default::default());
        painter.update_buffers(gpu, &device.queue, &mut encoder, primitives, &screen);
        let view = view_of(texture);
        let pass =
            encoder.begin_render_pass(&render_pass(&[attachment(&view, wgpu::Color::TRANSPARENT)]));
        painter.render(&mut pass.forget_lifetime(), primitives, &screen);
        device.submit(encoder);
        for id in &textures.free {
            painter.free_texture(id);
        }
        textures.clear();
    }

    /// Draws the last picture as a view sees it, and the parts of the panel: x, y, width and height
    /// of each in pixels.
    ///
    /// # Errors
    /// The surface is lost for good.
    pub fn show(
        &mut self,
        window: &Arc<Window>,
        view: &View,
        over: &[[u32; 4]],
    ) -> Result<Shown, PreviewError> {
        use wgpu::CurrentSurfaceTexture as Current;
        let device = self.device.clone();
        let (frame, worn) = match self.surface.get_current_texture() {
            Current::Success(frame) => (frame, false),
            Current::Suboptimal(frame) => (frame, true),
            Current::Timeout | Current::Occluded => return Ok(Shown::Hidden),
            Current::Outdated | Current::Lost => {
                self.configure();
                return Ok(Shown::Again);
            }
            Current::Validation => {
                return Err(PreviewError::Surface(device.info.name.clone()));
            }
        };
        self.draw(&frame, view, over);
        window.pre_present_notify();
        let image = frame.texture.clone();
        device.queue.present(frame);
        if device.check().is_err() {
            // wgpu does not present the image of a lost device, and it would panic when the surface
            // is dropped with that image.
            image.destroy();
        }
        if worn {
            self.configure();
        }
        Ok(Shown::Yes)
    }

    fn draw(&self, frame: &SurfaceTexture, view: &View, over: &[[u32; 4]]) {
        let device = &self.device;
        let written = self.config.format.remove_srgb_suffix();
        let target = frame.texture.create_view(&wgpu::TextureViewDescriptor {
            format: Some(written),
            ..Default::default()
        });
        let mut encoder = device.device.create_command_encoder(&Default::default());
        if let Some(held) = &self.held {
            let parameters = ScreenParameters::new(&held.view, view);
            let bytes = bytemuck::bytes_of(&parameters);
            device.queue.write_buffer(&self.parameters, 0, bytes);
        }
        let grey = wgpu::Color {
            r: 0.1,
            g: 0.1,
            b: 0.1,
            a: 1.0,
        };
        let mut pass = encoder.begin_render_pass(&render_pass(&[attachment(&target, grey)]));
        if let Some(held) = &self.held {
            pass.set_pipeline(&self.show_picture);
            pass.set_bind_group(0, &held.bound, &[]);
            pass.draw(0..3, 0..1);
        }
        pass.set_pipeline(&self.show_panel);
        pass.set_bind_group(0, &self.panel.bound, &[]);
        let size = self.size();
        for [x, y, w, h] in over {
            // A rectangle may be older than the size of the window.
            let (x, y) = ((*x).min(size[0]), (*y).min(size[1]));
            let [w, h] = [(*w).min(size[0] - x), (*h).min(size[1] - y)];
            if w > 0 && h > 0 {
                pass.set_scissor_rect(x, y, w, h);
                pass.draw(0..3, 0..1);
            }
        }
        drop(pass);
        device.submit(encoder);
    }
}
