//! The tracers' shaders against the exact first hit in f64: nothing is skipped, and hits
//! lie where they should.
//!
//! f32 rounds heights along the ray by about 1e-7 of the distances in play, so that a ray
//! which passes a summit within that may or may not meet it. A hit counts as skipped only
//! if the truth still meets the surface lowered by 1e-5 of its height.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test may panic, and is read by its name"
)]

mod adapter;
#[allow(dead_code, reason = "other files use the rest")]
mod common {
    pub mod probe;
    pub mod random;
    pub mod reference_maps;
    pub mod relief_rays;
}

use std::sync::Arc;

use common::probe::{Errors, Numbers, Probe, probe};
use common::reference_maps;
use common::relief_rays::{Case, case, exact, rays, run};
use conemarch::base::shader::Program;
use conemarch::heightfield::conemap::{ConeMap, MapKind};
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::pattern::Pattern;
use conemarch::heightfield::tracer::cones::{Cones, Lookup, Manner};
use conemarch::heightfield::tracer::linear::LinearBinary;
use conemarch::heightfield::tracer::oracle::Oracle;
use conemarch::heightfield::tracer::walk::Walk;
use conemarch::heightfield::tracer::walk_mip::{WalkMip, node_cones};
use conemarch::heightfield::tracer::{AnyTracer, LocalRay, SURFACE, Step, Tracer};
use conemarch::wgsl;
use glam::DVec3;
use wgpu::naga::valid::Capabilities;

/// No ray here is longer.
const END: f64 = 1e7;
/// Steps that a ray may take on the device.
const STEPS: f32 = 4096.0;

fn reliefs() -> Vec<Case> {
    use Patches::{Bilinear, Boxes};
    vec![
        case(Pattern::Fbm, [128, 96], [false; 2], [1, 1], Bilinear),
        case(Pattern::Spikes, [64, 64], [true; 2], [3, 2], Bilinear),
        case(Pattern::Noise, [33, 64], [false, true], [1, 2], Bilinear),
        case(Pattern::Checker, [64, 48], [false; 2], [1, 1], Bilinear),
        case(Pattern::Ridges, [64, 65], [true, false], [1, 1], Boxes),
        case(Pattern::Sine, [5, 3], [false; 2], [1, 1], Bilinear),
    ]
}

/// The probe of a tracer.
fn probe_of(tracer: &impl Tracer) -> Probe {
    let mut modules = tracer.modules();
    modules.push(wgsl!("pass/shared.wgsl"));
    modules.push(wgsl!("base/counters_off.wgsl"));
    modules.push(probe!("relief"));
    Probe {
        modules,
        parameters: tracer.buffers(),
    }
}

/// A ray as f32 holds it.
fn narrow(ray: &LocalRay) -> LocalRay {
    LocalRay {
        origin: ray.origin.as_vec3().as_dvec3(),
        axis: ray.axis.as_vec3().as_dvec3(),
    }
}

fn question(ray: &LocalRay) -> Numbers {
    let [o, d] = [ray.origin, ray.axis].map(|v: DVec3| v.as_vec3());
    [
        [o.x, o.y, o.z, 0.0],
        [d.x, d.y, d.z, END as f32],
        [STEPS, 0.0, 0.0, 0.0],
    ]
}

/// What the device says: the state of its pass, s, and the hit's id.
fn answers(probe: &Probe, rays: &[LocalRay]) -> Vec<(u32, f64, u32)> {
    let asked: Vec<Numbers> = rays.iter().map(question).collect();
    let of = |a: &Numbers| {
        let [s, state, low, high] = a[0];
        (state as u32, f64::from(s), low as u32 | (high as u32) << 16)
    };
    probe.ask(&asked).iter().map(of).collect()
}

/// The same relief, its surface lowered by 1e-5 of the whole height.
fn lowered(relief: &HeightSurface) -> Arc<HeightSurface> {
    let heights = relief.heights();
    let low = heights.data().iter().map(|h| (h - 1e-5).max(0.0)).collect();
    let tiles = [0, 1].map(|a| relief.domain()[a] as u32 / relief.cells()[a]);
    let heights = Heights::new(heights.size(), heights.wrap(), low).unwrap();
    Arc::new(HeightSurface::new(heights, relief.patches(), tiles).unwrap())
}

/// Skipped hits, rays that do not end, and the errors of the others in texels.
fn measure(relief: &Arc<HeightSurface>, probe: &Probe, count: u64) -> (u32, u32, Errors) {
    let all: Vec<_> = rays(relief, count, 21).iter().map(narrow).collect();
    let (oracle, low) = (Oracle::new(relief.clone()), Oracle::new(lowered(relief)));
    let (mut skipped, mut unconverged) = (0, 0);
    let mut errors = Vec::new();
    for (ray, (state, s, id)) in all.iter().zip(answers(probe, &all)) {
        let (step, truth, _) = run(&oracle, ray, END).unwrap();
        unconverged += u32::from(state > 1);
        let pace = ray.axis.truncate().length();
        let late = |truth: f64| state != 1 || (s - truth) * pace > 1.0;
        if step == Step::Hit && late(truth.s) {
            let (step, truth, _) = run(&low, ray, END).unwrap();
            skipped += u32::from(step == Step::Hit && late(truth.s));
        } else if step == Step::Hit && state == 1 {
            errors.push((((s - truth.s) * pace) as f32, 0.0));
            // The same cell but for hits on its edge.
            let near = ((s - truth.s) * pace).abs() < 1e-6;
            let inside = truth.uv.iter().all(|u| (1e-3..=0.999).contains(u));
            assert!(
                !(near && inside && truth.face() == SURFACE) || id == truth.id,
                "{ray:?}"
            );
        }
    }
    (skipped, unconverged, Errors::of(errors, 1.0))
}

#[test]
fn shaders_skip_nothing_and_hit_where_they_should() {
    for case in reliefs() {
        for (name, tracer) in exact(&case.relief) {
            let (skipped, unconverged, errors) = measure(&case.relief, &probe_of(&tracer), 9000);
            println!("{}, {name}: {skipped} skipped, {errors}", case.name);
            assert_eq!((skipped, unconverged), (0, 0), "{}, {name}", case.name);
            assert!(errors.p99 < 0.01, "{}, {name}: {errors:?}", case.name);
        }
    }
}

#[test]
fn the_check_sees_cones_that_are_too_wide() {
    let case = case(
        Pattern::Spikes,
        [64, 64],
        [true; 2],
        [2, 2],
        Patches::Bilinear,
    );
    let map = reference_maps::walk(&case.relief, 1.5);
    let wide = ConeMap {
        ratios: map.ratios.iter().map(|r| 1.5 * r).collect(),
        ..map
    };
    let walk = Walk::new(case.relief.clone(), Arc::new(wide)).unwrap();
    let (skipped, ..) = measure(&case.relief, &probe_of(&walk), 9000);
    assert!(skipped > 0);
}

#[test]
fn inexact_shaders_agree_with_their_twins() {
    for case in reliefs() {
        let relief = &case.relief;
        let all: Vec<_> = rays(relief, 6000, 22).iter().map(narrow).collect();
        for (name, tracer) in inexact(relief) {
            let told = answers(&probe_of(&tracer), &all);
            let mut apart = 0;
            for (ray, (state, s, _)) in all.iter().zip(&told) {
                let (step, own, _) = run(&tracer, ray, END).unwrap();
                let code = match step {
                    Step::Out => 0,
                    Step::Hit => 1,
                    Step::Spent | Step::Moving => 2,
                };
                let way = (s - own.s).abs() * ray.axis.truncate().length();
                apart += u32::from(code != *state || (code == 1 && way > 0.01));
            }
            // Thresholds that f32 may take on either side; 75 at most were measured.
            println!("{}, {name}: {apart} of 6000 apart", case.name);
            assert!(apart < 90, "{}, {name}: {apart} apart", case.name);
        }
    }
}

/// The walk for distant views, over cells alone and over nodes that soon or late grow with
/// the distance: rays have a height or a texel to a unit of their parameter.
fn distant(relief: &Arc<HeightSurface>) -> Vec<(String, AnyTracer)> {
    let map = Arc::new(reference_maps::walk(relief, 1.5));
    let cells = |lod: f64| {
        let tracer = WalkMip::new(relief.clone(), map.clone(), lod).unwrap();
        (format!("walk-mip {lod}"), AnyTracer::WalkMip(tracer))
    };
    let nodes = |lod: f64| {
        let nodes = node_cones(relief, &map).unwrap();
        let tracer = WalkMip::of_nodes(relief.clone(), map.clone(), nodes, lod).unwrap();
        (format!("cone-mip {lod}"), AnyTracer::WalkMip(tracer))
    };
    let all = [0.0, 0.1, 3.0].map(|lod| [cells(lod), nodes(lod)]);
    all.into_iter().flatten().collect()
}

#[test]
fn the_shader_for_distant_views_passes_no_first_hit() {
    for case in reliefs() {
        for (name, tracer) in distant(&case.relief) {
            let (skipped, unconverged, _) = measure(&case.relief, &probe_of(&tracer), 9000);
            assert_eq!((skipped, unconverged), (0, 0), "{}, {name}", case.name);
        }
    }
}

/// The tracers that are not exact, every feature of their shaders switched both ways.
fn inexact(relief: &Arc<HeightSurface>) -> Vec<(String, AnyTracer)> {
    let linear = LinearBinary::new(relief.clone(), 32, 6);
    let mut all = distant(relief);
    all.push(("linear-binary".into(), AnyTracer::LinearBinary(linear)));
    for manner in Manner::ALL {
        let kind = manner.kinds()[0];
        let map = Arc::new(reference_maps::samples(relief, kind));
        for lookup in [Lookup::Nearest, Lookup::Bilinear] {
            let own = Manner { lookup, ..manner };
            let tracer = Cones::new(relief.clone(), map.clone(), own).unwrap();
            all.push((
                format!("{} {lookup:?}", manner.name),
                AnyTracer::Cones(tracer),
            ));
        }
    }
    all
}

#[test]
fn every_module_of_a_tracer_is_valid() {
    for case in reliefs() {
        let mut tracers: Vec<_> = inexact(&case.relief);
        tracers.extend(exact(&case.relief).into_iter().map(|(n, t)| (n.into(), t)));
        for (name, tracer) in tracers {
            let mut modules = probe_of(&tracer).modules;
            modules.push(probe!("frame"));
            let program = Program::new("probe", modules);
            let valid = program.validate(Capabilities::default());
            assert!(valid.is_ok(), "{name}: {}", valid.unwrap_err());
        }
    }
    // The maps of the other kinds have a place in the list above.
    let kinds: Vec<MapKind> = Manner::ALL.iter().map(|m| m.kinds()[0]).collect();
    assert!(kinds.contains(&MapKind::Quad) && kinds.contains(&MapKind::Relaxed));
}
