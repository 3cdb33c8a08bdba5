//! One reporter for all long work: how much is done and how long the rest will take.
//!
//! On a terminal it draws a bar on standard error. Elsewhere it writes a line after two seconds
//! and then one every ten seconds, so that a log shows that the program is alive.

use std::io::{self, IsTerminal};
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
    what: String,
    start: Instant,
    /// When the share was last 0.
    round: Instant,
    share: f64,
    /// `None` where standard error is no terminal.
    bar: Option<ProgressBar>,
    next_line: Duration,
}

impl Progress {
    /// Begins to report a work; `what` names it, like "rendering".
    pub fn start(what: &str) -> Self {
        let bar = io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(BAR_STEPS as u64).with_prefix(what.to_string());
            let template = "{prefix}  {bar:40} {percent:>3} %  {msg}  {eta} left";
            // The default style shows the same numbers.
            let style = ProgressStyle::with_template(template);
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        Self {
            what: what.into(),
            start: Instant::now(),
            round: Instant::now(),
            share: 0.0,
            bar,
            next_line: FIRST_LINE,
        }
    }

    /// What an executor calls while it renders.
    pub fn watch(&mut self) -> impl FnMut(&progress::Progress) -> bool + '_ {
        |now| self.report(now.done, &now.pass)
    }

    /// Shows that a share of the work, 0..1, is done. `detail` says what is done now, like
    /// the name of a pass; it may be empty. Returns whether to go on: no interrupt came.
    pub fn report(&mut self, share: f64, detail: &str) -> bool {
        // Some work is done again in finer steps. What the round before took says nothing
        // about the time that is left.
        if share < self.share {
            self.round = Instant::now();
        }
        self.share = share;
        if let Some(bar) = &self.bar {
            bar.set_position((share * BAR_STEPS) as u64);
            bar.set_message(detail.to_string());
        } else if self.start.elapsed() >= self.next_line {
            self.next_line = self.start.elapsed() + BETWEEN_LINES;
            say(&line(&self.what, share, detail, self.round.elapsed()));
        }
        !interrupt::asked()
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
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

    #[test]
    fn the_first_line_comes_after_two_seconds_and_the_next_ten_later() {
        let mut progress = Progress::start("testing");
        // As if it were off a terminal and had begun a while ago.
        progress.bar = None;
        progress.report(0.1, "");
        assert_eq!(progress.next_line, FIRST_LINE);
        progress.start -= Duration::from_secs(3);
        progress.report(0.2, "");
        assert!(progress.next_line >= Duration::from_secs(13));
    }
}
