//! What the device made of a block, copied into the frame of the whole picture.

use std::collections::HashMap;
use std::rc::Rc;

use crate::base::work::{State, Work};
use crate::gpu::buffer::Buffer;
use crate::gpu::device::{Device, DeviceError};
use crate::gpu::error::RenderError;
use crate::gpu::job::Job;
use crate::picture::frame::Frame;
use crate::plan::Pass;

/// The buffers of one block, by the names of their variables; what each pass leaves is
/// there a second time with the number of the pass.
pub type Bound = HashMap<String, Rc<wgpu::Buffer>>;

/// A state that no shader writes: what cells are found by that were not visited.
pub const UNWRITTEN: u32 = u32::MAX;

/// Copies a block's channels into the frame.
///
/// # Errors
/// A lost device; cells that should have been visited and were not.
pub fn collect(
    device: &Device,
    job: &Job<'_>,
    passes: &[Pass],
    bound: &Bound,
    frame: &mut Frame,
) -> Result<(), RenderError> {
    let get = |name: String| bound.get(&name).map(|b| &**b);
    let mut parents: Option<Vec<u32>> = None;
    for (at, pass) in passes.iter().enumerate() {
        let (Some(front), Some(state)) = (get(format!("front {at}")), get(format!("state {at}")))
        else {
            continue;
        };
        let divisor = match pass {
            Pass::March(level) => level.divisor,
            _ => 1,
        };
        let cells = job.cells(divisor);
        let count = cells[0] as usize * cells[1] as usize;
        let states: Vec<u32> = read(device, state, count)?;
        let missing = unvisited(&states, cells, parents.as_deref());
        if missing > 0 {
            return Err(RenderError::Unwritten {
                device: device.info.name.clone(),
                pass: pass.name(),
                cells: missing,
            });
        }
        let mut work = Vec::new();
        if let Some(tally) = get(format!("tally {at}")) {
            work = read::<[u32; 2]>(device, tally, count)?
                .into_iter()
                .map(|[evaluations, iterations]| Work {
                    evaluations,
                    iterations,
                })
                .collect();
            let figures = &mut frame.passes[at];
            let sum = |f: fn(&Work) -> u32| work.iter().map(|w| u64::from(f(w))).sum::<u64>();
            *figures.evaluations.get_or_insert(0) += sum(|w| w.evaluations);
            *figures.iterations.get_or_insert(0) += sum(|w| w.iterations);
        }
        let to = Target {
            origin: job.block.origin.map(|o| o / divisor),
            cells,
            width: job.plan.size[0].div_ceil(divisor),
        };
        let codes: Vec<u8> = states.iter().copied().map(seen).collect();
        if *pass == Pass::Trace {
            let mut depth: Vec<f32> = read(device, front, count)?;
            for (t, s) in depth.iter_mut().zip(&codes) {
                if *s == State::Sky as u8 {
                    *t = f32::INFINITY;
                }
            }
            to.copy(&depth, &mut frame.depth);
            to.copy(&codes, &mut frame.state);
            to.copy(&work, &mut frame.work);
        } else {
            let layer = &mut frame.levels[at];
            to.copy(&work, &mut layer.work);
            if job.extras.levels {
                let mut fronts: Vec<f32> = read(device, front, count)?;
                for (f, s) in fronts.iter_mut().zip(&states) {
                    if *s == UNWRITTEN {
                        *f = f32::MAX;
                    }
                }
                to.copy(&fronts, &mut layer.front);
                to.copy(&codes, &mut layer.state);
            }
        }
        parents = Some(states);
    }
    let to = Target {
        origin: job.block.origin,
        cells: job.block.size,
        width: job.plan.size[0],
    };
    let rgb =
        |v: Vec<[f32; 4]>| -> Vec<_> { v.into_iter().map(|[r, g, b, _]| [r, g, b]).collect() };
    if let Some(raw) = get("radiance".into()) {
        let pixels: Vec<[f32; 4]> = read(device, raw, job.block.area())?;
        frame.undecided += pixels.iter().filter(|p| p[3] == 0.0).count();
        to.copy(&rgb(pixels), &mut frame.radiance);
    }
    if let (true, Some(raw)) = (job.extras.normals, get("normals".into())) {
        let normals = rgb(read(device, raw, job.block.area())?);
        to.copy(&normals, &mut frame.normal);
    }
    Ok(())
}

/// Cells that were not visited although their parent is not sky, or that were although
/// it is; without parents every cell is to be visited.
fn unvisited(states: &[u32], cells: [u32; 2], parents: Option<&[u32]>) -> usize {
    let width = cells[0] as usize;
    let parent_width = width.div_ceil(2);
    let wrong = |(i, state): (usize, &u32)| {
        let wanted = parents.is_none_or(|p| {
            let parent = p[(i / width / 2) * parent_width + i % width / 2];
            seen(parent) != State::Sky as u8
        });
        wanted == State::from_code(*state).is_none()
    };
    states.iter().enumerate().filter(|c| wrong(*c)).count()
}

/// A state as it goes into a frame: cells that were never visited have a sky parent.
fn seen(state: u32) -> u8 {
    if state == UNWRITTEN {
        State::Sky as u8
    } else {
        state as u8
    }
}

/// Where a block's rows go in a layer of the whole image.
struct Target {
    origin: [u32; 2],
    cells: [u32; 2],
    width: u32,
}

impl Target {
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

fn read<T: bytemuck::Pod>(
    device: &Device,
    raw: &wgpu::Buffer,
    count: usize,
) -> Result<Vec<T>, DeviceError> {
    Buffer::<T>::over(raw.clone(), count).read(device, count)
}
