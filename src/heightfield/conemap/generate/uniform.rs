//! The parameters and results of the kernels, laid out as in WGSL. Twins:
//! `wgsl/heightfield/conemap/generate/{task,pyramid,min3x3}.wgsl`.

use bytemuck::{Pod, Zeroable};

/// Parameters of one dispatch over a band of places.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct GenerateUniform {
    /// Places along each axis.
    pub size: [u32; 2],
    /// 1 for each axis that wraps.
    pub wrap: [u32; 2],
    /// First row of the band.
    pub first: u32,
    /// Rows of the band.
    pub rows: u32,
    /// Rounds that a place may take.
    pub rounds: u32,
    /// Levels of tiles.
    pub levels: u32,
    /// 1 for the first dispatch of a search.
    pub begins: u32,
    /// 1 if the search keeps what another one has found.
    pub keeps: u32,
    /// Number of the quadrant or side, 0 to 3.
    pub sector: u32,
    /// Steps along a ray.
    pub steps: u32,
    /// Room that a walk's cones leave, in texels.
    pub offset: f32,
    /// The highest of all that bounds cones.
    pub top: f32,
    /// Padding.
    pub pad0: u32,
    /// Padding.
    pub pad1: u32,
    /// Where each level's tiles begin.
    pub at: [[u32; 4]; 4],
}

/// The search from one place: what bounds its cone, and where the search goes on.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct SearchState {
    /// Squared distance of what bounds the cone.
    pub squared: u32,
    /// Its height, below 0 for nothing.
    pub top: f32,
    /// 1 for nearly a tie, or the step at which a ray came out.
    pub note: u32,
    /// How far the search has come; [`SearchState::DONE`].
    pub stage: u32,
    /// Where it goes on.
    pub node_x: u32,
    /// Where it goes on.
    pub node_y: u32,
    /// What is still to be visited.
    pub pending_low: u32,
    /// What is still to be visited.
    pub pending_high: u32,
}

impl SearchState {
    /// The stage of a search that has ended.
    pub const DONE: u32 = u32::MAX;
}

/// Parameters of one level of a pyramid.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PyramidUniform {
    /// Values along each axis of the level below.
    pub below: [u32; 2],
    /// Tiles along each axis.
    pub size: [u32; 2],
    /// Where the tiles of the level below begin.
    pub below_at: u32,
    /// Where the tiles of this level begin.
    pub at: u32,
    /// 1 if the level below is the grid itself.
    pub first: u32,
    /// Padding.
    pub pad: u32,
}

/// Parameters of a band of the 3 x 3 minimum.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Min3x3Uniform {
    /// Places of a row.
    pub width: u32,
    /// Rows of the band.
    pub rows: u32,
    /// 1 if the horizontal axis wraps.
    pub wrap: u32,
    /// Ratios per place.
    pub channels: u32,
}
