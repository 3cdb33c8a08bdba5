//! One reporter for all long work: how much is done and how long the rest will take.
//!
//! On a terminal it draws a bar on standard error. Elsewhere it writes a line after two seconds
//! and then one every ten seconds, so that a log shows that the program is alive.

use std::io::{self, IsTerminal};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::command::interrupt;
use crate::command::print::say;
use crate::pass::progress;

/// Work that ends sooner writes no line.
const FIRST_LINE: Duration = Duration::from_secs(2);
/// Time between two lines.
const BETWEEN_LINES: Duration = Duration::from_secs(10);
/// Steps of the bar: finer than any terminal shows.
const BAR_STEPS: f64 = 1000.0;

/// Reports one work from its start until it is dropped.
#[derive(Debug)]
pub struct Progress {
    now: Arc<Mutex<Now>>,
    shown: Shown,
}

/// What was reported last.
#[derive(Debug)]
struct Now {
    what: String,
    /// When the share was last 0.
    round: Instant,
    share: f64,
    detail: String,
}

/// Where it is shown.
#[derive(Debug)]
enum Shown {
    /// On a terminal.
    Bar(ProgressBar),
    /// By a thread that writes lines, also while nothing is reported, until the sender is
    /// dropped.
    Lines(Option<(Sender<()>, JoinHandle<()>)>),
}

impl Progress {
    /// Begins to report a work; `what` names it, like "rendering".
    pub fn start(what: &str) -> Self {
        let now = Arc::new(Mutex::new(Now {
            what: what.into(),
            round: Instant::now(),
            share: 0.0,
            detail: String::new(),
        }));
        let shown = match io::stderr().is_terminal() {
            true => Shown::Bar(bar(what)),
            false => Shown::Lines(Some(lines(now.clone()))),
        };
        Self { now, shown }
    }

    /// What an executor calls while it renders.
    pub fn watch(&mut self) -> impl FnMut(&progress::Progress) -> bool + '_ {
        |now| self.report(now.done, &now.pass)
    }

    /// Shows that a share of the work, 0..1, is done. `detail` says what is done now, like
    /// the name of a pass; it may be empty. Returns whether to go on: no interrupt came.
    pub fn report(&mut self, share: f64, detail: &str) -> bool {
        if let Shown::Bar(bar) = &self.shown {
            bar.set_position((share * BAR_STEPS) as u64);
            bar.set_message(detail.to_string());
        }
        let mut now = self.now.lock().unwrap_or_else(PoisonError::into_inner);
        // Some work is done again in finer steps. What the round before took says nothing
        // about the time that is left.
        if share < now.share {
            now.round = Instant::now();
        }
        now.share = share;
        now.detail = detail.into();
        !interrupt::asked()
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        match &mut self.shown {
            Shown::Bar(bar) => bar.finish_and_clear(),
            Shown::Lines(thread) => {
                if let Some((ended, thread)) = thread.take() {
                    drop(ended);
                    // It only writes lines: there is nothing to do about a panic.
                    let _ = thread.join();
                }
            }
        }
    }
}

fn bar(what: &str) -> ProgressBar {
    let bar = ProgressBar::new(BAR_STEPS as u64).with_prefix(what.to_string());
    let template = "{prefix}  {bar:40} {percent:>3} %  {msg}  {eta} left";
    // The default style shows the same numbers.
    let style = ProgressStyle::with_template(template);
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

fn lines(now: Arc<Mutex<Now>>) -> (Sender<()>, JoinHandle<()>) {
    let (sender, ended) = channel();
    let write = move || {
        let mut patience = FIRST_LINE;
        while ended.recv_timeout(patience) == Err(RecvTimeoutError::Timeout) {
            let now = now.lock().unwrap_or_else(PoisonError::into_inner);
            say(&line(
                &now.what,
                now.share,
                &now.detail,
                now.round.elapsed(),
            ));
            patience = BETWEEN_LINES;
        }
    };
    (sender, std::thread::spawn(write))
}

/// `rendering: 43 % (trace), about 12 s left`.
fn line(what: &str, share: f64, detail: &str, elapsed: Duration) -> String {
    let mut line = format!("{what}: {:.0} %", 100.0 * share);
    if !detail.is_empty() {
        line += &format!(" ({detail})");
    }
    if share > 0.0 {
        let left = elapsed.as_secs_f64() * (1.0 - share) / share;
        line += &match left {
            s if s < 100.0 => format!(", about {s:.0} s left"),
            s => format!(", about {:.0} min left", s / 60.0),
        };
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_what_is_done_and_what_is_left() {
        let of = |share, detail, s| line("making", share, detail, Duration::from_secs(s));
        assert_eq!(of(0.25, "", 4), "making: 25 %, about 12 s left");
        assert_eq!(of(0.5, "a", 600), "making: 50 % (a), about 10 min left");
        assert_eq!(of(0.0, "cones 43 %", 9), "making: 0 % (cones 43 %)");
    }
}
