//! Tracers of heightfields that are not exact end on the surface or say that they do not;
//! and what all of them cost and miss is counted as it is.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test may panic, and is read by its name"
)]

#[allow(dead_code, reason = "other files use the rest")]
mod common {
    pub mod random;
    pub mod reference_maps;
    pub mod relief_rays;
}

use std::sync::Arc;

use common::reference_maps;
use common::relief_rays::{Case, END, KINDS, block, case, cases, made, rays, run};
use conemarch::heightfield::conemap::generate::generator::Generator;
use conemarch::heightfield::conemap::{ConeMap, MapKind};
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::Patches;
use conemarch::heightfield::pattern::Pattern;
use conemarch::heightfield::tracer::cones::{Budget, Cones, Lookup, Manner};
use conemarch::heightfield::tracer::linear::LinearBinary;
use conemarch::heightfield::tracer::max_mip::MaxMipTracer;
use conemarch::heightfield::tracer::oracle::Oracle;
use conemarch::heightfield::tracer::walk::Walk;
use conemarch::heightfield::tracer::{AnyTracer, LocalRay, Step};
use conemarch::measure::tracer_stats::{first_hits, survey, view_rays};
use glam::DVec3;

/// Every tracer that is not exact.
fn inexact(relief: &Arc<HeightSurface>) -> Vec<(&'static str, AnyTracer)> {
    let linear = LinearBinary::new(relief.clone(), 32, 6);
    let mut all = vec![("linear-binary", AnyTracer::LinearBinary(linear))];
    let maps: Vec<Arc<ConeMap>> = [MapKind::Samples, MapKind::Quad, MapKind::Relaxed]
        .map(|kind| Arc::new(reference_maps::samples(relief, kind)))
        .into();
    for manner in Manner::ALL {
        for lookup in [Lookup::Nearest, Lookup::Bilinear] {
            let map = maps
                .iter()
                .find(|m| manner.kinds().contains(&m.kind))
                .unwrap();
            let own = Manner { lookup, ..manner };
            let tracer = Cones::new(relief.clone(), map.clone(), own).unwrap();
            all.push((manner.name, AnyTracer::Cones(tracer)));
        }
    }
    all
}

#[test]
fn inexact_tracers_end_on_the_surface_or_say_that_they_do_not() {
    let own: Vec<Case> = cases().into_iter().step_by(5).collect();
    let mut spent = [0, 0];
    for case in &own {
        let oracle = Oracle::new(case.relief.clone());
        let rays = rays(&case.relief, 600, 12).into_iter().enumerate();
        // Rays that only touch are another question.
        let rays: Vec<_> = rays
            .filter(|(i, _)| ![7, 9].contains(&(*i as u64 % KINDS)))
            .collect();
        for (name, tracer) in inexact(&case.relief) {
            for (_, ray) in &rays {
                let truth = run(&oracle, ray, END).unwrap();
                let (step, hit, _) = run(&tracer, ray, END).expect("ends");
                let limited = ["csm-loop", "csm-fixed", "rcs-binary"].contains(&name);
                spent[usize::from(limited)] += u32::from(step == Step::Spent);
                // Never in front of the truth by more than a bracket leaves, and never a hit
                // where there is none.
                if step == Step::Hit {
                    assert_eq!(truth.0, Step::Hit, "{}, {name}: {ray:?}", case.name);
                    let early = (truth.1.s - hit.s) * ray.axis.length();
                    let bracket = if name == "linear-binary" { 20.0 } else { 6.0 };
                    assert!(early < bracket, "{}, {name}: {ray:?}: {early}", case.name);
                }
            }
        }
    }
    assert_eq!(spent[0], 0);
    assert!(spent[1] > 100, "{spent:?}");
}

/// Mean steps of the walk over those of the pyramid, in views of 30, 60 and 80 degrees.
fn walk_over_pyramid(field: Pattern) -> [f64; 3] {
    let case = case(field, [256, 256], [false; 2], [1, 1], Patches::Bilinear);
    let relief = &case.relief;
    let oracle = Oracle::new(relief.clone());
    let map = made(Generator::Walk, relief, 2.0);
    let walk = Walk::new(relief.clone(), map).unwrap();
    let pyramid = MaxMipTracer::new(relief.clone());
    [30.0, 60.0, 80.0].map(|degrees| {
        let rays = view_rays(relief, degrees, 20_000);
        let truths = first_hits(&oracle, &rays);
        let both = [
            survey(&walk, &rays, &truths),
            survey(&pyramid, &rays, &truths),
        ];
        for own in both {
            assert_eq!((own.skipped, own.unconverged), (0.0, 0.0), "{}", case.name);
            assert!(own.error_texels < 1e-9, "{}: {own:?}", case.name);
        }
        let [walk, pyramid] = both.map(|own| own.steps_mean);
        println!(
            "{} {degrees}: walk {walk:.2} pyramid {pyramid:.2}",
            case.name
        );
        walk / pyramid
    })
}

#[test]
fn the_walk_takes_fewer_steps_than_the_pyramid_on_terrain() {
    for field in [Pattern::Fbm, Pattern::Ridges] {
        let ratios = walk_over_pyramid(field);
        assert!(
            ratios[0] <= 1.0 && ratios[1] <= 1.0,
            "{field:?}: {ratios:?}"
        );
        if field == Pattern::Fbm {
            for (own, wanted) in ratios.iter().zip([0.65, 0.85, 1.05]) {
                assert!((own / wanted - 1.0).abs() < 0.15, "{ratios:?}");
            }
        }
    }
}

#[test]
fn a_survey_counts_what_is_missed() {
    // A wall one cell thick in a plain, and rays that meet it or the ground behind.
    let z = (0..64 * 64).map(|i| if i % 64 == 32 { 1.0 } else { 0.0 });
    let relief = block([64, 64], [false; 2], [1, 1], Patches::Bilinear, z.collect());
    let rays = view_rays(&relief, 60.0, 4000);
    let truths = first_hits(&Oracle::new(relief.clone()), &rays);
    let coarse = LinearBinary::new(relief.clone(), 4, 0);
    let own = survey(&coarse, &rays, &truths);
    assert!(own.skipped > 0.05 && own.error_texels > 0.5, "{own:?}");
    assert!(
        (1.0..=4.0).contains(&own.steps_mean) && own.steps_p99 == 4,
        "{own:?}"
    );
    let fine = LinearBinary::new(relief.clone(), 512, 20);
    let fine = survey(&fine, &rays, &truths);
    assert!(fine.skipped < 0.005 && fine.error_texels < 0.01, "{fine:?}");
    // So flat a view that whoever misses the wall leaves by the sides.
    let flat = view_rays(&relief, 86.0, 4000);
    let hits = first_hits(&Oracle::new(relief.clone()), &flat);
    let flat = survey(&coarse, &flat, &hits);
    assert!(flat.skipped > 0.3, "{flat:?}");
    let map = Arc::new(reference_maps::samples(&relief, MapKind::Samples));
    let few = Manner {
        budget: Budget::Fixed(2),
        ..Manner::CSM_FIXED
    };
    let few = Cones::new(relief.clone(), map, few).unwrap();
    let few = survey(&few, &rays, &truths);
    assert!(few.unconverged > 0.2 && few.steps_p99 == 2, "{few:?}");
}

#[test]
fn budgets_follow_the_view_and_the_distance() {
    let relief = block(
        [17, 17],
        [false; 2],
        [1, 1],
        Patches::Bilinear,
        vec![0.0; 289],
    );
    let map = Arc::new(ConeMap {
        ratios: vec![0.0; 289],
        ..reference_maps::samples(&relief, MapKind::Samples)
    });
    // Steps until it is spent: cones of no width let every ray go cell by cell.
    let spent = |steps, lod, ray: &LocalRay| {
        let manner = Manner {
            budget: Budget::View { steps, lod },
            ..Manner::CSM_LOOP
        };
        let tracer = Cones::new(relief.clone(), map.clone(), manner).unwrap();
        let (step, _, steps) = run(&tracer, ray, END).unwrap();
        assert_eq!(step, Step::Spent);
        steps
    };
    let level = LocalRay {
        origin: DVec3::new(0.25, 0.25, 0.25),
        axis: DVec3::X,
    };
    assert_eq!(spent(8, 0.0, &level), 12);
    let steep = LocalRay {
        axis: DVec3::new(16.0, 0.0, 1.0),
        ..level
    };
    assert_eq!(spent(8, 0.0, &steep), 10);
    // From two and a half away, with half of the steps there.
    let far = LocalRay {
        origin: DVec3::new(-2.5, 0.25, 0.25),
        ..level
    };
    assert_eq!(spent(8, 2.5, &far), 6);
}
