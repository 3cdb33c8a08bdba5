//! The executor that `--device` chooses: a device, or the CPU.

use crate::cpu;
use crate::gpu::RenderError;
use crate::gpu::adapters::{Adapters, Choice};
use crate::gpu::device::{Device, DeviceError};
use crate::gpu::render::Renderer;
use crate::pass::progress::{Progress, Watch};
use crate::picture::beside;
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
/// The text is blank.
pub fn device(text: &str) -> Result<Choice, String> {
    Choice::read(text).ok_or_else(|| {
        "must be auto, gpu, software, cpu, an index or a part of a name; `conemarch devices` lists them".into()
    })
}

impl Executor {
    /// Checks that a choice matches an adapter of this machine. Nothing is opened.
    ///
    /// # Errors
    /// No adapter matches.
    pub fn check(choice: &Choice) -> Result<(), DeviceError> {
        // These two always match, and no driver is asked.
        if matches!(choice, Choice::Auto | Choice::Cpu) {
            return Ok(());
        }
        Adapters::find().choose(choice).map(|_| ())
    }

    /// Opens what a choice matches. The text names it and says why it was chosen.
    ///
    /// # Errors
    /// No adapter matches, or it does not open. `auto` then takes the CPU executor.
    pub fn open(choice: &Choice) -> Result<(Self, String), DeviceError> {
        Self::open_with(choice, true)
    }

    /// As [`Executor::open`]. `auto` takes a software adapter only if `software` is set.
    ///
    /// # Errors
    /// As [`Executor::open`].
    pub fn open_with(choice: &Choice, software: bool) -> Result<(Self, String), DeviceError> {
        let (device, why) = match choice {
            Choice::Cpu => (None, "as asked".into()),
            Choice::Auto => match Adapters::find().open_first(software) {
                Ok((device, why)) => (Some(device), why),
                Err(why) => (None, why),
            },
            choice => match Adapters::find().choose(choice)? {
                Some((adapter, why)) => (Some(Device::open(adapter)?), why),
                None => (None, "as there is no adapter".into()),
            },
        };
        let gpu = |device| Self::Gpu(Box::new(Renderer::new(device)));
        let executor = device.map_or(Self::Cpu, gpu);
        let who = format!("{} ({why})", executor.name());
        Ok((executor, who))
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
            Self::Cpu => Ok(cpu::render(plan, assets, extras, watch)?),
        }
    }

    /// Renders the picture of a plan that passes [`Plan::check`]: one view, or those of two eyes side
    /// by side.
    ///
    /// # Errors
    /// As [`Executor::render`].
    pub fn picture(
        &mut self,
        plan: &Plan,
        assets: &Assets,
        extras: Extras,
        watch: Watch<'_>,
    ) -> Result<Frame, RenderError> {
        let Some(eyes) = plan.eyes() else {
            return self.render(plan, assets, extras, watch);
        };
        let mut view = |nth: usize| {
            let half = &mut |now: &Progress| {
                watch(&Progress {
                    done: match now.is_step {
                        true => now.done,
                        false => 0.5 * (nth as f64 + now.done),
                    },
                    ..now.clone()
                })
            };
            self.render(&eyes[nth], assets, extras, half)
        };
        Ok(beside(view(0)?, view(1)?))
    }

    /// The device; `None` for the CPU.
    pub fn device(&self) -> Option<&Device> {
        match self {
            Self::Gpu(renderer) => Some(&renderer.device),
            Self::Cpu => None,
        }
    }

    /// Whether only the clock tells the time: on the CPU, and on devices without timestamps.
    pub fn is_untimed(&self) -> bool {
        self.device().is_none_or(|device| device.tick_ns.is_none())
    }

    /// A warning if the executor's numbers are not precise enough for a plan. The f64 of the
    /// CPU always are.
    pub fn precision_warning(&self, plan: &Plan) -> Option<String> {
        self.device().and_then(|_| plan.precision_warning())
    }

    /// The device's name.
    pub fn name(&self) -> String {
        match self.device() {
            Some(device) => device.info.name.clone(),
            None => format!("the CPU, f64 on {} threads", rayon::current_num_threads()),
        }
    }

    /// What decides the bits of a picture beside its plan: the device and its driver.
    pub fn identity(&self) -> String {
        match self.device() {
            Some(device) if device.info.driver_info.is_empty() => device.info.name.clone(),
            Some(device) => format!("{}, {}", device.info.name, device.info.driver_info),
            None => "the CPU, f64".into(),
        }
    }

    /// `vulkan`, `metal`, `dx12` or `cpu`.
    pub fn backend(&self) -> String {
        let backend = |device: &Device| format!("{:?}", device.info.backend).to_lowercase();
        self.device().map_or("cpu".into(), backend)
    }
}
