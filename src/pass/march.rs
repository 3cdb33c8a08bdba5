//! One level of the pyramid: cones go on from the fronts of their parents (docs/method.md, 1
//! and 2).
//! Twin: `wgsl/pass/march.wgsl`.

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
        if at.front > solid.bounds_far() {
            return (at.front, Ended::Sky);
        }
        if !at.going {
            return (at.front, Ended::Stopped);
        }
    }
    (at.front, Ended::Limited)
}
