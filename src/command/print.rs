//! Text on standard output, and words on standard error.

use std::io::{self, ErrorKind, Write};

use anyhow::{Context, Result, anyhow};

/// Writes text for reading to standard output. A reader that has seen enough is no error.
///
/// # Errors
/// Standard output cannot be written.
pub fn print(bytes: &[u8]) -> Result<()> {
    match write(bytes) {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
        other => other.context(UNWRITABLE),
    }
}

/// Writes a result to standard output, which is of no use unless all of it arrives.
///
/// # Errors
/// Standard output cannot be written, or its reader has gone before the end.
pub fn deliver(bytes: &[u8]) -> Result<()> {
    match write(bytes) {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Err(anyhow!(
            "the reader of standard output has closed it before the end; let it read everything, or name a file"
        )),
        other => other.context(UNWRITABLE),
    }
}

const UNWRITABLE: &str = "standard output cannot be written; send it elsewhere, or name a file";

fn write(bytes: &[u8]) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(bytes).and_then(|()| out.flush())
}

/// Text on standard error, where standard output has something else to carry.
pub fn tell(text: &str) {
    let _ = write!(io::stderr(), "{text}");
}

/// A line on standard error. Nobody may be listening there; that stops nothing.
pub fn say(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}
