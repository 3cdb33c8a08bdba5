//! Tracers of heightfields find the first hit: the oracle against closed forms, all exact
//! tracers against the oracle.
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

use common::random::Random;
use common::reference_maps;
use common::relief_rays::{Case, END, block, cases, exact, rays, run};
use conemarch::heightfield::conemap::{ConeMap, MapKind};
use conemarch::heightfield::height_surface::{HeightSurface, HeightSurfaceError};
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::pattern::Pattern;
use conemarch::heightfield::tracer::oracle::Oracle;
use conemarch::heightfield::tracer::relaxed::WalkRelaxed;
use conemarch::heightfield::tracer::walk::Walk;
use conemarch::heightfield::tracer::{
    AnyTracer, BASE, LocalRay, SURFACE, Step, TraceError, TraceHit, Tracer, WALL_X_HIGH,
    WALL_X_LOW, WALL_Y_LOW,
};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

fn hit_of(tracer: &impl Tracer, ray: &LocalRay) -> Option<TraceHit> {
    let (step, hit, _) = run(tracer, ray, END).expect("the ray ends");
    assert_ne!(step, Step::Spent);
    (step == Step::Hit).then_some(hit)
}

#[test]
fn planes_are_hit_where_their_equation_says() {
    let mut random = Random::new(1);
    let mut met = 0;
    for size in [[9, 7], [2, 2], [33, 5]] {
        let slope = DVec2::new(0.6 / f64::from(size[0]), -0.3 / f64::from(size[1]));
        let plane = |p: DVec2| 0.35 + p.dot(slope);
        let samples = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        let z = samples.map(|(x, y)| plane(DVec2::new(f64::from(x), f64::from(y))) as f32);
        let relief = block(size, [false; 2], [1, 1], Patches::Bilinear, z.collect());
        let oracle = Oracle::new(relief.clone());
        for ray in rays(&relief, 6000, 2) {
            let Some(hit) = hit_of(&oracle, &ray) else {
                continue;
            };
            if hit.face() != SURFACE || hit.s == 0.0 {
                continue;
            }
            met += 1;
            // Where z - plane is 0, or in the floor's last rounding.
            let pace = ray.axis.z - slope.dot(ray.axis.truncate());
            let above = ray.origin.z - plane(ray.origin.truncate());
            let s = -above / pace;
            let way = (hit.s - s).abs() * pace.abs();
            assert!(way < 1e-7, "{ray:?}: {} and {s}", hit.s);
        }
        // Every point of it is hit from straight above: no row, no column is lost.
        for _ in 0..2000 {
            let [w, h] = relief.domain().map(f64::from);
            let p = DVec3::new(random.unit() * w, random.unit() * h, 2.0);
            let hit = hit_of(
                &oracle,
                &LocalRay {
                    origin: p,
                    axis: -DVec3::Z,
                },
            )
            .unwrap();
            assert!((2.0 - hit.s - plane(p.truncate())).abs() < 1e-7);
            let cell = [
                hit.cell() % relief.cells()[0],
                hit.cell() / relief.cells()[0],
            ];
            let at = [0, 1].map(|a| f64::from(cell[a]) + hit.uv[a]);
            assert!(
                (DVec2::from_array(at) - p.truncate()).length() < 1e-9,
                "{p} {hit:?}"
            );
        }
    }
    assert!(met > 4000, "only {met} rays");
}

#[test]
fn boxes_are_hit_where_each_alone_would_be() {
    let mut random = Random::new(3);
    let mut met = 0;
    for _ in 0..200 {
        let size = [4, 3];
        let z: Vec<f32> = (0..12).map(|_| random.unit() as f32).collect();
        let relief = block(size, [false; 2], [1, 1], Patches::Boxes, z.clone());
        let oracle = Oracle::new(relief.clone());
        for ray in rays(&relief, 120, (random.unit() * 1e6) as u64) {
            // The first of all boxes, each by its three pairs of planes.
            let mut first = f64::INFINITY;
            for (i, top) in z.iter().enumerate() {
                let low = DVec3::new((i % 4) as f64, (i / 4) as f64, 0.0);
                let high = low + DVec3::new(1.0, 1.0, f64::from(*top));
                let (mut near, mut far) = (0.0_f64, f64::INFINITY);
                for a in 0..3 {
                    let (p, d) = (ray.origin[a], ray.axis[a]);
                    if d == 0.0 {
                        // A ray between two boxes runs in the higher one of both indices.
                        if p < low[a] || p > high[a] || (a < 2 && p == high[a]) {
                            near = f64::INFINITY;
                        }
                        continue;
                    }
                    let [s, t] = [(low[a] - p) / d, (high[a] - p) / d];
                    near = near.max(s.min(t));
                    far = far.min(s.max(t));
                }
                // A point touched on an edge may be met or not.
                if far - near > 1e-9 {
                    first = first.min(near);
                }
            }
            match hit_of(&oracle, &ray) {
                Some(hit) => {
                    met += 1;
                    let touch = ray.at(hit.s);
                    let z = relief.heights().height(Patches::Boxes, touch.truncate());
                    let early = hit.s < first - 1e-9 && touch.z > z + 1e-9;
                    let edge = touch.x.fract() * touch.y.fract() == 0.0;
                    assert!(hit.s < first + 1e-9, "{ray:?}: {} for {first}", hit.s);
                    assert!(!early || edge, "{ray:?}: {} for {first}", hit.s);
                }
                None => assert!(first.is_infinite(), "{ray:?}: none for {first}"),
            }
        }
    }
    assert!(met > 8000, "only {met} rays");
}

#[test]
fn the_oracle_never_passes_a_point_under_the_surface() {
    let settings = [
        ([17, 12], [false, false], [1, 1]),
        ([11, 16], [true, false], [2, 1]),
        ([9, 7], [true, true], [2, 3]),
    ];
    let mut random = Random::new(4);
    let mut met = 0;
    for (size, wrap, tiles) in settings {
        for patches in [Patches::Bilinear, Patches::Boxes] {
            let z = (0..size[0] * size[1])
                .map(|_| random.unit() as f32)
                .collect();
            let relief = block(size, wrap, tiles, patches, z);
            let oracle = Oracle::new(relief.clone());
            let [w, h] = relief.domain().map(f64::from);
            for ray in rays(&relief, 600, 5) {
                let hit = hit_of(&oracle, &ray);
                met += u32::from(hit.is_some());
                // A start in the solid is a hit at once.
                if hit.is_some_and(|hit| hit.s == 0.0) {
                    continue;
                }
                let speed = ray.axis.truncate().length().max(0.02);
                let until = hit.map_or(6.0 * (w + h) / speed, |hit| hit.s);
                for i in 0..2000 {
                    let s = until * (f64::from(i) + 0.5) / 2000.0;
                    let p = ray.at(s);
                    let inside = p.x > 0.0 && p.x < w && p.y > 0.0 && p.y < h && p.z > 0.0;
                    let z = relief.heights().height(patches, p.truncate());
                    assert!(!inside || p.z > z - 1e-9, "{ray:?} at {s}: {} in {z}", p.z);
                }
                let Some(hit) = hit.filter(|h| h.face() == SURFACE && h.s > 0.0) else {
                    continue;
                };
                let p = ray.at(hit.s);
                let z = relief.heights().height(patches, p.truncate());
                let side = hit.uv.iter().any(|u| *u == 0.0 || *u == 1.0);
                let on = if patches == Patches::Boxes && side {
                    p.z < 1.0
                } else {
                    (p.z - z).abs() < 1e-9
                };
                assert!(on, "{ray:?}: {hit:?} at {} over {z}", p.z);
            }
        }
    }
    assert!(met > 1500, "only {met} rays");
}

/// What one ray came to.
type End = (Step, TraceHit, u32);

/// What is wrong with an answer.
fn wrong(ray: &LocalRay, truth: &End, own: Option<End>) -> Option<String> {
    let Some(own) = own else {
        return Some("does not end".into());
    };
    let way = (own.1.s - truth.1.s).abs() * ray.axis.length();
    let other = own.1.face() != truth.1.face();
    let hit = truth.0 == Step::Hit;
    let fault = own.0 != truth.0 || (hit && (way > 1e-7 || other));
    fault.then(|| {
        format!(
            "{:?} at {:?} for {:?} at {:?}",
            own.0, own.1, truth.0, truth.1
        )
    })
}

/// Whether a hit earlier than the truth's is one all the same: a point of the surface, or of
/// the side of a box, that the ray touches, and rounding hid from the oracle.
fn touches(relief: &HeightSurface, ray: &LocalRay, truth: &End, own: Option<End>) -> bool {
    let Some((Step::Hit, hit, _)) = own else {
        return false;
    };
    if truth.0 == Step::Hit && (hit.s - truth.1.s) * ray.axis.length() > 1e-7 {
        return false;
    }
    let cells = relief.cells()[0];
    let cell = [hit.cell() % cells, hit.cell() / cells].map(|i| i as i32);
    let under = relief.height(cell, hit.uv[0], hit.uv[1]) - ray.height(hit.s);
    let side = hit.uv.iter().any(|u| *u == 0.0 || *u == 1.0);
    under.abs() < 1e-12 || (relief.patches() == Patches::Boxes && side && under > 0.0)
}

#[test]
fn exact_tracers_find_the_first_hit() {
    const RAYS: u64 = 4200;
    let check = |case: &Case| {
        let oracle = Oracle::new(case.relief.clone());
        let rays = rays(&case.relief, RAYS, 11);
        let truths: Vec<_> = rays.iter().map(|r| run(&oracle, r, END).unwrap()).collect();
        let mut told = Vec::new();
        let (mut traced, mut touched) = (0, 0);
        for (name, tracer) in exact(&case.relief) {
            let mut bad = 0;
            let mut first = String::new();
            for (ray, truth) in rays.iter().zip(&truths) {
                traced += 1;
                let own = run(&tracer, ray, END);
                if let Some(fault) = wrong(ray, truth, own) {
                    // Only who samples heights between the cells can see such a point.
                    if name.starts_with("walk-relaxed") && touches(&case.relief, ray, truth, own) {
                        touched += 1;
                        continue;
                    }
                    bad += 1;
                    if first.is_empty() {
                        first = format!("{ray:?}: {fault}");
                    }
                }
            }
            if bad > 0 {
                told.push(format!("{}, {name}: {bad} wrong, {first}", case.name));
            }
        }
        let hits = truths.iter().filter(|t| t.0 == Step::Hit).count();
        (traced, hits, told, touched)
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
    let hits: usize = all.iter().map(|a| a.1).sum();
    assert!(hits as u64 * 8 > traced, "{hits} hits in {traced}");
}

#[test]
fn rising_rays_pass_over_what_lies_under_them() {
    let field = Pattern::Fbm.heights([128, 128], 7, 2.6);
    let relief = block([128, 128], [false; 2], [1, 1], Patches::Bilinear, field);
    let mut random = Random::new(12);
    let rays: Vec<_> = (0..500)
        .map(|_| {
            let [x, y] = [0; 2].map(|_| random.between(40.0, 87.0));
            let z = relief.height([x as i32, y as i32], x.fract(), y.fract());
            let way = DVec2::from_angle(random.between(0.0, 6.2));
            LocalRay {
                origin: DVec3::new(x, y, z + 1e-3),
                axis: way.extend(random.between(0.002, 0.02)),
            }
        })
        .collect();
    let steps = |tracer: &dyn Fn(&LocalRay) -> u32| rays.iter().map(tracer).sum::<u32>();
    let oracle = Oracle::new(relief.clone());
    let cells = steps(&|ray| run(&oracle, ray, END).unwrap().2);
    let all = exact(&relief).into_iter();
    for (name, tracer) in all.filter(|(name, _)| name.starts_with("walk")) {
        let own = steps(&|ray| run(&tracer, ray, END).unwrap().2);
        assert!(
            5 * own < 3 * cells,
            "{name}: {own} steps over {cells} cells"
        );
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
    let relief = block([97, 97], [false; 2], [1, 1], Patches::Boxes, z);
    let oracle = Oracle::new(relief.clone());
    let mut random = Random::new(8);
    let rays: Vec<_> = (0..4000)
        .map(|_| clipping(&mut random, DVec2::splat(48.5)))
        .collect();
    let bad = |tracer: &AnyTracer| {
        let faults = rays.iter().filter_map(|ray| {
            let truth = run(&oracle, ray, END).unwrap();
            wrong(ray, &truth, run(tracer, ray, END))
        });
        faults.count()
    };
    for (name, tracer) in exact(&relief) {
        assert_eq!(bad(&tracer), 0, "{name}");
    }
    // A hundredth more and some are lost.
    let wider = |map: ConeMap| {
        Arc::new(ConeMap {
            ratios: map.ratios.iter().map(|r| 1.01 * r).collect(),
            ..map
        })
    };
    let map = wider(reference_maps::walk(&relief, 1.5));
    let walk = Walk::new(relief.clone(), map).unwrap();
    assert!(bad(&AnyTracer::Walk(walk)) > 0);
    let map = wider(reference_maps::walk_relaxed(&relief, 1.5));
    let relaxed = WalkRelaxed::new(relief.clone(), map).unwrap();
    assert!(bad(&AnyTracer::WalkRelaxed(relaxed)) > 0);
}

/// Straight down at a position of the domain.
fn down(at: DVec2) -> LocalRay {
    LocalRay {
        origin: at.extend(1.0),
        axis: -DVec3::Z,
    }
}

#[test]
fn a_cell_beyond_both_borders_joins_all_four_corners_of_the_map() {
    // The corners of the map are 1/2, 1/8, 1/4 and 0; nothing between them is as high.
    let mut z = vec![0.0; 12];
    (z[0], z[3], z[8]) = (0.5, 0.125, 0.25);
    let relief = block([4, 3], [true; 2], [2, 2], Patches::Bilinear, z.clone());
    // From the last sample on to the first ones, in the middle of the block and at its end.
    for cell in [DVec2::new(3.0, 2.0), DVec2::new(7.0, 5.0)] {
        for (at, height) in [
            ([0.5, 0.5], 0.21875),
            ([0.25, 0.75], 0.1796875),
            ([0.75, 0.75], 0.3515625),
        ] {
            let ray = down(cell + DVec2::from_array(at));
            for (name, tracer) in exact(&relief) {
                let hit = hit_of(&tracer, &ray).unwrap();
                let own = ray.height(hit.s);
                assert!((own - height).abs() < 1e-12, "{name} {ray:?}: {own}");
            }
        }
    }
    // On an axis that ends there is no such cell: the last one ends at the last sample.
    let relief = block([4, 3], [true, false], [2, 1], Patches::Bilinear, z);
    for (name, tracer) in exact(&relief) {
        let inside = hit_of(&tracer, &down(DVec2::new(3.5, 1.5))).unwrap();
        assert!((inside.s - 0.9375).abs() < 1e-12, "{name}: {inside:?}");
        let ray = down(DVec2::new(3.5, 2.5));
        assert_eq!(hit_of(&tracer, &ray), None, "{name}");
    }
}

#[test]
fn the_block_has_walls_and_a_floor() {
    let relief = block([3, 3], [false; 2], [1, 1], Patches::Bilinear, vec![0.5; 9]);
    for (origin, axis, face, s, uv) in [
        (
            [-1.0, 0.75, 0.25],
            [1.0, 0.0, 0.0],
            WALL_X_LOW,
            1.0,
            [0.75, 0.25],
        ),
        (
            [4.0, 1.25, 0.375],
            [-2.0, 0.0, 0.0],
            WALL_X_HIGH,
            1.0,
            [0.25, 0.375],
        ),
        (
            [0.25, -3.0, 0.5],
            [0.0, 1.0, 0.0],
            WALL_Y_LOW,
            3.0,
            [0.25, 0.5],
        ),
        ([1.5, 0.5, -2.0], [0.0, 0.0, 4.0], BASE, 0.5, [0.5, 0.5]),
        (
            [0.0, 0.5, 0.25],
            [1.0, 0.0, 0.0],
            WALL_X_LOW,
            0.0,
            [0.5, 0.25],
        ),
        ([0.5, 0.5, 0.25], [1.0, 0.0, 0.0], SURFACE, 0.0, [0.5, 0.5]),
        (
            [-1.0, 0.5, 1.0],
            [1.0, 0.0, -0.25],
            SURFACE,
            2.0,
            [1.0, 0.5],
        ),
    ] {
        let ray = LocalRay {
            origin: DVec3::from_array(origin),
            axis: DVec3::from_array(axis),
        };
        for (name, tracer) in exact(&relief) {
            let hit = hit_of(&tracer, &ray).unwrap();
            assert_eq!((hit.face(), hit.s, hit.uv), (face, s, uv), "{name} {ray:?}");
        }
    }
    // Above the surface but within the sides, and past the end.
    let over = LocalRay {
        origin: DVec3::new(-1.0, 0.5, 0.75),
        axis: DVec3::X,
    };
    let down = LocalRay {
        origin: DVec3::new(0.5, 0.5, 2.0),
        axis: -DVec3::Z,
    };
    for (name, tracer) in exact(&relief) {
        assert_eq!(hit_of(&tracer, &over), None, "{name}");
        assert_eq!(run(&tracer, &down, 1.25).unwrap().0, Step::Out, "{name}");
        assert_eq!(run(&tracer, &down, 1.75).unwrap().0, Step::Hit, "{name}");
    }
}

#[test]
fn rays_of_no_numbers_end() {
    let tracers = exact(&cases()[3].relief);
    let odd = [
        f64::NAN,
        f64::INFINITY,
        -f64::INFINITY,
        1e300,
        0.0,
        1e-300,
        5.0,
        -0.0,
    ];
    let mut random = Random::new(6);
    let mut any = || odd[(random.unit() * 8.0) as usize];
    for _ in 0..3000 {
        let ray = LocalRay {
            origin: DVec3::new(any(), any(), any()),
            axis: DVec3::new(any(), any(), any()),
        };
        for (_, tracer) in &tracers {
            // A caller counts: a number of steps is enough, and none panics.
            let mut work = conemarch::base::work::Work::default();
            let mut walk = tracer.begin(&ray, any(), any(), &mut work);
            for _ in 0..200 {
                tracer.step(&ray, &mut walk, &mut work);
            }
        }
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let heights = Heights::new([4, 3], [true, false], vec![0.5; 12]).unwrap();
    let tiled = |tiles| HeightSurface::new(heights.clone(), Patches::Bilinear, tiles);
    assert!(tiled([7, 1]).is_ok());
    assert_eq!(tiled([1, 2]).unwrap_err(), HeightSurfaceError::Unwrapped(1));
    assert!(matches!(
        tiled([0, 1]),
        Err(HeightSurfaceError::Tiles { axis: 0, .. })
    ));
    assert!(matches!(
        tiled([1 << 20, 1]),
        Err(HeightSurfaceError::Tiles { .. })
    ));
    let relief = Arc::new(tiled([2, 1]).unwrap());
    let good = reference_maps::walk(&relief, 1.5);
    let refused = |change: &dyn Fn(&mut ConeMap)| {
        let mut map = good.clone();
        change(&mut map);
        Walk::new(relief.clone(), Arc::new(map)).unwrap_err()
    };
    assert!(matches!(
        refused(&|m| m.kind = MapKind::Samples),
        TraceError::Kind { .. }
    ));
    assert!(matches!(
        refused(&|m| m.size = [4, 3]),
        TraceError::Size { .. }
    ));
    assert!(matches!(
        refused(&|m| m.wrap = [true, true]),
        TraceError::Wrap { .. }
    ));
    assert!(matches!(
        refused(&|m| m.ratios.truncate(3)),
        TraceError::Count { .. }
    ));
    assert!(matches!(
        refused(&|m| m.ratios[2] = f64::NAN),
        TraceError::Number(_)
    ));
    assert!(matches!(
        refused(&|m| m.offset = -1.0),
        TraceError::Number(_)
    ));
    assert!(Walk::new(relief.clone(), Arc::new(good.clone())).is_ok());
}
