//! How quickly the window answers.

use std::time::Instant;

use serde::Serialize;

use crate::picture::frame::Traffic;

/// Times of a session in milliseconds.
#[derive(Debug, Default)]
pub struct Meter {
    /// When the oldest change came that no picture shows yet, and its wish.
    asked: Option<(u64, Instant)>,
    /// The same of the newest change, until its full picture is shown.
    newest: Option<(u64, Instant)>,
    answers: Vec<f64>,
    full: Vec<f64>,
    turns: Vec<f64>,
    frames: Vec<f64>,
    shown: Option<Instant>,
    first: Option<f64>,
}

/// The middle, and two of the largest, of some times.
#[derive(Debug, Serialize)]
pub struct Spread {
    median: f64,
    p95: f64,
    p99: f64,
    count: usize,
}

impl Spread {
    fn of(times: &[f64]) -> Option<Self> {
        let mut times = times.to_vec();
        times.sort_by(f64::total_cmp);
        let last = times.len().checked_sub(1)?;
        let at = |share: f64| times[(share * last as f64).round() as usize];
        Some(Self {
            median: at(0.5),
            p95: at(0.95),
            p99: at(0.99),
            count: times.len(),
        })
    }
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

/// The most times of a kind that are kept: the last half an hour of turns.
const MOST: usize = 1 << 20;

/// Keeps a time, and forgets old ones.
fn keep(times: &mut Vec<f64>, ms: f64) {
    if times.len() == MOST {
        times.drain(..MOST / 2);
    }
    times.push(ms);
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
        let note = |open: &mut Option<(u64, Instant)>, list: &mut Vec<f64>| {
            // The first wish waits for the start of the program.
            if let Some((asked, since)) = open.take_if(|(asked, _)| wish >= *asked)
                && asked > 1
            {
                keep(list, ms(since));
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
            keep(&mut self.frames, ms(last));
        }
        self.shown = moving.then(Instant::now);
    }

    /// A turn of the loop is over.
    pub fn turn(&mut self, since: Instant) {
        keep(&mut self.turns, ms(since));
    }

    /// The figures.
    pub fn figures(&self, traffic: Traffic) -> Figures {
        Figures {
            open_ms: self.first,
            answer_ms: Spread::of(&self.answers),
            full_ms: Spread::of(&self.full),
            frame_ms: Spread::of(&self.frames),
            turn_ms: Spread::of(&self.turns),
            allocations: traffic.allocations,
            compilations: traffic.compilations,
        }
    }
}
