//! How far a render has come.

/// How far a render has come.
#[derive(Clone, Debug, Default)]
pub struct Progress {
    /// The current pass, or the one that has just ended.
    pub pass: String,
    /// The share of the whole frame that is done, 0 to 1, or of the step.
    pub done: f64,
    /// Whether `done` is the share of one step, after which others follow that may take longer:
    /// heights and cone maps come before the other passes.
    pub is_step: bool,
}

/// A function that is called after each part of a render. It returns `false` to cancel the
/// render.
pub type Watch<'a> = &'a mut dyn FnMut(&Progress) -> bool;
