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
use crate::pass::progress::Progress;

/// Work that ends sooner writes no line.
const FIRST_LINE: Duration = Duration::from_secs(2);
/// Time between two lines.
const BETWEEN_LINES: Duration = Duration::from_secs(10);
/// Steps of the bar: finer than any terminal shows.
const BAR_STEPS: f64 = 1000.0;

/// Reports one work from its start until it is dropped.
#[derive(Debug)]
pub struct Reporter {
    now: Arc<Mutex<Now>>,
    shown: Shown,
}

/// What was reported last.
#[derive(Debug)]
struct Now {
    what: String,
    /// When the share last fell, and to what.
    since: (Instant, f64),
    share: f64,
    detail: String,
    /// Whether the share is that of one step, after which others follow.
    is_step: bool,
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

impl Reporter {
    /// Begins to report a work; `what` names it, like "rendering".
    pub fn start(what: &str) -> Self {
        let now = Arc::new(Mutex::new(Now {
            what: what.into(),
            since: (Instant::now(), 0.0),
            share: 0.0,
            detail: String::new(),
            is_step: false,
        }));
        let shown = match io::stderr().is_terminal() {
            true => Shown::Bar(bar(what)),
            false => Shown::Lines(Some(lines(now.clone()))),
        };
        Self { now, shown }
    }

    /// What an executor calls while it renders.
    pub fn watch(&mut self) -> impl FnMut(&Progress) -> bool + '_ {
        |now| self.report_part(now, now.done, &now.pass)
    }

    /// Shows how far a render has come that is part of a work: a step of it, or else the share of
    /// the whole work that is done, with a detail. Returns whether to go on.
    pub fn report_part(&mut self, now: &Progress, share: f64, detail: &str) -> bool {
        match now.is_step {
            true => self.report_step(now.done, &now.pass),
            false => self.report(share, detail),
        }
    }

    /// Shows that a share of the work, 0..1, is done. `detail` says what is done now, like
    /// the name of a pass; it may be empty. Returns whether to go on: no interrupt came.
    pub fn report(&mut self, share: f64, detail: &str) -> bool {
        self.show(share, detail, false)
    }

    /// Shows that a share of one step is done, after which others follow.
    pub fn report_step(&mut self, share: f64, detail: &str) -> bool {
        self.show(share, detail, true)
    }

    fn show(&mut self, share: f64, detail: &str, is_step: bool) -> bool {
        if let Shown::Bar(bar) = &self.shown {
            bar.set_position((share * BAR_STEPS) as u64);
            let of = if is_step { "of this step: " } else { "" };
            bar.set_message(format!("{of}{detail}"));
        }
        let mut now = self.now.lock().unwrap_or_else(PoisonError::into_inner);
        // A cone map comes before a picture, and a truth is done again in finer steps. What
        // the work before took says nothing about the time that is left.
        if share < now.share {
            now.since = (Instant::now(), share);
        }
        now.share = share;
        now.detail = detail.into();
        now.is_step = is_step;
        !interrupt::asked()
    }
}

impl Drop for Reporter {
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
    let template = "{prefix}  {bar:40} {percent:>3} %  {eta} left  {msg}";
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
            say(&now.line(now.since.0.elapsed()));
            patience = BETWEEN_LINES;
        }
    };
    (sender, std::thread::spawn(write))
}

impl Now {
    /// `rendering: 43 % (trace), about 12 s left`, so long after the share last fell; where no share
    /// is known, `converting (reading): 12 s so far`.
    fn line(&self, elapsed: Duration) -> String {
        let percent = format!("{:.0} %", 100.0 * self.share);
        let (what, detail) = (&self.what, &self.detail);
        let about = match detail.is_empty() {
            true => String::new(),
            false => format!(" ({detail})"),
        };
        if self.share == 0.0 {
            return format!("{what}{about}: {} s so far", elapsed.as_secs());
        }
        let mut line = match self.is_step {
            true => format!("{what}: {detail}, {percent}"),
            false => format!("{what}: {percent}{about}"),
        };
        let done = self.share - self.since.1;
        if done > 0.0 {
            let left = elapsed.as_secs_f64() * (1.0 - self.share) / done;
            line += &match left {
                s if s < 100.0 => format!(", about {s:.0} s left"),
                s => format!(", about {:.0} min left", s / 60.0),
            };
            if self.is_step {
                line += " of this step";
            }
        }
        line
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_what_is_done_and_what_is_left() {
        let of = |is_step, from, share, detail: &str, s| {
            let (what, detail) = ("making".into(), detail.into());
            let since = (Instant::now(), from);
            let now = Now {
                what,
                since,
                share,
                detail,
                is_step,
            };
            now.line(Duration::from_secs(s))
        };
        assert_eq!(of(false, 0.0, 0.25, "", 4), "making: 25 %, about 12 s left");
        assert_eq!(
            of(false, 0.0, 0.5, "a", 600),
            "making: 50 % (a), about 10 min left"
        );
        assert_eq!(of(false, 0.5, 0.75, "", 4), "making: 75 %, about 4 s left");
        assert_eq!(of(false, 0.5, 0.5, "b", 9), "making: 50 % (b)");
        assert_eq!(
            of(true, 0.0, 0.5, "a", 6),
            "making: a, 50 %, about 6 s left of this step"
        );
        assert_eq!(of(false, 0.0, 0.0, "c", 7), "making (c): 7 s so far");
    }
}
