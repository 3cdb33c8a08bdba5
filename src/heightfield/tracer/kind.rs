//! The list of tracers, and what is known of each before it is made.

use std::sync::Arc;

use crate::base::named::named_enum;
use crate::heightfield::HeightSurface;
use crate::heightfield::conemap::MapKind::{self, Relaxed, Samples};
use crate::heightfield::tracer::settings::{TracerCones, TracerSettings};
use crate::heightfield::tracer::{
    Method, TraceError, Tracer, cone::check_map, cones, linear::LinearBinary,
    max_mip::MaxMipTracer, relaxed::WalkRelaxed, walk::Walk, walk_mip,
};

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
    /// How it finds the first hit.
    pub method: &'static dyn Method,
}

fn facts(
    accuracy: Accuracy,
    kinds: &'static [MapKind],
    steps: Steps,
    method: &'static dyn Method,
) -> TracerFacts {
    TracerFacts {
        accuracy,
        kinds,
        steps,
        method,
    }
}

named_enum! {
    /// A way to find where a ray first meets a height surface.
    #[derive(Default)]
    pub enum TracerKind: TracerFacts {
        /// The cone walk.
        #[default]
        Walk = "walk" => facts(Exact, &[MapKind::Walk], Cells, &Walk),
        /// The cone walk with relaxed cones.
        WalkRelaxed = "walk-relaxed" => facts(Exact, &[MapKind::WalkRelaxed], Cells, &WalkRelaxed),
        /// The cone walk over nodes as wide as a pixel, with the cones of cells.
        WalkMip = "walk-mip" => facts(Pixel, &[MapKind::Walk], Cells, &walk_mip::WALK_MIP),
        /// The cone walk over nodes as wide as a pixel, with the cones of nodes.
        ConeMip = "cone-mip" => facts(Pixel, &[MapKind::Walk], Cells, &walk_mip::CONE_MIP),
        /// Descent of the pyramid of maxima.
        MaxMip = "max-mip" => facts(Exact, &[], Pyramid, &MaxMipTracer),
        /// Equal steps, then bisection (Policarpo, Oliveira, Comba 2005).
        LinearBinary = "linear-binary" => facts(Approximate, &[], Divided(32), &LinearBinary),
        /// Cone steps until the surface, with the exact solve of every patch on the way.
        CsmExact = "csm-exact" => facts(Approximate, &[Samples], Cells, &cones::CSM_EXACT),
        /// As many cone steps as the view needs. The paper shows its adaptive version with 20.
        CsmLoop = "csm-loop" => facts(Approximate, &[Samples], Limited(20), &cones::CSM_LOOP),
        /// The same number of cone steps for every ray: the paper's fixed version has 10.
        CsmFixed = "csm-fixed" => facts(Approximate, &[Samples], Limited(10), &cones::SECANT),
        /// Cone steps that are stretched, then bisection.
        CsmScaled = "csm-scaled" => facts(Approximate, &[Samples], Cells, &cones::CSM_SCALED),
        /// Cone steps with one cone for each of four sides.
        Quad = "quad" => facts(Approximate, &[MapKind::Quad], Cells, &cones::SECANT),
        /// Relaxed cones, then bisection. Listing 18-3 has 15 cone steps.
        RcsBinary = "rcs-binary" => facts(Approximate, &[Relaxed], Limited(15), &cones::RCS_BINARY),
        /// Any cones over samples, then the secant method.
        Secant = "secant" => facts(Approximate, &[Samples, MapKind::Quad, Relaxed], Cells, &cones::SECANT),
    }
}

impl TracerKind {
    /// The words of `scene.tracer`, with `auto`.
    pub(super) const CHOICES: [(&str, Option<Self>); Self::ALL.len() + 1] = {
        let mut choices = [("auto", None); Self::ALL.len() + 1];
        let mut i = 0;
        while i < Self::ALL.len() {
            choices[i + 1] = (Self::WORDS[i].0, Some(Self::WORDS[i].1));
            i += 1;
        }
        choices
    };

    /// Whether it needs a cone map.
    pub fn needs_map(self) -> bool {
        !self.facts().kinds.is_empty()
    }

    /// The first tracer of the list that finds every first hit and needs no cone map.
    ///
    /// # Panics
    /// Never: the list has one.
    pub fn exact_without_map() -> Self {
        let exact = |kind: &Self| kind.facts().accuracy == Exact && !kind.needs_map();
        let found = Self::ALL.into_iter().find(exact);
        found.expect("an exact tracer without a map")
    }

    /// Makes the tracer of a surface. `settings` gives its numbers; `pixel` is the distance from
    /// the eye at which a texel is as wide as a pixel.
    ///
    /// # Errors
    /// It needs a cone map, and there is none that it can use.
    pub fn make(
        self,
        surface: &Arc<HeightSurface>,
        cones: Option<&TracerCones>,
        settings: &TracerSettings,
        pixel: f64,
    ) -> Result<Arc<Tracer>, TraceError> {
        let method = self.facts().method;
        let mut tracer = Tracer {
            lookup: settings.lookup,
            numbers: method.numbers(settings, pixel),
            method,
            ..Tracer::reference(surface.clone())
        };
        if self.needs_map() {
            let cones = cones.ok_or(TraceError::Missing(self.name()))?;
            check_map(self, surface, cones)?;
            tracer.map = cones.map().clone();
            tracer.nodes = method.nodes(surface, cones);
        }
        Ok(Arc::new(tracer))
    }
}
