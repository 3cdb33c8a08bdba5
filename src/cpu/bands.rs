//! A grid of cells, spread over all cores.

use rayon::prelude::*;

use crate::pass::prepare::FrameError;
use crate::pass::progress::{Progress, Watch};

/// Cells between two calls of the watch: some tens of milliseconds on two cores.
pub(super) const BAND_CELLS: usize = 1 << 15;

/// The least and the most cells that a thread takes at once. The last rays of a part leave lanes
/// idle, and the last parts leave threads idle.
const PART_CELLS: [usize; 2] = [64, 512];

/// Runs a pass in bands of rows and calls the watch after each.
pub(super) struct Bands<'a> {
    /// Its name.
    pub pass: String,
    /// The share of the render that was done before it.
    pub before: f64,
    /// Its own share.
    pub share: f64,
    /// Told after each band.
    pub watch: Watch<'a>,
}

impl Bands<'_> {
    /// Calls `some` for all cells of a grid in parts, which are spread over threads, and `keep` for
    /// the results in order.
    pub fn over<T: Send>(
        &mut self,
        cells: [u32; 2],
        some: impl Fn(Vec<[u32; 2]>) -> Vec<T> + Sync,
        mut keep: impl FnMut(usize, T),
    ) -> Result<(), FrameError> {
        let [width, height] = cells.map(|n| n as usize);
        // At least a few rows for every thread.
        let threads = rayon::current_num_threads();
        let least = 4 * threads;
        let rows = (BAND_CELLS / width.max(1)).max(least);
        let [fewest, most] = PART_CELLS;
        let part = (width * height / (8 * threads)).clamp(fewest, most);
        for first in (0..height).step_by(rows) {
            let last = (first + rows).min(height);
            let parts = (first * width..last * width).into_par_iter().step_by(part);
            let made: Vec<T> = parts
                .flat_map_iter(|start| {
                    let end = (start + part).min(last * width);
                    let cell = |i| [(i % width) as u32, (i / width) as u32];
                    some((start..end).map(cell).collect())
                })
                .collect();
            for (i, value) in made.into_iter().enumerate() {
                keep(first * width + i, value);
            }
            let mut progress = Progress::default();
            progress.pass.clone_from(&self.pass);
            progress.done = self.before + self.share * last as f64 / height as f64;
            if !(self.watch)(&progress) {
                return Err(FrameError::Cancelled);
            }
        }
        Ok(())
    }
}
