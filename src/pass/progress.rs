//! Where a render stands, and who is told.

/// Where a render stands.
#[derive(Clone, Debug)]
pub struct Progress {
    /// The pass that is done, or under way.
    pub pass: String,
    /// The share of the whole frame that is done, 0 to 1.
    pub done: f64,
}

/// Is told after each part of a render. It returns `false` to cancel the render.
pub type Watch<'a> = &'a mut dyn FnMut(&Progress) -> bool;
