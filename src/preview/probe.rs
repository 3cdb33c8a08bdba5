//! What the CPU can tell about the scene at once, in f64.

use glam::DVec3;

use crate::base::outcome::{Counts, State};
use crate::pass::trace::trace;
use crate::plan::Plan;
use crate::scene::{Assets, Solid, Task};

/// The radius of a ball about a point that is proven empty.
struct Clearance(DVec3);

impl Task for Clearance {
    type Output = f64;

    fn run<S: Solid>(self, solid: &S) -> f64 {
        solid.clearance(self.0)
    }
}

/// Follows the ray of a pixel.
struct Ray<'a>(&'a Plan, [u32; 2], u32);

impl Task for Ray<'_> {
    type Output = (f64, State, Counts);

    fn run<S: Solid>(self, solid: &S) -> Self::Output {
        let Self(plan, pixel, steps) = self;
        let mut work = Counts::default();
        let ray = plan.view().view_ray(pixel);
        let (hit, state) = trace(solid, &ray, 0.0, steps, &mut work);
        (hit.t, state, work)
    }
}

/// The radius of a ball about the eye that is proven empty; `None` while heights are missing.
pub fn clearance(plan: &Plan, assets: &Assets) -> Option<f64> {
    let assets = &assets.snapshot(false);
    if !plan.scene.has_assets(assets) {
        return None;
    }
    let solid = plan.scene.solid(&plan.viewpoint(), assets).ok()?;
    Some(solid.run(Clearance(DVec3::ZERO)))
}

/// What the ray of a pixel meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probed {
    /// The distance along the ray.
    pub distance: f64,
    /// The point in the world.
    pub point: DVec3,
    /// What the pixel is.
    pub state: State,
    /// Evaluations of the estimate, or look-ups of heights.
    pub evaluations: u32,
}

/// What the ray of a pixel meets; `None` while heights are missing.
pub fn pixel(plan: &Plan, assets: &Assets, pixel: [u32; 2]) -> Option<Probed> {
    let assets = &assets.snapshot(false);
    if !plan.scene.has_assets(assets) {
        return None;
    }
    let solid = plan.scene.solid(&plan.viewpoint(), assets).ok()?;
    let steps = plan.ray_steps(&solid);
    let (distance, state, work) = solid.run(Ray(plan, pixel, steps));
    let ray = plan.view().view_ray(pixel);
    Some(Probed {
        distance,
        point: plan.camera.eye + ray.at(distance),
        state,
        evaluations: work.evaluations,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::truth;
    use crate::preset;

    #[test]
    fn the_truth_of_heights_is_known_beside_their_cone_map() {
        let text = "[scene]\nkind = 'heightfield'\nfield = 'fbm:32x32'\n";
        let (plan, assets) = (preset::read(text, "a test"), Assets::default());
        let plan = plan.expect("a preset");
        let known = |plan: &Plan| pixel(plan, &assets, [3, 3]);
        assert_eq!(known(&plan), None);
        plan.scene
            .solid(&plan.viewpoint(), &assets)
            .expect("heights");
        assert!(known(&plan).is_some());
        assert!(known(&truth::asked(&plan)).is_some());
        assert!(known(&plan).is_some(), "its map is gone");
    }
}
