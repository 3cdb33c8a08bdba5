//! The CPU executor: the passes of a Plan in f64, with parts of a grid spread over all cores.
//!
//! It renders where a machine has no adapter, makes the truths, and is what the GPU is compared with.
//! `bands` spreads cells over the cores, `sample` has single pixels, and `until` ends tiles.

mod bands;
mod sample;
mod until;

use glam::DVec3;

use crate::base::clock::clock;
use crate::base::filter::{lens_share, offset};
use crate::base::outcome::{Counts, State};
use crate::base::view::{Beam, View};
use crate::heightfield::conemap::generate::cpu::generate;
use crate::pass::color::Sight;
use crate::pass::follow::{Start, follow_all};
use crate::pass::look::Light;
use crate::pass::march::{Ended, march, march_all};
use crate::pass::prepare::{FrameError, prepare};
use crate::pass::progress::Watch;
use crate::pass::{color, trace, variance::spread_of};
use crate::picture::frame::{Frame, in_image};
use crate::plan::pyramid::Level;
use crate::plan::{Extras, Pass, Plan};
use crate::scene::{Assets, Hit, Solid, Task};
use bands::Bands;
pub use sample::sample;
use until::{Judge, average};

/// The proven front of one cell.
#[derive(Clone, Copy)]
struct Proof {
    front: f64,
    ended: Ended,
}

impl Proof {
    /// That of a cell whose parent has proven a front.
    fn of<S: Solid>(
        (solid, view): (&S, &View),
        cell: [u32; 2],
        level: Level,
        front: f64,
        work: &mut Counts,
    ) -> Self {
        let cone = cone_of(view, cell, level);
        let (front, ended) = march(solid, &cone, front, level.steps, work);
        Self { front, ended }
    }
}

/// The cone of a cell.
fn cone_of(view: &View, cell: [u32; 2], level: Level) -> Beam {
    let mut cone = view.view_cone(cell, level.divisor);
    cone.k *= level.fudge;
    cone
}

/// A finished level, row by row.
struct Proofs {
    width: usize,
    cells: Vec<Proof>,
}

/// Renders a plan. It must pass [`Plan::check`]. The assets keep what is loaded and made for it.
///
/// # Errors
/// [`FrameError::Cancelled`] if `watch` returns `false`. A named file cannot be read or does
/// not fit, or a cone map cannot be made.
pub fn render(
    plan: &Plan,
    assets: &Assets,
    extras: Extras,
    watch: Watch<'_>,
) -> Result<Frame, FrameError> {
    let plan = &*plan.resolved(extras, assets);
    let prepared = prepare(plan, assets, &mut generate, clock, watch)?;
    // Heights decide about cones.
    let plan = &*plan.resolved(extras, assets);
    let solid = plan.scene.solid(&plan.viewpoint(), assets)?;
    let render = Render {
        plan,
        light: &Light::of(plan, &solid).with_sky(assets.sky(plan)?),
        ray_steps: plan.ray_steps(&solid),
        extras,
        watch,
    };
    let mut frame = solid.run(render)?;
    frame.finish(prepared);
    Ok(frame)
}

/// What is rendered.
struct Render<'a> {
    plan: &'a Plan,
    light: &'a Light,
    ray_steps: u32,
    extras: Extras,
    watch: Watch<'a>,
}

impl Task for Render<'_> {
    type Output = Result<Frame, FrameError>;

    fn run<S: Solid>(self, solid: &S) -> Self::Output {
        let Self { plan, extras, .. } = self;
        let passes = plan.passes(extras);
        let frame = Frame::blank(plan, extras);
        let mut run = Run {
            solid,
            view: plan.view(),
            judge: Judge::of(plan, &frame),
            frame,
            ended: Vec::new(),
            parents: None,
            hits: Vec::new(),
            sample: 0,
            counts: true,
            before: 0,
            undecided: Vec::new(),
        };
        // The cones serve all samples. The last one is that of the pixels' centres, whose depths stay.
        let rays = passes.iter().position(|pass| *pass == Pass::Trace);
        let (cones, rays) = passes.split_at(rays.unwrap_or(passes.len()));
        let samples = (0..plan.visits()).rev();
        let all = cones.iter().map(|pass| (0, pass));
        let all = all.chain(samples.flat_map(|i| rays.iter().map(move |pass| (i, pass))));
        let share = 1.0 / (cones.len() + rays.len() * plan.visits() as usize) as f64;
        for (nth, (sample, &pass)) in all.enumerate() {
            let at = nth.min(cones.len()) + usize::from(pass == Pass::Color);
            run.sample = sample;
            run.before = plan.visits() - 1 - sample;
            // Behind a lens, the centre counts for the depth alone.
            run.counts = sample > 0 || plan.visits() == plan.samples;
            let start = clock();
            let mut bands = Bands {
                pass: pass.name(),
                before: nth as f64 * share,
                share,
                watch: &mut *self.watch,
            };
            let work = match pass {
                Pass::March(level) => run.march(at, level, &mut bands)?,
                Pass::Trace => run.trace(self.ray_steps, &mut bands)?,
                Pass::Color => run.color(self.light, &mut bands)?,
                // Done before all others.
                Pass::Prepare(_) => continue,
            };
            if let Some(judge) = run.judge.as_mut().filter(|_| pass == Pass::Color) {
                judge.judge(&mut run.frame, run.before + 1);
                run.ended = judge.ended(&run.frame);
            }
            let figures = &mut run.frame.passes[at];
            figures.wall_ms += clock() - start;
            if extras.count && pass.marches() {
                *figures.evaluations.get_or_insert(0) += work.0;
                *figures.iterations.get_or_insert(0) += work.1;
            }
        }
        average(&mut run.frame, plan.samples);
        run.frame.undecided = run.undecided.iter().filter(|u| **u).count();
        Ok(run.frame)
    }
}

/// A render under way.
struct Run<'a, S> {
    solid: &'a S,
    view: View,
    frame: Frame,
    /// Ends tiles, if they may.
    judge: Option<Judge>,
    /// Pixels whose samples have ended.
    ended: Vec<bool>,
    parents: Option<Proofs>,
    /// What the rays hit, for the colour pass.
    hits: Vec<Hit>,
    /// The sample, and whether its light counts.
    sample: u32,
    counts: bool,
    /// Samples before it.
    before: u32,
    /// Pixels with a shadow ray that reached its step limit.
    undecided: Vec<bool>,
}

/// Evaluations and iterations of a whole pass.
type Sum = (u64, u64);

impl<S: Solid> Run<'_, S> {
    /// The rays of the sample by pixels of the frame.
    fn rays(&self) -> impl Fn([u32; 2]) -> Beam + Sync + use<S> {
        let (view, place) = (self.view, offset(self.sample));
        let origin = self.frame.origin;
        let share = (self.sample > 0).then(|| lens_share(self.sample));
        move |pixel| {
            let pixel = in_image(origin, pixel);
            match share {
                Some(share) => view.view_ray_from(pixel, place, share),
                None => view.view_ray_at(pixel, place),
            }
        }
    }

    fn march(&mut self, at: usize, level: Level, bands: &mut Bands) -> Result<Sum, FrameError> {
        let cells = level.cells(self.frame.size);
        let first = self.frame.origin.map(|o| o / level.divisor);
        let (solid, view, parents) = (self.solid, &self.view, self.parents.as_ref());
        let some = |part: Vec<[u32; 2]>| {
            let parent = |cell: &[u32; 2]| parent_of(parents, *cell);
            let mut all: Vec<(Proof, Counts)> = part
                .iter()
                .map(|cell| (parent(cell), Counts::default()))
                .collect();
            let going = || (0..part.len()).filter(|i| parent(&part[*i]).ended != Ended::Sky);
            let start = |i: usize| {
                let cone = cone_of(view, in_image(first, part[i]), level);
                (cone, parent(&part[i]).front)
            };
            let starts: Vec<_> = going().map(start).collect();
            let ends = march_all(solid, &starts, level.steps);
            for (i, (front, ended, work)) in going().zip(ends) {
                all[i] = (Proof { front, ended }, work);
            }
            all
        };
        let mut proofs = Vec::with_capacity(cells[0] as usize * cells[1] as usize);
        let mut sum = (0, 0);
        let layer = &mut self.frame.levels[at];
        bands.over(cells, some, |i, (proof, work)| {
            proofs.push(proof);
            add(&mut sum, work);
            set(&mut layer.front, i, proof.front as f32);
            set(&mut layer.state, i, proof.ended as u8);
            set(&mut layer.work, i, work);
        })?;
        self.parents = Some(Proofs {
            width: cells[0] as usize,
            cells: proofs,
        });
        Ok(sum)
    }

    fn trace(&mut self, limit: u32, bands: &mut Bands) -> Result<Sum, FrameError> {
        let (solid, parents) = (self.solid, self.parents.as_ref());
        let (ray, width) = (self.rays(), self.frame.size[0] as usize);
        let (frame, hits) = (&mut self.frame, &mut self.hits);
        let (ended, is_centre) = (&self.ended, self.sample == 0);
        let far = solid.bounds_far();
        let some = |part: Vec<[u32; 2]>| {
            let (mut going, mut starts) = (Vec::new(), Vec::new());
            let mut all = vec![None; part.len()];
            for (i, &pixel) in part.iter().enumerate() {
                // The centre has a ray anyway: its depth stays.
                let at = pixel[1] as usize * width + pixel[0] as usize;
                if is_on(ended, at) && !is_centre {
                    continue;
                }
                let Proof { front, ended } = parent_of(parents, pixel);
                all[i] = Some((Hit::default(), State::Sky, Counts::default()));
                if ended != Ended::Sky {
                    let ray = ray(pixel);
                    going.push(i);
                    starts.push(Start { ray, front, far });
                }
            }
            for (i, end) in going.into_iter().zip(follow_all(solid, &starts, limit)) {
                all[i] = Some((end.hit, trace::state(&end), end.work));
            }
            all
        };
        let mut sum = (0, 0);
        // As the colours, they are kept only if somebody asks for colours.
        hits.resize(frame.radiance.len(), Hit::default());
        bands.over(frame.size, some, |i, traced| {
            let Some((hit, state, work)) = traced else {
                return;
            };
            add(&mut sum, work);
            frame.state[i] = state as u8;
            frame.depth[i] = match state {
                State::Sky => f32::INFINITY,
                _ => hit.t as f32,
            };
            if let Some(all) = frame.work.get_mut(i) {
                all.evaluations = all.evaluations.saturating_add(work.evaluations);
                all.iterations = all.iterations.saturating_add(work.iterations);
            }
            set(hits, i, hit);
        })?;
        Ok(sum)
    }

    fn color(&mut self, light: &Light, bands: &mut Bands) -> Result<Sum, FrameError> {
        let (ray, solid, hits) = (self.rays(), self.solid, &self.hits);
        let size = self.frame.size;
        let (radiance, normals) = (&mut self.frame.radiance, &mut self.frame.normal);
        let (alpha, variance) = (&mut self.frame.alpha, &mut self.frame.variance);
        let (states, undecided) = (&self.frame.state, &mut self.undecided);
        undecided.resize(states.len(), false);
        let (counts, before, origin) = (self.counts, self.before, self.frame.origin);
        let (ended, is_centre) = (&self.ended, self.sample == 0);
        let some = |part: Vec<[u32; 2]>| {
            let place = |pixel: &[u32; 2]| pixel[1] as usize * size[0] as usize + pixel[0] as usize;
            // The normal is that of the centre.
            let seen = |pixel: &[u32; 2]| is_centre || !is_on(ended, place(pixel));
            let sight = |pixel: &[u32; 2]| Sight {
                pixel: in_image(origin, *pixel),
                ray: ray(*pixel),
                hit: hits[place(pixel)],
                state: State::from_code(u32::from(states[place(pixel)]))
                    .unwrap_or(State::Unconverged),
            };
            let sights: Vec<Sight> = part.iter().filter(|p| seen(p)).map(sight).collect();
            let mut colors = color::colors((solid, light), before, &sights).into_iter();
            let one = |pixel: &[u32; 2]| if seen(pixel) { colors.next() } else { None };
            part.iter().map(one).collect::<Vec<_>>()
        };
        bands.over(size, some, |i, pixel| {
            let Some(pixel) = pixel else {
                return;
            };
            set(normals, i, pixel.normal.as_vec3().to_array());
            if is_on(ended, i) {
                return;
            }
            let is_hit = states[i] != State::Sky as u8;
            let adds = counts && (is_hit || alpha.is_empty());
            let own = if adds { pixel.radiance } else { DVec3::ZERO };
            if let Some(spread) = variance.get_mut(i).filter(|_| counts && before > 0) {
                *spread += spread_of(radiance[i], own, before);
            }
            for (sum, light) in radiance[i].iter_mut().zip(own.to_array()) {
                *sum += light as f32;
            }
            if let Some(hits) = alpha.get_mut(i) {
                *hits += f32::from(u8::from(adds));
            }
            undecided[i] |= !pixel.decided;
        })?;
        Ok((0, 0))
    }
}

/// Whether a pixel is among those that have ended; none are if the list is empty.
fn is_on(list: &[bool], at: usize) -> bool {
    list.get(at).copied().unwrap_or(false)
}

/// Sets a value of a layer if the layer is kept.
fn set<T>(layer: &mut [T], i: usize, value: T) {
    if let Some(to) = layer.get_mut(i) {
        *to = value;
    }
}

fn add(sum: &mut Sum, work: Counts) {
    sum.0 += u64::from(work.evaluations);
    sum.1 += u64::from(work.iterations);
}

fn parent_of(parents: Option<&Proofs>, [x, y]: [u32; 2]) -> Proof {
    let start = Proof {
        front: 0.0,
        ended: Ended::Stopped,
    };
    let at = |p: &Proofs| p.cells[(y as usize / 2) * p.width + x as usize / 2];
    parents.map_or(start, at)
}

#[cfg(test)]
mod tests {
    use super::bands::BAND_CELLS;
    use super::*;
    use crate::formula::{Formula, balls::Balls};
    use crate::pass::progress::Progress;

    #[test]
    fn a_render_is_cancelled_within_a_pass() {
        let mut plan = Plan::new(Formula::Balls(Balls::default()));
        (plan.size, plan.samples) = ([2 * BAND_CELLS as u32, 96], 1);
        plan.march.coarsest = Some(2);
        let mut told = Vec::new();
        let watch = &mut |p: &Progress| {
            told.push((p.pass.clone(), p.done));
            p.pass != "trace"
        };
        let ended = render(&plan, &Assets::default(), Extras::default(), watch);
        assert!(matches!(ended, Err(FrameError::Cancelled)));
        let (pass, done) = told.last().expect("told");
        assert_eq!(pass, "trace");
        // In the second of three passes.
        assert!(*done > 0.34 && *done < 0.66, "{done}");
        assert!(told.is_sorted_by(|a, b| a.1 < b.1), "{told:?}");
    }
}
