//! Ctrl-C: the render stops at its next opportunity and leaves no file.

use std::io::{self, IsTerminal, Write};
use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crate::command::failure::CANCELLED;
use crate::command::print::say;
use crate::picture;

static ASKED: AtomicBool = AtomicBool::new(false);

/// How long a render has to notice: a single pass may take much longer, and nobody
/// waits for that.
const PATIENCE: Duration = Duration::from_millis(700);

/// From now on an interrupt is noted. A second one ends the process at once.
pub fn listen() {
    // Without a handler an interrupt still ends the process; it only leaves the
    // temporary file. That is no reason not to render.
    let _ = ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::SeqCst) {
            end();
        }
        thread::spawn(|| {
            thread::sleep(PATIENCE);
            end();
        });
    });
}

/// Whether to stop.
pub fn asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}

/// Ends the process without a trace of files.
fn end() -> ! {
    let _kept = picture::clear();
    if io::stderr().is_terminal() {
        // The progress bar's line, which nobody else will clear now.
        let _ = write!(io::stderr(), "\r\x1b[2K");
    }
    say(&format!("error: {CANCELLED}"));
    exit(1);
}
