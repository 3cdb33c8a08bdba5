//! The window: how it opens, and the loop of its events.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use wgpu::{Adapter, Instance, Surface};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::{Window, WindowId};

use crate::gpu::adapters::{Adapters, Choice};
use crate::gpu::device::Device;
use crate::plan::Plan;
use crate::preset::{Override, Preset};
use crate::preview::error::PreviewError;
use crate::preview::live::Live;
use crate::preview::meter::Figures;
use crate::preview::screen::Screen;

/// How long the loop sleeps if nothing is under way: files are looked at so often.
pub const REST: Duration = Duration::from_millis(300);

/// What a preview begins with.
pub struct Options {
    /// The preset.
    pub preset: Preset,
    /// The file that it is in, if it is in one.
    pub path: Option<PathBuf>,
    /// Values that were set over those of the file.
    pub sets: Vec<Override>,
    /// Who renders.
    pub device: Choice,
    /// Width and height of the window.
    pub size: [u32; 2],
    /// A folder of shader texts that are read again when they change.
    pub wgsl: Option<PathBuf>,
    /// Where unsaved work is kept; `None` to keep none.
    pub kept: Option<PathBuf>,
    /// Says why a still does not fit into memory, if it does not.
    pub fits: fn(&Plan) -> Result<(), String>,
    /// When the program was started.
    pub started: Instant,
}

/// Opens a window, and returns the figures of the session when it is closed.
///
/// # Errors
/// No window opens, or no adapter can draw to it.
pub fn run(options: Options) -> Result<Option<Figures>, PreviewError> {
    let no_display = |e: winit::error::EventLoopError| {
        // The places in the sources before it tell a user nothing.
        let text = e.to_string();
        let why = text.rsplit(": ").next().unwrap_or_default();
        PreviewError::Display(why.trim_end_matches('.').into())
    };
    let event_loop = EventLoop::new().map_err(no_display)?;
    let mut app = App {
        options: Some(options),
        live: None,
        ended: Ok(None),
    };
    event_loop.run_app(&mut app).map_err(no_display)?;
    app.ended
}

struct App {
    options: Option<Options>,
    live: Option<Live>,
    ended: Result<Option<Figures>, PreviewError>,
}

impl App {
    fn with(
        &mut self,
        event_loop: &ActiveEventLoop,
        act: impl FnOnce(&mut Live) -> Result<(), PreviewError>,
    ) {
        let Some(live) = &mut self.live else { return };
        let acted = act(live);
        if acted.is_err() || live.is_closed() {
            self.ended = acted.map(|()| Some(live.figures()));
            event_loop.exit();
        }
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        let Some(options) = self.options.take() else {
            return;
        };
        match Stage::open(event_loop, &options) {
            Ok(stage) => self.live = Some(Live::new(stage, options)),
            Err(e) => {
                self.ended = Err(e);
                event_loop.exit();
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        self.with(event_loop, |live| live.event(&event));
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let mut next = REST;
        self.with(event_loop, |live| {
            next = live.tick()?;
            Ok(())
        });
        event_loop.set_control_flow(ControlFlow::WaitUntil(Instant::now() + next));
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        // The surface goes before the display that it is on.
        self.live = None;
    }
}

/// A window with a surface, and a device that draws to it.
pub struct Stage {
    /// The window.
    pub window: Arc<Window>,
    /// Its surface.
    pub screen: Screen,
    adapters: Adapters,
    adapter: Adapter,
}

impl Stage {
    /// Opens a window.
    fn open(event_loop: &ActiveEventLoop, options: &Options) -> Result<Self, PreviewError> {
        let [width, height] = options.size;
        let attributes = Window::default_attributes()
            .with_title(format!("{} - conemarch", options.preset.name))
            .with_inner_size(PhysicalSize::new(width, height));
        let window = event_loop.create_window(attributes);
        let window = Arc::new(window.map_err(|e| PreviewError::Display(e.to_string()))?);
        let adapters = Adapters::find();
        let surface = surface_of(adapters.instance(), &window)?;
        let adapter = adapter_for(&adapters, &options.device, &surface)?;
        let device = Device::open(&adapter)?;
        let screen = Screen::new(surface, device, &adapter, size_of(&window))?;
        Ok(Self {
            window,
            screen,
            adapters,
            adapter,
        })
    }

    /// Opens the device again after a loss, with another surface.
    ///
    /// # Errors
    /// It does not open.
    pub fn reopen(&mut self) -> Result<(), PreviewError> {
        let surface = surface_of(self.adapters.instance(), &self.window)?;
        let device = Device::open(&self.adapter)?;
        let screen = Screen::new(surface, device, &self.adapter, size_of(&self.window))?;
        self.screen = screen;
        Ok(())
    }
}

fn size_of(window: &Window) -> [u32; 2] {
    let size = window.inner_size();
    [size.width.max(1), size.height.max(1)]
}

fn surface_of(instance: &Instance, window: &Arc<Window>) -> Result<Surface<'static>, PreviewError> {
    let made = instance.create_surface(window.clone());
    made.map_err(|e| PreviewError::Adapter(e.to_string()))
}

/// The adapter of a choice that can draw to a surface.
fn adapter_for(
    adapters: &Adapters,
    choice: &Choice,
    surface: &Surface<'_>,
) -> Result<Adapter, PreviewError> {
    if *choice == Choice::Auto {
        let mut all = adapters.in_order().into_iter().map(|(adapter, _)| adapter);
        let found = all.find(|adapter| adapter.is_surface_supported(surface));
        return found
            .cloned()
            .ok_or_else(|| PreviewError::Adapter("none of this machine's fits".into()));
    }
    let Some((adapter, _)) = adapters.choose(choice)? else {
        let why = "the CPU executor draws to no window";
        return Err(PreviewError::Adapter(why.into()));
    };
    match adapter.is_surface_supported(surface) {
        true => Ok(adapter.clone()),
        false => Err(PreviewError::Adapter(adapter.get_info().name)),
    }
}
