//! Which cells a dispatch visits: all, the listed children, or what still moves.
//! Twin: `wgsl/pass/queue.wgsl`. The CPU executor runs every cell to its end at once,
//! so there are no functions here.

use bytemuck::{Pod, Zeroable};

use crate::base::shader::Module;
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
    /// What is visited: [`Turn::ALL`], [`Turn::PARENTS`] or [`Turn::CELLS`].
    pub visits: u32,
}

/// Largest number of workgroups along an axis.
const MOST_GROUPS: u32 = 65_535;

impl Turn {
    /// Every cell of the block is visited.
    pub const ALL: u32 = 0;
    /// The children of listed parents are.
    pub const PARENTS: u32 = 1;
    /// Listed cells are.
    pub const CELLS: u32 = 2;

    /// Turns to the children of so many listed parents, four of each: the workgroups to
    /// dispatch, none for none.
    pub fn to_children_of(&mut self, parents: u32) -> [u32; 2] {
        self.visits = Self::PARENTS;
        self.spread(parents.div_ceil(16))
    }

    /// Turns to a list of so many cells.
    pub fn to_cells(&mut self, cells: u32) -> [u32; 2] {
        self.visits = Self::CELLS;
        self.spread(cells.div_ceil(64))
    }

    fn spread(&mut self, groups: u32) -> [u32; 2] {
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
