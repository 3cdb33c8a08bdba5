//! What all measurements share: which presets, on which device, and where rows go.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;

use crate::command::executor::{Executor, device};
use crate::command::failure::usage;
use crate::command::memory;
use crate::command::print::{print, say, tell};
use crate::command::sink::{Parcel, Sink, apart, is_stdout, spared};
use crate::command::size;
use crate::gpu::device::{Choice, DeviceError, STORAGE_BUFFERS};
use crate::plan::Plan;
use crate::preset;
use crate::scene::Assets;

/// Bytes for every pixel of a measurement: frame, truth, and the pictures that FLIP compares.
/// Measured on 2 million pixels of `error`, which holds most, and rounded up.
const BYTES_PER_PIXEL: u64 = 450;

/// Options of every measurement.
#[derive(Debug, Args)]
pub struct Common {
    /// Presets; all built-in ones where none is named
    pub names: Vec<String>,
    /// Pixels, instead of the presets' own
    #[arg(long, value_name = "WxH", value_parser = size::read)]
    pub size: Option<[u32; 2]>,
    /// auto, gpu, software, cpu, an index or a part of a name
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = device)]
    pub device: Choice,
    /// Write the rows as JSON too; - is standard output, and the tables go to stderr then
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the rows as CSV too, - as above
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

impl Common {
    /// Every preset's name and plan.
    ///
    /// # Errors
    /// A preset is unknown or wrong, two have one name, or one does not fit into memory.
    pub fn plans(&self, assets: &Assets) -> Result<Vec<(String, Plan)>> {
        let all = || preset::BUILTIN.iter().map(|(name, _)| (*name).to_string());
        let names: Vec<String> = if self.names.is_empty() {
            all().collect()
        } else {
            self.names.clone()
        };
        let load = |name: String| {
            let found = preset::load(&name, &[])?;
            found.load_assets(assets)?;
            let mut plan = found.plan;
            plan.size = self.size.unwrap_or(plan.size);
            Ok((found.name, plan))
        };
        let plans: Result<Vec<(String, Plan)>> = names.into_iter().map(load).collect();
        let plans = plans?;
        for (i, (name, _)) in plans.iter().enumerate() {
            if plans[..i].iter().any(|(n, _)| n == name) {
                return Err(usage(format!(
                    "two of the presets are called `{name}`, and rows and pictures go by the name; leave one out, or give its file another name"
                )));
            }
        }
        for (name, plan) in &plans {
            if let Some(why) = memory::lacking(plan.size, BYTES_PER_PIXEL, memory::available()) {
                anyhow::bail!("{name}: {why}");
            }
            if let Some(why) = memory::lacking_for(plan, assets, memory::available()) {
                anyhow::bail!("{name}: {why}");
            }
        }
        Ok(plans)
    }

    /// The executor, announced on standard error.
    ///
    /// # Errors
    /// The choice matches nothing, or the adapter does not open.
    pub fn executor(&self) -> Result<Executor, DeviceError> {
        self.executor_with(STORAGE_BUFFERS)
    }

    /// An executor whose programs bind up to so many storage buffers.
    ///
    /// # Errors
    /// As [`Common::executor`].
    pub fn executor_with(&self, storage_buffers: u32) -> Result<Executor, DeviceError> {
        let (executor, who) = Executor::open_with(&self.device, storage_buffers)?;
        say(&format!("measuring on {who}"));
        if executor.is_untimed() {
            say("this device has no timestamps: times are wall time");
        }
        Ok(executor)
    }

    /// Makes sure that the asked files can be written, before anything is measured;
    /// `plot` is that of a measurement that draws.
    ///
    /// # Errors
    /// One of them cannot, two are the same, or one is a preset or a file that a plan names.
    pub fn files(&self, plot: Option<&Path>, plans: &[(String, Plan)]) -> Result<Files> {
        let named = [
            ("--json", self.json.as_deref()),
            ("--csv", self.csv.as_deref()),
            ("--plot", plot),
        ];
        apart(&named)?;
        let presets = self.names.iter().filter_map(|name| preset::file(name));
        let presets = presets.map(|file| ("a preset", file));
        let read = plans.iter().flat_map(|(_, plan)| plan.scene.files());
        spared(&named, &presets.chain(read).collect::<Vec<_>>())?;
        let [json, csv, plot] = named.map(|(_, path)| path.map(Sink::prepare).transpose());
        Ok(Files {
            json: json?,
            csv: csv?,
            plot: plot?,
            printing: named.iter().any(|(_, path)| path.is_some_and(is_stdout)),
            parcel: Parcel::default(),
        })
    }
}

/// Where the rows and pictures of a measurement go.
pub struct Files {
    json: Option<Sink>,
    csv: Option<Sink>,
    plot: Option<Sink>,
    /// Whether standard output is one of them.
    printing: bool,
    /// Results that are written already.
    pub parcel: Parcel,
}

impl Files {
    /// Shows a table: on standard output, unless that carries rows or a picture.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn show(&self, table: &str) -> Result<()> {
        if self.printing {
            tell(table);
            return Ok(());
        }
        print(table.as_bytes())
    }

    /// Writes the picture, if one was asked for.
    ///
    /// # Errors
    /// The disk is full.
    pub fn draw(&mut self, picture: impl FnOnce() -> String) -> Result<()> {
        if let Some(sink) = self.plot.take() {
            self.parcel.put(sink, picture().as_bytes())?;
        }
        Ok(())
    }

    /// Writes all rows, and hands over everything that was written, or nothing.
    ///
    /// # Errors
    /// A file or standard output cannot be written.
    pub fn write<R: Serialize>(mut self, rows: &[R], flat: &[Vec<(String, String)>]) -> Result<()> {
        if let Some(sink) = self.json {
            let mut text =
                serde_json::to_string_pretty(rows).context("the rows cannot be written")?;
            text.push('\n');
            self.parcel.put(sink, text.as_bytes())?;
        }
        if let Some(sink) = self.csv {
            self.parcel.put(sink, &csv(flat)?)?;
        }
        self.parcel.hand_over()
    }
}

/// Rows of names and values as CSV: a line of names first.
fn csv(rows: &[Vec<(String, String)>]) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    if let Some(first) = rows.first() {
        writer.write_record(first.iter().map(|(name, _)| name))?;
    }
    for row in rows {
        writer.write_record(row.iter().map(|(_, value)| value))?;
    }
    writer.into_inner().context("the rows cannot be written")
}

/// The middle of some values; sorts them.
pub fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
