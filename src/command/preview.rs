//! `conemarch preview [PRESET]`

use std::path::PathBuf;
use std::time::Instant;

use anyhow::Result;
use clap::{Args, ValueHint};

use crate::command::arguments::size;
use crate::command::completions;
use crate::command::executor::device;
use crate::command::failure::usage;
use crate::command::memory;
use crate::command::output::Format;
use crate::command::render::loaded;
use crate::command::sink::{Results, Sink};
use crate::gpu::adapters::Choice;
use crate::measure::truth::cache_folder;
use crate::picture::Layer;
use crate::plan::{Extras, Plan};
use crate::preset::{self, Override};
use crate::preview::screen::MOST_SIDE;
use crate::preview::window::{self, Options};

/// What `preview` takes.
#[derive(Args, Debug)]
pub struct Preview {
    /// A built-in preset, a .toml file, or a .png or .exr file that this program wrote
    #[arg(value_name = "PRESET", default_value = "mandelbox", add = completions::presets())]
    preset: PathBuf,

    /// Width and height of the window in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = window_size)]
    size: [u32; 2],

    /// Set one value of the preset; may be given again
    #[arg(long, value_name = "SECTION.KEY=VALUE", allow_hyphen_values = true)]
    #[arg(add = completions::settings())]
    set: Vec<String>,

    /// A folder like wgsl/ of the sources; its shader files are used, and read again when they
    /// change
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    wgsl: Option<PathBuf>,

    /// Write at the end how quickly the window answered, as JSON
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    stats: Option<PathBuf>,

    /// Who renders: auto, gpu, software, or an index or part of a name from `devices`
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = device)]
    device: Choice,
}

fn window_size(text: &str) -> Result<[u32; 2], String> {
    let size = size(text)?;
    match size.iter().all(|n| *n <= MOST_SIDE) {
        true => Ok(size),
        false => Err(format!(
            "a window has at most {MOST_SIDE}x{MOST_SIDE} pixels; F12 and `render` make larger pictures"
        )),
    }
}

/// Whether a still, which is no file of bands, fits into memory.
fn fits(plan: &Plan) -> Result<(), String> {
    let per_pixel = Format::Png.bytes_per_pixel(Layer::Color, plan, Extras::default());
    let helps = "save the preset with Ctrl+S and use `conemarch render`, which writes pictures of any size in bands";
    memory::check_pixels("a still", plan.size, per_pixel, helps).map_err(|e| e.to_string())
}

/// Opens a window on a preset.
///
/// # Errors
/// A wrong preset or option, no display, or no adapter that can draw to the window.
pub fn run(args: &Preview) -> Result<()> {
    let started = Instant::now();
    let (preset, _) = loaded(&args.preset, &args.set)?;
    let sets: Result<_, _> = args.set.iter().map(|s| Override::read(s)).collect();
    if let Some(folder) = args.wgsl.as_ref().filter(|folder| !folder.is_dir()) {
        let folder = folder.display();
        return Err(usage(format!(
            "--wgsl `{folder}` is no folder; copy wgsl/ of the sources"
        )));
    }
    if let Some(inner) = args.wgsl.as_ref().map(|folder| folder.join("wgsl"))
        && inner.is_dir()
    {
        return Err(usage(format!(
            "--wgsl names a folder like wgsl/ itself; try --wgsl {}",
            inner.display()
        )));
    }
    let stats = args.stats.as_deref().map(Sink::prepare).transpose()?;
    let figures = window::run(Options {
        preset,
        path: preset::file(&args.preset),
        sets: sets?,
        device: args.device.clone(),
        size: args.size,
        wgsl: args.wgsl.clone(),
        kept: cache_folder(),
        fits,
        started,
    })?;
    if let Some(stats) = stats {
        let mut results = Results::default();
        results.put_json(stats, &figures)?;
        results.hand_over()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_still_that_does_not_fit_is_refused_with_advice() {
        let (preset, _) = loaded("mandelbox".as_ref(), &[]).expect("a preset");
        let mut plan = preset.plan;
        assert_eq!(fits(&plan), Ok(()));
        plan.size = [1 << 20, 1 << 20];
        let why = fits(&plan).expect_err("more than there is");
        assert!(why.contains("a still") && why.contains("bands"), "{why}");
    }
}
