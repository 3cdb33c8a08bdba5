//! Copies what the device made of a block into the frame of the whole picture.

use std::iter::repeat;

use crate::base::outcome::{Counts, State};
use crate::gpu::device::{Device, DeviceError};
use crate::gpu::staging::Staging;
use crate::gpu::target::Target;
use crate::pass::layout::{CellsHead, Layout};
use crate::pass::variance::variance_of;
use crate::picture::frame::Frame;
use crate::plan::{Extras, Pass};

const SKY: u8 = State::Sky as u8;

/// Which values of a block are read, in words: where each part starts, and how long it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parts {
    depth: Range,
    state: Range,
    tally: Range,
    level_states: Range,
    level_fronts: Range,
    pixels: Range,
}

/// A part of the values of all cells, in words.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Range {
    at: u32,
    words: u32,
}

impl Range {
    fn between(at: u32, end: u32) -> Self {
        Self {
            at,
            words: end - at,
        }
    }

    fn only_if(self, wanted: bool) -> Self {
        if wanted { self } else { Self::default() }
    }
}

impl Parts {
    /// What a frame with these extras holds of a block.
    pub fn new(layout: &Layout, extras: Extras) -> Self {
        if extras.unread {
            return Self::default();
        }
        let area = layout.count(1);
        let (tally, front) = (layout.tally(1), layout.front(1));
        Self {
            depth: Range::between(front, front + area),
            state: Range::between(0, area),
            tally: Range::between(tally, front).only_if(extras.count),
            level_states: Range::between(area, layout.states_end())
                .only_if(extras.levels || extras.count),
            level_fronts: Range::between(front + area, layout.mark()).only_if(extras.levels),
            pixels: Range::between(layout.light(), layout.lists()),
        }
    }

    fn all(&self) -> [Range; 6] {
        [
            self.depth,
            self.state,
            self.tally,
            self.level_states,
            self.level_fronts,
            self.pixels,
        ]
    }

    /// Bytes of all parts.
    pub fn bytes(&self) -> u64 {
        4 * self.all().iter().map(|r| u64::from(r.words)).sum::<u64>()
    }

    /// The ranges to copy from the buffers of a target, in order.
    pub fn ranges<'a>(&self, target: &'a Target) -> Vec<(&'a wgpu::Buffer, u64, u64)> {
        let head = size_of::<CellsHead>() as u64;
        let range = |r: Range| {
            let [at, bytes] = [r.at, r.words].map(|n| 4 * u64::from(n));
            (&target.shared.cells, head + at, bytes)
        };
        self.all().map(range).to_vec()
    }

    /// Copies the parts into the frame.
    ///
    /// # Errors
    /// The device was lost.
    pub fn collect(
        &self,
        device: &Device,
        from: &Staging,
        (layout, generation): (&Layout, u32),
        (passes, samples): (&[Pass], u32),
        frame: &mut Frame,
    ) -> Result<(), DeviceError> {
        if self.bytes() == 0 {
            return Ok(());
        }
        let view = from.view(device)?;
        let mut rest = &view[..];
        let parts = self.all().map(|r| {
            let (part, after) = rest.split_at(4 * r.words as usize);
            rest = after;
            part
        });
        let [depth, state_words, tally, level_states, fronts, pixels] = parts;
        let whole = BlockPlace::new(layout, 1, frame);
        let states = || words::<1>(state_words).map(|[w]| state(w, generation));
        let depths = words::<1>(depth)
            .zip(states())
            .map(|([t], state)| match code(state) {
                SKY => f32::INFINITY,
                _ => f32::from_bits(t),
            });
        whole.fill(&mut frame.depth, depths);
        whole.fill(&mut frame.state, states().map(code));
        let area = layout.count(1) as usize;
        for (i, pass) in passes.iter().enumerate().filter(|(_, p)| p.marches()) {
            let divisor = match pass {
                Pass::March(level) => level.divisor,
                _ => 1,
            };
            let place = BlockPlace::new(layout, divisor, frame);
            let count = layout.count(divisor) as usize;
            let first = layout.state(divisor) as usize;
            let states = || {
                let own = match divisor {
                    1 => state_words,
                    _ => part(level_states, first - area, count),
                };
                words::<1>(own).map(|[w]| state(w, generation))
            };
            if !tally.is_empty() {
                let tally = part(tally, 2 * first, 2 * count);
                let work = || words::<2>(tally).zip(states()).map(|(w, s)| work_of(w, s));
                let figures = &mut frame.passes[i];
                let [evaluations, iterations] = work().fold([0; 2], |[e, i], w| {
                    [e + u64::from(w.evaluations), i + u64::from(w.iterations)]
                });
                *figures.evaluations.get_or_insert(0) += evaluations;
                *figures.iterations.get_or_insert(0) += iterations;
                let kept = match divisor {
                    1 => &mut frame.work,
                    _ => &mut frame.levels[i].work,
                };
                place.fill(kept, work());
            }
            if divisor > 1 && !fronts.is_empty() {
                let layer = &mut frame.levels[i];
                let fronts = words::<1>(part(fronts, first - area, count)).zip(states());
                let fronts = fronts.map(|([front], state)| match state {
                    Some(_) => f32::from_bits(front),
                    None => f32::MAX,
                });
                place.fill(&mut layer.front, fronts);
                place.fill(&mut layer.state, states().map(code));
            }
        }
        let mut planes = pixels.chunks(16 * area);
        let mut plane = |kept: bool| match kept {
            true => planes.next().unwrap_or_default(),
            false => &[],
        };
        let light = plane(!frame.radiance.is_empty());
        let normals = plane(!frame.normal.is_empty() || !frame.variance.is_empty());
        let halves = plane(!frame.samples.is_empty());
        let pixels_of = |plane| words::<4>(plane).map(|words| words.map(f32::from_bits));
        let rgb = |[r, g, b, _]: [f32; 4]| [r, g, b];
        let own_count = |p: [f32; 4]| if p[3] > 0.0 { p[3] as u32 } else { samples };
        let counts = || pixels_of(halves).map(own_count).chain(repeat(samples));
        // One more than the hits, below zero if a shadow is a guess: see `background.wgsl`.
        let share = |(p, count): ([f32; 4], u32)| (p[3].abs() - 1.0) * (1.0 / count as f32);
        whole.fill(&mut frame.alpha, pixels_of(light).zip(counts()).map(share));
        frame.undecided += pixels_of(light).filter(|p| p[3] <= 0.0).count();
        let spread = |(p, count): ([f32; 4], u32)| variance_of(p[3], count);
        whole.fill(
            &mut frame.variance,
            pixels_of(normals).zip(counts()).map(spread),
        );
        whole.fill(&mut frame.radiance, pixels_of(light).map(rgb));
        whole.fill(&mut frame.normal, pixels_of(normals).map(rgb));
        whole.fill(&mut frame.samples, counts());
        Ok(())
    }
}

/// Some words of a part.
fn part(bytes: &[u8], first: usize, words: usize) -> &[u8] {
    &bytes[4 * first..4 * (first + words)]
}

/// The words of a part, so many at a time.
fn words<const N: usize>(bytes: &[u8]) -> impl Iterator<Item = [u32; N]> {
    bytes.chunks_exact(4 * N).map(|chunk| {
        let (words, _) = chunk.as_chunks::<4>();
        std::array::from_fn(|i| u32::from_ne_bytes(words[i]))
    })
}

/// The state in a word of a block; `None` if the block did not visit the cell.
fn state(word: u32, generation: u32) -> Option<State> {
    let visited = word >> 2 == generation;
    visited.then(|| State::from_code(word & 3)).flatten()
}

/// What the device counted in a cell, which is out of date if the cell was not visited.
fn work_of([evaluations, iterations]: [u32; 2], state: Option<State>) -> Counts {
    let counted = Counts {
        evaluations,
        iterations,
    };
    state.map(|_| counted).unwrap_or_default()
}

/// A state in a frame. Cells that were not visited are sky, as their parents are.
fn code(state: Option<State>) -> u8 {
    state.unwrap_or(State::Sky) as u8
}

/// The place of a block in a layer of a frame.
struct BlockPlace {
    origin: [u32; 2],
    cells: [u32; 2],
    width: u32,
}

impl BlockPlace {
    /// The place of a block in the layer of a divisor.
    fn new(layout: &Layout, divisor: u32, frame: &Frame) -> Self {
        let from = |axis: usize| layout.block.origin[axis] - frame.origin[axis];
        Self {
            origin: [0, 1].map(|axis| from(axis) / divisor),
            cells: layout.cells(divisor),
            width: frame.size[0].div_ceil(divisor),
        }
    }

    /// Puts the values of the block into a layer, row by row, if the frame has that layer.
    fn fill<T>(&self, to: &mut [T], mut from: impl Iterator<Item = T>) {
        if to.is_empty() {
            return;
        }
        let [x, y] = self.origin.map(|n| n as usize);
        let rows = to.chunks_mut(self.width as usize).skip(y);
        for row in rows.take(self.cells[1] as usize) {
            let cells = row[x..].iter_mut().take(self.cells[0] as usize);
            for (cell, value) in cells.zip(from.by_ref()) {
                *cell = value;
            }
        }
    }
}
