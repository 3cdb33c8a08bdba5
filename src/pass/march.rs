//! One level of the pyramid: cones from the parents' fronts (METHOD 1 and 2).
//! Twin: `wgsl/pass/march.wgsl`.

use bytemuck::{Pod, Zeroable};

use crate::frame::Work;
use crate::scene::Solid;
use crate::shader::Module;
use crate::view::Beam;
use crate::wgsl;

/// A level as WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LevelUniform {
    /// Pixels per cell along each axis.
    pub divisor: u32,
    /// Steps that one dispatch may do.
    pub chunk: u32,
    /// Steps that all dispatches of the level may do.
    pub limit: u32,
    /// Steps done by earlier dispatches.
    pub done: u32,
    /// First cell of the block.
    pub origin: [u32; 2],
    /// Cells in the block.
    pub cells: [u32; 2],
    /// Cells per row of the parent level; 0 for the first.
    pub parent_width: u32,
    /// Factor on the chord.
    pub fudge: f32,
    /// Unused.
    pub pad0: u32,
    /// Unused.
    pub pad1: u32,
}

/// The WGSL module of the pass.
pub fn module() -> Module {
    wgsl!("pass/march.wgsl")
}

/// How a cell ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The front is past everything: no child has anything to do.
    Sky,
    /// No more can be proven.
    Stopped,
    /// Out of steps; the front is proven all the same.
    Limited,
}

/// Advances one cone from a proven front, by at most `limit` steps.
pub fn march<S: Solid>(
    solid: &S,
    cone: &Beam,
    front: f64,
    limit: u32,
    work: &mut Work,
) -> (f64, Ended) {
    let mut f = front;
    for _ in 0..limit {
        let next = solid.advance(cone, f, work);
        if next > solid.bounds_far() {
            return (next, Ended::Sky);
        }
        if next <= f {
            return (f, Ended::Stopped);
        }
        f = next;
    }
    (f, Ended::Limited)
}
