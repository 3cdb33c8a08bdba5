//! `conemarch presets [PRESET]`

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;

use crate::command::completions::presets;
use crate::command::print::print;
use crate::command::table::columns;
use crate::preset::{BUILTIN, load, read};

/// What `presets` takes.
#[derive(Args, Debug)]
pub struct Presets {
    /// Print the TOML text of this preset: a built-in one, a .toml file, or that of a .png or .exr
    /// file that this program wrote
    #[arg(value_name = "PRESET", add = presets())]
    preset: Option<PathBuf>,
}

/// Lists the built-in presets, or prints one.
///
/// # Errors
/// The preset cannot be found or is wrong, or standard output cannot be written.
pub fn run(args: &Presets) -> Result<()> {
    match &args.preset {
        Some(argument) => print(load(argument, &[])?.text().as_bytes()),
        None => print(list()?.as_bytes()),
    }
}

/// One line for each preset: name, at least two blanks, title.
fn list() -> Result<String> {
    let row = |(name, source): &(&str, &str)| Ok(vec![name.to_string(), read(source, name)?.title]);
    let rows: Result<_> = BUILTIN.iter().map(row).collect();
    Ok(columns(rows?))
}
