//! How quickly the window answers.

use std::time::Instant;

use serde::Serialize;

use crate::picture::frame::Traffic;

/// The least time that is told from shorter ones, in milliseconds.
const LEAST: f64 = 1e-3;
/// The ratio of a class of times to the next shorter one: a share is right within half a percent.
const RATIO: f64 = 1.01;
/// Classes of times, up to 9 minutes.
const CLASSES: usize = 2020;

/// How many times there were of each length. A session may last for days, so none is kept.
#[derive(Debug)]
struct Times([u32; CLASSES]);

impl Default for Times {
    fn default() -> Self {
        Self([0; CLASSES])
    }
}

impl Times {
    fn add(&mut self, ms: f64) {
        let class = (ms / LEAST).max(1.0).ln() / RATIO.ln();
        let count = &mut self.0[(class as usize).min(CLASSES - 1)];
        *count = count.saturating_add(1);
    }

    fn spread(&self) -> Option<Spread> {
        let count: u64 = self.0.iter().map(|n| u64::from(*n)).sum();
        let last = count.checked_sub(1)?;
        let at = |share: f64| {
            let rank = (share * last as f64).round() as u64;
            let mut before = 0;
            let class = self.0.iter().position(|n| {
                before += u64::from(*n);
                before > rank
            });
            LEAST * RATIO.powf(class.unwrap_or(CLASSES) as f64 + 0.5)
        };
        Some(Spread {
            median: at(0.5),
            p95: at(0.95),
            p99: at(0.99),
            count,
        })
    }
}

/// Times of a session in milliseconds.
#[derive(Debug, Default)]
pub struct Meter {
    /// When the oldest change came that no picture shows yet, and its wish.
    asked: Option<(u64, Instant)>,
    /// The same of the newest change, until its full picture is shown.
    newest: Option<(u64, Instant)>,
    answers: Times,
    full: Times,
    turns: Times,
    frames: Times,
    shown: Option<Instant>,
    first: Option<f64>,
}

/// The middle, and two of the largest, of some times.
#[derive(Debug, Serialize)]
pub struct Spread {
    median: f64,
    p95: f64,
    p99: f64,
    count: u64,
}

/// The figures of a session, as JSON.
#[derive(Debug, Serialize)]
pub struct Figures {
    /// From the start to the first picture.
    open_ms: Option<f64>,
    /// From a change to the first picture of it.
    answer_ms: Option<Spread>,
    /// From a change to the full picture of it.
    full_ms: Option<Spread>,
    /// Between two pictures on the screen, while the picture changes.
    frame_ms: Option<Spread>,
    /// A turn of the window's loop: how long an event waits at most.
    turn_ms: Option<Spread>,
    /// Buffers that were made.
    allocations: u32,
    /// Programs that were compiled.
    compilations: usize,
}

fn ms(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}

impl Meter {
    /// Another picture is wanted.
    pub fn ask(&mut self, wish: u64) {
        self.newest = Some((wish, Instant::now()));
        self.asked = self.asked.or(self.newest);
    }

    /// A picture of a wish is on the screen.
    pub fn answer(&mut self, opened: Instant, wish: u64, full: bool) {
        self.first.get_or_insert_with(|| ms(opened));
        let note = |open: &mut Option<(u64, Instant)>, list: &mut Times| {
            // The first wish waits for the start of the program.
            if let Some((asked, since)) = open.take_if(|(asked, _)| wish >= *asked)
                && asked > 1
            {
                list.add(ms(since));
            }
        };
        note(&mut self.asked, &mut self.answers);
        if full {
            note(&mut self.newest, &mut self.full);
        }
    }

    /// Something is on the screen, while pictures change or not.
    pub fn show(&mut self, moving: bool) {
        if let Some(last) = self.shown.filter(|_| moving) {
            self.frames.add(ms(last));
        }
        self.shown = moving.then(Instant::now);
    }

    /// A turn of the loop is over.
    pub fn turn(&mut self, since: Instant) {
        self.turns.add(ms(since));
    }

    /// The figures.
    pub fn figures(&self, traffic: Traffic) -> Figures {
        Figures {
            open_ms: self.first,
            answer_ms: self.answers.spread(),
            full_ms: self.full.spread(),
            frame_ms: self.frames.spread(),
            turn_ms: self.turns.spread(),
            allocations: traffic.allocations,
            compilations: traffic.compilations,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_of_many_times_are_near_those_of_all() {
        let mut times = Times::default();
        assert!(times.spread().is_none());
        (1..=1000).for_each(|n| times.add(f64::from(n) / 10.0));
        let spread = times.spread().expect("times");
        let near = |found: f64, exact: f64| (found / exact - 1.0).abs() < 0.01;
        assert_eq!(spread.count, 1000);
        assert!(near(spread.median, 50.0) && near(spread.p95, 95.0) && near(spread.p99, 99.0));
        // Times beyond the classes are those at their ends.
        for ms in [0.0, f64::MAX] {
            let mut one = Times::default();
            one.add(ms);
            assert!(one.spread().is_some_and(|s| s.median > 0.0));
        }
    }
}
