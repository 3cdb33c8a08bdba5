//! The cone walks for distant views: never behind the first hit, off by at most a node, and with
//! fewer steps than the cone walk. While texels are wider than pixels they are the cone walk.

use std::sync::Arc;

use conemarch::heightfield::conemap::ConeMap;
use conemarch::heightfield::conemap::generate::generator::Generator;
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::Patches;
use conemarch::heightfield::pattern::Pattern;
use conemarch::heightfield::tracer::settings::TracerSettings;
use conemarch::heightfield::tracer::walk_mip::walk_mip_level;
use conemarch::heightfield::tracer::{
    Accuracy, LocalRay, SURFACE, Step, Trace, Tracer, TracerKind,
};
use conemarch::measure::tracer_stats::{first_hits, measure, view_rays};
use rayon::prelude::*;

use crate::cases::{Case, END, alone, case, cases, made, of_accuracy, rays, run, traced, tracer};

/// A parameter that no ray of a test comes to.
const NEVER: f64 = 2.0 * END;

/// The tracers that are off by a pixel, where a texel is as wide as one at a parameter.
fn distant(surface: &Arc<HeightSurface>, map: &Arc<ConeMap>, lod: f64) -> Vec<Arc<Tracer>> {
    let made = of_accuracy(|own| own == Accuracy::Pixel).map(|kind| {
        let mut settings = TracerSettings::from(kind);
        settings.lod = Some(lod);
        tracer(surface, &settings, Some(map.clone())).unwrap()
    });
    made.collect()
}

fn walk(surface: &Arc<HeightSurface>, map: &Arc<ConeMap>) -> Arc<Tracer> {
    tracer(surface, &TracerKind::Walk.into(), Some(map.clone())).unwrap()
}

#[test]
fn as_long_as_texels_are_wider_than_pixels_it_is_the_walk() {
    let check = |case: &Case| {
        let map = made(Generator::Walk, &case.surface, 2.0);
        let walk = walk(&case.surface, &map);
        let all = [0.0, NEVER].map(|lod| distant(&case.surface, &map, lod));
        for own in all.iter().flatten() {
            for ray in rays(&case.surface, 1200, 31) {
                let (truth, own) = (run(&walk, &ray, END), run(own, &ray, END));
                assert_eq!(own, truth, "{}: {ray:?}", case.name);
            }
        }
    };
    cases().par_iter().for_each(check);
}

#[test]
fn levels_double_with_the_distance_and_end_with_the_pyramid() {
    let setting = ([40, 33], [true; 2], [1, 1], Patches::Bilinear);
    let Case { surface, .. } = case(Pattern::Sine, setting);
    let level = |s| walk_mip_level(&surface, 0.75, s);
    let parameters = [-3.0, 0.0, 0.74, 0.75, 1.49, 1.5, 2.99, 3.0, 5.99, 6.0, 1e30];
    assert_eq!(parameters.map(level), [0, 0, 0, 0, 0, 1, 1, 2, 2, 3, 6]);
    assert_eq!([f64::NAN, f64::INFINITY].map(level), [0, 6]);
}

/// What is wrong with where a ray ends. The truth is the parameter of its first hit.
fn wrong(
    surface: &HeightSurface,
    lod: f64,
    ray: &LocalRay,
    end: &Trace,
    truth: Option<f64>,
) -> Option<String> {
    let hit = end.hit();
    if let Some(truth) = truth {
        let behind = (hit.s - truth) * ray.axis.length();
        if end.state != Step::Hit || behind > 1e-7 {
            return Some(format!("{end:?} behind {truth}"));
        }
    }
    if end.state != Step::Hit || hit.face() != SURFACE || end.level == 0 {
        // Cells are solved, and what lies before is free: nothing but the first hit.
        let early = truth.map_or(f64::INFINITY, |t| (t - hit.s) * ray.axis.length());
        let met = end.state == Step::Hit;
        return (met && early > 1e-7).then(|| format!("{end:?} before {truth:?}"));
    }
    // The surface under the node reaches up to the ray, and the node is no wider than a pixel.
    let node = surface.node(end.cell, end.level);
    let over = ray.height(hit.s) - node.maximum;
    let inside = (0..2).all(|a| (node.low[a]..node.high[a]).contains(&end.cell[a]));
    let at = ray.at(hit.s);
    let off = (0..2).map(|a| at[a] - at[a].clamp(f64::from(node.low[a]), f64::from(node.high[a])));
    let off = off.fold(0.0, |m: f64, o| m.max(o.abs()));
    let wide = end.level > walk_mip_level(surface, lod, hit.s);
    (over > 1e-9 || !inside || off > 1e-7 || wide)
        .then(|| format!("{end:?}: {over} over {node:?}, {off} off"))
}

#[test]
fn no_first_hit_is_passed_and_every_hit_is_of_the_node_under_it() {
    let check = |case: &Case| {
        let surface = &case.surface;
        let map = made(Generator::Walk, surface, 2.0);
        let rays = rays(surface, 2400, 32);
        let reference = Tracer::reference(surface.clone());
        let truths = rays.iter().map(|ray| {
            let (step, hit, _) = run(&reference, ray, END).unwrap();
            (step == Step::Hit).then_some(hit.s)
        });
        let truths: Vec<_> = truths.collect();
        let mut told = Vec::new();
        let mut coarse = 0;
        // Rays of one height per unit of the parameter, and such of one texel.
        for lod in [0.02, 0.3, 5.0] {
            for own in distant(surface, &map, lod) {
                for (ray, truth) in rays.iter().zip(&truths) {
                    let (end, _) = traced(&own, ray, END).expect("the ray ends");
                    let fault = wrong(surface, lod, ray, &end, *truth);
                    told.extend(fault.map(|f| format!("{} {lod}: {ray:?}: {f}", case.name)));
                    coarse += u32::from(end.state == Step::Hit && end.level > 0);
                }
            }
        }
        (told, coarse)
    };
    let all: Vec<_> = cases().par_iter().map(check).collect();
    let told: Vec<_> = all.iter().flat_map(|(told, _)| told).collect();
    let first: Vec<_> = told.iter().take(5).collect();
    assert!(told.is_empty(), "{} wrong: {first:#?}", told.len());
    let coarse: u32 = all.iter().map(|(_, coarse)| coarse).sum();
    assert!(coarse > 100_000, "only {coarse} hits of larger nodes");
}

#[test]
fn distant_views_take_fewer_steps_than_with_the_walk() {
    let Case { surface, .. } = case(Pattern::Fbm, alone([512, 512], Patches::Bilinear));
    let map = made(Generator::Walk, &surface, 2.0);
    let reference = Tracer::reference(surface.clone());
    for degrees in [60.0, 80.0] {
        // As many heights away as texels are to be as wide as a pixel.
        let mut rays = view_rays(&surface, degrees, 10_000);
        for ray in &mut rays {
            ray.origin -= 64.0 * ray.axis;
        }
        let truths = first_hits(&reference, &rays);
        let walk = measure(&walk(&surface, &map), &rays, &truths);
        for texels in [2.0, 4.0, 8.0] {
            let all = distant(&surface, &map, 64.0 / texels);
            let found = all.iter().map(|own| measure(own, &rays, &truths));
            let found: Vec<_> = found.collect();
            println!("{degrees}: {texels} texels to a pixel: {found:?}, walk {walk:?}");
            for own in &found {
                assert_eq!((own.skipped, own.unconverged), (0.0, 0.0));
            }
            let [own, narrow] = found[..] else {
                panic!("cones of cells, and cones of nodes");
            };
            let most = if texels < 8.0 { 0.9 } else { 0.65 };
            assert!(own.steps_mean < most * walk.steps_mean, "{own:?} {walk:?}");
            assert!(own.steps_p99 < walk.steps_p99, "{own:?} {walk:?}");
            // The cone of a node lies within that of its cell.
            assert!(narrow.steps_mean >= own.steps_mean, "{narrow:?} {own:?}");
        }
    }
}
