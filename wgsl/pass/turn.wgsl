// The stages of a frame and the dispatch that is under way.
//
// A stage is a pass over a block, or one of the short stages between passes (`judge.wgsl`,
// `sketch.wgsl`, `develop.wgsl`, `census.wgsl`). It runs in rounds. The first visits all cells, or the
// children of listed parents. Each later one visits the cells that still move. A round is cut into
// dispatches. Before each dispatch, `arrange.wgsl` decides on the device what it visits, so the
// host never waits for a count.

/// The numbers of a stage. The host writes them.
struct Stage {
    /// Position among all stages of the frame.
    number: u32,
    /// The step limit of a cell.
    limit: u32,
    /// The step limits of the first and of the largest dispatch.
    chunk: u32,
    most: u32,
    /// The largest product of the workgroups and the step limit of a dispatch.
    slice: u32,
    /// Workgroups that visit every cell; 0 if the stage is left out.
    tiles: u32,
    /// Cells per row of the parent level in the block; 0 if there is no parent level.
    parent_width: u32,
    /// Pixels per cell, along each axis.
    divisor: u32,
    /// First cell of the block, and cells in the block.
    origin: vec2<u32>,
    cells: vec2<u32>,
    /// Factor on the cone's chord.
    fudge: f32,
    /// Position among the stages of the block.
    index: u32,
    /// Where its two queues start in the cells.
    queues: vec2<u32>,
    /// Where its parents are listed, and where it lists parents itself.
    listed: u32,
    parents: u32,
    /// Where the parents' fronts start in `cells`, and the values of this stage.
    parent_front: u32,
    front: u32,
    state: u32,
    tally: u32,
    mark: u32,
    /// Where the light of the pixels starts, and after it the normals if they are kept, four words
    /// to a pixel.
    light: u32,
    /// The number of the block, which is part of every state.
    generation: u32,
    /// Samples of the pixels whose light is summed already.
    before: u32,
    /// Where the rays of this sample go, in pixels from the upper left corner of their pixels.
    place: vec2<f32>,
    /// Where on the lens they start, from 0 to 1 along both axes; below 0 for its centre.
    lens: vec2<f32>,
    /// Factors on the light of the sample, and on the sum of all.
    weight: f32,
    scale: f32,
    /// Where the halves start that `judge.wgsl` keeps, four words to a pixel.
    halves: u32,
    /// A tile ends if its squared error is below this, in levels; below 0 if it may not end yet.
    until: f32,
}

/// What the next dispatch does. Only `arrange` writes it.
struct Turn {
    stage: Stage,
    /// The number of the stage that is under way, and 1 once it has begun.
    number: u32,
    begun: u32,
    /// The step limit of the dispatch, and the steps done in the rounds before.
    chunk: u32,
    done: u32,
    /// The first workgroup of the dispatch in its round, and how many there are.
    first: u32,
    groups: u32,
    /// What is visited: VISIT_ALL, VISIT_PARENTS or VISIT_CELLS; how many of them are listed,
    /// and where the list starts.
    visits: u32,
    count: u32,
    read: u32,
    /// Where the queue starts that is filled.
    filled: u32,
    /// Dispatches of the stage that is under way.
    dispatches: u32,
    pad: u32,
}

/// All values of the cells of the block, and lists of cells: one buffer, as a stage may have only
/// eight. First there are the values, one plane after the other. Fronts are floats. A state has two
/// bits. The others are the number of the block, so values of an earlier block need no reset.
struct Cells {
    /// Cells that still move.
    moving: atomic<u32>,
    /// Cells whose children the next stage visits.
    parents: atomic<u32>,
    /// Cells that were left out.
    wrong: atomic<u32>,
    /// Cells of the finest cone level whose pixels have rays.
    traced: u32,
    /// Dispatches of each stage of the block.
    dispatches: array<u32, 20>,
    words: array<u32>,
}

/// Workgroups of a dispatch along the second axis; see `queue_group`.
const PARTS = 16u;

/// Every cell of the block.
const VISIT_ALL = 0u;
/// The children of the listed cells of the parent level.
const VISIT_PARENTS = 1u;
/// The listed cells.
const VISIT_CELLS = 2u;

@group(2) @binding(1) var<storage, read_write> cells: Cells;
