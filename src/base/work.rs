//! What a step came to, what a pixel is, and what it cost.

/// What one step of a ray came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The ray goes on.
    Moving,
    /// The surface is met.
    Hit,
    /// The ray is past its end and has met nothing.
    Out,
    /// The tracer's own limit of steps is reached: the ray has not converged.
    Spent,
}

/// What a pixel is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum State {
    /// The ray left the bounds.
    Sky = 0,
    /// The ray met the surface.
    Hit = 1,
    /// A limit was reached before either; never counted as a hit.
    Unconverged = 2,
}

impl State {
    /// The state of a number that an executor wrote, if it is one.
    pub fn from_code(code: u32) -> Option<Self> {
        match code {
            0 => Some(Self::Sky),
            1 => Some(Self::Hit),
            2 => Some(Self::Unconverged),
            _ => None,
        }
    }
}

/// Work of one cell or pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Calls of the scene's estimate.
    pub evaluations: u32,
    /// Fold iterations inside them.
    pub iterations: u32,
}
