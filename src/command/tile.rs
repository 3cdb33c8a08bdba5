//! Parts of a picture: what `--tile` renders, and what the file of a part tells.

use std::io::Cursor;
use std::path::Path;

use anyhow::Result;
use sha2::{Digest, Sha256};

use crate::command::executor::Executor;
use crate::command::failure::usage;
use crate::picture::frame::Frame;
use crate::picture::write_exr_part;
use crate::plan::pyramid::Block;
use crate::plan::{Plan, WINDOW_STEP};
use crate::preset;
use crate::scene::Assets;

/// A part of a grid over the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tile {
    /// Column and row, from 0.
    at: [u32; 2],
    /// Columns and rows.
    grid: [u32; 2],
}

impl Tile {
    /// Reads `C,R/CxR`.
    ///
    /// # Errors
    /// The text has another form, or the grid has no such part.
    pub fn read(text: &str) -> Result<Self, String> {
        let pair = |text: &str, by: char| -> Option<[u32; 2]> {
            let (a, b) = text.split_once(by)?;
            Some([a.parse().ok()?, b.parse().ok()?])
        };
        let read = |(at, grid): (&str, &str)| Some((pair(at, ',')?, pair(grid, 'x')?));
        let read = text.split_once('/').and_then(read);
        let inside = read.filter(|(at, grid)| at[0] < grid[0] && at[1] < grid[1]);
        inside.map(|(at, grid)| Self { at, grid }).ok_or_else(|| {
            "must be a column and a row, from 0, of a grid, like 0,0/4x3 for the first part and 3,2/4x3 for the last".into()
        })
    }

    /// The pixels of the part.
    ///
    /// # Errors
    /// The grid is too fine for the picture.
    pub fn window(self, size: [u32; 2]) -> Result<Block> {
        let steps = size.map(|n| n.div_ceil(WINDOW_STEP));
        if [0, 1].iter().any(|axis| self.grid[*axis] > steps[*axis]) {
            let ([w, h], [columns, rows]) = (size, steps);
            return Err(usage(format!(
                "--tile: the parts of a picture of {w}x{h} begin at multiples of {WINDOW_STEP} pixels, so the finest grid is {columns}x{rows}"
            )));
        }
        let border = |axis: usize, i: u32| {
            let step = u64::from(i) * u64::from(steps[axis]) / u64::from(self.grid[axis]);
            (step as u32 * WINDOW_STEP).min(size[axis])
        };
        let origin = [0, 1].map(|axis| border(axis, self.at[axis]));
        let end = [0, 1].map(|axis| border(axis, self.at[axis] + 1));
        let size = [0, 1].map(|axis| end[axis] - origin[axis]);
        Ok(Block { origin, size })
    }
}

/// The version, and the sources that this program was built of.
pub const BUILD: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    " (build ",
    env!("CONEMARCH_BUILD"),
    ")"
);

/// A hash of what decides the bits of a picture beside the device: the program, the plan, the files
/// that it names, and more.
pub fn fingerprint(plan: &Plan, assets: &Assets, more: &str) -> String {
    let mut hash = Sha256::new();
    for part in [BUILD, more, &preset::write(plan)] {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part);
    }
    hash.update(assets.contents(plan));
    // The cones of a file decide the steps of a ray.
    for path in plan.scene.map_files() {
        hash.update(std::fs::read(path).unwrap_or_default());
    }
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

/// What the file of a part tells of its origin, as its comments.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    /// What rendered it.
    pub device: String,
    /// The [`fingerprint`] of the picture.
    pub picture: String,
}

impl Note {
    /// Reads the comments of a file.
    pub fn read(text: &str) -> Option<Self> {
        let (device, picture) = text.strip_prefix("device: ")?.split_once("\npicture: ")?;
        let [device, picture] = [device, picture].map(String::from);
        Some(Self { device, picture })
    }

    fn write(&self) -> String {
        format!("device: {}\npicture: {}", self.device, self.picture)
    }
}

/// A part as the bytes of the file `output`.
///
/// # Errors
/// The encoder failed.
pub fn encode(
    (plan, assets): (&Plan, &Assets),
    frame: &Frame,
    executor: &Executor,
    output: &Path,
) -> Result<Vec<u8>> {
    let note = Note {
        device: executor.identity(),
        picture: fingerprint(plan, assets, ""),
    };
    let mut content = Vec::new();
    let to = &mut Cursor::new(&mut content);
    let text = preset::write_beside(plan, output);
    write_exr_part(to, frame, plan, &text, &note.write())?;
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_of_a_grid_cover_a_picture_once() {
        for (size, [columns, rows]) in [
            ([1000, 333], [4, 3]),
            ([64, 1], [1, 1]),
            ([640, 129], [10, 3]),
        ] {
            let mut pixels = 0;
            let mut end = [0; 2];
            for (c, r) in (0..rows).flat_map(|r| (0..columns).map(move |c| (c, r))) {
                let tile = Tile::read(&format!("{c},{r}/{columns}x{rows}")).expect("a part");
                let block = tile.window(size).expect("coarse enough");
                assert!(
                    block.origin.iter().all(|o| o % WINDOW_STEP == 0),
                    "{block:?}"
                );
                assert!(block.area() > 0);
                if c > 0 {
                    assert_eq!(block.origin[0], end[0], "{block:?}");
                }
                end = [0, 1].map(|axis| block.origin[axis] + block.size[axis]);
                pixels += block.area();
            }
            assert_eq!((end, pixels), (size, size[0] as usize * size[1] as usize));
        }
        for wrong in [
            "", "1", "1,1", "4,0/4x3", "0,3/4x3", "0,0/0x0", "-1,0/2x2", "0,0/2",
        ] {
            assert!(Tile::read(wrong).is_err(), "{wrong}");
        }
        let fine = Tile::read("0,0/5x1").expect("a part");
        assert!(fine.window([256, 64]).is_err() && fine.window([257, 64]).is_ok());
    }
}
