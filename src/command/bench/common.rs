//! What all measurements of presets share: their options, and what these options choose.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;

use crate::command::bench::files::{Files, RowFiles};
use crate::command::executor::{Executor, device};
use crate::command::failure::usage;
use crate::command::print::say;
use crate::command::progress::Reporter;
use crate::command::{arguments, completions, interrupt, memory};
use crate::gpu::adapters::Choice;
use crate::gpu::device::DeviceError;
use crate::plan::Plan;
use crate::preset::{self, Preset};
use crate::scene::Assets;

/// Bytes for every pixel of a measurement: frame, truth, and the pictures that FLIP compares.
/// Measured on 2 million pixels of `error`, which holds most, and rounded up.
const BYTES_PER_PIXEL: u64 = 450;

/// Options of every measurement of presets.
#[derive(Debug, Args)]
pub struct Common {
    /// Presets; all built-in ones if none is named
    #[arg(add = completions::presets())]
    names: Vec<PathBuf>,
    /// Width and height in pixels [default: those of the presets]
    #[arg(long, value_name = "WxH", value_parser = arguments::size)]
    size: Option<[u32; 2]>,
    /// auto, gpu, software, cpu, an index or a part of a name
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = device)]
    device: Choice,
    #[command(flatten)]
    rows: RowFiles,
}

/// A preset to measure.
pub struct Subject {
    /// Its name.
    pub name: String,
    /// Its plan.
    pub plan: Plan,
    /// Its name and number, like `mandelbox (3 of 14)`.
    pub what: String,
}

/// Everything that a measurement of presets needs.
pub struct Measurement {
    /// The presets.
    pub subjects: Vec<Subject>,
    /// What their plans have loaded.
    pub assets: Assets,
    /// Where the results go.
    pub files: Files,
    /// Who renders.
    pub executor: Executor,
}

impl Common {
    /// Loads the presets, prepares the files and opens the device; `plot` is a file too where a
    /// measurement draws.
    ///
    /// # Errors
    /// A preset is unknown or wrong, two have one name, or one does not fit into memory. A file
    /// cannot be written, or is one that is read. The device does not open.
    pub fn begin(&self, plot: Option<&Path>) -> Result<Measurement> {
        let assets = Assets::default();
        let subjects = self.subjects(&assets)?;
        let presets = self.names.iter().filter_map(|name| preset::file(name));
        let presets = presets.map(|file| ("a preset", file));
        let read = subjects.iter().flat_map(|one| one.plan.files());
        let read: Vec<_> = presets.chain(read).collect();
        let files = self.rows.prepare(plot, &read)?;
        Ok(Measurement {
            executor: open(&self.device)?,
            subjects,
            assets,
            files,
        })
    }

    fn subjects(&self, assets: &Assets) -> Result<Vec<Subject>> {
        let mut names = self.names.clone();
        if names.is_empty() {
            names.extend(preset::BUILTIN.iter().map(|(name, _)| name.into()));
        }
        let mut subjects: Vec<Subject> = Vec::new();
        let mut progress = Reporter::start("loading");
        for (i, named) in names.iter().enumerate() {
            let preset = preset::load(named, &[])?;
            progress.report(i as f64 / names.len() as f64, &preset.name);
            preset.load_assets(assets)?;
            interrupt::check()?;
            let Preset { name, mut plan, .. } = preset;
            // What is compared is a single ray of each pixel.
            plan = plan.one_sample();
            plan.size = self.size.unwrap_or(plan.size);
            if subjects.iter().any(|other| other.name == name) {
                return Err(usage(format!(
                    "two presets are called `{name}`, and rows and pictures are told apart by the name; leave one out, or rename its file"
                )));
            }
            memory::check(&plan, BYTES_PER_PIXEL, assets, &self.device)
                .with_context(|| name.clone())?;
            let what = of_how_many(&name, i, names.len());
            subjects.push(Subject { name, plan, what });
        }
        Ok(subjects)
    }
}

/// Opens an executor and announces it on standard error.
///
/// # Errors
/// The choice matches nothing, or the adapter does not open.
pub fn open(device: &Choice) -> Result<Executor, DeviceError> {
    let (executor, who) = Executor::open(device)?;
    say(&format!("measuring on {who}"));
    if executor.is_untimed() {
        say("this device has no timestamps: times are wall time");
    }
    Ok(executor)
}

/// `mandelbox (3 of 14)`.
pub fn of_how_many(name: &str, index: usize, all: usize) -> String {
    format!("{name} ({} of {all})", index + 1)
}
