//! The questions that a scene asks a tracer, and what goes to and fro.
//!
//! A tracer is a small state, the [`Trace`], and a step of bounded work. It has no loop
//! over steps: whoever asks counts and caps them, so that a limit is always theirs to
//! report. All tracers have the same state and answer to the same names, here and in
//! `wgsl/heightfield/tracer/NAME.wgsl`, so that one can take another's place.

use glam::DVec3;
use thiserror::Error;

use crate::base::shader::Module;
use crate::base::work::Work;
use crate::heightfield::conemap::MapKind;

/// A ray in the relief's own units: x and y in texels, z in heights. `axis` is not of
/// unit length: s is whatever parameter the caller's ray has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalRay {
    /// Where s is 0.
    pub origin: DVec3,
    /// Change per unit of s.
    pub axis: DVec3,
}

impl LocalRay {
    /// The point at a parameter.
    pub fn at(&self, s: f64) -> DVec3 {
        self.origin + s * self.axis
    }

    /// The height at a parameter.
    pub fn height(&self, s: f64) -> f64 {
        self.origin.z + s * self.axis.z
    }
}

/// What one step came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Go on.
    Moving,
    /// The block is met.
    Hit,
    /// Past the block, or past the end: nothing there.
    Out,
    /// The tracer has a number of steps of its own, and it is used up: not converged.
    Spent,
}

/// Bits of a hit's id below the face.
pub const FACE_BITS: u32 = 28;
/// The surface on top.
pub const SURFACE: u32 = 0;
/// The wall at x = 0.
pub const WALL_X_LOW: u32 = 1;
/// The wall where x ends.
pub const WALL_X_HIGH: u32 = 2;
/// The wall at y = 0.
pub const WALL_Y_LOW: u32 = 3;
/// The wall where y ends.
pub const WALL_Y_HIGH: u32 = 4;
/// The underside, at z = 0.
pub const BASE: u32 = 5;

/// Where a ray met the block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TraceHit {
    /// The parameter of the ray.
    pub s: f64,
    /// In the low [`FACE_BITS`] bits the cell, `y * cells_x + x` within its tile; above
    /// them the face.
    pub id: u32,
    /// On the surface and the underside the place in the cell, 0..=1. On a wall the
    /// place along the cell, 0..=1, and the height. A box that is met on its side has 0
    /// or 1 exactly.
    pub uv: [f64; 2],
}

impl TraceHit {
    /// What was met: [`SURFACE`], a wall, or [`BASE`].
    pub fn face(&self) -> u32 {
        self.id >> FACE_BITS
    }

    /// The number of the cell.
    pub fn cell(&self) -> u32 {
        self.id & ((1 << FACE_BITS) - 1)
    }
}

/// A ray on its way, whatever traces it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trace {
    /// Where the ray stands: nothing is met before, as far as the tracer can tell.
    pub s: f64,
    /// Where it leaves the block or reaches its end.
    pub end: f64,
    /// Where it came into its cell, or into the block.
    pub enter: f64,
    /// A lower bound of its height above the apex of its cell, or of the larger node that
    /// it was last over.
    pub gap: f64,
    /// Its cell of the domain.
    pub cell: [i32; 2],
    /// The level of the pyramid that is looked at.
    pub level: u32,
    /// Steps that are left to a tracer that counts its own.
    pub left: u32,
    /// Whether the end is the bottom of the block, reached from above.
    pub falls: bool,
    /// What the last step came to.
    pub state: Step,
    /// What was met, once it was.
    pub id: u32,
    /// Where on it.
    pub uv: [f64; 2],
}

impl Trace {
    /// Where the ray stands: its hit, once it has one.
    pub fn hit(&self) -> TraceHit {
        TraceHit {
            s: self.s,
            id: self.id,
            uv: self.uv,
        }
    }
}

/// A way of finding the first hit.
pub trait Tracer {
    /// Starts a ray; nothing before `from` or beyond `to` counts.
    fn begin(&self, ray: &LocalRay, from: f64, to: f64, work: &mut Work) -> Trace;

    /// What a step does with a ray that moves.
    fn look(&self, ray: &LocalRay, trace: &mut Trace, work: &mut Work) -> Step;

    /// One step, of bounded work; none of a ray that has ended. `work` gains an evaluation
    /// for it, and an iteration for each round of refinement.
    fn step(&self, ray: &LocalRay, trace: &mut Trace, work: &mut Work) -> Step {
        if trace.state != Step::Moving {
            return trace.state;
        }
        work.evaluations += 1;
        self.look(ray, trace, work)
    }

    /// The modules of WGSL to join for it, those of its relief among them.
    fn modules(&self) -> Vec<Module>;

    /// What the relief's buffers hold for it, by the names of the WGSL variables.
    fn buffers(&self) -> Vec<(&'static str, Vec<u8>)>;
}

/// Why a cone map does not serve a tracer.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TraceError {
    /// Its cones promise something else.
    #[error("the tracer `{tracer}` cannot use cones of the kind {kind:?}")]
    Kind {
        /// The tracer.
        tracer: &'static str,
        /// What the map is.
        kind: MapKind,
    },
    /// It was made for another grid.
    #[error("a cone map of {found:?} places for a relief of {wanted:?}")]
    Size {
        /// Places of the relief.
        wanted: [u32; 2],
        /// Places of the map.
        found: [u32; 2],
    },
    /// It holds another number of cones than its size says.
    #[error("a cone map of {found} cones where its size needs {wanted}")]
    Count {
        /// Cones of its size.
        wanted: usize,
        /// Cones given.
        found: usize,
    },
    /// Its axes do not wrap as those of the relief do.
    #[error("a cone map that wraps {found:?} for a relief that wraps {wanted:?}")]
    Wrap {
        /// Axes of the relief.
        wanted: [bool; 2],
        /// Axes of the map.
        found: [bool; 2],
    },
    /// A cone or an offset that no arithmetic may meet.
    #[error("a cone map with the number {0}: ratios and offsets are finite and not negative")]
    Number(f64),
}
