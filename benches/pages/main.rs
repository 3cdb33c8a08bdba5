//! Writes the generated parts of the documents in `docs/`: `cargo bench --bench pages -- COMMAND`.
//!
//! - `presets` writes `docs/presets.md`, the reference of all keys. A test fails while the page
//!   differs from what this would write.
//! - `benchmarks FOLDER DATE PART...` fills the named parts of `docs/benchmarks.md` from the rows in a
//!   folder, and draws their plots.
//! - `heightfields FOLDER DATE` does so for `docs/heightfields.md`.
//! - `frames FILE FIELD MAP` measures whole frames over a field and writes rows as JSON. MAP is
//!   the file of the field's relaxed cone map, which takes long to make.
//! - `distances FILE` measures the tracers for distant views and writes rows as JSON.
//! - `maps FOLDER` draws cone maps.
//! - `join FILE COLUMNS PNG...` puts pictures side by side.
//!
//! `scripts/benchmarks` and `scripts/heightfields` measure and call these in turn.

mod distances;
mod frames;
mod pictures;
mod presets;
mod scale;
mod tables;

#[path = "../common/markdown.rs"]
mod markdown;
#[path = "../common/median.rs"]
mod median;
#[path = "../common/rows.rs"]
mod rows;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};
use conemarch::command::bench::plot;
use conemarch::command::bench::row::Row;
use conemarch::command::bench::steps_row::StepsRow;
use conemarch::command::bench::table;
use serde::Serialize;
use serde::de::DeserializeOwned;

const DOCS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs");

fn main() -> Result<()> {
    // Cargo appends `--bench`.
    let args: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    match args[..] {
        ["presets"] => {
            let page = format!("{DOCS}/presets.md");
            fs::write(&page, presets::reference()).context(page)
        }
        ["benchmarks", folder, date, ref parts @ ..] => benchmarks(Path::new(folder), date, parts),
        ["heightfields", folder, date] => heightfields(Path::new(folder), date),
        ["frames", file, field, map] => write(file, &frames::measure(field, map)?),
        ["distances", file] => write(file, &distances::measure()?),
        ["maps", folder] => pictures::maps(Path::new(folder)),
        ["join", file, columns, ref files @ ..] => {
            let columns = columns.parse().context("a number of columns")?;
            pictures::join(Path::new(file), columns, files)
        }
        _ => bail!(
            "usage: presets | benchmarks FOLDER DATE PART... | heightfields FOLDER DATE | frames FILE FIELD MAP | distances FILE | maps FOLDER | join FILE COLUMNS PNG..."
        ),
    }
}

/// Writes rows as JSON.
fn write<T: Serialize>(file: &str, rows: &[T]) -> Result<()> {
    fs::write(file, serde_json::to_string_pretty(rows)?).context(file.to_owned())
}

/// Reads rows from a file of a folder.
fn read<T: DeserializeOwned>(folder: &Path, file: &str) -> Result<Vec<T>> {
    let path = folder.join(file);
    let name = || path.display().to_string();
    let text = fs::read_to_string(&path).with_context(name)?;
    serde_json::from_str(&text).with_context(name)
}

/// Fills the marked sections of a page.
fn fill(page: &str, sections: &[(&str, String)]) -> Result<()> {
    let page = format!("{DOCS}/{page}");
    let mut text = fs::read_to_string(&page).context(page.clone())?;
    for (name, content) in sections {
        let marks = [format!("<!-- {name} -->"), format!("<!-- /{name} -->")];
        markdown::replace(&mut text, [&marks[0], &marks[1]], content)?;
    }
    fs::write(&page, text).context(page)
}

fn benchmarks(folder: &Path, date: &str, parts: &[&str]) -> Result<()> {
    let text = |part: &str| {
        let path = folder.join(part).with_extension("md");
        fs::read_to_string(&path).with_context(|| path.display().to_string())
    };
    let mut sections = Vec::new();
    for part in parts {
        let content = match *part {
            "error" => {
                let rows: Vec<Row> = read(folder, "error.json")?;
                fs::write(format!("{DOCS}/benchmarks.svg"), plot::draw(&rows))?;
                let device = rows.first().map_or("", |r| &r.device);
                sections.push(("device", format!("Measured {date} on {device}.")));
                let presets = rows.chunk_by(|a, b| a.preset == b.preset);
                let error: String = presets.map(table::preset).collect();
                let error = error + &table::means(&rows) + &table::better_than_safe(&rows);
                error + &table::slides(&rows)
            }
            "steps" => {
                let steps: Vec<StepsRow> = read(folder, "steps.json")?;
                let levels = steps.chunk_by(|a, b| a.preset == b.preset && a.mode == b.mode);
                levels.map(table::levels).collect()
            }
            "scale" => {
                let text = text("scale")?;
                fs::write(format!("{DOCS}/scale.svg"), scale::draw(&text))?;
                text
            }
            "rival" | "switches" => text(part)?,
            other => bail!("`{other}` is none of error, steps, switches, rival, scale"),
        };
        sections.push((*part, content));
    }
    fill("benchmarks.md", &sections)
}

fn heightfields(folder: &Path, date: &str) -> Result<()> {
    let cones = read(folder, "cones.json")?;
    let boxes = read(folder, "boxes.json")?;
    let nodes = read(folder, "nodes.json")?;
    let times: Vec<rows::TimesRow> = read(folder, "times.json")?;
    let large = read(folder, "large.json")?;
    let device = times.first().map_or("", |r| &r.device);
    fill(
        "heightfields.md",
        &[
            ("device", format!("Measured {date} on {device}.")),
            ("tracers", tables::tracers(&cones)),
            ("boxes", tables::means(&boxes, tables::SMALL)),
            ("generators", tables::generators(&cones)),
            ("nodes", tables::nodes(&nodes)),
            ("times", tables::times(&times) + &tables::large(&large)),
            ("aims", tables::aims(&cones, &nodes, &times)),
            ("sizes", tables::sizes(&read(folder, "sizes.json")?)),
            (
                "distances",
                tables::distances(&read(folder, "distances.json")?),
            ),
            ("frames", tables::frames(&read(folder, "frames.json")?)),
        ],
    )
}
