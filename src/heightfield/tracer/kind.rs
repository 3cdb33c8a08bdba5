//! The list of tracers, and what is known of each before it is made.

use std::sync::Arc;

use crate::base::named::named_enum;
use crate::heightfield::conemap::ConeMap;
use crate::heightfield::conemap::MapKind::{self, Relaxed, Samples};
use crate::heightfield::height_surface::HeightSurface;
use crate::heightfield::tracer::cone::check_map;
use crate::heightfield::tracer::contract::{TraceError, Tracer};
use crate::heightfield::tracer::settings::{Supply, TracerSettings};
use crate::heightfield::tracer::{cones, linear, max_mip, relaxed, walk, walk_mip};

/// How well a tracer finds the first hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accuracy {
    /// It finds every first hit.
    Exact,
    /// It passes no first hit, and its own hits are off by at most a pixel.
    Pixel,
    /// It may pass thin parts of the surface.
    Approximate,
}

/// What limits the steps of a ray, if its caller does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steps {
    /// One step for each cell on its way.
    Cells,
    /// Steps up and down the pyramid of maxima.
    Pyramid,
    /// The tracer divides every ray into this number of steps by default.
    Divided(u32),
    /// As `Cells`, but by default the tracer gives a ray up after about this number of steps.
    Limited(u32),
}

use Accuracy::{Approximate, Exact, Pixel};
use Steps::{Cells, Divided, Limited, Pyramid};

/// What is known of a tracer before it is made.
pub struct TracerFacts {
    /// How well it finds the first hit.
    pub accuracy: Accuracy,
    /// The kinds of cones that it can use, the one to make by default first; none for a tracer
    /// without cones.
    pub kinds: &'static [MapKind],
    /// What limits its steps.
    pub steps: Steps,
    make: Make,
}

/// Makes a tracer.
type Make = fn(&Parts<'_>) -> Result<Arc<dyn Tracer>, TraceError>;

fn facts(accuracy: Accuracy, kinds: &'static [MapKind], steps: Steps, make: Make) -> TracerFacts {
    TracerFacts {
        accuracy,
        kinds,
        steps,
        make,
    }
}

/// What a tracer is made of.
#[derive(Debug)]
pub struct Parts<'a> {
    /// The tracer.
    pub kind: TracerKind,
    /// What it traces.
    pub surface: &'a Arc<HeightSurface>,
    /// The cones, if there are any.
    pub cones: Option<&'a Supply>,
    /// The numbers that a preset gives it.
    pub settings: &'a TracerSettings,
    /// The distance from the eye at which a texel is as wide as a pixel.
    pub pixel: f64,
}

impl Parts<'_> {
    /// The cone map, after a check that the tracer can use it.
    ///
    /// # Errors
    /// There is none, it is of another kind, or it was made for another surface.
    pub fn map(&self) -> Result<Arc<ConeMap>, TraceError> {
        let missing = TraceError::Missing(self.kind.name());
        let map = &self.cones.ok_or(missing)?.map;
        check_map(self.kind, self.surface, map)?;
        Ok(map.clone())
    }
}

named_enum! {
    /// A way to find where a ray first meets a height surface.
    pub enum TracerKind: TracerFacts {
        /// The cone walk.
        Walk = "walk" => facts(Exact, &[MapKind::Walk], Cells, walk::make),
        /// The cone walk with relaxed cones.
        WalkRelaxed = "walk-relaxed" => facts(Exact, &[MapKind::WalkRelaxed], Cells, relaxed::make),
        /// The cone walk over nodes as wide as a pixel, with the cones of cells.
        WalkMip = "walk-mip" => facts(Pixel, &[MapKind::Walk], Cells, walk_mip::make),
        /// The cone walk over nodes as wide as a pixel, with the cones of nodes.
        ConeMip = "cone-mip" => facts(Pixel, &[MapKind::Walk], Cells, walk_mip::make_with_nodes),
        /// Descent of the pyramid of maxima.
        MaxMip = "max-mip" => facts(Exact, &[], Pyramid, max_mip::make),
        /// Equal steps, then bisection (Policarpo, Oliveira, Comba 2005).
        LinearBinary = "linear-binary" => facts(Approximate, &[], Divided(32), linear::make),
        /// Cone steps until the surface, with the exact solve of every patch on the way.
        CsmExact = "csm-exact" =>
            facts(Approximate, &[Samples], Cells, |p| cones::make(p, cones::CSM_EXACT)),
        /// As many cone steps as the view needs. The paper shows its adaptive version with 20.
        CsmLoop = "csm-loop" =>
            facts(Approximate, &[Samples], Limited(20), |p| cones::make(p, cones::CSM_LOOP)),
        /// The same number of cone steps for every ray: the paper's fixed version has 10.
        CsmFixed = "csm-fixed" =>
            facts(Approximate, &[Samples], Limited(10), |p| cones::make(p, cones::SECANT)),
        /// Cone steps that are stretched, then bisection.
        CsmScaled = "csm-scaled" =>
            facts(Approximate, &[Samples], Cells, |p| cones::make(p, cones::CSM_SCALED)),
        /// Cone steps with one cone for each of four sides.
        Quad = "quad" =>
            facts(Approximate, &[MapKind::Quad], Cells, |p| cones::make(p, cones::SECANT)),
        /// Relaxed cones, then bisection. Listing 18-3 has 15 cone steps.
        RcsBinary = "rcs-binary" =>
            facts(Approximate, &[Relaxed], Limited(15), |p| cones::make(p, cones::RCS_BINARY)),
        /// Any cones over samples, then the secant method.
        Secant = "secant" =>
            facts(Approximate, &[Samples, MapKind::Quad, Relaxed], Cells, |p| cones::make(p, cones::SECANT)),
    }
}

impl TracerKind {
    /// Whether it needs a cone map.
    pub fn needs_map(self) -> bool {
        !self.facts().kinds.is_empty()
    }

    /// Makes the tracer of a surface. `settings` gives its numbers; `pixel` is the distance from
    /// the eye at which a texel is as wide as a pixel.
    ///
    /// # Errors
    /// It needs a cone map, and there is none that it can use.
    pub fn make(
        self,
        surface: &Arc<HeightSurface>,
        cones: Option<&Supply>,
        settings: &TracerSettings,
        pixel: f64,
    ) -> Result<Arc<dyn Tracer>, TraceError> {
        (self.facts().make)(&Parts {
            kind: self,
            surface,
            cones,
            settings,
            pixel,
        })
    }
}
