//! Rays are followed to their ends. Where a scene steps rays side by side at less cost, a lane takes
//! the next ray as soon as its own has ended.

use crate::base::lanes::LANES;
use crate::base::outcome::Counts;
use crate::base::view::Beam;
use crate::scene::{Hit, Solid, Step};

/// A ray from a proven front.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// The ray.
    pub ray: Beam,
    /// Nothing is nearer.
    pub front: f64,
    /// Where it ends at the latest.
    pub far: f64,
}

/// How a ray ended.
#[derive(Clone, Copy, Debug, Default)]
pub struct End {
    /// Where it is, and what it met.
    pub hit: Hit,
    /// What its last step came to: moving if it reached the limit of steps.
    pub step: Step,
    /// Its cost.
    pub work: Counts,
}

/// Follows a ray by at most `limit` steps.
pub fn follow<S: Solid>(solid: &S, start: &Start, limit: u32) -> End {
    let mut end = End::default();
    let mut walk = solid.begin(&start.ray, start.front, start.far, &mut end.work);
    for _ in 0..limit {
        end.step = solid.walk_step(&start.ray, &mut walk, &mut end.work);
        if end.step != Step::Moving {
            break;
        }
    }
    end.hit = solid.walk_hit(&walk);
    end
}

/// [`follow`] for many rays.
pub fn follow_all<S: Solid>(solid: &S, starts: &[Start], limit: u32) -> Vec<End> {
    let mut waiting = starts.iter().enumerate();
    if starts.len() < 2 || limit == 0 || !solid.has_lanes() {
        let one = |start| follow(solid, start, limit);
        return starts.iter().map(one).collect();
    }
    let mut ends = vec![End::default(); starts.len()];
    let Start { ray, front, far } = starts[0];
    let mut rays = [ray; LANES];
    let mut walks = [solid.begin(&ray, front, far, &mut Counts::default()); LANES];
    let mut work = [Counts::default(); LANES];
    let mut left = [0; LANES];
    let mut held = [None; LANES];
    loop {
        for lane in 0..LANES {
            if held[lane].is_none()
                && let Some((i, start)) = waiting.next()
            {
                (held[lane], left[lane]) = (Some(i), limit);
                (rays[lane], work[lane]) = (start.ray, Counts::default());
                walks[lane] = solid.begin(&start.ray, start.front, start.far, &mut work[lane]);
            }
        }
        let on = held.map(|ray| ray.is_some());
        if !on.contains(&true) {
            return ends;
        }
        let steps = solid.step_lanes(&rays, &mut walks, on, &mut work);
        for lane in 0..LANES {
            let Some(i) = held[lane] else {
                continue;
            };
            left[lane] -= 1;
            if steps[lane] == Step::Moving && left[lane] > 0 {
                continue;
            }
            ends[i] = End {
                hit: solid.walk_hit(&walks[lane]),
                step: steps[lane],
                work: work[lane],
            };
            held[lane] = None;
        }
    }
}
