//! How far a render has come.

/// How far a render has come.
#[derive(Clone, Debug, Default)]
pub struct Progress {
    /// The current pass, or the one that has just ended.
    pub pass: String,
    /// The share of the whole frame that is done, 0 to 1; while a cone map is made before the
    /// other passes, the share of that map.
    pub done: f64,
}

/// A function that is called after each part of a render. It returns `false` to cancel the
/// render.
pub type Watch<'a> = &'a mut dyn FnMut(&Progress) -> bool;
