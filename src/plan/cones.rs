//! Whether cones make a render faster (docs/method.md, 2).
//!
//! Cones save the steps that the rays of a block share. Close to the surface every pixel needs
//! its own steps, and after cones these differ more between neighbours, which wait for each other.
//! So cones are faster where a ray alone needs many steps. A few rays tell how many.

use crate::base::outcome::Counts;
use crate::base::view::View;
use crate::scene::{Solid, Step, Task};

/// Rays along each axis of the picture.
const RAYS: [u32; 2] = [16, 9];
/// Cones pay from this mean number of evaluations per ray on. Over all built-in Mandelboxes from
/// 640 x 360 to 1920 x 1080, rays alone are faster or equal up to 9, and cones from 11 on.
const EVALUATIONS: u32 = 10;

/// Follows a few rays without cones.
pub struct Probe {
    /// The view.
    pub view: View,
    /// Its width and height in pixels.
    pub size: [u32; 2],
    /// The step limit of a ray.
    pub steps: u32,
}

impl Task for Probe {
    /// Whether cones pay.
    type Output = bool;

    fn run<S: Solid>(self, solid: &S) -> bool {
        let middle = |axis: usize, i: u32| {
            let at = u64::from(2 * i + 1) * u64::from(self.size[axis]);
            (at / u64::from(2 * RAYS[axis])) as u32
        };
        let enough = RAYS[0] * RAYS[1] * EVALUATIONS;
        let mut work = Counts::default();
        for i in 0..RAYS[0] * RAYS[1] {
            let pixel = [middle(0, i % RAYS[0]), middle(1, i / RAYS[0])];
            let ray = self.view.view_ray(pixel);
            let mut walk = solid.begin(&ray, 0.0, solid.bounds_far(), &mut work);
            for _ in 0..self.steps {
                if solid.walk_step(&ray, &mut walk, &mut work) != Step::Moving {
                    break;
                }
                if work.evaluations >= enough {
                    return true;
                }
            }
        }
        work.evaluations >= enough
    }
}
