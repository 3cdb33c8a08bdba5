//! One executor out of two: a renderer on a device, or the CPU.

use crate::cpu;
use crate::gpu::RenderError;
use crate::gpu::device::{Adapters, Choice, Device, DeviceError, STORAGE_BUFFERS};
use crate::gpu::render::Renderer;
use crate::pass::progress::Watch;
use crate::picture::frame::Frame;
use crate::plan::{Extras, Plan};
use crate::scene::Assets;

/// Who runs a plan.
pub enum Executor {
    /// The GPU executor on an open device.
    Gpu(Box<Renderer>),
    /// The f64 executor on all cores.
    Cpu,
}

/// Reads `--device`.
///
/// # Errors
/// There is nothing to read.
pub fn device(text: &str) -> Result<Choice, String> {
    Choice::read(text).ok_or_else(|| {
        "must be auto, gpu, software, cpu, an index or a part of a name; `conemarch devices` lists them".into()
    })
}

impl Executor {
    /// Whether a choice means anything here, nothing being opened.
    ///
    /// # Errors
    /// It matches nothing.
    pub fn check(choice: &Choice) -> Result<(), DeviceError> {
        // These two always mean something, and ask no driver.
        if matches!(choice, Choice::Auto | Choice::Cpu) {
            return Ok(());
        }
        Adapters::find().choose(choice).map(|_| ())
    }

    /// Opens what a choice means, and says in a line who it is and why.
    ///
    /// # Errors
    /// The choice matches nothing, or the adapter does not open. `auto` has the CPU
    /// executor left for both.
    pub fn open(choice: &Choice) -> Result<(Self, String), DeviceError> {
        Self::open_with(choice, STORAGE_BUFFERS)
    }

    /// As [`Executor::open`], for programs that bind up to so many storage buffers: those of
    /// cone maps need fewer than those of pictures.
    ///
    /// # Errors
    /// As [`Executor::open`].
    pub fn open_with(choice: &Choice, storage_buffers: u32) -> Result<(Self, String), DeviceError> {
        if *choice == Choice::Cpu {
            return Ok(Self::cpu("as asked"));
        }
        let adapters = Adapters::find();
        if *choice == Choice::Auto {
            return Ok(match adapters.open_first(storage_buffers, true) {
                Ok((device, why)) => Self::gpu(device, &why),
                Err(why) => Self::cpu(&why),
            });
        }
        let Some((adapter, why)) = adapters.choose(choice)? else {
            return Ok(Self::cpu("as there is no adapter"));
        };
        let device = Device::open(adapter, storage_buffers)?;
        Ok(Self::gpu(device, &why))
    }

    fn gpu(device: Device, why: &str) -> (Self, String) {
        let who = format!("{} ({why})", device.info.name);
        (Self::Gpu(Box::new(Renderer::new(device))), who)
    }

    fn cpu(why: &str) -> (Self, String) {
        let who = format!("{} ({why})", Self::Cpu.name());
        (Self::Cpu, who)
    }

    /// Renders a plan that passes [`Plan::check`].
    ///
    /// # Errors
    /// The device failed, or `watch` returned `false`.
    pub fn render(
        &mut self,
        plan: &Plan,
        assets: &Assets,
        extras: Extras,
        watch: Watch<'_>,
    ) -> Result<Frame, RenderError> {
        match self {
            Self::Gpu(renderer) => renderer.render(plan, assets, extras, watch),
            Self::Cpu => cpu::render(plan, assets, extras, watch),
        }
    }

    /// Whether nothing but the clock tells the time: on the CPU, and on devices that have
    /// no timestamps.
    pub fn is_untimed(&self) -> bool {
        match self {
            Self::Gpu(renderer) => renderer.device.tick_ns.is_none(),
            Self::Cpu => true,
        }
    }

    /// A sentence where the numbers of the executor cannot hold what a plan asks for. The
    /// CPU has f64, and nothing to be warned of.
    pub fn precision_warning(&self, plan: &Plan) -> Option<String> {
        match self {
            Self::Gpu(_) => plan.precision_warning(),
            Self::Cpu => None,
        }
    }

    /// The device's name.
    pub fn name(&self) -> String {
        match self {
            Self::Gpu(renderer) => renderer.device.info.name.clone(),
            Self::Cpu => format!("the CPU, f64 on {} threads", rayon::current_num_threads()),
        }
    }

    /// `vulkan`, `metal`, `dx12` or `cpu`.
    pub fn backend(&self) -> String {
        match self {
            Self::Gpu(renderer) => format!("{:?}", renderer.device.info.backend).to_lowercase(),
            Self::Cpu => "cpu".into(),
        }
    }
}
