//! What the kernels are told, laid out as they read it. Twins:
//! `wgsl/heightfield/conemap/generate/{shared,pyramid,mips,nine,slopes}.wgsl`.

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
    /// 1 if that keeps what another search has found.
    pub keeps: u32,
    /// Quadrant or side, 0 to 3.
    pub aim: u32,
    /// Steps along a ray.
    pub steps: u32,
    /// Room that a walk's cones leave, in texels.
    pub offset: f32,
    /// The highest of all that bounds cones.
    pub top: f32,
    /// Nothing.
    pub pad0: u32,
    /// Nothing.
    pub pad1: u32,
    /// Where each level's tiles begin.
    pub at: [[u32; 4]; 4],
}

/// Where a place stands: what bounds its cone, and how the search goes on.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct Search {
    /// Squared distance of what bounds the cone.
    pub squared: u32,
    /// Its height, below 0 for nothing.
    pub top: f32,
    /// Whether it is nearly a tie, or the step at which a ray came out.
    pub note: u32,
    /// How far the search has come; [`Search::DONE`].
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

impl Search {
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
    /// Nothing.
    pub pad: u32,
}

/// Parameters of one level of a cone map's pyramid.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct MipUniform {
    /// Nodes along each axis of the level below.
    pub below: [u32; 2],
    /// Nodes along each axis.
    pub size: [u32; 2],
    /// Where the level below begins.
    pub below_at: u32,
    /// Where this level begins.
    pub at: u32,
    /// Nothing.
    pub pad0: u32,
    /// Nothing.
    pub pad1: u32,
}

/// Parameters of a band of the 3 x 3 minimum.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct NineUniform {
    /// Places of a row.
    pub width: u32,
    /// Rows of the band.
    pub rows: u32,
    /// 1 if rows come round to their start.
    pub wrap: u32,
    /// Ratios to a place.
    pub channels: u32,
}

/// Parameters of a band of slopes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct SlopesUniform {
    /// Samples along each axis.
    pub size: [u32; 2],
    /// 1 for each axis that wraps.
    pub wrap: [u32; 2],
    /// First row of the band.
    pub first: u32,
    /// Rows of the band.
    pub rows: u32,
    /// Nothing.
    pub pad0: u32,
    /// Nothing.
    pub pad1: u32,
}
