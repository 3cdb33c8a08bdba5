//! What is asked of a picture however hard its plan is: measured on both executors and
//! against what is true.

use conemarch::scene::Assets;
use conemarch::scene::distance::DistanceSettings;
use std::time::{Duration, Instant};

use conemarch::base::work::State;
use conemarch::cpu;
use conemarch::gpu::RenderError;
use conemarch::pass::progress::Progress;
use conemarch::picture::frame::Frame;
use conemarch::plan::march::Mode;
use conemarch::plan::{Extras, Plan};

use super::solved::solved;

/// Every layer that there is.
pub const ALL: Extras = Extras {
    count: true,
    normals: true,
    levels: true,
    depth_only: false,
    time: false,
};

/// A render that takes longer than this hangs. The longest here takes some seconds on two
/// slow cores.
const PATIENCE: Duration = Duration::from_secs(60);

/// Footprints between two depths that count as apart, as in the error reports.
const APART: f64 = 2.0;

/// How a length of a normal may differ from 1: roundings of f32, with room.
const UNIT: f32 = 1e-4;

/// A watch that cancels what hangs.
fn patient() -> impl FnMut(&Progress) -> bool {
    let start = Instant::now();
    move |_| start.elapsed() < PATIENCE
}

/// A plan on the GPU and on the CPU, with every layer.
pub fn both(plan: &Plan) -> [Frame; 2] {
    let asked = plan.clone();
    let frame = crate::adapter::with(move |renderer| {
        renderer.cutting = Default::default();
        renderer.render(&asked, &Assets::default(), ALL, &mut patient())
    });
    [
        frame,
        cpu::render(plan, &Assets::default(), ALL, &mut patient()),
    ]
    .map(|made| match made {
        Ok(frame) => frame,
        Err(RenderError::Cancelled) => panic!("a render hangs: {plan:?}"),
        Err(e) => panic!("a render fails: {e}"),
    })
}

/// What is wrong with the layers of a frame in themselves: numbers that are none, normals
/// of no length, states that there are not.
pub fn faults(plan: &Plan, frame: &Frame) -> Vec<String> {
    let mut found = Vec::new();
    let mut bad = |layer: &str, count: usize| {
        if count > 0 {
            found.push(format!("{count} in {layer}"));
        }
    };
    let sky = |i: usize| frame.state[i] == State::Sky as u8;
    let count =
        |wrong: &dyn Fn(usize) -> bool| (0..frame.state.len()).filter(|i| wrong(*i)).count();
    bad(
        "state",
        count(&|i| State::from_code(u32::from(frame.state[i])).is_none()),
    );
    bad(
        "depth",
        count(&|i| {
            let t = frame.depth[i];
            if sky(i) {
                t != f32::INFINITY
            } else {
                !t.is_finite() || t < 0.0
            }
        }),
    );
    let light = |c: [f32; 3]| c.iter().any(|x| !x.is_finite() || *x < 0.0);
    bad("radiance", count(&|i| light(frame.radiance[i])));
    bad(
        "normal",
        count(&|i| {
            let length = frame.normal[i].iter().map(|x| x * x).sum::<f32>().sqrt();
            let wanted = f32::from(u8::from(!sky(i)));
            length.is_nan() || (length - wanted).abs() >= UNIT
        }),
    );
    let position = frame.positions(&plan.view());
    bad(
        "position",
        count(&|i| position[i].iter().any(|x| !x.is_finite())),
    );
    let limit = plan.ray_steps(&Assets::default());
    bad("evaluations", count(&|i| frame.work[i].evaluations > limit));
    for level in &frame.levels {
        let fronts = level.front.iter().filter(|f| !f.is_finite() || **f < 0.0);
        bad(&format!("fronts of 1/{}", level.divisor), fronts.count());
    }
    found
}

/// Share of pixels in which two frames differ: another state, or depths by over two
/// footprints.
pub fn apart(plan: &Plan, a: &Frame, b: &Frame) -> f64 {
    let view = plan.view();
    let width = plan.size[0] as usize;
    let differ = |i: &usize| {
        let i = *i;
        if a.state[i] != b.state[i] {
            return true;
        }
        let [s, t] = [a.depth[i], b.depth[i]].map(f64::from);
        let grain = view
            .view_ray([(i % width) as u32, (i / width) as u32])
            .grain;
        a.state[i] == State::Hit as u8 && (s - t).abs() > APART * grain * s.max(t)
    };
    let count = (0..a.state.len()).filter(differ).count();
    count as f64 / a.state.len() as f64
}

/// What a ray truly meets: the equations' answer for solids, else tiny steps in f64.
pub fn reference(plan: &Plan) -> Frame {
    if solids(plan) {
        return solved(plan).0;
    }
    let mut plan = plan.clone();
    plan.march.mode = Mode::Truth;
    plan.march.clip = Some(true);
    plan.march.steps = Some(1024);
    let extras = Extras {
        depth_only: true,
        ..Extras::default()
    };
    cpu::render(&plan, &Assets::default(), extras, &mut patient()).expect("the truth in time")
}

/// Whether a plan's picture is known in closed form.
pub fn solids(plan: &Plan) -> bool {
    use conemarch::formula::Formula;
    use conemarch::scene::Scene;
    match &plan.scene {
        Scene::Distance(DistanceSettings { formula: shape, .. }) => {
            matches!(shape, Formula::Balls(_))
        }
        Scene::Slab(_) => true,
        // Traced exactly: there are no tiny steps to compare with.
        Scene::Heightfield(_) => false,
    }
}

/// Share of pixels of a frame that miss what the reference hits, or hit over two
/// footprints behind it. What is unconverged is neither.
pub fn wrong(plan: &Plan, frame: &Frame, reference: &Frame) -> f64 {
    let view = plan.view();
    let width = plan.size[0] as usize;
    let hit = State::Hit as u8;
    let missed = |i: &usize| {
        let i = *i;
        if reference.state[i] != hit || frame.state[i] == State::Unconverged as u8 {
            return false;
        }
        let [t, t_ref] = [frame.depth[i], reference.depth[i]].map(f64::from);
        let grain = view
            .view_ray([(i % width) as u32, (i / width) as u32])
            .grain;
        frame.state[i] != hit || t - t_ref > APART * grain * t_ref.max(f64::from(f32::MIN_POSITIVE))
    };
    let count = (0..frame.state.len()).filter(missed).count();
    count as f64 / frame.state.len() as f64
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
    plan.check().unwrap_or_else(|e| panic!("{what}: {e:?}"));
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
