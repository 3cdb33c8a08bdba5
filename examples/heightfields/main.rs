//! Measures, draws and writes what `docs/heightfields.md` shows; `scripts/heightfields`
//! calls it.
//!
//! - `heightfields frames FILE FIELD MAP`: times of whole frames as JSON, MAP being the file
//!   of the field's relaxed map, which takes long to make;
//! - `heightfields distances FILE`: the walks for distant views beside the walk, as JSON;
//! - `heightfields maps FOLDER`: cone maps of one relief, drawn;
//! - `heightfields join FILE COLUMNS PNG...`: pictures side by side;
//! - `heightfields page FOLDER DOCUMENT DATE`: the tables of the page, from the rows of
//!   the measurements in a folder.

mod distances;
mod frames;
mod maps;
mod picture;
mod tables;

#[path = "../common/page.rs"]
mod page;
#[path = "../common/rows.rs"]
mod rows;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use picture::Picture;

fn main() -> Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    match args[..] {
        ["frames", file, field, map] => {
            let rows = frames::measure(field, map)?;
            fs::write(file, serde_json::to_string_pretty(&rows)?).context("the rows")
        }
        ["distances", file] => {
            let rows = distances::measure()?;
            fs::write(file, serde_json::to_string_pretty(&rows)?).context("the rows")
        }
        ["maps", folder] => maps::draw(Path::new(folder)),
        ["join", file, columns, ref files @ ..] => {
            let read = |f: &&str| Picture::read(Path::new(f));
            let pictures: Vec<Picture> = files.iter().map(read).collect::<Result<_>>()?;
            let columns = columns.parse().context("a number of columns")?;
            Picture::grid(&pictures, columns).write(Path::new(file))
        }
        ["page", folder, document, date] => write(Path::new(folder), document, date),
        _ => anyhow::bail!(
            "usage: heightfields frames FILE FIELD MAP | distances FILE | maps FOLDER | join FILE COLUMNS PNG... | page FOLDER DOCUMENT DATE"
        ),
    }
}

/// Fills the marked places of the page.
fn write(folder: &Path, document: &str, date: &str) -> Result<()> {
    let cones: Vec<tables::ConesRow> = page::read(&folder.join("cones.json"))?;
    let boxes: Vec<tables::ConesRow> = page::read(&folder.join("boxes.json"))?;
    let nodes: Vec<rows::NodesRow> = page::read(&folder.join("nodes.json"))?;
    let times: Vec<rows::TimesRow> = page::read(&folder.join("times.json"))?;
    let large: Vec<rows::TimesRow> = page::read(&folder.join("large.json"))?;
    let sizes: Vec<rows::SizesRow> = page::read(&folder.join("sizes.json"))?;
    let distances: Vec<distances::DistanceRow> = page::read(&folder.join("distances.json"))?;
    let frames: Vec<frames::FrameRow> = page::read(&folder.join("frames.json"))?;
    let device = times.first().map_or("", |r| &r.device);
    let mut text = fs::read_to_string(document).context("the document")?;
    let measured = [
        ("device", format!("Measured {date} on {device}.\n")),
        ("tracers", tables::tracers(&cones)),
        ("boxes", tables::means(&boxes, tables::SMALL)),
        ("generators", tables::generators(&cones)),
        ("nodes", tables::nodes(&nodes)),
        ("times", tables::times(&times) + &tables::large(&large)),
        ("aims", tables::aims(&cones, &nodes, &times)),
        ("sizes", tables::sizes(&sizes)),
        ("distances", tables::distances(&distances)),
        ("frames", tables::frames(&frames)),
    ];
    for (section, content) in measured {
        page::replace(&mut text, section, &content)?;
    }
    fs::write(document, text).context("the document")
}
