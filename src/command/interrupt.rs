//! Ctrl-C and other requests to end: the work stops as soon as it can and leaves no file.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use signal_hook::low_level::exit;

use crate::command::print::say;
use crate::gpu::RenderError;
use crate::picture;

/// The signals that ask to end. A closed terminal sends a hang-up.
#[cfg(unix)]
const SIGNALS: [i32; 3] = [SIGINT, SIGTERM, signal_hook::consts::SIGHUP];
#[cfg(not(unix))]
const SIGNALS: [i32; 2] = [SIGINT, SIGTERM];

/// The sentence after an interrupt.
pub const CANCELLED: &str = "cancelled; nothing was written";

/// The exit code that a signal asked for; 0 before.
static ASKED: AtomicUsize = AtomicUsize::new(0);

/// What stays of work that is ended, as a part of a sentence.
static KEPT: Mutex<Option<String>> = Mutex::new(None);

/// How long the work has to notice: a single pass may take much longer, and nobody waits
/// for that.
const PATIENCE: Duration = Duration::from_millis(700);
/// Time between two looks for a signal, or for the end of another program: too short to be felt.
pub const POLL: Duration = Duration::from_millis(20);

/// From now on a signal is noted. A second one ends the process at once.
pub fn listen() {
    let signal = Arc::new(AtomicUsize::new(0));
    for number in SIGNALS {
        // As shells count: 130 after SIGINT, 143 after SIGTERM.
        let code = 128 + number.unsigned_abs() as usize;
        // Without a handler a signal still ends the process; it only leaves the temporary
        // file. That is no reason not to work.
        let _ = flag::register_usize(number, signal.clone(), code);
    }
    thread::spawn(move || {
        let mut first: Option<Instant> = None;
        loop {
            thread::sleep(POLL);
            let code = signal.swap(0, Ordering::SeqCst);
            if code != 0 && first.is_none() {
                ASKED.store(code, Ordering::SeqCst);
                first = Some(Instant::now());
            } else if code != 0 || first.is_some_and(|at| at.elapsed() > PATIENCE) {
                end();
            }
        }
    });
}

/// Whether to stop.
pub fn asked() -> bool {
    code() != 0
}

/// Ends work that must not go on.
///
/// # Errors
/// An interrupt came.
pub fn check() -> Result<(), RenderError> {
    match asked() {
        true => Err(RenderError::Cancelled),
        false => Ok(()),
    }
}

/// The exit code that the signal asks for; 0 where none came.
pub fn code() -> u8 {
    ASKED.load(Ordering::SeqCst) as u8
}

/// From now on this stays when the process is ended.
pub fn keeps(what: Option<String>) {
    *KEPT.lock().unwrap_or_else(PoisonError::into_inner) = what;
}

/// Ends the process without a trace of files, but for what is kept. Destructors of the driver do not
/// run, as one of its threads may compile a program.
fn end() -> ! {
    let _kept = picture::clear();
    let kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    match &*kept {
        Some(kept) => say(&format!("error: cancelled; {kept}")),
        None => say(&format!("error: {CANCELLED}")),
    }
    exit(code().into())
}
