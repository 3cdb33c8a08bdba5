//! `conemarch conemap convert MAP -o MAP`

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::{Args, ValueHint};

use crate::command::conemap::common::{Output, Strange, Writing, of_map, shown, wraps};
use crate::command::failure::usage;
use crate::command::interrupt;
use crate::command::print::say;
use crate::command::sink::{Sink, spared};
use crate::heightfield::conemap::file::{MapFile, decode_bytes, encode, kind_word};

/// What `convert` takes.
#[derive(Args, Debug)]
pub struct Convert {
    /// The cone map to convert: a .png or .exr file
    #[arg(value_name = "MAP", value_hint = ValueHint::FilePath)]
    map: PathBuf,

    #[command(flatten)]
    output: Output,

    #[command(flatten)]
    writing: Writing,

    #[command(flatten)]
    strange: Strange,

    /// Which axes another program's map wraps along
    #[arg(long, value_name = "AXES", default_value = "none", value_parser = wraps(), requires = "from")]
    wrap: [bool; 2],
}

/// Converts a map.
///
/// # Errors
/// No map, a layout that cannot hold it, an unwritable file.
pub fn run(args: &Convert) -> Result<()> {
    let Some(output) = &args.output.output else {
        return Err(usage(
            "there is nowhere to write to; give -o MAP.png or -o MAP.exr",
        ));
    };
    spared(
        &[("the new map", Some(output))],
        &[("the one that is read", args.map.clone())],
    )?;
    let file = args.strange.decode(&args.map, args.wrap)?;
    let form = args.writing.form(output, file.map.kind)?;
    interrupt::listen();
    let sink = Sink::prepare(output)?;
    let bytes = encode(&file, &form).map_err(of_map)?;
    let again = decode_bytes(&bytes).map_err(anyhow::Error::msg);
    let again = again.context("the map could not be read back")?;
    sink.finish(&bytes)?;
    let [w, h] = file.map.size;
    say(&format!(
        "{}  {w} x {h}  {}, layout {}  {}",
        shown(output),
        kind_word(file.map.kind),
        form.layout.name(),
        kept(&file, &again)
    ));
    Ok(())
}

/// How much of the ratios a file has kept.
pub fn kept(before: &MapFile, after: &MapFile) -> String {
    let [was, is] = [before, after].map(MapFile::mean_share);
    let share = if was > 0.0 { is / was } else { 1.0 };
    // Never rounded up to all of it, and never so little less that nobody can tell.
    let share = if share > 0.999_999 { 1.0 } else { share };
    let share = (share * 1e4).floor() / 1e2;
    format!("mean ratio {is:.4} of the width, {share} % of what it was")
}
