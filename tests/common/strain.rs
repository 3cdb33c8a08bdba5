//! What is asked of a picture however hard its plan is: measured on both executors and
//! against what is true.

use conemarch::base::outcome::State;
use conemarch::base::view::{Beam, footprint};
use conemarch::picture::frame::Frame;
use conemarch::plan::Plan;
use conemarch::plan::march::Mode;

use super::plans::solid;
use super::solved::{rays, solids, solved};
use crate::adapter::{HIT, LEVELS, SKY, UNCONVERGED, both, on_cpu};

/// Footprints between two depths that count as apart, as in the error reports.
const APART: f64 = 2.0;
/// How a length of a normal may differ from 1: roundings of f32, with room.
const UNIT: f32 = 1e-4;

/// What is wrong with the layers of a frame in themselves: numbers that are none, normals
/// of no length, states that there are not.
pub fn faults(plan: &Plan, frame: &Frame) -> Vec<String> {
    let mut found = Vec::new();
    let mut bad = |layer: &str, wrong: &dyn Fn(usize) -> bool| {
        let count = (0..frame.state.len()).filter(|i| wrong(*i)).count();
        found.extend((count > 0).then(|| format!("{count} in {layer}")));
    };
    let sky = |i: usize| frame.state[i] == SKY;
    let negative = |x: f32| !x.is_finite() || x < 0.0;
    bad("state", &|i| {
        State::from_code(u32::from(frame.state[i])).is_none()
    });
    bad("depth", &|i| {
        let t = frame.depth[i];
        if sky(i) {
            t != f32::INFINITY
        } else {
            negative(t)
        }
    });
    bad("radiance", &|i| frame.radiance[i].into_iter().any(negative));
    bad("normal", &|i| {
        let length = frame.normal[i].iter().map(|x| x * x).sum::<f32>().sqrt();
        let wanted = f32::from(u8::from(!sky(i)));
        length.is_nan() || (length - wanted).abs() >= UNIT
    });
    let position = frame.positions(&plan.picture_rays());
    bad("position", &|i| position[i].iter().any(|x| !x.is_finite()));
    let limit = plan.visits() * plan.ray_steps(&solid(plan));
    bad("evaluations", &|i| frame.work[i].evaluations > limit);
    for level in &frame.levels {
        let layer = format!("fronts of 1/{}", level.divisor);
        bad(&layer, &|i| {
            level.front.get(i).is_some_and(|front| negative(*front))
        });
    }
    found
}

/// Share of pixels for which something holds of their number and their ray.
fn share(plan: &Plan, holds: impl Fn(usize, &Beam) -> bool) -> f64 {
    let all: Vec<bool> = rays(plan)
        .enumerate()
        .map(|(i, ray)| holds(i, &ray))
        .collect();
    all.iter().filter(|held| **held).count() as f64 / all.len() as f64
}

/// Share of pixels in which two frames differ: another state, or depths by over two
/// footprints.
pub fn apart(plan: &Plan, a: &Frame, b: &Frame) -> f64 {
    share(plan, |i, ray| {
        let [s, t] = [a.depth[i], b.depth[i]].map(f64::from);
        let far = a.state[i] == HIT && (s - t).abs() > APART * footprint(ray, s.max(t));
        a.state[i] != b.state[i] || far
    })
}

/// What a ray truly meets: the equations' answer for solids, else tiny steps in f64.
pub fn reference(plan: &Plan) -> Frame {
    if solids(plan).is_some() {
        return solved(plan).0;
    }
    let mut plan = plan.clone();
    plan.march.mode = Mode::Truth;
    plan.march.clip = Some(true);
    plan.march.steps = Some(1024);
    on_cpu(&plan, LEVELS)
}

/// Share of pixels of a frame that miss what the reference hits, or hit over two
/// footprints behind it. What is unconverged is neither.
pub fn wrong(plan: &Plan, frame: &Frame, reference: &Frame) -> f64 {
    share(plan, |i, ray| {
        let [t, t_ref] = [frame.depth[i], reference.depth[i]].map(f64::from);
        let behind = t - t_ref > (APART * footprint(ray, t_ref)).max(f64::from(f32::MIN_POSITIVE));
        let ended = frame.state[i] != UNCONVERGED && reference.state[i] == HIT;
        ended && (frame.state[i] != HIT || behind)
    })
}

/// How a plan comes out; shares of pixels, of the worse executor.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Between the executors.
    pub apart: f64,
    /// Against the reference, on the GPU.
    pub wrong_gpu: f64,
    /// Against the reference, on the CPU.
    pub wrong_cpu: f64,
    /// Limits reached.
    pub unconverged: f64,
    /// Hits of the CPU.
    pub hits: f64,
    /// Whether the program warns that f32 does not hold what is asked for.
    pub warned: bool,
}

/// Renders a plan on both executors, with its reference, and measures.
///
/// # Panics
/// Where a layer holds what no layer may.
pub fn strain(what: &str, plan: &Plan) -> Outcome {
    let frames = both(plan);
    for (frame, name) in frames.iter().zip(["GPU", "CPU"]) {
        assert_eq!(faults(plan, frame), [""; 0], "{what}, on the {name}");
    }
    let truth = reference(plan);
    let [gpu, cpu] = &frames;
    let share = |f: &Frame, s: usize| f.census()[s] as f64 / f.state.len() as f64;
    Outcome {
        apart: apart(plan, gpu, cpu),
        wrong_gpu: wrong(plan, gpu, &truth),
        wrong_cpu: wrong(plan, cpu, &truth),
        unconverged: share(gpu, 2).max(share(cpu, 2)),
        hits: share(cpu, 1),
        warned: plan.precision_warning().is_some(),
    }
}
