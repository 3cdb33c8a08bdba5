//! What passes ask a scene. They know nothing else about it.
//! Twin: `wgsl/scene/contract.wgsl`.

use glam::DVec3;

use crate::base::array::SceneArray;
use crate::base::lanes::{LANES, Places};
use crate::base::outcome::Counts;
pub use crate::base::outcome::{Advance, Hit, Step};
use crate::base::shader::Module;
use crate::base::view::Beam;

/// What the colour pass needs to know about a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Unit normal.
    pub normal: DVec3,
    /// Three numbers from 0 to 1 that pick a colour of the palette. In coloured scenes
    /// ([`Solid::is_colored`]) it is a linear colour.
    pub pigment: DVec3,
}

/// Distances along a normal at which occlusion asks for the free room.
pub const ROOMS: usize = 5;

/// A scene in f64. Its WGSL twin has functions of the same names. Points `q` are relative to
/// the eye. A function that takes `work` adds its cost to it.
pub trait Solid: Sync {
    /// The state of a ray between two steps.
    type Walk: Copy;

    /// One step of a cone. The new front is never below the old one.
    fn advance(&self, cone: &Beam, at: Advance, work: &mut Counts) -> Advance;

    /// Starts a ray at a proven front. It ends at `t_max` at the latest.
    fn begin(&self, ray: &Beam, front: f64, t_max: f64, work: &mut Counts) -> Self::Walk;

    /// One step of a ray.
    fn walk_step(&self, ray: &Beam, walk: &mut Self::Walk, work: &mut Counts) -> Step;

    /// Whether rays side by side cost less than one by one.
    fn has_lanes(&self) -> bool {
        false
    }

    /// [`Self::advance`] for the cones of some lanes.
    fn advance_lanes(
        &self,
        cones: &[Beam; LANES],
        at: &mut [Advance; LANES],
        on: [bool; LANES],
        work: &mut [Counts; LANES],
    ) {
        for i in (0..LANES).filter(|i| on[*i]) {
            at[i] = self.advance(&cones[i], at[i], &mut work[i]);
        }
    }

    /// [`Self::walk_step`] for the rays of some lanes.
    fn step_lanes(
        &self,
        rays: &[Beam; LANES],
        walks: &mut [Self::Walk; LANES],
        on: [bool; LANES],
        work: &mut [Counts; LANES],
    ) -> [Step; LANES] {
        std::array::from_fn(|i| match on[i] {
            true => self.walk_step(&rays[i], &mut walks[i], &mut work[i]),
            false => Step::Moving,
        })
    }

    /// Where the ray is; its hit, once it has one.
    fn walk_hit(&self, walk: &Self::Walk) -> Hit;

    /// How far from the surface shadow rays start, along the normal. `grain` is half a pixel's
    /// width at the point.
    fn shadow_lift(&self, grain: f64) -> f64 {
        // Beyond the threshold that would end the ray at once.
        4.0 * grain
    }

    /// The radius of a ball about a point that is as surely empty as the step of a ray is.
    fn clearance(&self, q: DVec3) -> f64;

    /// The free room about a point, for occlusion. It may be a guess that exceeds the
    /// clearance. Where it is more than `enough`, any number from `enough` on will do.
    fn room(&self, q: DVec3, _enough: f64, _work: &mut Counts) -> f64 {
        self.clearance(q)
    }

    /// The free room at five distances from a point, of which each is twice the one before.
    fn rooms(&self, q: DVec3, axis: DVec3, nearest: f64) -> [f64; ROOMS] {
        std::array::from_fn(|i| {
            let h = nearest * f64::from(1 << i);
            self.room(q + h * axis, h, &mut Counts::default())
        })
    }

    /// [`Self::rooms`] about the points of some lanes.
    fn rooms_lanes(
        &self,
        at: &Places,
        axes: &[DVec3; LANES],
        nearest: &[f64; LANES],
    ) -> [[f64; ROOMS]; LANES] {
        at.each(|i, q| self.rooms(q, axes[i], nearest[i]))
    }

    /// Normal and pigment of a hit.
    fn surface(&self, ray: &Beam, hit: &Hit) -> Surface;

    /// [`Self::surface`] of at most [`LANES`] hits.
    fn surfaces(&self, hits: &[(Beam, Hit)]) -> Vec<Surface> {
        hits.iter()
            .map(|(ray, hit)| self.surface(ray, hit))
            .collect()
    }

    /// The numbers of all traps at a point (`formula::Traps`), if the scene has orbits.
    fn traps(&self, _q: DVec3) -> Option<[f64; 7]> {
        None
    }

    /// The distance from the eye beyond which there is nothing.
    fn bounds_far(&self) -> f64;

    /// Whether pigments are colours and need no palette.
    fn is_colored(&self) -> bool {
        false
    }
}

/// What a GPU needs of a scene: modules to join and values to bind.
pub trait Twin {
    /// The WGSL modules.
    fn modules(&self) -> Vec<Module>;
    /// The WGSL modules of the twin of [`Solid::traps`]; none without orbits.
    fn trap_modules(&self) -> Vec<Module> {
        Vec::new()
    }
    /// The bytes of each WGSL parameter variable.
    fn uniforms(&self) -> Vec<(&'static str, Vec<u8>)>;
    /// The arrays that the shaders read beside the parameters.
    fn arrays(&self) -> Vec<SceneArray> {
        Vec::new()
    }
    /// A line about the scene, with the numbers that it was resolved to.
    fn describe(&self) -> String;
    /// The most steps that a ray can take through the scene, where this is known.
    fn most_steps(&self) -> Option<u32> {
        None
    }
    /// An upper bound of the inner loop rounds in one step.
    fn rounds(&self) -> u32;
    /// Whether hits carry an id and a place as well as a distance.
    fn marks_hits(&self) -> bool {
        true
    }
}
