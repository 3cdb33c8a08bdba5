//! `conemarch conemap convert MAP -o MAP`

use std::path::PathBuf;

use anyhow::Result;
use clap::{Args, ValueHint};

use crate::command::conemap::options::{Foreign, Writing, wraps, write};
use crate::command::failure::usage;
use crate::command::interrupt;
use crate::command::print::say;
use crate::command::progress::Reporter;
use crate::command::sink::{Sink, shown, spared};

/// What `convert` takes.
#[derive(Args, Debug)]
pub struct Convert {
    /// The cone map to convert: a .png or .exr file
    #[arg(value_name = "MAP", value_hint = ValueHint::FilePath)]
    map: PathBuf,

    /// Where to write: a .png or .exr file, or - for PNG on standard output
    #[arg(short, long, value_name = "MAP", value_hint = ValueHint::FilePath)]
    output: Option<PathBuf>,

    #[command(flatten)]
    writing: Writing,

    #[command(flatten)]
    foreign: Foreign,

    /// Axes along which another program's map repeats
    #[arg(long, value_name = "AXES", default_value = "none", value_parser = wraps(), requires = "from")]
    wrap: [bool; 2],
}

/// Converts a map.
///
/// # Errors
/// There is no map, the layout cannot hold it, or the file cannot be written.
pub fn run(args: &Convert) -> Result<()> {
    let Some(output) = &args.output else {
        return Err(usage(
            "the output is missing; give -o MAP.png or -o MAP.exr",
        ));
    };
    spared(
        &[("the new map", Some(output))],
        &[("the one that is read", args.map.clone())],
    )?;
    interrupt::listen();
    let mut progress = Reporter::start("converting");
    progress.report_step(0.0, "step 1 of 2: reading");
    let file = args.foreign.decode(&args.map, args.wrap)?;
    let format = args.writing.format(output, file.map.kind)?;
    let sink = Sink::prepare(output)?;
    interrupt::check()?;
    progress.report_step(0.0, "step 2 of 2: writing, and reading back");
    let what_is_kept = write(&file, &format, sink)?;
    drop(progress);
    let [w, h] = file.map.size;
    say(&format!(
        "{}  {w} x {h}  {}, layout {}  {what_is_kept}",
        shown(output),
        file.map.kind.name(),
        format.layout.name(),
    ));
    Ok(())
}
