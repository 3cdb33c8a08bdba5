//! Pages whose tables are measured: reading rows, and filling the marked places of a page.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use serde::de::DeserializeOwned;

/// The rows of a file.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    serde_json::from_str(&text).with_context(|| path.display().to_string())
}

/// Puts text between the two lines that mark a section.
pub fn replace(text: &mut String, section: &str, content: &str) -> Result<()> {
    let [open, close] = ["", "/"].map(|s| format!("<!-- {s}{section} -->\n"));
    let start = text.find(&open).with_context(|| open.clone())? + open.len();
    let end = text.find(&close).with_context(|| close.clone())?;
    text.replace_range(start..end, &format!("\n{}\n\n", content.trim()));
    Ok(())
}
