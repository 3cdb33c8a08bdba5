//! From an argument to heights from 0 to 1.
//!
//! NaN and infinite numbers are refused, with their place. Numbers outside 0..=1, such as
//! the metres of an elevation model, are refused too, unless `normalize` scales the lowest
//! to 0 and the highest to 1. This is not done automatically, because two maps of one
//! landscape would not fit together any more, and a dent that uses half of the range would
//! become twice as deep. `invert` turns depths into heights, as the last step.

use std::ffi::{OsStr, OsString};
use std::path::Path;

use crate::heightfield::conemap::generate::generator::ShareWatch;
use crate::heightfield::load::file::read;
use crate::heightfield::load::pattern_spec::PatternSpec;
use crate::heightfield::pattern::{Pattern, stretched};
use crate::heightfield::{FileError, Heights};

/// How heights are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoadOptions {
    /// Which axes wrap.
    pub wrap: [bool; 2],
    /// Turn depths into heights: 0 becomes 1 and 1 becomes 0.
    pub invert: bool,
    /// Scale the lowest to 0 and the highest to 1. An even map becomes 0.
    pub normalize: bool,
    /// Columns and rows of a raw file.
    pub size: Option<[u32; 2]>,
}

/// Heights that were loaded.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The file's name without its ending, or the pattern's name.
    pub name: OsString,
    /// The heights.
    pub heights: Heights,
    /// Where they come from, in words.
    pub form: String,
    /// What was left out of the file, if it is not obvious; with its name.
    pub note: Option<String>,
}

/// Loads the heights that an argument names: a pattern, or a file by its path. `watch` is told the
/// share of a pattern that is made.
///
/// # Errors
/// The argument names nothing, the file cannot be read or holds no heights, or `watch` returns
/// `false`.
pub fn load(
    argument: impl AsRef<OsStr>,
    options: &LoadOptions,
    watch: ShareWatch<'_>,
) -> Result<Loaded, FileError> {
    let path = Path::new(argument.as_ref());
    let shown = path.display().to_string();
    if let Some(named) = path.to_str().and_then(PatternSpec::read) {
        return generated(named, options, watch).map_err(|why| wrong(&shown, &why));
    }
    let is_path = shown.contains(['/', '\\', '.'])
        || (cfg!(feature = "cli") && !shown.is_empty() && path.exists());
    if !is_path {
        let why = format!(
            "there is no such file or field; fields are {}, and files are PNG, EXR, TIFF or .raw",
            Pattern::ALL.map(Pattern::name).join(", ")
        );
        return Err(wrong(&shown, &why));
    }
    in_file(path, options).map_err(|why| FileError::file(path, why))
}

/// The error of an argument that names no heights.
fn wrong(argument: &str, why: &str) -> FileError {
    // A long text is not a name, and need not be repeated in full.
    let argument: String = argument.chars().take(80).collect();
    FileError::Usage(format!("{argument}: {why}"))
}

fn generated(
    named: Result<PatternSpec, String>,
    options: &LoadOptions,
    watch: ShareWatch<'_>,
) -> Result<Loaded, String> {
    let named = named?;
    let name = named.field.name();
    if options.size.is_some() {
        return Err(format!(
            "is a field; give its size after a colon like {name}:512x512 (--size is for raw files)"
        ));
    }
    let (size, seed, power) = (named.size, named.seed, named.power);
    let values = named.field.watched(size, seed, power, watch);
    Ok(Loaded {
        name: name.into(),
        heights: finished(size, values.ok_or("cancelled")?, options)?,
        form: named.to_string(),
        note: None,
    })
}

fn in_file(path: &Path, options: &LoadOptions) -> Result<Loaded, String> {
    let mut grid = read(path, options.size)?;
    into_range(&mut grid.values, grid.size[0] as usize, options.normalize)?;
    Ok(Loaded {
        name: path.file_stem().unwrap_or(OsStr::new("heights")).into(),
        heights: finished(grid.size, grid.values, options)?,
        form: grid.form,
        note: grid.note.map(|note| format!("{} {note}", path.display())),
    })
}

/// Normalizes numbers, or checks that they are in 0..=1.
fn into_range(values: &mut Vec<f32>, width: usize, normalize: bool) -> Result<(), String> {
    if let Some(i) = values.iter().position(|z| !z.is_finite()) {
        let (x, y, z) = (i % width, i / width, values[i]);
        return Err(format!(
            "the height at column {x}, row {y} is {z}; fill such places first"
        ));
    }
    if normalize {
        *values = stretched(values);
        return Ok(());
    }
    let low = values.iter().copied().fold(f32::INFINITY, f32::min);
    let high = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    if low < 0.0 || high > 1.0 {
        return Err(format!(
            "its heights reach from {low} to {high}, and heights must be 0 to 1; --normalize (in a preset, normalize = true) scales them to that range"
        ));
    }
    Ok(())
}

fn finished(
    size: [u32; 2],
    mut values: Vec<f32>,
    options: &LoadOptions,
) -> Result<Heights, String> {
    if options.invert {
        for z in &mut values {
            *z = 1.0 - *z;
        }
    }
    // Minus zero becomes zero, because its bits would make equal heights look different.
    for z in &mut values {
        *z += 0.0;
    }
    Heights::new(size, options.wrap, values).map_err(|e| e.to_string())
}
