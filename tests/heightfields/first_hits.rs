//! Exact tracers find the first hit of the reference tracer, and their maps are checked.

use std::sync::Arc;

use conemarch::base::outcome::Counts;
use conemarch::heightfield::conemap::{ConeMap, MapKind};
use conemarch::heightfield::height_surface::{HeightSurface, HeightSurfaceError};
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::pattern::Pattern;
use conemarch::heightfield::tracer::{
    Accuracy, LocalRay, Step, TraceError, TraceHit, Tracer, TracerKind,
};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::cases::{
    Case, END, Named, alone, case, cases, cell_of, rays, reference_map, run, surface, tracer,
    tracers,
};
use crate::common::random::Random;

fn exact(surface: &Arc<HeightSurface>) -> Vec<Named> {
    tracers(surface, Accuracy::Exact)
}

/// What one ray came to.
type End = (Step, TraceHit, u32);

/// What is wrong with an answer.
fn wrong(ray: &LocalRay, truth: &End, own: Option<End>) -> Option<String> {
    let right = own.is_some_and(|(step, hit, _)| {
        let way = (hit.s - truth.1.s).abs() * ray.axis.length();
        let same = way <= 1e-7 && hit.face() == truth.1.face();
        step == truth.0 && (step != Step::Hit || same)
    });
    (!right).then(|| format!("{own:?} for {truth:?}"))
}

/// Whether a hit earlier than the truth's is one all the same: a point of the surface, or of
/// the side of a box, that the ray touches, and rounding hid from the reference.
fn touches(surface: &HeightSurface, ray: &LocalRay, truth: &End, own: Option<End>) -> bool {
    let Some((Step::Hit, hit, _)) = own else {
        return false;
    };
    if truth.0 == Step::Hit && (hit.s - truth.1.s) * ray.axis.length() > 1e-7 {
        return false;
    }
    let cell = cell_of(surface, &hit).map(|i| i as i32);
    let under = surface.height(cell, hit.uv[0], hit.uv[1]) - ray.height(hit.s);
    let side = hit.uv.iter().any(|u| *u == 0.0 || *u == 1.0);
    under.abs() < 1e-12 || (surface.patches() == Patches::Boxes && side && under > 0.0)
}

#[test]
fn exact_tracers_find_the_first_hit() {
    const RAYS: u64 = 4200;
    let check = |case: &Case| {
        let reference = Tracer::reference(case.surface.clone());
        let rays = rays(&case.surface, RAYS, 11);
        let ends = rays.iter().map(|ray| run(&reference, ray, END).unwrap());
        let truths: Vec<_> = ends.collect();
        let mut told = Vec::new();
        let (mut traced, mut touched) = (0, 0);
        for own in exact(&case.surface) {
            let mut faults = Vec::new();
            for (ray, truth) in rays.iter().zip(&truths) {
                traced += 1;
                let end = run(&own.tracer, ray, END);
                let Some(fault) = wrong(ray, truth, end) else {
                    continue;
                };
                // Only a tracer that samples heights between the cells can see such a point.
                let samples = own.kind == TracerKind::WalkRelaxed;
                if samples && touches(&case.surface, ray, truth, end) {
                    touched += 1;
                } else {
                    faults.push(format!("{ray:?}: {fault}"));
                }
            }
            if let Some(first) = faults.first() {
                let count = faults.len();
                let what = format!("{}, {}", case.name, own.name);
                told.push(format!("{what}: {count} wrong, {first}"));
            }
        }
        let hits = truths.iter().filter(|t| t.0 == Step::Hit).count();
        (traced, [hits, rays.len()], told, touched)
    };
    let all: Vec<_> = cases().par_iter().map(check).collect();
    let told: Vec<_> = all.iter().flat_map(|a| a.2.clone()).collect();
    assert!(told.is_empty(), "{}", told.join("\n"));
    let traced: u64 = all.iter().map(|a| a.0).sum();
    assert!(traced >= 1_000_000, "only {traced} rays");
    let touched: u64 = all.iter().map(|a| a.3).sum();
    println!("{traced} rays, {touched} of them touch");
    assert!(touched * 2000 < traced, "{touched} touches");
    // Most rays meet something: else there would be nothing to find.
    let [hits, rays] = [0, 1].map(|i| all.iter().map(|a| a.1[i]).sum::<usize>());
    assert!(2 * hits > rays, "{hits} hits of {rays} rays");
}

#[test]
fn rising_rays_pass_over_what_lies_under_them() {
    let Case { surface, .. } = case(Pattern::Fbm, alone([128, 128], Patches::Bilinear));
    let mut random = Random::new(12);
    let rays: Vec<_> = (0..500)
        .map(|_| {
            let [x, y] = [0; 2].map(|_| random.between(40.0, 87.0));
            let z = surface.height([x as i32, y as i32], x.fract(), y.fract());
            let way = DVec2::from_angle(random.between(0.0, 6.2));
            LocalRay {
                origin: DVec3::new(x, y, z + 1e-3),
                axis: way.extend(random.between(0.002, 0.02)),
            }
        })
        .collect();
    let steps = |tracer: &Tracer| -> u32 {
        let all = rays.iter().map(|ray| run(tracer, ray, END).unwrap().2);
        all.sum()
    };
    let cells = steps(&Tracer::reference(surface.clone()));
    for own in exact(&surface).iter().filter(|own| own.kind.needs_map()) {
        let steps = steps(&own.tracer);
        let name = &own.name;
        let few = 5 * steps < 3 * cells;
        assert!(few, "{name}: {steps} steps over {cells} cells");
    }
}

/// A level ray just under the top of a single box, from the near edge of a cell in its row
/// or column to where it clips a corner of the box for a tenth of a texel: what a cone a
/// little too wide jumps over. `middle` is the box's.
fn clipping(random: &mut Random, middle: DVec2) -> LocalRay {
    let cells = random.between(20.0, 45.0).floor();
    let slope = random.between(0.2, 0.8) / cells;
    let left = 0.5 - cells - 1e-3;
    let mut start = DVec2::new(left, 0.5 - slope * (-0.4 - left));
    let mut way = DVec2::new(1.0, slope);
    let turn = (random.unit() * 4.0) as u32;
    for _ in 0..turn {
        (start, way) = (start.perp(), way.perp());
    }
    LocalRay {
        origin: (middle + start).extend(1.0 - 1e-3 * random.unit()),
        axis: way.extend(0.0),
    }
}

#[test]
fn cones_are_not_wider_than_they_may_be() {
    let mut z = vec![0.0; 97 * 97];
    z[48 * 97 + 48] = 1.0;
    let block = surface(alone([97, 97], Patches::Boxes), z);
    let reference = Tracer::reference(block.clone());
    let mut random = Random::new(8);
    let rays = (0..4000).map(|_| clipping(&mut random, DVec2::splat(48.5)));
    let rays: Vec<_> = rays.collect();
    let bad = |tracer: &Tracer| {
        let faults = rays.iter().filter_map(|ray| {
            let truth = run(&reference, ray, END).unwrap();
            wrong(ray, &truth, run(tracer, ray, END))
        });
        faults.count()
    };
    for own in exact(&block) {
        assert_eq!(bad(&own.tracer), 0, "{}", own.name);
        // With cones that are wider by a hundredth some hits are lost.
        if let Some(kind) = own.kind.facts().kinds.first() {
            let mut map = reference_map(&block, *kind, 1.5);
            map.ratios.iter_mut().for_each(|r| *r *= 1.01);
            let wider = tracer(&block, &own.kind.into(), Some(Arc::new(map))).unwrap();
            assert!(bad(&wider) > 0, "{}", own.name);
        }
    }
}

#[test]
fn rays_of_no_numbers_end() {
    let all = exact(&cases()[3].surface);
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    let odd = [nan, inf, -inf, 1e300, 0.0, 1e-300, 5.0, -0.0];
    let mut random = Random::new(6);
    let mut any = || odd[(random.unit() * 8.0) as usize];
    for _ in 0..3000 {
        let ray = LocalRay {
            origin: DVec3::new(any(), any(), any()),
            axis: DVec3::new(any(), any(), any()),
        };
        for own in &all {
            // The caller limits the steps; none of them panics.
            let mut work = Counts::default();
            let mut trace = own.tracer.begin(&ray, any(), any());
            for _ in 0..200 {
                own.tracer.step(&ray, &mut trace, &mut work);
            }
        }
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let heights = Heights::new([4, 3], [true, false], vec![0.5; 12]).unwrap();
    let tiled = |tiles| HeightSurface::new(heights.clone(), Patches::Bilinear, tiles);
    assert!(tiled([7, 1]).is_ok());
    let why = |tiles| tiled(tiles).unwrap_err();
    use HeightSurfaceError::{Tiles, Unwrapped};
    assert_eq!(why([1, 2]), Unwrapped(1));
    assert!(matches!(why([0, 1]), Tiles { axis: 0, .. }));
    assert!(matches!(why([1 << 20, 1]), Tiles { .. }));
    let block = Arc::new(tiled([2, 1]).unwrap());
    let settings = TracerKind::Walk.into();
    let made = |change: &dyn Fn(&mut ConeMap)| {
        let mut map = reference_map(&block, MapKind::Walk, 1.5);
        change(&mut map);
        tracer(&block, &settings, Some(Arc::new(map))).err()
    };
    assert_eq!(made(&|_| {}), None);
    let error = tracer(&block, &settings, None).unwrap_err();
    assert_eq!(error, TraceError::Missing("walk"));
    let refused = |change: &dyn Fn(&mut ConeMap)| match made(change) {
        Some(TraceError::Misfit { what, .. }) => what,
        Some(TraceError::Kind { .. }) => "kind",
        Some(TraceError::Number(_)) => "number",
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(&|m| m.kind = MapKind::Samples), "kind");
    assert_eq!(refused(&|m| m.size = [4, 3]), "places");
    assert_eq!(refused(&|m| m.wrap = [true; 2]), "wrapping axes");
    assert_eq!(refused(&|m| m.ratios.truncate(3)), "cones");
    assert_eq!(refused(&|m| m.ratios[2] = f64::NAN), "number");
    assert_eq!(refused(&|m| m.offset = -1.0), "number");
}
