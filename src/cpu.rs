//! The CPU executor: the same passes in f64, rows over threads.
//!
//! It is what a machine without an adapter falls back to, what the truth is made with,
//! and what the GPU is compared to.

use std::time::Instant;

use rayon::prelude::*;

use crate::frame::{Frame, State, Work};
use crate::pass::look::Light;
use crate::pass::march::{Ended, march};
use crate::pass::{color, trace};
use crate::plan::{Extras, Pass, Plan};
use crate::pyramid::Level;
use crate::render::{Progress, RenderError, Watch, blank};
use crate::scene::{Hit, Solid, Task};
use crate::view::View;

/// A proven front of one cell.
#[derive(Clone, Copy)]
struct Proof {
    front: f64,
    ended: Ended,
}

/// A finished level: proofs row by row.
struct Proofs {
    width: usize,
    cells: Vec<Proof>,
}

/// Renders a plan that passes [`Plan::check`].
pub fn render(plan: &Plan, extras: Extras, watch: Watch<'_>) -> Result<Frame, RenderError> {
    plan.scene().run(Render {
        plan,
        extras,
        watch,
    })
}

struct Render<'a> {
    plan: &'a Plan,
    extras: Extras,
    watch: Watch<'a>,
}

impl Task for Render<'_> {
    type Output = Result<Frame, RenderError>;

    fn run<S: Solid>(self, solid: &S) -> Self::Output {
        let (plan, extras) = (self.plan, self.extras);
        let view = plan.view();
        let light = plan.light();
        let mut passes = plan.passes();
        passes.retain(|p| !(extras.depth_only && *p == Pass::Color));
        let mut frame = blank(plan, &passes, extras);
        let mut parents: Option<Proofs> = None;
        let mut hits: Vec<Hit> = Vec::new();
        for (at, &pass) in passes.iter().enumerate() {
            let start = Instant::now();
            let cells = match pass {
                Pass::March(level) => level.cells(plan.size),
                _ => plan.size,
            };
            let mut work = Vec::new();
            match pass {
                Pass::March(level) => {
                    let (proofs, done) = level_pass(solid, &view, level, cells, parents.as_ref());
                    if extras.levels {
                        let layer = &mut frame.levels[at];
                        layer.front = proofs.cells.iter().map(|p| p.front as f32).collect();
                        layer.state = proofs.cells.iter().map(|p| p.ended as u8).collect();
                    }
                    if extras.count {
                        frame.levels[at].work.clone_from(&done);
                    }
                    parents = Some(proofs);
                    work = done;
                }
                Pass::Trace => {
                    let limit = plan.march.ray_steps();
                    let (found, done) =
                        trace_pass(solid, &view, limit, parents.as_ref(), &mut frame.state);
                    for ((t, s), hit) in frame.depth.iter_mut().zip(&frame.state).zip(&found) {
                        *t = if *s == State::Sky as u8 {
                            f32::INFINITY
                        } else {
                            hit.t as f32
                        };
                    }
                    if extras.count {
                        frame.work.clone_from(&done);
                    }
                    hits = found;
                    work = done;
                }
                Pass::Color => color_pass(solid, &view, &light, &hits, extras, &mut frame),
            }
            let figures = &mut frame.passes[at];
            figures.cells = u64::from(cells[0]) * u64::from(cells[1]);
            figures.wall_ms = start.elapsed().as_secs_f64() * 1e3;
            if extras.count && pass != Pass::Color {
                let sum = |f: fn(&Work) -> u32| work.iter().map(|w| u64::from(f(w))).sum();
                figures.evaluations = Some(sum(|w| w.evaluations));
                figures.iterations = Some(sum(|w| w.iterations));
            }
            let progress = Progress {
                pass: pass.name(),
                done: (at + 1) as f64 / passes.len() as f64,
            };
            if !(self.watch)(&progress) {
                return Err(RenderError::Cancelled);
            }
        }
        let timed = frame.passes.iter().filter(|p| p.name != "color");
        frame.march_ms = timed.map(|p| p.wall_ms).sum();
        Ok(frame)
    }
}

/// Runs a function over all cells of a grid, rows over threads.
fn over<T: Send>(cells: [u32; 2], f: impl Fn([u32; 2]) -> T + Sync) -> Vec<T> {
    let rows = (0..cells[1]).into_par_iter();
    rows.flat_map_iter(|y| {
        let f = &f;
        (0..cells[0]).map(move |x| f([x, y]))
    })
    .collect()
}

fn parent_of(parents: Option<&Proofs>, [x, y]: [u32; 2]) -> Proof {
    let start = Proof {
        front: 0.0,
        ended: Ended::Stopped,
    };
    let at = |p: &Proofs| p.cells[(y as usize / 2) * p.width + x as usize / 2];
    parents.map_or(start, at)
}

fn level_pass<S: Solid>(
    solid: &S,
    view: &View,
    level: Level,
    cells: [u32; 2],
    parents: Option<&Proofs>,
) -> (Proofs, Vec<Work>) {
    let (proofs, work) = over(cells, |cell| {
        let parent = parent_of(parents, cell);
        let mut work = Work::default();
        if parent.ended == Ended::Sky {
            return (parent, work);
        }
        let mut cone = view.view_cone(cell, level.divisor);
        cone.k *= level.fudge;
        let (front, ended) = march(solid, &cone, parent.front, level.steps, &mut work);
        (Proof { front, ended }, work)
    })
    .into_iter()
    .unzip();
    let proofs = Proofs {
        width: cells[0] as usize,
        cells: proofs,
    };
    (proofs, work)
}

fn trace_pass<S: Solid>(
    solid: &S,
    view: &View,
    limit: u32,
    parents: Option<&Proofs>,
    states: &mut [u8],
) -> (Vec<Hit>, Vec<Work>) {
    let pixels = over(view.size, |pixel| {
        let parent = parent_of(parents, pixel);
        let mut work = Work::default();
        if parent.ended == Ended::Sky {
            return (Hit::default(), State::Sky, work);
        }
        let ray = view.view_ray(pixel);
        let (hit, state) = trace::trace(solid, &ray, parent.front, limit, &mut work);
        (hit, state, work)
    });
    for (to, (_, state, _)) in states.iter_mut().zip(&pixels) {
        *to = *state as u8;
    }
    pixels.into_iter().map(|(hit, _, work)| (hit, work)).unzip()
}

fn color_pass<S: Solid>(
    solid: &S,
    view: &View,
    light: &Light,
    hits: &[Hit],
    extras: Extras,
    frame: &mut Frame,
) {
    let width = view.size[0] as usize;
    let states = &frame.state;
    let pixels = over(view.size, |pixel| {
        let at = pixel[1] as usize * width + pixel[0] as usize;
        let state = State::from_code(u32::from(states[at])).unwrap_or(State::Unconverged);
        let ray = view.view_ray(pixel);
        color::color(solid, light, &ray, &hits[at], state)
    });
    frame.radiance = pixels.iter().map(|(c, _)| c.as_vec3().to_array()).collect();
    if extras.normals {
        frame.normal = pixels.iter().map(|(_, n)| n.as_vec3().to_array()).collect();
    }
}

/// Traces every so many pixels of a plan without cones: index, distance and state.
pub fn sample(plan: &Plan, every: usize) -> Vec<(usize, f64, State)> {
    plan.scene().run(Sample { plan, every })
}

struct Sample<'a> {
    plan: &'a Plan,
    every: usize,
}

impl Task for Sample<'_> {
    type Output = Vec<(usize, f64, State)>;

    fn run<S: Solid>(self, solid: &S) -> Self::Output {
        let view = self.plan.view();
        let limit = self.plan.march.ray_steps();
        let width = view.size[0] as usize;
        let pixels = width * view.size[1] as usize;
        (0..pixels.div_ceil(self.every))
            .into_par_iter()
            .map(|n| {
                let i = n * self.every;
                let ray = view.view_ray([(i % width) as u32, (i / width) as u32]);
                let work = &mut Work::default();
                let (hit, state) = trace::trace(solid, &ray, 0.0, limit, work);
                (i, hit.t, state)
            })
            .collect()
    }
}
