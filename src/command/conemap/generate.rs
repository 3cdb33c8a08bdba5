//! Who makes a cone map, and the bar while it is made.

use std::io::IsTerminal;
use std::time::Duration;

use anyhow::{Context, Result};
use indicatif::{ProgressBar, ProgressStyle};

use crate::command::interrupt;
use crate::gpu::conemap::generate as device;
use crate::gpu::device::{Adapters, Choice, Device, DeviceError, PROMISED_BUFFERS};
use crate::gpu::render::RenderError;
use crate::heightfield::conemap::ConeMap;
use crate::heightfield::conemap::generate::generator::{GenerateError, Generator, Options};
use crate::heightfield::conemap::generate::{cpu, slopes as on_cpu};
use crate::heightfield::heights::{Heights, Patches};

/// Who makes cones.
pub enum Maker {
    /// A device: the same map, bit for bit.
    Gpu(Box<Device>),
    /// All cores, in f64.
    Cpu,
}

impl Maker {
    /// Opens what a choice means, and says in a line who it is and why. Unlike a render,
    /// `auto` passes over software adapters: they are the same cores, which are faster
    /// without them.
    ///
    /// # Errors
    /// The choice matches nothing, or the adapter does not open.
    pub fn open(choice: &Choice) -> Result<(Self, String), DeviceError> {
        let cpu = |why: &str| {
            let threads = rayon::current_num_threads();
            let who = format!("the CPU, f64 on {threads} threads ({why})");
            Ok((Self::Cpu, who))
        };
        if *choice == Choice::Cpu {
            return cpu("as asked");
        }
        let adapters = Adapters::find();
        if *choice == Choice::Auto {
            return match adapters.open_first(PROMISED_BUFFERS, false) {
                Ok((device, why)) => Ok(Self::gpu(device, &why)),
                Err(why) => cpu(&why),
            };
        }
        match adapters.choose(choice)? {
            Some((adapter, why)) => {
                let device = Device::open(adapter, PROMISED_BUFFERS)?;
                Ok(Self::gpu(device, &why))
            }
            None => cpu("as there is no adapter"),
        }
    }

    fn gpu(device: Device, why: &str) -> (Self, String) {
        let who = format!("{} ({why})", device.info.name);
        (Self::Gpu(Box::new(device)), who)
    }
}

/// Makes a map with a bar on terminals, until done or interrupted.
///
/// # Errors
/// The device failed, or an interrupt.
pub fn generate(
    maker: &Maker,
    generator: Generator,
    heights: &Heights,
    patches: Patches,
    options: &Options,
) -> Result<ConeMap> {
    let bar = if std::io::stderr().is_terminal() {
        let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}  {eta} left");
        ProgressBar::new(1000).with_style(style.context("the progress bar")?)
    } else {
        ProgressBar::hidden()
    };
    bar.set_message(generator.name());
    bar.enable_steady_tick(Duration::from_millis(200));
    let watch = &mut |done: f64| {
        bar.set_position((done * 1000.0) as u64);
        !interrupt::asked()
    };
    let made = match maker {
        Maker::Gpu(device) => {
            device::Maker::new(device).generate(generator, heights, patches, options, watch)
        }
        Maker::Cpu => cpu::generate(generator, heights, patches, options, watch),
    };
    bar.finish_and_clear();
    made.map_err(|e| match e {
        GenerateError::Cancelled => RenderError::Cancelled.into(),
        e => e.into(),
    })
}

/// Makes the slopes at the samples, by the same maker.
///
/// # Errors
/// The device failed.
pub fn slopes(maker: &Maker, heights: &Heights) -> Result<Vec<[f32; 2]>> {
    Ok(match maker {
        Maker::Gpu(device) => device::Maker::new(device).slopes(heights)?,
        Maker::Cpu => on_cpu::slopes(heights),
    })
}
