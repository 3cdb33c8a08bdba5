//! The shaders and their twins in Rust agree: the layout of every struct that both read,
//! and the values of their functions, f32 on the GPU against f64 on the CPU.
//!
//! Values are compared by quantile, never by the largest error: next to a fold or a
//! threshold f32 may well take the other side. Each comparison is made once more with
//! one constant moved by a ten-thousandth, and must then fail.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test may panic, and is read by its name"
)]

mod adapter;
mod common {
    pub mod layout;
    pub mod plans;
    pub mod probe;
    pub mod random;
    pub mod setups;
}

use common::layout::{Layout, layout};
use common::plans::every_program;
use common::probe::{Allowed, Errors, Numbers, Probe, agree_unless_moved, probe};
use common::random::Random;
use common::setups::{
    MOVED, balls, beams, four, lit_probe_of, look_parameter, mandelboxes, narrow, points, probe_of,
    shape_plan, slab_plan, three,
};
use conemarch::cone::ConeRule;
use conemarch::formula::Shape;
use conemarch::formula::balls::BallsUniform;
use conemarch::formula::mandelbox::{Mandelbox, MandelboxUniform};
use conemarch::formula::rotation::RotationUniform;
use conemarch::frame::Work;
use conemarch::pass::look::LookUniform;
use conemarch::pass::march::LevelUniform;
use conemarch::pass::queue::{COUNT_AT, Turn};
use conemarch::pass::{fog, look, occlusion, shadow};
use conemarch::plan::Plan;
use conemarch::scene::distance::{DistanceUniform, Relaxation};
use conemarch::scene::slab::{SlabShape, SlabUniform};
use conemarch::scene::{Hit, Scene, Solid, Step, Surface};
use conemarch::view::{Beam, ViewUniform, footprint};
use glam::DVec3;

/// Every struct of parameters, as Rust lays it out.
fn layouts() -> Vec<(&'static str, Layout)> {
    vec![
        layout!(ViewUniform {
            right, pixel, up, slack, forward, pad, size, block_origin, block_size, pad2
        }),
        layout!(MandelboxUniform {
            julia, scale, fold_limit, min2, fixed2, bail2, reach, tail, classic_reach, classic_skin
        }),
        layout!(BallsUniform { ball0, ball1, ball2, box0, box1, rod }),
        layout!(RotationUniform { row0, pad0, row1, pad1, row2, pad2 }),
        layout!(DistanceUniform {
            eye, detail, centre, radius, half, far, lipschitz, shell, relaxation, stride,
            iterations, clip, pad0, pad1
        }),
        layout!(SlabUniform { eye, half, normal, radius, side, far, other, pad }),
        layout!(LevelUniform { divisor, fudge, origin, cells, children }),
        layout!(LookUniform {
            light, key, light_color, fill, sky_high, fog, sky_low, gloss, world_up, softness,
            occlusion_reach, occlusion_strength, shadow_steps, stops, palette_cycles, flag, pad,
            palette
        }),
    ]
}

/// The layout of a WGSL struct in the first program that has it.
fn in_any_program(name: &str) -> Layout {
    let programs = every_program();
    let found = programs.values().find_map(|p| Layout::in_wgsl(p, name));
    found.unwrap_or_else(|| panic!("no program has a struct {name}"))
}

#[test]
fn structs_have_the_layout_that_the_shaders_read() {
    for (name, own) in layouts() {
        assert!(own.complete(), "{name}: a field is not listed, or there is a gap");
        let wgsl = in_any_program(name);
        assert_eq!(own, wgsl, "{name}");
        // The same comparison sees a field that is moved, renamed, resized or lost.
        let mut shifted = own.clone();
        shifted.fields[1].1 += 4;
        assert_ne!(shifted, wgsl, "{name}");
        let mut swapped = own.clone();
        let (first, second) = (own.fields[0].0.clone(), own.fields[1].0.clone());
        swapped.fields[0].0 = second;
        swapped.fields[1].0 = first;
        assert_ne!(swapped, wgsl, "{name}");
        let mut lost = own.clone();
        lost.fields.pop();
        assert_ne!(lost, wgsl, "{name}");
        assert!(!lost.complete());
    }
}

#[test]
fn a_turn_leads_both_queues() {
    let (_, turn) = layout!(Turn { chunk, done, limit, row, parent_width, listed });
    assert!(turn.complete());
    for name in ["Turn", "Queue"] {
        let queue = in_any_program(name);
        let led = queue.fields.len() - 2;
        assert_eq!(queue.fields[..led], turn.fields, "{name}");
        let count = &queue.fields[led];
        assert_eq!((count.0.as_str(), count.1 as u64), ("count", COUNT_AT), "{name}");
        let cells = &queue.fields[led + 1];
        assert_eq!((cells.0.as_str(), cells.1), ("cells", count.1 + 4), "{name}");
        assert_ne!(queue.fields[1..led], turn.fields[..led - 1]);
    }
}

#[test]
fn no_struct_of_parameters_is_left_out() {
    let listed: Vec<&str> = layouts().into_iter().map(|l| l.0).chain(["Turn"]).collect();
    let mut folders = vec![std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src")];
    let mut found = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            for part in text.split("#[repr(C)]").skip(1) {
                let after = part.split("pub struct ").nth(1).unwrap();
                let name = after.split([' ', '(', '<']).next().unwrap();
                assert!(listed.contains(&name), "{name} in {}", path.display());
                found += 1;
            }
        }
    }
    assert_eq!(found, listed.len());
}

/// What a formula's estimate and traps may be off by, from its shaders' and its own.
fn formula_errors(gpu: &Shape, cpu: &Shape) -> [Errors; 2] {
    const ITERATIONS: u32 = 6;
    let asked = points(&**cpu, ITERATIONS, 1);
    let plan = shape_plan(gpu.clone(), ITERATIONS, DVec3::new(9.0, 0.0, 0.0));
    let told = probe_of(&plan, probe!("formula")).ask(&asked);
    let mut estimates = Vec::new();
    let mut traps = Vec::new();
    for (q, a) in asked.iter().zip(&told) {
        let p = three(q[0]);
        estimates.push((a[0][0], cpu.estimate(p, ITERATIONS).0));
        let trap = cpu.trap(p, ITERATIONS);
        traps.extend((0..3).map(|i| (a[1][i], trap[i])));
    }
    [Errors::of(estimates, 0.01), Errors::of(traps, 0.01)]
}

#[test]
fn mandelboxes_agree() {
    for (name, own) in mandelboxes() {
        let own = Shape::Mandelbox(own);
        let scaled = |f: &dyn Fn(&mut Mandelbox)| {
            let Shape::Mandelbox(mut m) = own.clone() else {
                unreachable!("made above");
            };
            f(&mut m);
            Shape::Mandelbox(m)
        };
        let [e, t] = formula_errors(&own, &own);
        let moved = scaled(&|m| m.scale *= MOVED);
        let [em, _] = formula_errors(&moved, &own);
        let allowed = Allowed { median: 2e-6, p99: 6e-5 };
        agree_unless_moved(&format!("estimate, {name}"), allowed, e, em);
        let moved = scaled(&|m| m.fold_limit *= MOVED);
        let [_, tm] = formula_errors(&moved, &own);
        let allowed = Allowed { median: 6e-7, p99: 6e-4 };
        agree_unless_moved(&format!("trap, {name}"), allowed, t, tm);
    }
}

#[test]
fn balls_agree() {
    let [e, t] = formula_errors(&balls(1.0), &balls(1.0));
    let [em, _] = formula_errors(&balls(MOVED), &balls(1.0));
    let allowed = Allowed { median: 2e-7, p99: 2e-6 };
    agree_unless_moved("estimate, balls", allowed, e, em);
    // Their traps read no parameter: nothing to move, but still nothing to get wrong.
    assert!(t.within(allowed), "{t:?}");
}

/// Fronts, samples, balls and chords, most of them near the edge of progress.
fn cones(count: usize, near: f64, seed: u64) -> Vec<Numbers> {
    let mut random = Random::new(seed);
    let of = |i: usize| {
        let t = narrow(10.0_f64.powf(random.between(-2.0, 2.0)));
        let k = narrow(2.0 * random.unit().powi(2)).max(1e-4);
        // Every other sample is taken ahead of the front.
        let front = if i.is_multiple_of(2) { t } else { t * random.between(0.7, 1.0) };
        let d = k * t * (1.0 + near * random.between(-1.0, 1.0));
        [four(DVec3::new(front, t, d), k), [0.0; 4], [0.0; 4]]
    };
    (0..count).map(of).collect()
}

fn cone_probe() -> Probe {
    Probe {
        modules: vec![ConeRule::Exact.module(), probe!("cone")],
        parameters: Vec::new(),
    }
}

#[test]
fn the_cone_step_agrees() {
    let asked = cones(8192, 0.9, 2);
    let errors = |probe: Probe| {
        let told = probe.ask(&asked);
        let want = |q: &Numbers| {
            let [front, t, d, k] = q[0].map(f64::from);
            ConeRule::Exact.cone_front(front, t, d, k)
        };
        Errors::of(told.iter().zip(&asked).map(|(a, q)| (a[0][0], want(q))), 1e-9)
    };
    let allowed = Allowed { median: 2e-7, p99: 1e-6 };
    let own = errors(cone_probe());
    for name in ["CONE_TRUST", "CONE_ROUND_DOWN"] {
        let moved = errors(cone_probe().with_constant_scaled(name, 1.0 / MOVED));
        agree_unless_moved(&format!("cone_front, {name}"), allowed, own, moved);
    }
    let mut slides = cone_probe();
    slides.modules[0] = ConeRule::Slides.module();
    assert!(!errors(slides).within(allowed));
}

/// The front that one empty ball proves, without regard to rounding.
fn exact_front(front: f64, t: f64, d: f64, k: f64) -> f64 {
    let q = d * d - t * t * (k * k - 0.25 * k.powi(4));
    let middle = t * (1.0 - 0.5 * k * k);
    if d <= 0.0 || q < 0.0 || middle - q.sqrt() > front {
        return front;
    }
    front.max(middle + q.sqrt())
}

#[test]
fn f32_never_claims_more_than_the_exact_front() {
    // The ball's radius within a hundred-thousandth of k t, the edge of progress.
    let asked = cones(100_000, 1e-5, 3);
    let beyond = |probe: Probe| {
        let told = probe.ask(&asked);
        let past = told.iter().zip(&asked).filter(|(a, q)| {
            let [front, t, d, k] = q[0].map(f64::from);
            f64::from(a[0][0]) > exact_front(front, t, d, k)
        });
        past.count()
    };
    assert_eq!(beyond(cone_probe()), 0);
    // Without its two factors f32 does claim more.
    let mut raw = cone_probe();
    for constant in &mut raw.modules[0].constants {
        constant.1 = 1.0;
    }
    assert!(beyond(raw) > 10);
}

#[test]
fn rays_and_cones_of_the_view_agree() {
    let of = |fov: f64| {
        let mut plan = slab_plan(SlabShape::default());
        plan.camera.fov = fov;
        plan.size = [1366, 768];
        plan
    };
    let mut random = Random::new(4);
    let question = |i: u32| {
        let x = random.between(0.0, 1366.0).floor();
        let y = random.between(0.0, 768.0).floor();
        let divisor = f64::from(2_u32 << (i % 5));
        [four(DVec3::new(x, y, divisor), 0.0), [0.0; 4], [0.0; 4]]
    };
    let asked: Vec<Numbers> = (0..8192).map(question).collect();
    for fov in [1.0, 48.5, 170.0] {
        let view = of(fov).view();
        let errors = |gpu: &Plan| {
            let told = probe_of(gpu, probe!("view")).ask(&asked);
            let (mut axes, mut chords, mut grains) = (vec![], vec![], vec![]);
            for (q, a) in asked.iter().zip(&told) {
                let [x, y, d, _] = q[0].map(|n| n as u32);
                let (ray, cone) = (view.view_ray([x, y]), view.view_cone([x / d, y / d], d));
                axes.extend((0..3).flat_map(|i| [(a[0][i], ray.axis[i]), (a[1][i], cone.axis[i])]));
                chords.push((a[2][0], cone.k));
                grains.extend([(a[0][3], ray.grain), (a[1][3], cone.grain)]);
                assert_eq!((a[2][1], a[2][2]), (0.0, 0.0));
            }
            [Errors::of(axes, 1.0), Errors::of(chords, 0.0), Errors::of(grains, 0.0)]
        };
        let own = errors(&of(fov));
        let moved = errors(&of(fov * MOVED));
        let allowed = Allowed { median: 3e-7, p99: 1e-6 };
        let names = ["axes", "chords", "grains"];
        for (i, name) in names.iter().enumerate() {
            let name = format!("{name} at {fov} degrees");
            // In so narrow a view all axes are nearly one.
            if fov > 1.0 || i > 0 {
                agree_unless_moved(&name, allowed, own[i], moved[i]);
            }
            assert!(own[i].within(allowed), "{name}: {:?}", own[i]);
        }
    }
}

/// The beam of a question.
fn beam(q: &Numbers) -> Beam {
    Beam {
        origin: three(q[0]),
        axis: three(q[1]),
        r0: f64::from(q[2][0]),
        k: f64::from(q[1][3]),
        grain0: 0.0,
        grain: f64::from(q[2][1]),
    }
}

/// Errors of fronts, decisions, clearances, walks and hits of beams.
struct BeamErrors {
    advance: Errors,
    going: Errors,
    clearance: Errors,
    walk: Errors,
    step: Errors,
    mark: Errors,
}

fn beam_errors(gpu: &Plan, cpu: &Plan, steps: f64) -> BeamErrors {
    let asked = beams(cpu, 3.0, steps, 5);
    let told = probe_of(gpu, probe!("beam")).ask(&asked);
    match cpu.scene() {
        Scene::Distance(s) => beam_errors_of(&s, &asked, &told),
        Scene::Slab(s) => beam_errors_of(&s, &asked, &told),
    }
}

fn beam_errors_of<S: Solid>(solid: &S, asked: &[Numbers], told: &[Numbers]) -> BeamErrors {
    let (mut fronts, mut going, mut clear) = (vec![], vec![], vec![]);
    let (mut walks, mut ends, mut marks) = (vec![], vec![], vec![]);
    for (q, a) in asked.iter().zip(told) {
        let (ray, front, work) = (beam(q), f64::from(q[0][3]), &mut Work::default());
        let next = solid.advance(&ray, front, work);
        fronts.push((a[0][0], next.front));
        going.push((a[0][1], f64::from(u8::from(next.going))));
        clear.push((a[0][2], solid.clearance(ray.at(front))));
        let mut walk = solid.begin(&ray, front, f64::from(q[2][2]), work);
        let mut step = Step::Moving;
        for _ in 0..q[2][3] as u32 {
            step = solid.walk_step(&ray, &mut walk, work);
            if step != Step::Moving {
                break;
            }
        }
        let state = match step {
            Step::Moving => 3.0,
            Step::Hit => 1.0,
            Step::Out => 0.0,
        };
        let hit = solid.walk_hit(&walk);
        walks.extend([(a[1][0], hit.t), (a[1][3], solid.walk_radius(&walk))]);
        ends.push((a[1][1], state));
        marks.extend([(a[1][2], f64::from(hit.id)), (a[2][0], hit.uv[0]), (a[2][1], hit.uv[1])]);
    }
    BeamErrors {
        advance: Errors::of(fronts, 0.1),
        going: Errors::of(going, 1.0),
        clearance: Errors::of(clear, 0.1),
        walk: Errors::of(walks, 0.1),
        step: Errors::of(ends, 1.0),
        mark: Errors::of(marks, 0.1),
    }
}

#[test]
fn beams_in_a_distance_scene_agree() {
    let eye = DVec3::new(1.0, -6.0, 2.5);
    let of = |factor: f64, stride: f64, relaxation| {
        let mut plan = shape_plan(balls(factor), 1, eye);
        plan.march.stride = Some(stride);
        plan.march.relaxation = relaxation;
        plan
    };
    let allowed = Allowed { median: 1e-6, p99: 1e-5 };
    for relaxation in [Relaxation::Auto, Relaxation::Off, Relaxation::Factor(1.4)] {
        for steps in [1.0, 4.0, 9.0] {
            let cpu = of(1.0, 0.9, relaxation);
            let own = beam_errors(&cpu, &cpu, steps);
            let moved = beam_errors(&of(MOVED, 0.9, relaxation), &cpu, steps);
            let name = format!("after {steps} steps, {relaxation:?}");
            agree_unless_moved(&format!("advance {name}"), allowed, own.advance, moved.advance);
            agree_unless_moved(&format!("clearance {name}"), allowed, own.clearance, moved.clearance);
            let strides = beam_errors(&of(1.0, 0.9 * MOVED, relaxation), &cpu, steps);
            agree_unless_moved(&format!("walk {name}"), allowed, own.walk, strides.walk);
            // Decisions agree but for a few at a threshold.
            let few = Allowed { median: 0.0, p99: 0.0 };
            assert!(own.going.within(few) && own.step.within(few), "{name}");
        }
    }
}

#[test]
fn beams_in_a_mandelbox_agree() {
    let of = |scale: f64| {
        let m = Mandelbox { scale, ..Mandelbox::default() };
        shape_plan(Shape::Mandelbox(m), 8, DVec3::new(3.0, -12.0, 5.0))
    };
    let own = beam_errors(&of(2.0), &of(2.0), 4.0);
    let moved = beam_errors(&of(2.0 * MOVED), &of(2.0), 4.0);
    let allowed = Allowed { median: 1e-5, p99: 2e-4 };
    agree_unless_moved("advance, mandelbox", allowed, own.advance, moved.advance);
    agree_unless_moved("walk, mandelbox", allowed, own.walk, moved.walk);
}

#[test]
fn the_part_of_a_ray_near_the_bounds_agrees() {
    let of = |scale: f64| {
        let m = Mandelbox { scale, rotation: DVec3::X, ..Mandelbox::default() };
        shape_plan(Shape::Mandelbox(m), 6, DVec3::new(9.0, -17.0, 8.0))
    };
    let plan = of(2.0);
    let Scene::Distance(scene) = plan.scene() else {
        unreachable!("a distance scene");
    };
    let mut random = Random::new(6);
    let question = |_| {
        let axis = (random.cube(12.0) - plan.camera.eye).normalize();
        let margin = random.between(0.0, 0.1);
        [four(random.cube(0.1), margin), four(axis, 0.0), [0.0; 4]]
    };
    let asked: Vec<Numbers> = (0..8192).map(question).collect();
    let errors = |gpu: &Plan| {
        let told = probe_of(gpu, probe!("interval")).ask(&asked);
        let pair = |(q, a): (&Numbers, &Numbers)| {
            let (near, far) = scene.bounds_interval(&beam(q), f64::from(q[0][3]));
            [(a[0][0], near), (a[0][1], far)]
        };
        Errors::of(asked.iter().zip(&told).flat_map(pair), 1.0)
    };
    let allowed = Allowed { median: 3e-6, p99: 2e-5 };
    agree_unless_moved("bounds_interval", allowed, errors(&plan), errors(&of(2.0 * MOVED)));
    // What f32 finds holds what f64 finds: nothing within the bounds is cut off.
    let told = probe_of(&plan, probe!("interval")).ask(&asked);
    for (q, a) in asked.iter().zip(&told) {
        let (near, far) = scene.bounds_interval(&beam(q), f64::from(q[0][3]));
        let held = f64::from(a[0][0]) <= near && f64::from(a[0][1]) >= far;
        assert!(near > far || held, "{near} {far} {a:?}");
    }
}

#[test]
fn the_slab_agrees() {
    let of = |factor: f64| {
        slab_plan(SlabShape {
            normal: DVec3::new(0.3, -0.2, 1.0),
            half: 0.5 * factor,
            radius: 6.0 * factor,
        })
    };
    let own = beam_errors(&of(1.0), &of(1.0), 1.0);
    let moved = beam_errors(&of(MOVED), &of(1.0), 1.0);
    let allowed = Allowed { median: 2e-7, p99: 1e-6 };
    agree_unless_moved("advance, slab", allowed, own.advance, moved.advance);
    agree_unless_moved("clearance, slab", allowed, own.clearance, moved.clearance);
    agree_unless_moved("walk, slab", allowed, own.walk, moved.walk);
    agree_unless_moved("mark, slab", allowed, own.mark, moved.mark);
    let few = Allowed { median: 0.0, p99: 0.0 };
    assert!(own.step.within(few) && own.going.within(few));
}

/// A change of a plan, by name.
type Change = (&'static str, fn(&mut Plan));

#[test]
fn palette_pigment_and_sky_agree() {
    let plan = slab_plan(SlabShape::default());
    let mut random = Random::new(7);
    let question = |_| {
        let x = random.between(-1.0, 4.0);
        let pigment = DVec3::new(random.unit(), random.unit(), random.unit());
        [four(DVec3::X * x, 0.0), four(random.direction(), 0.0), four(pigment, 0.0)]
    };
    let asked: Vec<Numbers> = (0..8192).map(question).collect();
    let light = plan.light();
    let errors = |gpu: &Plan| {
        let probe = Probe {
            modules: vec![look::module(), probe!("look")],
            parameters: vec![look_parameter(gpu)],
        };
        let told = probe.ask(&asked);
        let mut all = [vec![], vec![], vec![]];
        for (q, a) in asked.iter().zip(&told) {
            let want = [
                light.palette_at(f64::from(q[0][0])),
                light.sky(three(q[1])),
                light.pigment_color(three(q[2])),
            ];
            for (i, want) in want.into_iter().enumerate() {
                all[i].extend((0..3).map(|j| (a[i][j], want[j])));
            }
        }
        all.map(|pairs| Errors::of(pairs, 0.01))
    };
    let allowed = Allowed { median: 1e-6, p99: 1e-5 };
    let own = errors(&plan);
    let changes: [Change; 3] = [
        ("palette_at", |p| p.look.palette_cycles *= MOVED),
        ("sky", |p| {
            p.look.sky_high *= MOVED;
            p.look.sky_low *= MOVED;
        }),
        ("pigment_color", |p| p.look.palette_cycles *= MOVED),
    ];
    for (i, (name, change)) in changes.into_iter().enumerate() {
        let mut moved = plan.clone();
        change(&mut moved);
        agree_unless_moved(name, allowed, own[i], errors(&moved)[i]);
    }
}

/// Errors of a lit point: normal, pigment, shadow, occlusion, fog.
fn lit_errors<S: Solid>(solid: &S, cpu: &Plan, asked: &[Numbers], told: &[Numbers]) -> [Errors; 5] {
    let light = cpu.light();
    let mut all = [vec![], vec![], vec![], vec![], vec![]];
    for (q, a) in asked.iter().zip(told) {
        let ray = Beam { origin: DVec3::ZERO, grain: f64::from(q[1][3]), r0: 0.0, k: 0.0, ..beam(q) };
        let t = f64::from(q[0][3]);
        let at: Surface = solid.surface(&ray, &Hit { t, ..Hit::default() });
        let (point, normal, grain) = (three(q[0]), three(q[2]), footprint(&ray, t));
        let fogged = fog::fog(&light, DVec3::new(0.2, 0.5, 0.9), ray.axis, t);
        for i in 0..3 {
            all[0].push((a[0][i], at.normal[i]));
            all[1].push((a[1][i], at.pigment[i]));
            all[4].push((a[2][i], fogged[i]));
        }
        all[2].push((a[0][3], shadow::shadow(solid, &light, point, normal, grain)));
        all[3].push((a[1][3], occlusion::occlusion(solid, &light, point, normal, grain)));
    }
    all.map(|pairs| Errors::of(pairs, 0.1))
}

#[test]
fn surfaces_and_their_light_agree() {
    let eye = DVec3::new(1.0, -6.0, 2.5);
    let mut plan = shape_plan(balls(1.0), 1, eye);
    plan.look.fog = 1.0;
    plan.look.light_size = 20.0;
    plan.look.occlusion_reach = 0.3;
    let mut random = Random::new(8);
    let question = |_| {
        // Points on the sphere about the largest ball, seen from the eye.
        let normal = random.direction();
        let point = normal * random.between(1.001, 1.3) - eye;
        let (t, grain) = (point.length(), 0.002);
        [four(point, t), four(point / t, grain), four(normal, 0.0)]
    };
    let asked: Vec<Numbers> = (0..8192).map(question).collect();
    let Scene::Distance(scene) = plan.scene() else {
        unreachable!("a distance scene");
    };
    let errors = |gpu: &Plan| {
        let told = lit_probe_of(gpu, probe!("lit")).ask(&asked);
        lit_errors(&scene, &plan, &asked, &told)
    };
    let own = errors(&plan);
    let allowed = [
        ("normal", Allowed { median: 5e-5, p99: 5e-4 }),
        ("pigment", Allowed { median: 2e-6, p99: 3e-5 }),
        ("shadow", Allowed { median: 1e-6, p99: 5e-5 }),
        ("occlusion", Allowed { median: 1e-5, p99: 1e-4 }),
        ("fog", Allowed { median: 1e-6, p99: 1e-5 }),
    ];
    let changes: [Option<fn(&mut Plan)>; 5] = [
        None,
        None,
        Some(|p| p.look.light_size *= MOVED),
        Some(|p| p.look.occlusion *= MOVED),
        Some(|p| p.look.fog *= MOVED),
    ];
    for (i, (name, allowed)) in allowed.into_iter().enumerate() {
        let mut moved = plan.clone();
        match changes[i] {
            Some(change) => change(&mut moved),
            None => moved.camera.eye += DVec3::splat(0.05),
        }
        agree_unless_moved(name, allowed, own[i], errors(&moved)[i]);
    }
}
