//! The files of a measurement: its rows as JSON and CSV, and its picture.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;

use crate::command::bench::row::flat;
use crate::command::print::{print, tell};
use crate::command::sink::{Results, Sink, apart, is_stdout, spared};

/// The options for rows, which all measurements share.
#[derive(Debug, Args)]
pub struct RowFiles {
    /// Also write the rows as JSON; - is standard output, and the tables then go to stderr
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Also write the rows as CSV; - is standard output, and the tables then go to stderr
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

impl RowFiles {
    /// Makes sure before the measurement that its files can be written; `plot` is one of
    /// them where a measurement draws. `inputs` are the files that it reads.
    ///
    /// # Errors
    /// One of them cannot be written, two are the same, or one is an input.
    pub fn prepare(&self, plot: Option<&Path>, inputs: &[(&str, PathBuf)]) -> Result<Files> {
        let named = [
            ("--json", self.json.as_deref()),
            ("--csv", self.csv.as_deref()),
            ("--plot", plot),
        ];
        apart(&named)?;
        spared(&named, inputs)?;
        let [json, csv, plot] = named.map(|(_, path)| path.map(Sink::prepare).transpose());
        Ok(Files {
            json: json?,
            csv: csv?,
            plot: plot?,
            printing: named.iter().any(|(_, path)| path.is_some_and(is_stdout)),
            results: Results::default(),
        })
    }
}

/// Where the rows and pictures of a measurement go.
pub struct Files {
    json: Option<Sink>,
    csv: Option<Sink>,
    /// Where the picture goes, if one was asked for.
    pub plot: Option<Sink>,
    /// Whether standard output is one of them.
    printing: bool,
    /// Results that are written already.
    pub results: Results,
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

    /// Writes all rows, and hands over all files or none.
    ///
    /// # Errors
    /// A file or standard output cannot be written.
    pub fn write<R: Serialize>(mut self, rows: &[R]) -> Result<()> {
        if let Some(sink) = self.json {
            self.results.put_json(sink, rows)?;
        }
        if let Some(sink) = self.csv {
            let rows: Vec<_> = rows.iter().map(flat).collect();
            self.results.put(sink, &csv(&rows)?)?;
        }
        self.results.hand_over()
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
