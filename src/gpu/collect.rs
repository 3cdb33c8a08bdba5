//! Copies what the device made of a block into the frame of the whole picture.

use crate::base::outcome::{Counts, State};
use crate::gpu::device::{Device, DeviceError};
use crate::gpu::staging::Staging;
use crate::gpu::target::Target;
use crate::pass::layout::{CellsHead, Layout};
use crate::pass::variance::variance_of;
use crate::picture::frame::Frame;
use crate::plan::{Extras, Pass};

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
        let mut at = 0;
        let mut next = |r: Range| {
            let start = at;
            at += 4 * r.words as usize;
            start
        };
        let starts = self.all().map(&mut next);
        let words = |i: usize| -> Result<Vec<u32>, DeviceError> {
            from.read(device, starts[i], self.all()[i].words as usize)
        };
        let whole = BlockPlace::new(layout, 1, frame);
        let states_of = |words: Vec<u32>| -> Vec<Option<State>> {
            words.iter().map(|w| state(*w, generation)).collect()
        };
        let states = states_of(words(1)?);
        let mut depth: Vec<f32> = from.read(device, starts[0], self.depth.words as usize)?;
        for (t, s) in depth.iter_mut().zip(&states) {
            if code(*s) == State::Sky as u8 {
                *t = f32::INFINITY;
            }
        }
        let codes: Vec<u8> = states.iter().map(|s| code(*s)).collect();
        whole.copy(&depth, &mut frame.depth);
        whole.copy(&codes, &mut frame.state);
        let tally: Vec<[u32; 2]> = from.read(device, starts[2], self.tally.words as usize / 2)?;
        let level_states = states_of(words(3)?);
        let fronts: Vec<f32> = from.read(device, starts[4], self.level_fronts.words as usize)?;
        for (i, pass) in passes.iter().enumerate().filter(|(_, p)| p.marches()) {
            let divisor = match pass {
                Pass::March(level) => level.divisor,
                _ => 1,
            };
            let place = BlockPlace::new(layout, divisor, frame);
            let first = layout.state(divisor) as usize;
            let cells = first..first + layout.count(divisor) as usize;
            let area = layout.count(1) as usize;
            let states = match divisor {
                1 => &states[..],
                _ => level_states
                    .get(cells.start - area..cells.end - area)
                    .unwrap_or_default(),
            };
            let work = tally.get(cells.clone()).unwrap_or_default();
            let work = work.iter().zip(states).map(|(w, s)| work_of(*w, *s));
            let work: Vec<Counts> = work.collect();
            if !work.is_empty() {
                let figures = &mut frame.passes[i];
                let sum = |f: fn(&Counts) -> u32| work.iter().map(|w| u64::from(f(w))).sum::<u64>();
                *figures.evaluations.get_or_insert(0) += sum(|w| w.evaluations);
                *figures.iterations.get_or_insert(0) += sum(|w| w.iterations);
            }
            if divisor == 1 {
                place.copy(&work, &mut frame.work);
                continue;
            }
            let layer = &mut frame.levels[i];
            place.copy(&work, &mut layer.work);
            let fronts = fronts.get(cells.start - area..cells.end - area);
            let fronts = fronts.unwrap_or_default().iter().zip(states);
            let fronts = fronts.map(|(front, state)| state.map_or(f32::MAX, |_| *front));
            place.copy(&fronts.collect::<Vec<_>>(), &mut layer.front);
            let codes: Vec<u8> = states.iter().map(|s| code(*s)).collect();
            place.copy(&codes, &mut layer.state);
        }
        let pixels: Vec<[f32; 4]> = from.read(device, starts[5], self.pixels.words as usize / 4)?;
        let mut planes = pixels.chunks(codes.len().max(1));
        let mut plane = |kept: bool| match kept {
            true => planes.next().unwrap_or_default(),
            false => &[],
        };
        let light = plane(!frame.radiance.is_empty());
        let normals = plane(!frame.normal.is_empty() || !frame.variance.is_empty());
        let halves = plane(!frame.samples.is_empty());
        let count = |p: &[f32; 4]| if p[3] > 0.0 { p[3] as u32 } else { samples };
        let counts: Vec<u32> = halves.iter().map(count).collect();
        let rgb = |p: &[[f32; 4]]| {
            p.iter()
                .map(|[r, g, b, _]| [*r, *g, *b])
                .collect::<Vec<_>>()
        };
        // One more than the hits, below zero if a shadow is a guess: see `background.wgsl`.
        let count = |i: usize| counts.get(i).copied().unwrap_or(samples);
        let share = |(i, p): (usize, &[f32; 4])| (p[3].abs() - 1.0) * (1.0 / count(i) as f32);
        let alpha: Vec<f32> = match frame.alpha.is_empty() {
            true => Vec::new(),
            false => light.iter().enumerate().map(share).collect(),
        };
        frame.undecided += light.iter().filter(|p| p[3] <= 0.0).count();
        let spread = |(i, p): (usize, &[f32; 4])| variance_of(p[3], count(i));
        let variance: Vec<f32> = match frame.variance.is_empty() {
            true => Vec::new(),
            false => normals.iter().enumerate().map(spread).collect(),
        };
        whole.copy(&alpha, &mut frame.alpha);
        whole.copy(&variance, &mut frame.variance);
        whole.copy(&rgb(light), &mut frame.radiance);
        if !frame.normal.is_empty() {
            whole.copy(&rgb(normals), &mut frame.normal);
        }
        whole.copy(&counts, &mut frame.samples);
        Ok(())
    }
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

    fn copy<T: Copy>(&self, from: &[T], to: &mut [T]) {
        if from.is_empty() || to.is_empty() {
            return;
        }
        let width = self.cells[0] as usize;
        for (y, row) in (self.origin[1] as usize..).zip(from.chunks(width)) {
            let start = y * self.width as usize + self.origin[0] as usize;
            to[start..start + width].copy_from_slice(row);
        }
    }
}
