//! Which cells a dispatch visits: all, the listed children, or what still moves.
//! Twin: `wgsl/pass/queue.wgsl`. The CPU executor runs every cell to its end at once,
//! so there are no functions here.

use bytemuck::{Pod, Zeroable};

use crate::shader::Module;
use crate::wgsl;

/// What leads a queue: the numbers of the dispatch that reads it. The count of cells
/// and the cells follow; only the device writes those.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Turn {
    /// Steps that the dispatch may do.
    pub chunk: u32,
    /// Steps that all before it did.
    pub done: u32,
    /// Steps that all may do.
    pub limit: u32,
    /// Workgroups per row of the dispatch.
    pub row: u32,
    /// Cells per row of the parent level in the block; 0 where there is none.
    pub parent_width: u32,
    /// 1 to visit the listed cells, 0 to visit all.
    pub listed: u32,
}

/// Largest number of workgroups along an axis.
const MOST_GROUPS: u32 = 65_535;

impl Turn {
    /// Turns to a list of so many cells: the workgroups to dispatch, none for none.
    pub fn spread(&mut self, cells: u32) -> [u32; 2] {
        let groups = cells.div_ceil(64);
        self.listed = 1;
        self.row = groups.clamp(1, MOST_GROUPS);
        [groups.min(MOST_GROUPS), groups.div_ceil(self.row)]
    }
}

/// Offset of the count in bytes; the cells follow it.
pub const COUNT_AT: u64 = std::mem::size_of::<Turn>() as u64;

/// The WGSL module of the queue.
pub fn module() -> Module {
    wgsl!("pass/queue.wgsl")
}
