//! Writes the measured sections of `docs/benchmarks.md` from the rows of the measurements:
//! `scripts/benchmarks` calls it with the folder of the rows, the document and the date.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use conemarch::command::bench::row::Row;
use conemarch::command::bench::steps_row::StepsRow;
use conemarch::command::bench::table;

#[path = "common/page.rs"]
mod page;
use page::{read, replace};

fn main() -> Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [folder, document, date] = &args[..] else {
        anyhow::bail!("usage: benchmarks FOLDER DOCUMENT DATE");
    };
    let folder = Path::new(folder);
    let rows: Vec<Row> = read(&folder.join("error.json"))?;
    let steps: Vec<StepsRow> = read(&folder.join("steps.json"))?;
    let switches = fs::read_to_string(folder.join("switches.md"))?;
    let mut text = fs::read_to_string(document).context("the document")?;
    let device = rows.first().map_or("", |r| &r.device);
    replace(
        &mut text,
        "device",
        &format!("Measured {date} on {device}.\n"),
    )?;
    replace(&mut text, "error", &error(&rows))?;
    replace(&mut text, "steps", &levels(&steps))?;
    replace(&mut text, "switches", &switches)?;
    fs::write(document, text)?;
    Ok(())
}

fn error(rows: &[Row]) -> String {
    let mut text = String::new();
    for group in rows.chunk_by(|a, b| a.preset == b.preset) {
        text += &table::preset(group);
    }
    text + &table::means(rows) + &table::better_than_safe(rows) + &table::slides(rows)
}

fn levels(rows: &[StepsRow]) -> String {
    let groups = rows.chunk_by(|a, b| a.preset == b.preset && a.mode == b.mode);
    groups.map(table::levels).collect()
}
