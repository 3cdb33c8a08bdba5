//! From an error to one sentence and an exit code.

use clap::error::ErrorKind;
use thiserror::Error;

use crate::gpu::render::RenderError;
use crate::preset::PresetError;

/// The command line asks for something that cannot be meant.
#[derive(Debug, Error)]
#[error("{0}")]
pub struct Usage(pub String);

/// A wrong use, as an error of a command.
pub fn usage(why: impl Into<String>) -> anyhow::Error {
    Usage(why.into()).into()
}

/// Exit code of an error: 2 for wrong usage, 1 for everything else.
pub fn code(error: &anyhow::Error) -> u8 {
    let wrong = error.is::<Usage>()
        || error
            .downcast_ref::<PresetError>()
            .is_some_and(PresetError::is_usage);
    if wrong { 2 } else { 1 }
}

/// What to tell of an error: one line.
pub fn sentence(error: &anyhow::Error) -> String {
    if let Some(RenderError::Cancelled) = error.downcast_ref() {
        return CANCELLED.into();
    }
    one_line(&format!("{error:#}"))
}

/// What an interrupt ends with.
pub const CANCELLED: &str = "cancelled; nothing was written";

fn one_line(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ")
}

/// A parser's error of several paragraphs as one line, without the usage block.
pub fn flatten(error: &clap::Error) -> String {
    let text = error.to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    let paragraphs = text.split("\n\n").map(one_line);
    let telling = paragraphs
        .filter(|p| !p.is_empty() && !p.starts_with("Usage:") && !p.starts_with("For more"))
        .map(|p| p.trim_start_matches("tip: ").to_string());
    let sentence = telling.collect::<Vec<_>>().join("; ");
    match error.kind() {
        ErrorKind::MissingSubcommand | ErrorKind::InvalidSubcommand => {
            format!("{sentence}; `conemarch --help` lists the commands")
        }
        _ => sentence,
    }
}
