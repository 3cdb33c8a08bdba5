//! The tracers' shaders against the exact first hit in f64: they skip nothing, and hits lie where
//! they should.
//!
//! f32 rounds heights along the ray by about 1e-7 of the distances, so that a ray which passes a
//! summit within that may or may not meet it. So a hit counts as skipped only if the truth also
//! meets the surface lowered by 1e-5 of its height.

use std::sync::Arc;

use bytemuck::bytes_of;
use conemarch::base::outcome::{self, Counts};
use conemarch::base::shader::Program;
use conemarch::heightfield::conemap::MapKind;
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::Patches;
use conemarch::heightfield::pattern::Pattern;
use conemarch::heightfield::tracer::{Accuracy, LocalRay, SURFACE, Step, Tracer, TracerKind};
use glam::DVec3;
use wgpu::naga::valid::Capabilities;

use crate::cases::{Case, Named, case, rays, reference_map, run, surface, tracer, tracers};
use crate::common::probe::{Numbers, Probe, is_software, probe};

/// No ray here is longer.
const END: f64 = 1e7;
/// Steps that a ray may take on the device.
const STEPS: f32 = 4096.0;

fn surfaces() -> Vec<Case> {
    use Patches::{Bilinear, Boxes};
    vec![
        case(Pattern::Fbm, ([128, 96], [false; 2], [1, 1], Bilinear)),
        case(Pattern::Spikes, ([64, 64], [true; 2], [3, 2], Bilinear)),
        case(Pattern::Noise, ([33, 64], [false, true], [1, 2], Bilinear)),
        case(Pattern::Checker, ([64, 48], [false; 2], [1, 1], Bilinear)),
        case(Pattern::Ridges, ([64, 65], [true, false], [1, 1], Boxes)),
        case(Pattern::Sine, ([5, 3], [false; 2], [1, 1], Bilinear)),
    ]
}

/// Every tracer in all its variants.
fn every_tracer(surface: &Arc<HeightSurface>) -> Vec<Named> {
    let all = [Accuracy::Exact, Accuracy::Pixel, Accuracy::Approximate];
    all.iter().flat_map(|a| tracers(surface, *a)).collect()
}

/// The probe of a tracer.
fn probe_of(tracer: &Tracer) -> Probe {
    let mut modules = tracer.modules();
    modules.extend(outcome::modules(false));
    modules.push(probe!("heightmap"));
    let arrays = tracer.arrays();
    let arrays = arrays.iter().map(|array| (array.name, array.bytes()));
    let own = bytes_of(&tracer.uniform()).to_vec();
    Probe {
        modules,
        parameters: arrays.chain([("heightmap_parameters", own)]).collect(),
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

/// The same surface, lowered by 1e-5 of the whole height.
fn lowered(own: &HeightSurface) -> Arc<HeightSurface> {
    let heights = own.heights();
    let low = heights.data().iter().map(|h| (h - 1e-5).max(0.0)).collect();
    let tiles = [0, 1].map(|a| own.domain()[a] as u32 / own.cells()[a]);
    surface((heights.size(), heights.wrap(), tiles, own.patches()), low)
}

/// Skipped hits, rays that do not end, and the 99th percentile of the others' errors in texels.
fn measure(surface: &Arc<HeightSurface>, tracer: &Tracer) -> (u32, u32, f64) {
    let all: Vec<_> = rays(surface, 9000, 21).iter().map(narrow).collect();
    let [reference, low] = [surface.clone(), lowered(surface)].map(Tracer::reference);
    let (mut skipped, mut unconverged) = (0, 0);
    let mut errors = Vec::new();
    for (ray, (state, s, id)) in all.iter().zip(answers(&probe_of(tracer), &all)) {
        let (step, truth, _) = run(&reference, ray, END).unwrap();
        unconverged += u32::from(state > 1);
        let pace = ray.axis.truncate().length();
        let late = |truth: f64| state != 1 || (s - truth) * pace > 1.0;
        if step == Step::Hit && late(truth.s) {
            let (step, truth, _) = run(&low, ray, END).unwrap();
            skipped += u32::from(step == Step::Hit && late(truth.s));
        } else if step == Step::Hit && state == 1 {
            let error = ((s - truth.s) * pace).abs();
            errors.push(error);
            // The same cell, but for hits on its edge.
            let near = error < 1e-6;
            let inside = truth.uv.iter().all(|u| (1e-3..=0.999).contains(u));
            let decided = near && inside && truth.face() == SURFACE;
            assert!(!decided || id == truth.id, "{ray:?}");
        }
    }
    errors.sort_by(f64::total_cmp);
    assert!(errors.len() >= 4096, "only {} hits", errors.len());
    (skipped, unconverged, errors[errors.len() * 99 / 100])
}

#[test]
fn shaders_skip_nothing_and_hit_where_they_should() {
    for case in surfaces() {
        for accuracy in [Accuracy::Exact, Accuracy::Pixel] {
            for own in tracers(&case.surface, accuracy) {
                let what = format!("{}, {}", case.name, own.name);
                let (skipped, unconverged, error) = measure(&case.surface, &own.tracer);
                println!("{what}: {skipped} skipped, error {error:.1e}");
                assert_eq!((skipped, unconverged), (0, 0), "{what}");
                let right = accuracy == Accuracy::Pixel || error < 0.01;
                assert!(right, "{what}: {error}");
            }
        }
    }
}

#[test]
fn the_check_sees_cones_that_are_too_wide() {
    let setting = ([64, 64], [true; 2], [2, 2], Patches::Bilinear);
    let case = case(Pattern::Spikes, setting);
    let mut map = reference_map(&case.surface, MapKind::Walk, 1.5);
    map.ratios.iter_mut().for_each(|r| *r *= 1.5);
    let walk = tracer(&case.surface, &TracerKind::Walk.into(), Some(Arc::new(map)));
    let (skipped, ..) = measure(&case.surface, &walk.unwrap());
    assert!(skipped > 0);
}

#[test]
fn inexact_shaders_agree_with_their_twins() {
    for case in surfaces() {
        let all: Vec<_> = rays(&case.surface, 6000, 22).iter().map(narrow).collect();
        for own in every_tracer(&case.surface) {
            if own.kind.facts().accuracy == Accuracy::Exact {
                continue;
            }
            let told = answers(&probe_of(&own.tracer), &all);
            let mut apart = 0;
            for (ray, (state, s, _)) in all.iter().zip(&told) {
                let (step, hit, _) = run(&own.tracer, ray, END).unwrap();
                let code = match step {
                    Step::Out => 0,
                    Step::Hit => 1,
                    Step::Spent | Step::Moving => 2,
                };
                let way = (s - hit.s).abs() * ray.axis.truncate().length();
                apart += u32::from(code != *state || (code == 1 && way > 0.01));
            }
            // Thresholds that f32 may take on either side. Software Vulkan had 75 at most, and an H200
            // 102.
            println!("{}, {}: {apart} of 6000 apart", case.name, own.name);
            let most = if is_software() { 90 } else { 120 };
            assert!(apart < most, "{}, {}: {apart} apart", case.name, own.name);
        }
    }
}

/// A shader that reads other cones than its twin may find the same hits, but not in as many steps.
#[test]
fn tracers_of_nodes_take_as_many_steps_on_the_device() {
    for case in surfaces() {
        let all: Vec<_> = rays(&case.surface, 2000, 23).iter().map(narrow).collect();
        for own in tracers(&case.surface, Accuracy::Pixel) {
            let asked: Vec<Numbers> = all.iter().map(question).collect();
            let answers = probe_of(&own.tracer).ask(&asked);
            let device: f64 = answers.iter().map(|a| f64::from(a[1][2])).sum();
            let steps = |ray: &LocalRay| {
                let (mut trace, mut work) = (own.tracer.begin(ray, 0.0, END), Counts::default());
                let mut step = || own.tracer.step(ray, &mut trace, &mut work);
                1 + std::iter::from_fn(|| (step() == Step::Moving).then_some(())).count()
            };
            let here = all.iter().map(steps).sum::<usize>() as f64;
            println!("{}, {}: {device} of {here} steps", case.name, own.name);
            let share = device / here;
            assert!(
                (0.99..1.01).contains(&share),
                "{}, {}: {share}",
                case.name,
                own.name
            );
        }
    }
}

#[test]
fn every_module_of_a_tracer_is_valid() {
    for case in surfaces() {
        for own in every_tracer(&case.surface) {
            let mut modules = probe_of(&own.tracer).modules;
            modules.push(probe!("frame"));
            let valid = Program::new("probe", modules).validate(Capabilities::default());
            assert!(valid.is_ok(), "{}: {}", own.name, valid.unwrap_err());
        }
    }
}
