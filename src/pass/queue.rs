//! What still moves, packed for the next dispatch of a pass.
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
}

/// Offset of the count in bytes; the cells follow it.
pub const COUNT_AT: u64 = std::mem::size_of::<Turn>() as u64;

/// The WGSL module of the queue.
pub fn module() -> Module {
    wgsl!("pass/queue.wgsl")
}
