//! Opens what makes a cone map, and makes it with a report of the progress.

use anyhow::Result;

use crate::command::interrupt;
use crate::command::progress::Progress;
use crate::gpu::conemap::generate::Maker;
use crate::gpu::device::{Adapters, Choice, Device, DeviceError, PROMISED_BUFFERS};
use crate::gpu::render::RenderError;
use crate::heightfield::conemap::ConeMap;
use crate::heightfield::conemap::generate::cpu;
use crate::heightfield::conemap::generate::generator::{GenerateError, Generator, Options};
use crate::heightfield::heights::{Heights, Patches};

/// Opens the device of a choice, or `None` for the CPU, with a line that says which and why.
/// Unlike a render, `auto` passes over software adapters: they run on the same cores, which
/// are faster without them.
///
/// # Errors
/// The choice matches nothing, or the adapter does not open.
pub fn open(choice: &Choice) -> Result<(Option<Device>, String), DeviceError> {
    let (device, why) = match choice {
        Choice::Cpu => (None, "as asked".into()),
        Choice::Auto => match Adapters::find().open_first(PROMISED_BUFFERS, false) {
            Ok((device, why)) => (Some(device), why),
            Err(why) => (None, why),
        },
        choice => match Adapters::find().choose(choice)? {
            Some((adapter, why)) => (Some(Device::open(adapter, PROMISED_BUFFERS)?), why),
            None => (None, "as there is no adapter".into()),
        },
    };
    let threads = rayon::current_num_threads();
    let who = match &device {
        Some(device) => device.info.name.clone(),
        None => format!("the CPU, f64 on {threads} threads"),
    };
    Ok((device, format!("{who} ({why})")))
}

/// Makes a map, until it is done or interrupted.
///
/// # Errors
/// The device failed, or an interrupt.
pub fn generate(
    device: Option<&Device>,
    generator: Generator,
    heights: &Heights,
    patches: Patches,
    options: &Options,
) -> Result<ConeMap> {
    let mut progress = Progress::start("making cones");
    let watch = &mut |done: f64| {
        progress.report(done, generator.name());
        !interrupt::asked()
    };
    let made = match device {
        Some(device) => Maker::new(device).generate(generator, heights, patches, options, watch),
        None => cpu::generate(generator, heights, patches, options, watch),
    };
    made.map_err(|e| match e {
        GenerateError::Cancelled => RenderError::Cancelled.into(),
        e => e.into(),
    })
}
