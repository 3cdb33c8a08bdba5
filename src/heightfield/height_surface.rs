//! A height surface: heights, the patches between them, their tiles, and the pyramid of maxima
//! over the cells. All tracers read it. Shaders read it by
//! `wgsl/heightfield/heights.wgsl`.
//!
//! The surface is the top of a solid block, which fills `0 <= z <= surface` over the domain. The
//! domain has `cells * tiles` cells and starts at the origin. Outside of it there is nothing, so
//! that its four sides are walls and its underside is a floor.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable, cast_slice};
use glam::DVec2;
use thiserror::Error;

use crate::base::array::SceneArray;
use crate::base::shader::Module;
use crate::heightfield::max_mip::MipLevel;
use crate::heightfield::{ConeMap, Heights, MaxMip, Patches, heights::bilinear};
use crate::wgsl;

/// Most cells along an axis of the domain. Up to there f32 resolves 1/256 of a texel.
pub const MOST_CELLS: u32 = 65_536;

/// Most levels of a pyramid, rounded up: 8192 cells halve 13 times.
pub const MOST_LEVELS: usize = 16;

/// Why heights cannot be tiled.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum HeightSurfaceError {
    /// No tiles, or too many cells.
    #[error(
        "{tiles} tiles of {cells} cells along axis {axis} are out of range; there must be at \
         least one tile and at most {MOST_CELLS} cells"
    )]
    Tiles {
        /// 0 for x, 1 for y.
        axis: usize,
        /// Cells of one tile.
        cells: u32,
        /// Tiles asked for.
        tiles: u32,
    },
    /// Several tiles along an axis that does not wrap: the last cell does not join the first,
    /// and the cones do not know the neighbour.
    #[error(
        "the map is repeated along {}, but it does not wrap there; set wrap = \"xy\"",
        ["x", "y"][*.0]
    )]
    Unwrapped(usize),
}

/// Most numbers of a pyramid with its windows: WebGPU promises buffers of 128 MiB.
const MOST_NUMBERS: usize = 128 << 20 >> 2;

/// The uniform that all tracers read.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct HeightmapUniform {
    /// Samples along each axis.
    pub samples: [i32; 2],
    /// Cells of one tile along each axis.
    pub cells: [i32; 2],
    /// Cells of all tiles along each axis.
    pub domain: [i32; 2],
    /// 1 for an axis that wraps.
    pub wrap: [u32; 2],
    /// Places of the cone map along each axis.
    pub places: [i32; 2],
    /// Offset of the walk's cones, in texels.
    pub offset: f32,
    /// Factor on cone steps.
    pub scale: f32,
    /// Levels of the pyramid of maxima.
    pub levels: u32,
    /// See [`TracerParameters`].
    pub steps: u32,
    /// See [`TracerParameters`].
    pub lod: f32,
    /// Rounds of refinement.
    pub rounds: u32,
    /// The finest level that has windows.
    pub finest: u32,
    /// The next field is aligned to 16 bytes.
    pub pad: [u32; 3],
    /// Where each level of the pyramid starts in its buffer.
    pub starts: [u32; MOST_LEVELS],
    /// Where the windows of each level start there.
    pub windows: [u32; MOST_LEVELS],
}

/// A tracer's numbers in the uniform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracerParameters {
    /// Factor on the steps that cones give.
    pub scale: f64,
    /// Steps that the tracer counts itself; 0 for no such limit.
    pub steps: u32,
    /// The distance along the ray at which it has half as many, or at which a texel is as wide
    /// as a pixel; 0 for never.
    pub lod: f64,
    /// Rounds of refinement.
    pub rounds: u32,
}

impl Default for TracerParameters {
    fn default() -> Self {
        Self {
            scale: 1.0,
            steps: 0,
            lod: 0.0,
            rounds: 0,
        }
    }
}

/// A node of the pyramid of maxima, over cells of the domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Its level; 0 for a cell.
    pub level: u32,
    /// Column and row in its level.
    pub place: [u32; 2],
    /// The highest point under it.
    pub maximum: f64,
    /// Its first cell along each axis.
    pub low: [i32; 2],
    /// The cell after its last one.
    pub high: [i32; 2],
}

/// A solid block with heights on top.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightSurface {
    heights: Heights,
    patches: Patches,
    cells: [u32; 2],
    domain: [i32; 2],
    maxima: MaxMip,
    windows: Vec<MipLevel>,
    finest: u32,
}

/// The finest level that has windows, so that these fit into a buffer with the maxima.
fn finest(maxima: &MaxMip) -> u32 {
    let windows = |level: &MipLevel| level.size.map(|n| n as usize + 1).iter().product::<usize>();
    let nodes = |level: &MipLevel| level.max.len();
    let mut all: usize = maxima.levels.iter().map(nodes).sum();
    all += maxima.levels.iter().map(windows).sum::<usize>();
    let mut finest = 0;
    while all > MOST_NUMBERS && finest < maxima.coarsest() {
        all -= windows(&maxima.levels[finest as usize]);
        finest += 1;
    }
    finest
}

/// Checks that a map of so many cells can be tiled.
///
/// # Errors
/// No tiles, too many, or several along an axis that does not wrap.
pub fn check_tiles(
    cells: [u32; 2],
    wrap: [bool; 2],
    tiles: [u32; 2],
) -> Result<(), HeightSurfaceError> {
    for (axis, (cells, tiles)) in cells.into_iter().zip(tiles).enumerate() {
        if tiles > 1 && !wrap[axis] {
            return Err(HeightSurfaceError::Unwrapped(axis));
        }
        if tiles == 0 || u64::from(cells) * u64::from(tiles) > u64::from(MOST_CELLS) {
            return Err(HeightSurfaceError::Tiles { axis, cells, tiles });
        }
    }
    Ok(())
}

impl HeightSurface {
    /// A surface of `tiles` repetitions along each axis.
    ///
    /// # Errors
    /// No tiles, too many, or several along an axis that does not wrap.
    pub fn new(
        heights: Heights,
        patches: Patches,
        tiles: [u32; 2],
    ) -> Result<Self, HeightSurfaceError> {
        let cells = heights.cells(patches);
        check_tiles(cells, heights.wrap(), tiles)?;
        let maxima = MaxMip::new(cells, heights.apexes(patches));
        let finest = finest(&maxima);
        Ok(Self {
            domain: [0, 1].map(|a| (cells[a] * tiles[a]) as i32),
            windows: maxima.windows(tiles.map(|n| n > 1), finest),
            finest,
            maxima,
            heights,
            patches,
            cells,
        })
    }

    /// The heights.
    pub fn heights(&self) -> &Heights {
        &self.heights
    }

    /// What lies between the samples.
    pub fn patches(&self) -> Patches {
        self.patches
    }

    /// Cells of one tile along each axis.
    pub fn cells(&self) -> [u32; 2] {
        self.cells
    }

    /// Cells of all tiles along each axis: the size of the block in texels.
    pub fn domain(&self) -> [i32; 2] {
        self.domain
    }

    /// Apexes of the cells of one tile, and their maxima.
    pub fn maxima(&self) -> &MaxMip {
        &self.maxima
    }

    /// The finest level that has windows.
    pub fn finest(&self) -> u32 {
        self.finest
    }

    /// The windows of a level: see [`MaxMip::windows`].
    pub fn windows(&self, level: u32) -> &MipLevel {
        &self.windows[level as usize]
    }

    /// The cell of the first tile that corresponds to a cell of the domain.
    pub fn tile_cell(&self, cell: [i32; 2]) -> [u32; 2] {
        [0, 1].map(|a| {
            let (i, n) = (cell[a].max(0) as u32, self.cells[a]);
            // Most maps have one tile, and a division takes long.
            if i < n { i } else { i % n }
        })
    }

    /// The highest point of a cell of the domain.
    pub fn apex(&self, cell: [i32; 2]) -> f64 {
        let [x, y] = self.tile_cell(cell);
        f64::from(self.maxima.levels[0].at(x, y))
    }

    /// The node of a level over a cell of the domain. Each tile begins nodes of its own.
    pub fn node(&self, cell: [i32; 2], level: u32) -> Node {
        let local = self.tile_cell(cell);
        let place = local.map(|i| i >> level);
        let maximum = self.maxima.levels[level as usize].at(place[0], place[1]);
        let tile = [0, 1].map(|a| cell[a] - local[a] as i32);
        Node {
            level,
            place,
            maximum: f64::from(maximum),
            low: [0, 1].map(|a| tile[a] + (place[a] << level) as i32),
            high: [0, 1].map(|a| {
                let end = ((place[a] + 1) << level).min(self.cells[a]);
                tile[a] + end as i32
            }),
        }
    }

    /// Corner heights of a cell of the domain: (0, 0), (1, 0), (0, 1), (1, 1).
    pub fn corners(&self, cell: [i32; 2]) -> [f64; 4] {
        let [x, y] = self.tile_cell(cell).map(i64::from);
        self.heights.corners(self.patches, x, y)
    }

    /// Height of the surface in a cell of the domain at (u, v) in 0..=1.
    pub fn height(&self, cell: [i32; 2], u: f64, v: f64) -> f64 {
        bilinear(self.corners(cell), u, v)
    }

    /// The slope in a cell of the domain at (u, v) in 0..=1, in heights per texel: bilinear between
    /// the slopes of the four samples.
    pub fn smooth_slope(&self, cell: [i32; 2], [u, v]: [f64; 2]) -> DVec2 {
        let [x, y] = self.tile_cell(cell).map(i64::from);
        let corners = [[0, 0], [1, 0], [0, 1], [1, 1]];
        let slopes = corners.map(|[i, j]| self.heights.slope(x + i, y + j));
        DVec2::new(
            bilinear(slopes.map(|s| s.x), u, v),
            bilinear(slopes.map(|s| s.y), u, v),
        )
    }

    /// The number of a cell within its tile, row by row.
    pub fn number(&self, cell: [i32; 2]) -> u32 {
        let [x, y] = self.tile_cell(cell);
        y * self.cells[0] + x
    }

    /// The WGSL modules of the surface, and those that all tracers share.
    pub fn modules(&self) -> Vec<Module> {
        let boxes = f64::from(u8::from(self.patches == Patches::Boxes));
        vec![
            wgsl!("heightfield/heights.wgsl", "HEIGHTMAP_BOXES" = boxes),
            wgsl!("heightfield/max_mip.wgsl"),
            wgsl!("heightfield/patch.wgsl"),
            wgsl!("heightfield/tracer/grid.wgsl"),
        ]
    }

    /// The levels of the pyramid, and then their windows.
    fn levels(&self) -> impl Iterator<Item = &MipLevel> {
        self.maxima.levels.iter().chain(&self.windows)
    }

    /// The values of the WGSL struct, for a tracer.
    pub fn uniform(&self, map: &ConeMap, tracer: TracerParameters) -> HeightmapUniform {
        let (mut starts, mut windows) = ([0; MOST_LEVELS], [0; MOST_LEVELS]);
        let count = self.maxima.levels.len();
        let all = starts[..count].iter_mut().chain(&mut windows[..count]);
        let mut end = 0;
        for (start, level) in all.zip(self.levels()) {
            *start = end;
            end += level.max.len() as u32;
        }
        HeightmapUniform {
            samples: self.heights.size().map(|n| n as i32),
            cells: self.cells.map(|n| n as i32),
            domain: self.domain,
            wrap: self.heights.wrap().map(u32::from),
            places: map.size.map(|n| n as i32),
            offset: map.offset as f32,
            scale: tracer.scale as f32,
            levels: self.maxima.levels.len() as u32,
            steps: tracer.steps,
            lod: tracer.lod as f32,
            rounds: tracer.rounds,
            finest: self.finest,
            pad: [0; 3],
            starts,
            windows,
        }
    }

    /// The heights, and the pyramid of maxima with its windows, as the shaders read them.
    pub fn arrays(self: &Arc<Self>) -> Vec<SceneArray> {
        let maxima = |surface: &Self| {
            let all = surface.levels().flat_map(|level| &level.max);
            cast_slice(&all.copied().collect::<Vec<f32>>()).to_vec()
        };
        vec![
            SceneArray::new("heights", self, |surface| {
                cast_slice(surface.heights.data()).to_vec()
            }),
            SceneArray::new("maxima", self, maxima),
        ]
    }
}
