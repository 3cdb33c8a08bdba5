//! The options that all measurements share: presets, size, device and the files for rows.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use serde::Serialize;

use crate::command::bench::row::flat;
use crate::command::executor::{Executor, device};
use crate::command::failure::usage;
use crate::command::print::{print, say, tell};
use crate::command::sink::{Parcel, Sink, apart, is_stdout, spared};
use crate::command::{completions, memory, size};
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
    /// Presets; all built-in ones if none is named
    #[arg(add = completions::presets())]
    pub names: Vec<PathBuf>,
    /// Width and height in pixels, in place of the presets'
    #[arg(long, value_name = "WxH", value_parser = size::read)]
    pub size: Option<[u32; 2]>,
    /// auto, gpu, software, cpu, an index or a part of a name
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = device)]
    pub device: Choice,
    /// Also write the rows as JSON; - is standard output, and the tables then go to stderr
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Also write the rows as CSV; - as above
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

impl Common {
    /// The name and the plan of every preset.
    ///
    /// # Errors
    /// A preset is unknown or wrong, two have one name, or one does not fit into memory.
    pub fn plans(&self, assets: &Assets) -> Result<Vec<(String, Plan)>> {
        let mut names = self.names.clone();
        if names.is_empty() {
            names = preset::BUILTIN
                .iter()
                .map(|(name, _)| name.into())
                .collect();
        }
        let load = |name: PathBuf| {
            let found = preset::load(&name, &[])?;
            found.load_assets(assets)?;
            let mut plan = found.plan;
            plan.size = self.size.unwrap_or(plan.size);
            Ok((found.name, plan))
        };
        let plans: Vec<(String, Plan)> = names.into_iter().map(load).collect::<Result<_>>()?;
        for (i, (name, _)) in plans.iter().enumerate() {
            if plans[..i].iter().any(|(n, _)| n == name) {
                return Err(usage(format!(
                    "two presets are called `{name}`, and rows and pictures are told apart by the name; leave one out, or rename its file"
                )));
            }
        }
        for (name, plan) in &plans {
            let available = memory::available();
            let lacking = memory::lacking(plan.size, BYTES_PER_PIXEL, available);
            if let Some(why) = lacking.or_else(|| memory::lacking_for(plan, assets, available)) {
                bail!("{name}: {why}");
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

    /// Makes sure before the measurement that its files can be written; `plot` is one of
    /// them where a measurement draws.
    ///
    /// # Errors
    /// One of them cannot be written, two are the same, or one is a preset or a file that a
    /// plan names.
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
    /// Prints a table to standard output, or to standard error if the other carries a file.
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

    /// Writes all rows, and hands over all files or none.
    ///
    /// # Errors
    /// A file or standard output cannot be written.
    pub fn write<R: Serialize>(mut self, rows: &[R]) -> Result<()> {
        if let Some(sink) = self.json {
            let mut text = serde_json::to_vec_pretty(rows).context("the rows cannot be written")?;
            text.push(b'\n');
            self.parcel.put(sink, &text)?;
        }
        if let Some(sink) = self.csv {
            let rows: Vec<_> = rows.iter().map(flat).collect();
            self.parcel.put(sink, &csv(&rows)?)?;
        }
        self.parcel.hand_over()
    }
}

/// Rows of names and values as CSV: one line of all names, and empty cells for the names
/// that a row lacks.
fn csv(rows: &[Vec<(String, String)>]) -> Result<Vec<u8>> {
    let mut names: Vec<&String> = Vec::new();
    for (name, _) in rows.iter().flatten() {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&names)?;
    for row in rows {
        let value = |name: &&String| row.iter().find(|(n, _)| n == *name);
        let values = names.iter().map(|name| value(name).map_or("", |(_, v)| v));
        writer.write_record(values)?;
    }
    writer.into_inner().context("the rows cannot be written")
}

/// The median of some values; sorts them.
pub fn median_of(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
