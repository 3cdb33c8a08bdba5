//! How far a render has come.

/// How far a render has come.
#[derive(Clone, Debug, Default)]
pub struct Progress {
    /// The current pass, or the one that has just ended.
    pub pass: String,
    /// The share of the whole frame that is done, 0 to 1; while heights or a cone map are made
    /// before the other passes, the share of these.
    pub done: f64,
}

/// A function that is called after each part of a render. It returns `false` to cancel the
/// render.
pub type Watch<'a> = &'a mut dyn FnMut(&Progress) -> bool;
