//! The questions that a pass may ask a scene (and nothing else may be asked).

use glam::DVec3;

use crate::base::shader::Module;
use crate::base::view::Beam;
pub use crate::base::work::Step;
use crate::base::work::Work;

/// What one step of a cone came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Advance {
    /// Distance up to which every ray of the cone is proven free.
    pub front: f64,
    /// Whether another step is worth its price.
    pub going: bool,
}

/// Where a ray met the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f64,
    /// What was met: a face, a cell.
    pub id: u32,
    /// Where on it.
    pub uv: [f64; 2],
}

/// What the colour pass needs to know of a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Unit normal.
    pub normal: DVec3,
    /// Three numbers in 0..1 to look the palette up with; of scenes that are colored
    /// ([`Solid::is_colored`]) linear red, green and blue.
    pub pigment: DVec3,
}

/// A scene in f64. Points `q` are relative to the eye; functions of the same names
/// answer in WGSL. `work` gains what the answer cost.
pub trait Solid: Sync {
    /// A ray on its way.
    type Walk: Copy;

    /// The new proven front of a cone, never below the old one.
    fn advance(&self, cone: &Beam, front: f64, work: &mut Work) -> Advance;

    /// Starts a ray at a proven front; nothing beyond `t_max` counts.
    fn begin(&self, ray: &Beam, front: f64, t_max: f64, work: &mut Work) -> Self::Walk;

    /// One step.
    fn walk_step(&self, ray: &Beam, walk: &mut Self::Walk, work: &mut Work) -> Step;

    /// Where a walk stands: its hit, once it has one.
    fn walk_hit(&self, walk: &Self::Walk) -> Hit;

    /// How much room there is about where the walk stands, as penumbrae want it: the
    /// radius of the ball that it found empty, or a guess near it.
    fn walk_radius(&self, ray: &Beam, walk: &Self::Walk) -> f64;

    /// Radius of a surely empty ball about a point.
    fn clearance(&self, q: DVec3) -> f64;

    /// How much room there seems to be about a point, as occlusion wants it: the clearance,
    /// or a guess that is nearer to the truth than that and may lie beyond it.
    fn room(&self, q: DVec3) -> f64 {
        self.clearance(q)
    }

    /// Normal and pigment of a hit.
    fn surface(&self, ray: &Beam, hit: &Hit) -> Surface;

    /// The distance from the eye past which there is nothing.
    fn bounds_far(&self) -> f64;

    /// Whether pigments are colours themselves, not numbers to look the palette up with.
    fn is_colored(&self) -> bool {
        false
    }
}

/// The GPU's side of a scene: modules to join and values to bind.
pub trait Twin {
    /// The scene's modules, its formula's included.
    fn modules(&self) -> Vec<Module>;
    /// Bytes of the uniforms by the names of the WGSL variables.
    fn uniforms(&self) -> Vec<(&'static str, Vec<u8>)>;
    /// A line for people: what it is, with the numbers that it was resolved to.
    fn describe(&self) -> String;
    /// Rounds of inner loops that one step may take: what a step costs at most.
    fn rounds(&self) -> u32;
    /// Whether its hits carry an id and a place beside their distance.
    fn marks_hits(&self) -> bool {
        true
    }
}
