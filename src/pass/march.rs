//! One level of the pyramid: cones go on from the fronts of their parents (docs/method.md, 1
//! and 2).
//! Twin: `wgsl/pass/march.wgsl`.

use crate::base::outcome::Counts;
use crate::base::view::Beam;
use crate::scene::Solid;

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
    let mut f = front;
    for _ in 0..limit {
        let next = solid.advance(cone, f, work);
        f = next.front;
        if f > solid.bounds_far() {
            return (f, Ended::Sky);
        }
        if !next.going {
            return (f, Ended::Stopped);
        }
    }
    (f, Ended::Limited)
}
