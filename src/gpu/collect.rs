//! Copies what the device made of a block into the frame of the whole picture.

use std::collections::HashMap;
use std::rc::Rc;

use bytemuck::Pod;

use crate::base::work::{State, Work};
use crate::gpu::buffer::Buffer;
use crate::gpu::device::Device;
use crate::gpu::error::RenderError;
use crate::gpu::job::Job;
use crate::picture::frame::Frame;
use crate::plan::Pass;

/// The buffers of a block by the names of their variables. What a pass writes is also there by
/// its name and the number of the pass.
pub type Bound = HashMap<String, Rc<wgpu::Buffer>>;

/// A state that no shader writes. It marks cells that were not visited.
pub const UNWRITTEN: u32 = u32::MAX;

/// Copies a block's layers into the frame.
///
/// # Errors
/// The device is lost, or it left cells unvisited.
pub fn collect(
    device: &Device,
    job: &Job<'_>,
    passes: &[Pass],
    bound: &Bound,
    frame: &mut Frame,
) -> Result<(), RenderError> {
    let mut parents: Option<Vec<u32>> = None;
    for (at, pass) in passes.iter().enumerate() {
        let divisor = match pass {
            Pass::March(level) => level.divisor,
            Pass::Trace => 1,
            Pass::Color | Pass::Prepare(_) => continue,
        };
        let to = Target::new(job, divisor);
        let states: Vec<u32> = to.read(device, bound, &format!("state {at}"))?;
        let missing = unvisited(&states, to.cells, parents.as_deref());
        if missing > 0 {
            return Err(RenderError::Unwritten {
                device: device.info.name.clone(),
                pass: pass.name(),
                cells: missing,
            });
        }
        let tally: Vec<[u32; 2]> = to.read(device, bound, &format!("tally {at}"))?;
        let work = |[evaluations, iterations]: [u32; 2]| Work {
            evaluations,
            iterations,
        };
        let work: Vec<Work> = tally.into_iter().map(work).collect();
        if !work.is_empty() {
            let figures = &mut frame.passes[at];
            let sum = |f: fn(&Work) -> u32| work.iter().map(|w| u64::from(f(w))).sum::<u64>();
            *figures.evaluations.get_or_insert(0) += sum(|w| w.evaluations);
            *figures.iterations.get_or_insert(0) += sum(|w| w.iterations);
        }
        let codes: Vec<u8> = states.iter().copied().map(seen).collect();
        if *pass == Pass::Trace {
            let mut depth: Vec<f32> = to.read(device, bound, &format!("front {at}"))?;
            for (t, _) in depth.iter_mut().zip(&codes).filter(|(_, s)| is_sky(**s)) {
                *t = f32::INFINITY;
            }
            to.copy(&depth, &mut frame.depth);
            to.copy(&codes, &mut frame.state);
            to.copy(&work, &mut frame.work);
        } else {
            let layer = &mut frame.levels[at];
            to.copy(&work, &mut layer.work);
            if job.extras.levels {
                let mut fronts: Vec<f32> = to.read(device, bound, &format!("front {at}"))?;
                let all = fronts.iter_mut().zip(&states);
                for (front, _) in all.filter(|(_, s)| **s == UNWRITTEN) {
                    *front = f32::MAX;
                }
                to.copy(&fronts, &mut layer.front);
                to.copy(&codes, &mut layer.state);
            }
        }
        parents = Some(states);
    }
    let to = Target::new(job, 1);
    let rgb = |[r, g, b, _]: [f32; 4]| [r, g, b];
    let pixels: Vec<[f32; 4]> = to.read(device, bound, "radiance")?;
    frame.undecided += pixels.iter().filter(|p| p[3] == 0.0).count();
    let radiance: Vec<_> = pixels.into_iter().map(rgb).collect();
    to.copy(&radiance, &mut frame.radiance);
    if job.extras.normals {
        let normals = to.read(device, bound, "normals")?;
        let normals: Vec<_> = normals.into_iter().map(rgb).collect();
        to.copy(&normals, &mut frame.normal);
    }
    Ok(())
}

/// Number of cells that were not visited although their parent is not sky, or visited although
/// it is. Without parents every cell must be visited.
fn unvisited(states: &[u32], cells: [u32; 2], parents: Option<&[u32]>) -> usize {
    let width = cells[0] as usize;
    let parent_width = width.div_ceil(2);
    let wrong = |(i, state): (usize, &u32)| {
        let wanted = parents.is_none_or(|p| {
            let parent = p[(i / width / 2) * parent_width + i % width / 2];
            !is_sky(seen(parent))
        });
        wanted == State::from_code(*state).is_none()
    };
    states.iter().enumerate().filter(|c| wrong(*c)).count()
}

/// A state in a frame. Cells that were not visited are sky, as their parents are.
fn seen(state: u32) -> u8 {
    if state == UNWRITTEN {
        State::Sky as u8
    } else {
        state as u8
    }
}

fn is_sky(code: u8) -> bool {
    code == State::Sky as u8
}

/// The place of a block in a layer of the whole image.
struct Target {
    origin: [u32; 2],
    cells: [u32; 2],
    width: u32,
}

impl Target {
    /// The place of a job's block in the layer of a divisor.
    fn new(job: &Job<'_>, divisor: u32) -> Self {
        Self {
            origin: job.block.origin.map(|o| o / divisor),
            cells: job.cells(divisor),
            width: job.plan.size[0].div_ceil(divisor),
        }
    }

    /// The block's values of a buffer; none if there is no such buffer.
    fn read<T: Pod>(
        &self,
        device: &Device,
        bound: &Bound,
        name: &str,
    ) -> Result<Vec<T>, RenderError> {
        let Some(raw) = bound.get(name) else {
            return Ok(Vec::new());
        };
        let count = self.cells[0] as usize * self.cells[1] as usize;
        let buffer = Buffer::<T>::over((**raw).clone(), count);
        Ok(buffer.read(device, count)?)
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
