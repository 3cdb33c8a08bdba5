//! `conemarch presets [PRESET]`

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::Result;
use clap::Args;

use crate::command::completions::presets;
use crate::command::print::print;
use crate::preset::{BUILTIN, load, read};

/// What `presets` takes.
#[derive(Args, Debug)]
pub struct Presets {
    /// Print the TOML text of this preset: a built-in one, or that of a .png that this
    /// program wrote
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
    let width = BUILTIN.iter().map(|(n, _)| n.len()).max().unwrap_or(0);
    let mut text = String::new();
    for (name, source) in BUILTIN {
        let title = read(source, name)?.title;
        writeln!(text, "{name:<width$}  {title}")?;
    }
    Ok(text)
}
