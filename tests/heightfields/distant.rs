//! The walk for distant views: never behind the first hit, off by a node at most, and with
//! fewer steps than the walk, which it is as long as texels are wider than pixels.
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

use common::relief_rays::{Case, END, case, cases, made, rays, run};
use conemarch::base::work::Work;
use conemarch::heightfield::conemap::ConeMap;
use conemarch::heightfield::conemap::generate::generator::Generator;
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::Patches;
use conemarch::heightfield::pattern::Pattern;
use conemarch::heightfield::tracer::oracle::Oracle;
use conemarch::heightfield::tracer::walk::Walk;
use conemarch::heightfield::tracer::walk_mip::{WalkMip, node_cones};
use conemarch::heightfield::tracer::{LocalRay, SURFACE, Step, Trace, Tracer};
use conemarch::measure::tracer_stats::{first_hits, survey, view_rays};
use rayon::prelude::*;

/// A parameter that no ray of a test comes to.
const NEVER: f64 = 2.0 * END;

fn walk_mip(relief: &Arc<HeightSurface>, map: &Arc<ConeMap>, lod: f64) -> WalkMip {
    WalkMip::new(relief.clone(), map.clone(), lod).unwrap()
}

fn cone_mip(relief: &Arc<HeightSurface>, map: &Arc<ConeMap>, lod: f64) -> WalkMip {
    let nodes = node_cones(relief, map).unwrap();
    WalkMip::of_nodes(relief.clone(), map.clone(), nodes, lod).unwrap()
}

/// By the cones of cells, and by those of nodes.
fn both(relief: &Arc<HeightSurface>, map: &Arc<ConeMap>, lod: f64) -> [WalkMip; 2] {
    [walk_mip(relief, map, lod), cone_mip(relief, map, lod)]
}

/// A ray to its end.
fn traced(tracer: &WalkMip, ray: &LocalRay) -> Trace {
    let mut work = Work::default();
    let mut walk = tracer.begin(ray, 0.0, END, &mut work);
    for _ in 0..100_000 {
        if tracer.step(ray, &mut walk, &mut work) != Step::Moving {
            return walk;
        }
    }
    panic!("{ray:?} does not end");
}

#[test]
fn as_long_as_texels_are_wider_than_pixels_it_is_the_walk() {
    let check = |case: &Case| {
        let map = made(Generator::Walk, &case.relief, 2.0);
        let walk = Walk::new(case.relief.clone(), map.clone()).unwrap();
        let all = [0.0, NEVER].map(|lod| both(&case.relief, &map, lod));
        for own in all.as_flattened() {
            for ray in rays(&case.relief, 1200, 31) {
                let (truth, own) = (run(&walk, &ray, END), run(own, &ray, END));
                assert_eq!(own, truth, "{}: {ray:?}", case.name);
            }
        }
    };
    cases().par_iter().for_each(check);
}

#[test]
fn levels_double_with_the_distance_and_end_with_the_pyramid() {
    let case = case(
        Pattern::Sine,
        [40, 33],
        [true; 2],
        [1, 1],
        Patches::Bilinear,
    );
    let map = made(Generator::Walk, &case.relief, 2.0);
    let own = walk_mip(&case.relief, &map, 0.75);
    let levels = [-3.0, 0.0, 0.74, 0.75, 1.49, 1.5, 2.99, 3.0, 5.99, 6.0, 1e30];
    assert_eq!(
        levels.map(|s| own.level(s)),
        [0, 0, 0, 0, 0, 1, 1, 2, 2, 3, 6]
    );
    assert_eq!(own.level(f64::NAN), 0);
    assert_eq!(own.level(f64::INFINITY), 6);
}

/// What is wrong with where a ray ended, the truth being a parameter, or none for no hit.
fn wrong(
    own: &WalkMip,
    relief: &HeightSurface,
    ray: &LocalRay,
    truth: Option<f64>,
) -> Option<String> {
    let end = traced(own, ray);
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
    // The surface under the node reaches up to the ray, and the node is no wider than a pixel,
    // which is 1 texel wide at the parameter that `level` divides by.
    let node = relief.node(end.cell, end.level);
    let over = ray.height(hit.s) - node.maximum;
    let inside = (0..2).all(|a| (node.low[a]..node.high[a]).contains(&end.cell[a]));
    let at = ray.at(hit.s);
    let off = (0..2).map(|a| at[a] - at[a].clamp(f64::from(node.low[a]), f64::from(node.high[a])));
    let off = off.fold(0.0, |m: f64, o| m.max(o.abs()));
    let wide = end.level > own.level(hit.s);
    (over > 1e-9 || !inside || off > 1e-7 || wide)
        .then(|| format!("{end:?}: {over} over {node:?}, {off} off"))
}

#[test]
fn no_first_hit_is_passed_and_every_hit_is_of_the_node_under_it() {
    let check = |case: &Case| {
        let oracle = Oracle::new(case.relief.clone());
        let map = made(Generator::Walk, &case.relief, 2.0);
        let rays = rays(&case.relief, 2400, 32);
        let truths: Vec<_> = rays
            .iter()
            .map(|ray| {
                let (step, hit, _) = run(&oracle, ray, END).unwrap();
                (step == Step::Hit).then_some(hit.s)
            })
            .collect();
        let mut told = Vec::new();
        let mut coarse = 0;
        // Rays of one height per unit of the parameter, and such of one texel.
        let all = [0.02, 0.3, 5.0].map(|lod| both(&case.relief, &map, lod));
        for (i, own) in all.as_flattened().iter().enumerate() {
            for (ray, truth) in rays.iter().zip(&truths) {
                let fault = wrong(own, &case.relief, ray, *truth);
                told.extend(fault.map(|f| format!("{} {i}: {ray:?}: {f}", case.name)));
                let end = traced(own, ray);
                coarse += u32::from(end.state == Step::Hit && end.level > 0);
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
    let case = case(
        Pattern::Fbm,
        [512, 512],
        [false; 2],
        [1, 1],
        Patches::Bilinear,
    );
    let relief = &case.relief;
    let map = made(Generator::Walk, relief, 2.0);
    let oracle = Oracle::new(relief.clone());
    for degrees in [60.0, 80.0] {
        // As many heights away as texels are to be as wide as a pixel.
        let mut rays = view_rays(relief, degrees, 10_000);
        for ray in &mut rays {
            ray.origin -= 64.0 * ray.axis;
        }
        let truths = first_hits(&oracle, &rays);
        let walk = survey(
            &Walk::new(relief.clone(), map.clone()).unwrap(),
            &rays,
            &truths,
        );
        for texels in [2.0, 4.0, 8.0] {
            let own = walk_mip(relief, &map, 64.0 / texels);
            let own = survey(&own, &rays, &truths);
            println!("{degrees}: {texels} texels to a pixel: {own:?}, walk {walk:?}");
            assert_eq!((own.skipped, own.unconverged), (0.0, 0.0));
            let most = if texels < 8.0 { 0.9 } else { 0.65 };
            assert!(own.steps_mean < most * walk.steps_mean, "{own:?} {walk:?}");
            assert!(own.steps_p99 < walk.steps_p99, "{own:?} {walk:?}");
            // The node's cone lies in the cell's.
            let narrow = survey(&cone_mip(relief, &map, 64.0 / texels), &rays, &truths);
            println!("{degrees}: {texels} texels to a pixel, by nodes: {narrow:?}");
            assert_eq!((narrow.skipped, narrow.unconverged), (0.0, 0.0));
            assert!(narrow.steps_mean >= own.steps_mean, "{narrow:?} {own:?}");
        }
    }
}
