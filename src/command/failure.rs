//! Turns an error into one sentence and an exit code.

use clap::error::ErrorKind;
use thiserror::Error;

use crate::command::interrupt::{self, CANCELLED};
use crate::gpu::RenderError;
use crate::heightfield::conemap::generate::generator::GenerateError;
use crate::heightfield::file_error::FileError;
use crate::preset::PresetError;

/// The command line is wrong.
#[derive(Debug, Error)]
#[error("{0}")]
pub struct Usage(pub String);

/// Wrong usage as an error of a command.
pub fn usage(why: impl Into<String>) -> anyhow::Error {
    Usage(why.into()).into()
}

/// Exit code of an error: that of the signal that ended the work, 2 for wrong usage, 1 for
/// everything else.
pub fn code(error: &anyhow::Error) -> u8 {
    if is_cancelled(error) && interrupt::asked() {
        return interrupt::code();
    }
    let wrong = error.is::<Usage>()
        || error.downcast_ref().is_some_and(PresetError::is_usage)
        || error.downcast_ref().is_some_and(FileError::is_usage);
    if wrong { 2 } else { 1 }
}

fn is_cancelled(error: &anyhow::Error) -> bool {
    matches!(error.downcast_ref(), Some(RenderError::Cancelled))
        || matches!(error.downcast_ref(), Some(GenerateError::Cancelled))
}

/// An error as one line.
pub fn sentence(error: &anyhow::Error) -> String {
    match (is_cancelled(error), error.chain().len()) {
        (true, 1) => CANCELLED.into(),
        // Its context tells what was written.
        (true, _) => format!("cancelled; {error}"),
        (false, _) => one_line(&format!("{error:#}")),
    }
}

/// A text on one line.
pub fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// An error of the parser, which has several paragraphs, as one line without the usage block.
pub fn flatten(error: &clap::Error) -> String {
    if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        return "a command is missing; `conemarch --help` lists the commands".into();
    }
    if error.kind() == ErrorKind::InvalidUtf8 {
        // The parser does not say which; paths are no reason for it.
        let mut given = std::env::args_os();
        let wrong = given.find(|a| a.to_str().is_none()).unwrap_or_default();
        return format!(
            "the argument `{}` is not UTF-8; only whole names of files may be something else, and a file that a preset names must have a name in UTF-8",
            wrong.to_string_lossy()
        );
    }
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
