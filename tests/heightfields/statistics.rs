//! Approximate tracers end on the surface or report that they do not, and the statistics count
//! what tracers cost and miss.

use std::sync::Arc;

use conemarch::heightfield::conemap::generate::generator::Generator;
use conemarch::heightfield::conemap::{ConeMap, MapKind};
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::Patches;
use conemarch::heightfield::pattern::Pattern;
use conemarch::heightfield::tracer::settings::TracerSettings;
use conemarch::heightfield::tracer::{Accuracy, LocalRay, Step, Steps, Tracer, TracerKind};
use conemarch::measure::tracer_stats::{first_hits, measure, view_rays};
use glam::DVec3;

use crate::cases::{
    END, KINDS, alone, case, cases, made, rays, reference_map, run, surface, tracer, tracers,
};

#[test]
fn approximate_tracers_end_on_the_surface_or_say_that_they_do_not() {
    let mut spent = [0, 0];
    for case in cases().iter().step_by(5) {
        let reference = Tracer::reference(case.surface.clone());
        // Without rays that only touch the surface.
        let rays = rays(&case.surface, 600, 12).into_iter().enumerate();
        let rays = rays.filter(|(i, _)| ![7, 9].contains(&(*i as u64 % KINDS)));
        let ends = rays.map(|(_, ray)| (ray, run(&reference, &ray, END).unwrap()));
        let ends: Vec<_> = ends.collect();
        for own in tracers(&case.surface, Accuracy::Approximate) {
            for (ray, truth) in &ends {
                let (step, hit, _) = run(&own.tracer, ray, END).expect("ends");
                spent[usize::from(matches!(own.kind.facts().steps, Steps::Limited(_)))] +=
                    u32::from(step == Step::Spent);
                // Never in front of the truth by more than a bracket leaves, and never a hit
                // where there is none.
                if step == Step::Hit {
                    let what = format!("{}, {}: {ray:?}", case.name, own.name);
                    assert_eq!(truth.0, Step::Hit, "{what}");
                    let early = (truth.1.s - hit.s) * ray.axis.length();
                    let steps = own.kind == TracerKind::LinearBinary;
                    assert!(early < if steps { 20.0 } else { 6.0 }, "{what}: {early}");
                }
            }
        }
    }
    assert_eq!(spent[0], 0);
    assert!(spent[1] > 100, "{spent:?}");
}

/// Mean steps of the walk over those of the pyramid, in views of 30, 60 and 80 degrees.
fn walk_over_pyramid(field: Pattern) -> [f64; 3] {
    let case = case(field, alone([256, 256], Patches::Bilinear));
    let map = made(Generator::Walk, &case.surface, 2.0);
    let reference = Tracer::reference(case.surface.clone());
    let both = [(TracerKind::Walk, Some(map)), (TracerKind::MaxMip, None)];
    let both = both.map(|(kind, map)| tracer(&case.surface, &kind.into(), map).unwrap());
    [30.0, 60.0, 80.0].map(|degrees| {
        let rays = view_rays(&case.surface, degrees, 20_000);
        let truths = first_hits(&reference, &rays);
        let [walk, pyramid] = both.each_ref().map(|own| {
            let own = measure(own, &rays, &truths);
            assert_eq!((own.skipped, own.unconverged), (0.0, 0.0), "{}", case.name);
            assert!(own.error_texels < 1e-9, "{}: {own:?}", case.name);
            own.steps_mean
        });
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
        let fewer = ratios[0] <= 1.0 && ratios[1] <= 1.0;
        assert!(fewer, "{field:?}: {ratios:?}");
        if field == Pattern::Fbm {
            for (own, wanted) in ratios.iter().zip([0.65, 0.85, 1.05]) {
                assert!((own / wanted - 1.0).abs() < 0.15, "{ratios:?}");
            }
        }
    }
}

/// A tracer with numbers of its own, and without a map or with cones over samples.
fn with(
    surface: &Arc<HeightSurface>,
    kind: TracerKind,
    change: impl Fn(&mut TracerSettings),
    map: Option<ConeMap>,
) -> Arc<Tracer> {
    let mut settings = kind.into();
    change(&mut settings);
    tracer(surface, &settings, map.map(Arc::new)).unwrap()
}

#[test]
fn statistics_count_what_is_missed() {
    // A wall one cell thick in a plain, and rays that meet it or the ground behind.
    let z = (0..64 * 64).map(|i| if i % 64 == 32 { 1.0 } else { 0.0 });
    let wall = surface(alone([64, 64], Patches::Bilinear), z.collect());
    let reference = Tracer::reference(wall.clone());
    let linear = |steps, rounds| {
        let numbers = |s: &mut TracerSettings| (s.steps, s.rounds) = (Some(steps), Some(rounds));
        with(&wall, TracerKind::LinearBinary, numbers, None)
    };
    let view = |own: &Tracer, degrees| {
        let rays = view_rays(&wall, degrees, 4000);
        measure(own, &rays, &first_hits(&reference, &rays))
    };
    let coarse = view(&linear(4, 0), 60.0);
    let missed = coarse.skipped > 0.05 && coarse.error_texels > 0.5;
    assert!(missed, "{coarse:?}");
    let steps = (1.0..=4.0).contains(&coarse.steps_mean) && coarse.steps_p99 == 4;
    assert!(steps, "{coarse:?}");
    let fine = view(&linear(512, 20), 60.0);
    assert!(fine.skipped < 0.005 && fine.error_texels < 0.01, "{fine:?}");
    // So flat a view that a ray which misses the wall leaves by the sides.
    let flat = view(&linear(4, 0), 86.0);
    assert!(flat.skipped > 0.3, "{flat:?}");
    let map = reference_map(&wall, MapKind::Samples, 0.0);
    let numbers = |s: &mut TracerSettings| s.steps = Some(2);
    let few = with(&wall, TracerKind::CsmFixed, numbers, Some(map));
    let few = view(&few, 60.0);
    assert!(few.unconverged > 0.2 && few.steps_p99 == 2, "{few:?}");
}

#[test]
fn steps_follow_the_view_and_the_distance() {
    let flat = surface(alone([17, 17], Patches::Bilinear), vec![0.0; 289]);
    let map = ConeMap {
        ratios: vec![0.0; 289],
        ..reference_map(&flat, MapKind::Samples, 0.0)
    };
    // Cones of no width let every ray go cell by cell until its 8 steps are spent, scaled by the
    // view: a level ray, a steep one, and one that comes from where half of them are left.
    for (x, axis, lod, wanted) in [
        (0.25, [1.0, 0.0, 0.0], 0.0, 12),
        (0.25, [16.0, 0.0, 1.0], 0.0, 10),
        (-2.5, [1.0, 0.0, 0.0], 2.5, 6),
    ] {
        let numbers = |s: &mut TracerSettings| (s.steps, s.lod) = (Some(8), Some(lod));
        let own = with(&flat, TracerKind::CsmLoop, numbers, Some(map.clone()));
        let ray = LocalRay {
            origin: DVec3::new(x, 0.25, 0.25),
            axis: axis.into(),
        };
        let (step, _, steps) = run(&own, &ray, END).unwrap();
        assert_eq!((step, steps), (Step::Spent, wanted));
    }
}
