//! Bloom: the share of the light that a lens spreads over the picture (docs/method.md, 1, Colours and air).
//!
//! The picture is mixed with a blurred one. For that it is reduced to a grid of [`ROWS`] rows over its height, whatever its size, so a small
//! picture spreads its light as a large one does. The grid is halved again and again. Each octave is
//! widened by a tent twice, and their mean is the blurred picture. All weights sum to one, and the
//! border repeats.
//!
//! Rows are added one by one, from the first to the last, so bands of any height give the same bits,
//! and memory does not grow with the height.

use glam::DVec3;

use crate::picture::frame::Frame;
use crate::plan::Plan;

/// Rows of the grid.
const ROWS: usize = 128;
/// Columns of the grid at most.
const MOST_COLUMNS: usize = 32 * ROWS;
/// Octaves.
const OCTAVES: usize = 6;

/// Values on a grid.
#[derive(Clone, Debug)]
struct Grid {
    size: [usize; 2],
    cells: Vec<[f64; 3]>,
}

/// The light of a picture while its rows come.
#[derive(Clone, Debug)]
pub struct SummedLight {
    share: f64,
    size: [u32; 2],
    /// The row that comes next.
    next: u32,
    /// The views of a picture, from left to right. A lens spreads light within its own.
    views: Vec<Grid>,
}

/// The light that is spread over a picture.
#[derive(Clone, Debug)]
pub struct Bloom {
    share: f64,
    size: [u32; 2],
    views: Vec<Grid>,
}

impl SummedLight {
    /// No rows yet of a plan's picture; `None` for a look without bloom.
    pub fn new(plan: &Plan) -> Option<Self> {
        let views = if plan.is_stereo() { 2 } else { 1 };
        let size = [plan.size[0] / views, plan.size[1]];
        let columns = ROWS as f64 * f64::from(size[0]) / f64::from(size[1].max(1));
        let columns = (columns.round() as usize).clamp(1, MOST_COLUMNS);
        (plan.look.bloom > 0.0).then(|| Self {
            share: plan.look.bloom,
            size,
            next: 0,
            views: vec![Grid::new([columns, ROWS]); views as usize],
        })
    }

    /// Adds the next rows of the picture. Light that is no number adds nothing.
    pub fn add(&mut self, light: &[[f32; 3]]) {
        let [width, height] = self.size;
        let count = self.views.len();
        for (i, row) in light.chunks(width.max(1) as usize).enumerate() {
            let grid = &mut self.views[i % count];
            let columns = grid.size[0];
            let rows = shares(self.next, height, ROWS);
            for (x, light) in row.iter().enumerate() {
                let light = light.map(|c| if c.is_finite() { f64::from(c) } else { 0.0 });
                for (i, across) in shares(x as u32, width, columns) {
                    for (j, down) in rows.clone() {
                        let cell = &mut grid.cells[j * columns + i];
                        let to = cell.iter_mut().zip(light);
                        to.for_each(|(sum, c)| *sum += across * down * c);
                    }
                }
            }
            self.next += u32::from(i % count + 1 == count);
        }
    }

    /// The bloom, once all rows are added.
    pub fn blurred(self) -> Bloom {
        Bloom {
            share: self.share,
            size: self.size,
            views: self.views.into_iter().map(Grid::blurred).collect(),
        }
    }
}

impl Bloom {
    /// The bloom of a whole picture; `None` if the frame is a part, or the look has none.
    pub fn of(frame: &Frame, plan: &Plan) -> Option<Self> {
        let mut gathered = SummedLight::new(plan).filter(|_| frame.size == plan.size)?;
        gathered.add(&frame.radiance);
        Some(gathered.blurred())
    }

    /// The light of a pixel of the whole picture, with the share that others spread to it.
    pub fn over(&self, light: DVec3, [x, y]: [u32; 2]) -> DVec3 {
        let spread = DVec3::from(
            self.views[(x / self.size[0]) as usize].at(self.size, [x % self.size[0], y]),
        );
        // What is no number stays so.
        light + self.share * (spread - light)
    }
}

/// The cells that a pixel covers along an axis, each with the share of the cell.
fn shares(at: u32, size: u32, cells: usize) -> impl Iterator<Item = (usize, f64)> + Clone {
    let scale = cells as f64 / f64::from(size);
    let [from, to] = [at, at + 1].map(|x| f64::from(x) * scale);
    let last = (to.ceil() as usize).clamp(1, cells);
    let first = (from as usize).min(last - 1);
    (first..last).map(move |i| (i, (to.min(i as f64 + 1.0) - from.max(i as f64)).max(0.0)))
}

impl Grid {
    fn new(size: [usize; 2]) -> Self {
        Self {
            size,
            cells: vec![[0.0; 3]; size[0] * size[1]],
        }
    }

    /// A grid made cell by cell.
    fn made(size: [usize; 2], of: impl Fn(usize, usize) -> [f64; 3]) -> Self {
        let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        let cells = places.map(|(x, y)| of(x, y)).collect();
        Self { size, cells }
    }

    /// The mean of cells with weights that sum to one. Beyond the border the last cell repeats.
    fn sum<const N: usize>(
        &self,
        [x, y]: [isize; 2],
        across: [f64; N],
        down: [f64; N],
    ) -> [f64; 3] {
        let [w, h] = self.size;
        let mut sum = [0.0; 3];
        for (j, b) in (y..).zip(down) {
            for (i, a) in (x..).zip(across) {
                let i = i.clamp(0, w as isize - 1) as usize;
                let j = j.clamp(0, h as isize - 1) as usize;
                let from = sum.iter_mut().zip(self.cells[j * w + i]);
                from.for_each(|(sum, c)| *sum += a * b * c);
            }
        }
        sum
    }

    /// The mean of all octaves.
    fn blurred(self) -> Self {
        let mut octaves = vec![self.tent().tent()];
        let mut grid = self;
        for _ in 1..OCTAVES {
            grid = grid.halved();
            octaves.push(grid.tent().tent());
        }
        let all = octaves.into_iter().rev();
        let sum = all.reduce(|coarse, fine| fine.plus(&coarse));
        let mut grid = sum.unwrap_or(grid);
        let mean = |cell: &mut [f64; 3]| *cell = cell.map(|c| c / OCTAVES as f64);
        grid.cells.iter_mut().for_each(mean);
        grid
    }

    /// The value in the middle of a pixel of a picture that the grid spans.
    fn at(&self, size: [u32; 2], pixel: [u32; 2]) -> [f64; 3] {
        let place =
            |i: usize| (f64::from(pixel[i]) + 0.5) * self.size[i] as f64 / f64::from(size[i]) - 0.5;
        self.between([place(0), place(1)])
    }

    fn tent(&self) -> Self {
        let tent = [0.25, 0.5, 0.25];
        let of = |x: usize, y: usize| self.sum([x as isize - 1, y as isize - 1], tent, tent);
        Self::made(self.size, of)
    }

    fn halved(&self) -> Self {
        let of =
            |x: usize, y: usize| self.sum([2 * x as isize, 2 * y as isize], [0.5; 2], [0.5; 2]);
        Self::made(self.size.map(|n| n.div_ceil(2)), of)
    }

    /// The value at a place in cells.
    fn between(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        let weights = |t: f64| [1.0 - (t - t.floor()), t - t.floor()];
        let from = [x.floor() as isize, y.floor() as isize];
        self.sum(from, weights(x), weights(y))
    }

    /// The sum with a grid of half the size.
    fn plus(&self, half: &Self) -> Self {
        Self::made(self.size, |x, y| {
            let place = [x, y].map(|n| 0.5 * (n as f64 + 0.5) - 0.5);
            let (a, b) = (self.cells[y * self.size[0] + x], half.between(place));
            [0, 1, 2].map(|c| a[c] + b[c])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::Formula;
    use crate::plan::stereo::Stereo;

    /// A plan of a size whose picture is the spread light alone.
    fn plan(size: [u32; 2]) -> Plan {
        let mut plan = Plan::new(Formula::all().remove(0));
        plan.size = size;
        plan.look.bloom = 1.0;
        plan
    }

    fn bloom(plan: &Plan, rows: usize, of: impl Fn(u32, u32) -> f32) -> Bloom {
        let [w, h] = plan.size;
        let places = (0..h).flat_map(|y| (0..w).map(move |x| (x, y)));
        let light: Vec<[f32; 3]> = places.map(|(x, y)| [of(x, y); 3]).collect();
        let mut gathered = SummedLight::new(plan).expect("a look with bloom");
        let bands = light.chunks(rows * w as usize);
        bands.for_each(|rows| gathered.add(rows));
        gathered.blurred()
    }

    fn spread(bloom: &Bloom, pixel: [u32; 2]) -> f64 {
        bloom.over(DVec3::ZERO, pixel).y
    }

    fn pixels([w, h]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
        (0..h).flat_map(move |y| (0..w).map(move |x| [x, y]))
    }

    #[test]
    fn an_even_picture_stays_and_a_bright_pixel_keeps_its_energy() {
        for size in [[320, 180], [97, 61], [641, 359], [5, 3], [1, 1], [300, 1]] {
            let even = bloom(&plan(size), 7, |_, _| 0.7);
            for pixel in [[0, 0], size.map(|n| n / 2), size.map(|n| n - 1)] {
                assert!(
                    (spread(&even, pixel) - 0.7).abs() < 1e-6,
                    "{size:?} {pixel:?}"
                );
            }
        }
        for size in [[640, 360], [960, 540]] {
            let middle = size.map(|n| n / 2);
            let spot = bloom(
                &plan(size),
                9,
                |x, y| if [x, y] == middle { 1e4 } else { 0.0 },
            );
            let all: f64 = pixels(size).map(|pixel| spread(&spot, pixel)).sum();
            assert!((all / 1e4 - 1.0).abs() < 0.02, "{size:?} {all}");
        }
    }

    #[test]
    fn bands_change_no_bit_and_a_small_picture_is_the_large_one_made_small() {
        let of = |x: u32, y: u32| ((x / 40 * 7 + y / 40 * 5) % 11) as f32;
        let [a, b] = [1, 64].map(|rows| bloom(&plan([640, 360]), rows, of));
        assert!(a.views[0].cells == b.views[0].cells);
        let small = bloom(&plan([320, 180]), 3, |x, y| of(2 * x, 2 * y));
        for [x, y] in pixels([320, 180]) {
            let four = [[0, 0], [1, 0], [0, 1], [1, 1]];
            let four = four.map(|[i, j]| spread(&a, [2 * x + i, 2 * y + j]));
            let mean = four.iter().sum::<f64>() / 4.0;
            // The light is up to 10. Between cells the blurred picture is linear, with a kink in each.
            assert!((mean - spread(&small, [x, y])).abs() < 10.0 / 255.0);
        }
    }

    #[test]
    fn each_eye_spreads_its_own_light() {
        let mut pair = plan([640, 180]);
        pair.camera.stereo = Stereo::Pair;
        let left = bloom(&pair, 5, |x, _| if x < 320 { 2.0 } else { 0.0 });
        for [x, y] in pixels(pair.size) {
            let own = if x < 320 { 2.0 } else { 0.0 };
            assert!((spread(&left, [x, y]) - own).abs() < 1e-6, "{x} {y}");
        }
    }
}
