//! The result of a step, the state of a pixel, where a ray met the scene, and counters of work.
//! Twin: `wgsl/base/outcome.wgsl`.

use crate::base::shader::Module;
use crate::wgsl;

/// A cone between two steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Advance {
    /// Every ray of the cone is proven free up to here.
    pub front: f64,
    /// The radius of the last ball; 0 before the first.
    pub radius: f64,
    /// Whether another step is worth its cost.
    pub going: bool,
}

impl Advance {
    /// A cone at a front, with nothing known about what is ahead.
    pub fn at(front: f64, going: bool) -> Self {
        Self {
            front,
            radius: 0.0,
            going,
        }
    }
}

/// What one step of a ray came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Step {
    /// The ray goes on.
    #[default]
    Moving,
    /// The surface is met.
    Hit,
    /// The ray is past its end and has met nothing.
    Out,
    /// The tracer's own limit of steps is reached: the ray has not converged.
    Spent,
}

/// What a pixel is. The numbers are those of the shaders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum State {
    /// The ray left the bounds.
    Sky = 0,
    /// The ray met the surface.
    Hit = 1,
    /// The ray reached a limit before either.
    Unconverged = 2,
}

impl State {
    /// The state of a number that an executor wrote; `None` for any other number.
    pub fn from_code(code: u32) -> Option<Self> {
        let all = [Self::Sky, Self::Hit, Self::Unconverged];
        all.into_iter().find(|state| *state as u32 == code)
    }
}

/// Where a ray met the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f64,
    /// The part that was met: a face or a cell.
    pub id: u32,
    /// The place on it.
    pub uv: [f64; 2],
}

/// The work of one cell or pixel, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Evaluations of the distance estimate, or lookups in a heightfield.
    pub evaluations: u32,
    /// Iterations of the formula in these evaluations.
    pub iterations: u32,
}

/// The modules of outcomes, with counters that count or with those that do not.
pub fn modules(counted: bool) -> [Module; 2] {
    let counters = match counted {
        true => wgsl!("base/counters.wgsl"),
        false => wgsl!("base/counters_off.wgsl"),
    };
    [wgsl!("base/outcome.wgsl"), counters]
}
