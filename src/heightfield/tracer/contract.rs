//! What a scene asks a tracer, and the values that they exchange.
//!
//! A tracer has no loop over steps. It answers [`Tracer::begin`] with a small state, the
//! [`Trace`], and moves it on by one bounded step at a time. The caller counts the steps and
//! limits them. All tracers share the state and the names of the functions, here and in
//! `wgsl/heightfield/tracer/NAME.wgsl`, so that one can replace another.

use std::fmt::Debug;
use std::sync::Arc;

use glam::DVec3;
use thiserror::Error;

use crate::base::array::SceneArray;
pub use crate::base::outcome::Step;
use crate::base::{outcome::Counts, shader::Module};
use crate::heightfield::conemap::generate::mips::stored;
use crate::heightfield::height_surface::{HeightmapUniform, TracerParameters};
use crate::heightfield::tracer::{
    GridRay, cones::Lookup, grid::grid_begin, reference::Reference, settings::TracerCones,
    settings::TracerSettings, walk_mip::NodeCones,
};
use crate::heightfield::{ConeMap, HeightSurface, MapKind};

/// A ray in the surface's own units: x and y in texels, z in heights. `axis` is not of unit
/// length; s is the parameter of the caller's ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalRay {
    /// The point at s = 0.
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

/// Where a ray meets the block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TraceHit {
    /// The parameter of the ray.
    pub s: f64,
    /// The low [`FACE_BITS`] bits are the cell, `y * cells_x + x` within its tile. The bits
    /// above them are the face.
    pub id: u32,
    /// On the surface and the underside the place in the cell, 0..=1. On a wall the place
    /// along the cell, 0..=1, and the height. On the side of a box one of them is exactly 0
    /// or 1.
    pub uv: [f64; 2],
}

impl TraceHit {
    /// What is met: [`SURFACE`], a wall, or [`BASE`].
    pub fn face(&self) -> u32 {
        self.id >> FACE_BITS
    }

    /// The number of the cell.
    pub fn cell(&self) -> u32 {
        self.id & ((1 << FACE_BITS) - 1)
    }
}

/// The state of a ray on its way, the same for every tracer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trace {
    /// Where the ray stands. The tracer has found nothing before it.
    pub s: f64,
    /// Where the ray leaves the block or reaches its end.
    pub end: f64,
    /// Where the ray came into its cell, or into the block.
    pub enter: f64,
    /// The cell of the domain that the ray is in.
    pub cell: [i32; 2],
    /// The level of the pyramid that the tracer looks at.
    pub level: u32,
    /// Steps left, for a tracer that counts its own.
    pub left: u32,
    /// Whether the end is the bottom of the block, reached from above.
    pub falls: bool,
    /// What the last step came to.
    pub state: Step,
    /// What is met, once there is a hit.
    pub id: u32,
    /// The place on it.
    pub uv: [f64; 2],
}

impl Trace {
    /// The hit, once there is one; the place of the ray before that.
    pub fn hit(&self) -> TraceHit {
        TraceHit {
            s: self.s,
            id: self.id,
            uv: self.uv,
        }
    }
}

/// A tracer of one surface: its method, and all that the method reads.
#[derive(Clone, Debug)]
pub struct Tracer {
    /// The surface that it traces.
    pub surface: Arc<HeightSurface>,
    /// Its cones; [`ConeMap::none`] for a method without cones.
    pub map: Arc<ConeMap>,
    /// The cones of nodes, if the method takes those.
    pub nodes: Option<NodeCones>,
    /// How ratios are read between the samples.
    pub lookup: Lookup,
    /// Its numbers in the uniform.
    pub numbers: TracerParameters,
    /// How it finds the first hit of a ray.
    pub method: &'static dyn Method,
}

/// A way to find the first hit of a ray.
pub trait Method: Debug + Sync {
    /// The numbers that it needs: those of a preset, or its own. `pixel` is the distance from
    /// the eye at which a texel is as wide as a pixel.
    fn numbers(&self, _: &TracerSettings, _pixel: f64) -> TracerParameters {
        TracerParameters::default()
    }

    /// The cones of nodes, if it reads those: the supplied ones, or new ones.
    fn nodes(&self, _: &HeightSurface, _: &TracerCones) -> Option<NodeCones> {
        None
    }

    /// Completes the state of a ray that starts.
    fn begin(&self, _: &Tracer, _: &LocalRay, _: &mut Trace) {}

    /// What a step does with a ray that is moving.
    fn advance(&self, tracer: &Tracer, grid: &mut GridRay<'_>, work: &mut Counts) -> Step;

    /// The WGSL modules of its own.
    fn modules(&self, tracer: &Tracer) -> Vec<Module>;

    /// The ratios, as the shaders read them.
    fn ratios(&self, tracer: &Tracer) -> SceneArray {
        let name = match tracer.map.kind.channels() {
            1 => "ratios",
            _ => "ratios_of_sides",
        };
        SceneArray::new(name, &tracer.map, |map| stored(&map.ratios))
    }
}

impl Tracer {
    /// The reference tracer of a surface.
    pub fn reference(surface: Arc<HeightSurface>) -> Self {
        Self {
            surface,
            map: Arc::new(ConeMap::none()),
            nodes: None,
            lookup: Lookup::default(),
            numbers: TracerParameters::default(),
            method: &Reference,
        }
    }

    /// Starts a ray. Nothing before `from` or beyond `to` counts.
    pub fn begin(&self, ray: &LocalRay, from: f64, to: f64) -> Trace {
        let mut trace = grid_begin(&self.surface, ray, from, to);
        self.method.begin(self, ray, &mut trace);
        trace
    }

    /// One step of bounded work; a ray that has ended stays as it is. `work` gains one
    /// evaluation, and an iteration for each round of refinement.
    pub fn step(&self, ray: &LocalRay, trace: &mut Trace, work: &mut Counts) -> Step {
        if trace.state != Step::Moving {
            return trace.state;
        }
        work.evaluations += 1;
        let surface = &self.surface;
        let mut grid = GridRay {
            surface,
            ray,
            trace,
        };
        self.method.advance(self, &mut grid, work)
    }

    /// All WGSL modules to join, those of the surface included.
    pub fn modules(&self) -> Vec<Module> {
        let mut all = self.surface.modules();
        all.extend(self.method.modules(self));
        all
    }

    /// Its parameters and those of the surface.
    pub fn uniform(&self) -> HeightmapUniform {
        self.surface.uniform(&self.map, self.numbers)
    }

    /// The arrays that the shaders read.
    pub fn arrays(&self) -> Vec<SceneArray> {
        let mut all = self.surface.arrays();
        all.push(self.method.ratios(self));
        all
    }
}

/// Why a tracer cannot use a cone map.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TraceError {
    /// There is no map.
    #[error("the tracer `{0}` needs a cone map")]
    Missing(&'static str),
    /// The map's cones promise something else.
    #[error("the tracer `{tracer}` cannot use cones of the kind {kind:?}")]
    Kind {
        /// The tracer.
        tracer: &'static str,
        /// The kind of the map.
        kind: MapKind,
    },
    /// The map was made for another surface.
    #[error("the cone map has {what} {found}, but the surface needs {wanted}")]
    Misfit {
        /// What differs: places, cones, or wrapping axes.
        what: &'static str,
        /// What the surface needs.
        wanted: String,
        /// What the map has.
        found: String,
    },
    /// A ratio or an offset that is out of range.
    #[error("the cone map contains {0}; ratios and offsets must be finite and not negative")]
    Number(f64),
}
