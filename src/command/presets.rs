//! `conemarch presets [NAME]`

use std::fmt::Write as _;

use anyhow::Result;
use clap::Args;

use crate::command::print::print;
use crate::preset::{BUILTIN, PresetError, builtin, nearest, read};

/// What `presets` takes.
#[derive(Args, Debug)]
pub struct Presets {
    /// Print the TOML text of this preset
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

/// Lists the built-in presets, or prints one.
pub fn run(args: &Presets) -> Result<()> {
    let Some(name) = &args.name else {
        return print(list()?.as_bytes());
    };
    let text = builtin(name).ok_or_else(|| PresetError::Unknown {
        name: name.clone(),
        nearest: nearest(name, BUILTIN.iter().map(|(n, _)| *n))
            .into_iter()
            .map(str::to_string)
            .collect(),
    })?;
    print(text.as_bytes())
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
