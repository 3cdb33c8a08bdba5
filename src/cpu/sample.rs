//! Some pixels of a plan alone.

use rayon::prelude::*;

use crate::base::outcome::{Counts, State};
use crate::base::view::View;
use crate::pass::march::Ended;
use crate::pass::prepare::FrameError;
use crate::pass::trace;
use crate::plan::Plan;
use crate::plan::pyramid::Level;
use crate::scene::{Assets, Hit, Solid, Task};

use super::Proof;

/// Renders some pixels of a plan alone: each goes through the cones above it.
///
/// # Errors
/// A named file cannot be read or does not fit.
pub fn sample(
    plan: &Plan,
    assets: &Assets,
    pixels: &[[u32; 2]],
) -> Result<Vec<(Hit, State)>, FrameError> {
    let solid = plan.scene.solid(&plan.viewpoint(), assets)?;
    let sample = Sample {
        view: plan.view(),
        limit: plan.ray_steps(&solid),
        levels: plan.levels(),
        pixels,
    };
    Ok(solid.run(sample))
}

struct Sample<'a> {
    view: View,
    limit: u32,
    levels: Vec<Level>,
    pixels: &'a [[u32; 2]],
}

impl Task for Sample<'_> {
    type Output = Vec<(Hit, State)>;

    fn run<S: Solid>(self, solid: &S) -> Self::Output {
        let one = |pixel: &[u32; 2]| {
            let (mut front, work) = (0.0, &mut Counts::default());
            for level in &self.levels {
                let cell = pixel.map(|p| p / level.divisor);
                let proof = Proof::of((solid, &self.view), cell, *level, front, work);
                if proof.ended == Ended::Sky {
                    return (Hit::default(), State::Sky);
                }
                front = proof.front;
            }
            trace::trace(solid, &self.view.view_ray(*pixel), front, self.limit, work)
        };
        self.pixels.par_iter().map(one).collect()
    }
}
