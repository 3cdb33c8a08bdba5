//! The cells that a dispatch visits: all, the children of listed parents, or those that have
//! not ended.
//!
//! Twin: `wgsl/pass/queue.wgsl`. Its functions have no counterpart here, as the CPU executor
//! runs every cell to its end at once.

use bytemuck::{Pod, Zeroable};

/// The head of a queue: the numbers of the dispatch that reads it. The count of the cells and
/// the cells follow it; only the device writes those.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Turn {
    /// The step limit of this dispatch.
    pub chunk: u32,
    /// Steps done by the dispatches before.
    pub done: u32,
    /// The step limit of the pass.
    pub limit: u32,
    /// Workgroups per row of the dispatch.
    pub row: u32,
    /// Cells per row of the parent level in the block; 0 if there is no parent level.
    pub parent_width: u32,
    /// The cells to visit: [`Turn::ALL`], [`Turn::PARENTS`] or [`Turn::CELLS`].
    pub visits: u32,
}

/// Largest number of workgroups along an axis.
const MOST_GROUPS: u32 = 65_535;

impl Turn {
    /// Every cell of the block.
    pub const ALL: u32 = 0;
    /// The children of the listed parents.
    pub const PARENTS: u32 = 1;
    /// The listed cells.
    pub const CELLS: u32 = 2;

    /// Visits the four children of each of so many listed parents next. Returns the workgroups
    /// to dispatch, which may be none.
    pub fn to_children_of(&mut self, parents: u32) -> [u32; 2] {
        self.visits = Self::PARENTS;
        self.spread(parents.div_ceil(16))
    }

    /// Visits so many listed cells next. Returns the workgroups to dispatch.
    pub fn to_cells(&mut self, cells: u32) -> [u32; 2] {
        self.visits = Self::CELLS;
        self.spread(cells.div_ceil(64))
    }

    fn spread(&mut self, groups: u32) -> [u32; 2] {
        self.row = groups.clamp(1, MOST_GROUPS);
        [groups.min(MOST_GROUPS), groups.div_ceil(self.row)]
    }
}

/// Offset of the count in bytes. The cells follow it.
pub const COUNT_AT: u64 = std::mem::size_of::<Turn>() as u64;
