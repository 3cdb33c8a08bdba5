//! Any of the tracers, for who chooses one by its name. The only place that tells them
//! apart.

use super::cones::Cones;
use super::contract::{LocalRay, Step, Trace, Tracer};
use super::linear::LinearBinary;
use super::max_mip::MaxMipTracer;
use super::oracle::Oracle;
use super::relaxed::WalkRelaxed;
use super::walk::Walk;
use super::walk_mip::WalkMip;
use crate::frame::Work;
use crate::shader::Module;

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
