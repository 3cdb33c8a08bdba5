//! Any of the tracers, for who chooses one by its name. The only place that tells them
//! apart.

use crate::base::shader::Module;
use crate::base::work::Work;
use crate::heightfield::tracer::cones::Cones;
use crate::heightfield::tracer::contract::{LocalRay, Step, Trace, Tracer};
use crate::heightfield::tracer::linear::LinearBinary;
use crate::heightfield::tracer::max_mip::MaxMipTracer;
use crate::heightfield::tracer::oracle::Oracle;
use crate::heightfield::tracer::relaxed::WalkRelaxed;
use crate::heightfield::tracer::walk::Walk;
use crate::heightfield::tracer::walk_mip::WalkMip;

/// One of the tracers.
#[derive(Clone, Debug)]
pub enum AnyTracer {
    /// Every cell: the truth.
    Oracle(Oracle),
    /// The cone walk.
    Walk(Walk),
    /// The walk with relaxed cones.
    WalkRelaxed(WalkRelaxed),
    /// The walk over nodes as wide as a pixel.
    WalkMip(WalkMip),
    /// The pyramid of maxima.
    MaxMip(MaxMipTracer),
    /// Equal steps and halvings.
    LinearBinary(LinearBinary),
    /// Cones over samples, in one of their manners.
    Cones(Cones),
}

/// Does the same to whichever tracer it is.
macro_rules! each {
    ($any:expr, $tracer:ident => $answer:expr) => {
        match $any {
            AnyTracer::Oracle($tracer) => $answer,
            AnyTracer::Walk($tracer) => $answer,
            AnyTracer::WalkRelaxed($tracer) => $answer,
            AnyTracer::WalkMip($tracer) => $answer,
            AnyTracer::MaxMip($tracer) => $answer,
            AnyTracer::LinearBinary($tracer) => $answer,
            AnyTracer::Cones($tracer) => $answer,
        }
    };
}

impl Tracer for AnyTracer {
    fn begin(&self, ray: &LocalRay, from: f64, to: f64, work: &mut Work) -> Trace {
        each!(self, t => t.begin(ray, from, to, work))
    }

    fn look(&self, ray: &LocalRay, trace: &mut Trace, work: &mut Work) -> Step {
        each!(self, t => t.look(ray, trace, work))
    }

    fn modules(&self) -> Vec<Module> {
        each!(self, t => t.modules())
    }

    fn buffers(&self) -> Vec<(&'static str, Vec<u8>)> {
        each!(self, t => t.buffers())
    }
}
