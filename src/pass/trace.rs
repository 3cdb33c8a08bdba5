//! The trace pass: one ray per pixel, from the front of its cell to the surface.
//! Twin: `wgsl/pass/trace.wgsl`.

use crate::base::outcome::{Counts, State};
use crate::base::shader::Module;
use crate::base::view::Beam;
use crate::pass::follow::{End, Start, follow};
use crate::pass::turn::until;
use crate::plan::Plan;
use crate::scene::{Hit, Solid, Step};
use crate::wgsl;

/// The entry point of the pass, and its own modules.
pub(super) fn program(plan: &Plan) -> (&'static str, Vec<Module>) {
    let own = [
        wgsl!("pass/tally.wgsl"),
        until(plan),
        wgsl!("pass/trace.wgsl"),
    ];
    ("trace", own.into())
}

/// Follows one ray from a proven front by at most `limit` steps.
pub fn trace<S: Solid>(
    solid: &S,
    ray: &Beam,
    front: f64,
    limit: u32,
    work: &mut Counts,
) -> (Hit, State) {
    let start = Start {
        ray: *ray,
        front,
        far: solid.bounds_far(),
    };
    let end = follow(solid, &start, limit);
    work.evaluations += end.work.evaluations;
    work.iterations += end.work.iterations;
    (end.hit, state(&end))
}

/// What a pixel is whose ray ended so.
pub fn state(end: &End) -> State {
    match end.step {
        Step::Hit => State::Hit,
        Step::Out => State::Sky,
        Step::Moving | Step::Spent => State::Unconverged,
    }
}
