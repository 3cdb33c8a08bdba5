//! Text on standard output, and words on standard error.

use std::io::{self, ErrorKind, Write};

use anyhow::{Context, Result};

/// Writes to standard output. A reader that has seen enough is no error.
pub fn print(bytes: &[u8]) -> Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
        other => {
            other.context("standard output cannot be written; send it elsewhere, or name a file")
        }
    }
}

/// A line on standard error. Nobody may be listening there; that stops nothing.
pub fn say(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}
