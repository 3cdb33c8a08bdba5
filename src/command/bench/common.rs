//! What all measurements share: which presets, on which device, and where rows go.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;

use crate::command::executor::Executor;
use crate::command::print::say;
use crate::command::size;
use crate::gpu::device::{Choice, DeviceError};
use crate::output::{self, Place};
use crate::plan::Plan;
use crate::preset;

/// Options of every measurement.
#[derive(Debug, Args)]
pub struct Common {
    /// Presets; all built-in ones where none is named
    pub names: Vec<String>,
    /// Pixels, instead of the presets' own
    #[arg(long, value_name = "WxH", value_parser = size::read)]
    pub size: Option<[u32; 2]>,
    /// auto, gpu, software, cpu, an index or a part of a name
    #[arg(long, value_name = "DEVICE", default_value = "auto")]
    pub device: String,
    /// Write the rows as JSON too
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the rows as CSV too
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

impl Common {
    /// Every preset's name and plan.
    ///
    /// # Errors
    /// A preset is unknown or wrong.
    pub fn plans(&self) -> Result<Vec<(String, Plan)>> {
        let all = || preset::BUILTIN.iter().map(|(name, _)| (*name).to_string());
        let names: Vec<String> = if self.names.is_empty() {
            all().collect()
        } else {
            self.names.clone()
        };
        let load = |name: String| {
            let found = preset::load(&name, &[])?;
            let mut plan = found.plan;
            plan.size = self.size.unwrap_or(plan.size);
            Ok((found.name, plan))
        };
        names.into_iter().map(load).collect()
    }

    /// The executor, announced on standard error.
    ///
    /// # Errors
    /// The choice matches nothing, or the adapter does not open.
    pub fn executor(&self) -> Result<Executor, DeviceError> {
        let (executor, who) = Executor::open(&Choice::read(&self.device))?;
        say(&format!("measuring on {who}"));
        if executor.is_untimed() {
            say("this device has no timestamps: times are those of the clock");
        }
        Ok(executor)
    }

    /// Makes sure that the asked files can be written, before anything is measured.
    ///
    /// # Errors
    /// One of them cannot.
    pub fn files(&self) -> Result<Files> {
        Ok(Files {
            json: prepare(self.json.as_deref())?,
            csv: prepare(self.csv.as_deref())?,
        })
    }
}

/// A place for an optional file.
///
/// # Errors
/// It cannot be written.
pub fn prepare(path: Option<&Path>) -> Result<Option<Place>> {
    Ok(path.map(Place::prepare).transpose()?)
}

/// Files that rows will go to.
pub struct Files {
    json: Option<Place>,
    csv: Option<Place>,
}

impl Files {
    /// Writes all rows, and other files that are already written, or none.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write<R: Serialize>(
        self,
        rows: &[R],
        flat: &[Vec<(String, String)>],
        more: Vec<Place>,
    ) -> Result<()> {
        let mut places = more;
        if let Some(mut place) = self.json {
            let mut text =
                serde_json::to_string_pretty(rows).context("the rows cannot be written")?;
            text.push('\n');
            place.write_all(text.as_bytes())?;
            places.push(place);
        }
        if let Some(mut place) = self.csv {
            place.write_all(&csv(flat)?)?;
            places.push(place);
        }
        output::commit(places)?;
        Ok(())
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
