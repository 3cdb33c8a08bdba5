//! One level of the pyramid: cones go on from the fronts of their parents (docs/method.md, 1
//! and 2).
//! Twin: `wgsl/pass/march.wgsl`.

use crate::base::lanes::LANES;
use crate::base::outcome::Counts;
use crate::base::shader::Module;
use crate::base::view::Beam;
use crate::scene::{Advance, Solid};
use crate::wgsl;

/// The entry point of the pass, and its own modules.
pub(super) fn program() -> (&'static str, Vec<Module>) {
    (
        "march",
        vec![wgsl!("pass/tally.wgsl"), wgsl!("pass/march.wgsl")],
    )
}

/// Why a cone ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The front is behind everything: there is nothing left for the children.
    Sky,
    /// Another step is not worth its cost.
    Stopped,
    /// The step limit was reached. The front is proven nevertheless.
    Limited,
}

/// Advances one cone from a proven front by at most `limit` steps. Returns the new front.
pub fn march<S: Solid>(
    solid: &S,
    cone: &Beam,
    front: f64,
    limit: u32,
    work: &mut Counts,
) -> (f64, Ended) {
    let mut at = Advance::at(front, true);
    for _ in 0..limit {
        at = solid.advance(cone, at, work);
        if let Some(ended) = ended(solid, &at) {
            return (at.front, ended);
        }
    }
    (at.front, Ended::Limited)
}

/// Why a cone ends after a step; `None` if it goes on.
fn ended<S: Solid>(solid: &S, at: &Advance) -> Option<Ended> {
    if at.front > solid.bounds_far() {
        return Some(Ended::Sky);
    }
    (!at.going).then_some(Ended::Stopped)
}

/// [`march`] for many cones with their fronts. Where the scene advances cones side by side at less
/// cost, a lane takes the next cone as soon as its own has ended.
pub fn march_all<S: Solid>(
    solid: &S,
    starts: &[(Beam, f64)],
    limit: u32,
) -> Vec<(f64, Ended, Counts)> {
    let mut waiting = starts.iter().enumerate();
    if starts.len() < 2 || limit == 0 || !solid.has_lanes() {
        let one = |(_, (cone, front)): (usize, &(Beam, f64))| {
            let mut work = Counts::default();
            let (front, ended) = march(solid, cone, *front, limit, &mut work);
            (front, ended, work)
        };
        return waiting.map(one).collect();
    }
    let mut ends = vec![(0.0, Ended::Limited, Counts::default()); starts.len()];
    let mut cones = [starts[0].0; LANES];
    let mut at = [Advance::at(0.0, true); LANES];
    let mut work = [Counts::default(); LANES];
    let mut left = [0; LANES];
    let mut held = [None; LANES];
    loop {
        for lane in 0..LANES {
            if held[lane].is_none()
                && let Some((i, (cone, front))) = waiting.next()
            {
                (held[lane], left[lane]) = (Some(i), limit);
                (cones[lane], work[lane]) = (*cone, Counts::default());
                at[lane] = Advance::at(*front, true);
            }
        }
        let on = held.map(|cone| cone.is_some());
        if !on.contains(&true) {
            return ends;
        }
        solid.advance_lanes(&cones, &mut at, on, &mut work);
        for lane in 0..LANES {
            let Some(i) = held[lane] else {
                continue;
            };
            left[lane] -= 1;
            let ended = ended(solid, &at[lane]);
            if ended.is_none() && left[lane] > 0 {
                continue;
            }
            ends[i] = (at[lane].front, ended.unwrap_or(Ended::Limited), work[lane]);
            held[lane] = None;
        }
    }
}
