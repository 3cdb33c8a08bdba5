//! Writes to standard output and standard error.

use std::io::{self, ErrorKind, IsTerminal, Write};

use anyhow::{Context, Result, anyhow};

/// Writes text for people to standard output. A reader that stops early is no error.
///
/// # Errors
/// Standard output cannot be written.
pub fn print(bytes: &[u8]) -> Result<()> {
    match write(bytes) {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
        other => other.context(UNWRITABLE),
    }
}

/// Writes a result to standard output. It is useless unless all of it arrives.
///
/// # Errors
/// Standard output cannot be written, or its reader stops before the end.
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

/// `1 frame`, `2 frames`.
pub fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Writes text to standard error: for tables while standard output carries a file.
pub fn tell(text: &str) {
    let _ = write!(io::stderr(), "{text}");
}

/// Writes a line to standard error. If that fails, the work goes on.
pub fn say(line: &str) {
    // A progress bar may stand in the line. It draws itself again below.
    let clear = match io::stderr().is_terminal() {
        true => "\r\x1b[2K",
        false => "",
    };
    let _ = writeln!(io::stderr(), "{clear}{line}");
}
