//! Tracers find the first hit: the reference tracer that of closed forms, exact tracers that of
//! the reference tracer.

use std::sync::Arc;

use conemarch::base::work::Work;
use conemarch::heightfield::conemap::{ConeMap, MapKind};
use conemarch::heightfield::height_surface::{HeightSurface, HeightSurfaceError};
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::pattern::Pattern;
use conemarch::heightfield::tracer::reference::ReferenceTracer;
use conemarch::heightfield::tracer::{
    Accuracy, BASE, LocalRay, SURFACE, Step, TraceError, TraceHit, Tracer, TracerKind, WALL_X_HIGH,
    WALL_X_LOW, WALL_Y_HIGH, WALL_Y_LOW,
};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::cases::{
    Case, END, Named, alone, case, cases, rays, reference_map, run, surface, tracer, tracers,
};
use crate::common::random::Random;

fn exact(surface: &Arc<HeightSurface>) -> Vec<Named> {
    tracers(surface, Accuracy::Exact)
}

fn hit_of(tracer: &dyn Tracer, ray: &LocalRay) -> Option<TraceHit> {
    let (step, hit, _) = run(tracer, ray, END).expect("the ray ends");
    assert_ne!(step, Step::Spent);
    (step == Step::Hit).then_some(hit)
}

/// Straight down from a point.
fn down(origin: DVec3) -> LocalRay {
    LocalRay {
        origin,
        axis: -DVec3::Z,
    }
}

/// Column and row of a hit's cell.
fn cell_of(surface: &HeightSurface, hit: &TraceHit) -> [u32; 2] {
    let width = surface.cells()[0];
    [hit.cell() % width, hit.cell() / width]
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
        let block = surface(alone(size, Patches::Bilinear), z.collect());
        let reference = ReferenceTracer::new(block.clone());
        for ray in rays(&block, 6000, 2) {
            let hit = hit_of(&reference, &ray);
            let Some(hit) = hit.filter(|hit| hit.face() == SURFACE && hit.s > 0.0) else {
                continue;
            };
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
            let [w, h] = block.domain().map(f64::from);
            let p = DVec3::new(random.unit() * w, random.unit() * h, 2.0);
            let hit = hit_of(&reference, &down(p)).unwrap();
            assert!((2.0 - hit.s - plane(p.truncate())).abs() < 1e-7);
            let cell = cell_of(&block, &hit).map(f64::from);
            let off = DVec2::from_array(cell) + DVec2::from_array(hit.uv) - p.truncate();
            assert!(off.length() < 1e-9, "{p} {hit:?}");
        }
    }
    assert!(met > 4000, "only {met} rays");
}

#[test]
fn boxes_are_hit_where_each_alone_would_be() {
    let mut random = Random::new(3);
    let mut met = 0;
    for _ in 0..200 {
        let z: Vec<f32> = (0..12).map(|_| random.unit() as f32).collect();
        let block = surface(alone([4, 3], Patches::Boxes), z.clone());
        let reference = ReferenceTracer::new(block.clone());
        for ray in rays(&block, 120, (random.unit() * 1e6) as u64) {
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
            match hit_of(&reference, &ray) {
                Some(hit) => {
                    met += 1;
                    let touch = ray.at(hit.s);
                    let z = block.heights().height(Patches::Boxes, touch.truncate());
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
fn the_reference_never_passes_a_point_under_the_surface() {
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
            let block = surface((size, wrap, tiles, patches), z);
            let reference = ReferenceTracer::new(block.clone());
            let [w, h] = block.domain().map(f64::from);
            for ray in rays(&block, 600, 5) {
                let hit = hit_of(&reference, &ray);
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
                    let z = block.heights().height(patches, p.truncate());
                    assert!(!inside || p.z > z - 1e-9, "{ray:?} at {s}: {} in {z}", p.z);
                }
                let Some(hit) = hit.filter(|h| h.face() == SURFACE && h.s > 0.0) else {
                    continue;
                };
                let p = ray.at(hit.s);
                let z = block.heights().height(patches, p.truncate());
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
        let reference = ReferenceTracer::new(case.surface.clone());
        let rays = rays(&case.surface, RAYS, 11);
        let ends = rays.iter().map(|ray| run(&reference, ray, END).unwrap());
        let truths: Vec<_> = ends.collect();
        let mut told = Vec::new();
        let (mut traced, mut touched) = (0, 0);
        for own in exact(&case.surface) {
            let mut faults = Vec::new();
            for (ray, truth) in rays.iter().zip(&truths) {
                traced += 1;
                let end = run(&*own.tracer, ray, END);
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
                told.push(format!(
                    "{}, {}: {count} wrong, {first}",
                    case.name, own.name
                ));
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
    let steps = |tracer: &dyn Tracer| -> u32 {
        let all = rays.iter().map(|ray| run(tracer, ray, END).unwrap().2);
        all.sum()
    };
    let cells = steps(&ReferenceTracer::new(surface.clone()));
    for own in exact(&surface).iter().filter(|own| own.kind.needs_map()) {
        let steps = steps(&*own.tracer);
        let name = &own.name;
        assert!(
            5 * steps < 3 * cells,
            "{name}: {steps} steps over {cells} cells"
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
    let block = surface(alone([97, 97], Patches::Boxes), z);
    let reference = ReferenceTracer::new(block.clone());
    let mut random = Random::new(8);
    let rays: Vec<_> = (0..4000)
        .map(|_| clipping(&mut random, DVec2::splat(48.5)))
        .collect();
    let bad = |tracer: &dyn Tracer| {
        let faults = rays.iter().filter_map(|ray| {
            let truth = run(&reference, ray, END).unwrap();
            wrong(ray, &truth, run(tracer, ray, END))
        });
        faults.count()
    };
    for own in exact(&block) {
        assert_eq!(bad(&*own.tracer), 0, "{}", own.name);
        // With cones that are wider by a hundredth some hits are lost.
        if let Some(kind) = own.kind.facts().kinds.first() {
            let mut map = reference_map(&block, *kind, 1.5);
            map.ratios.iter_mut().for_each(|r| *r *= 1.01);
            let wider = tracer(&block, &own.kind.into(), Some(Arc::new(map))).unwrap();
            assert!(bad(&*wider) > 0, "{}", own.name);
        }
    }
}

#[test]
fn a_cell_beyond_both_borders_joins_all_four_corners_of_the_map() {
    // The corners of the map are 1/2, 1/8, 1/4 and 0; nothing between them is as high.
    let mut z = vec![0.0; 12];
    (z[0], z[3], z[8]) = (0.5, 0.125, 0.25);
    let wrapped = surface(([4, 3], [true; 2], [2, 2], Patches::Bilinear), z.clone());
    // On an axis that ends there is no such cell: the last one ends at the last sample.
    let ended = surface(([4, 3], [true, false], [2, 1], Patches::Bilinear), z);
    let check = |block, cell: DVec2, at: [f64; 2], height: Option<f64>| {
        let ray = down((cell + DVec2::from_array(at)).extend(1.0));
        for own in exact(block) {
            let found = hit_of(&*own.tracer, &ray).map(|hit| ray.height(hit.s));
            let same = match (found, height) {
                (Some(found), Some(height)) => (found - height).abs() < 1e-12,
                (found, height) => found == height,
            };
            assert!(same, "{} {ray:?}: {found:?} for {height:?}", own.name);
        }
    };
    // From the last sample on to the first ones, in the middle of the block and at its end.
    for cell in [DVec2::new(3.0, 2.0), DVec2::new(7.0, 5.0)] {
        check(&wrapped, cell, [0.5, 0.5], Some(0.21875));
        check(&wrapped, cell, [0.25, 0.75], Some(0.1796875));
        check(&wrapped, cell, [0.75, 0.75], Some(0.3515625));
    }
    check(&ended, DVec2::new(3.0, 1.0), [0.5, 0.5], Some(0.0625));
    check(&ended, DVec2::new(3.0, 2.0), [0.5, 0.5], None);
}

#[test]
fn the_block_has_walls_and_a_floor() {
    let flat = surface(alone([3, 3], Patches::Bilinear), vec![0.5; 9]);
    // Origin, axis, end; the parameter of the hit, its face and its place.
    type Row = ([f64; 3], [f64; 3], f64, Option<(f64, u32, [f64; 2])>);
    let rows: [Row; 11] = [
        (
            [-1.0, 0.75, 0.25],
            [1.0, 0.0, 0.0],
            END,
            Some((1.0, WALL_X_LOW, [0.75, 0.25])),
        ),
        (
            [4.0, 1.25, 0.375],
            [-2.0, 0.0, 0.0],
            END,
            Some((1.0, WALL_X_HIGH, [0.25, 0.375])),
        ),
        (
            [0.25, -3.0, 0.5],
            [0.0, 1.0, 0.0],
            END,
            Some((3.0, WALL_Y_LOW, [0.25, 0.5])),
        ),
        (
            [0.25, 5.0, 0.5],
            [0.0, -1.0, 0.0],
            END,
            Some((3.0, WALL_Y_HIGH, [0.25, 0.5])),
        ),
        (
            [1.5, 0.5, -2.0],
            [0.0, 0.0, 4.0],
            END,
            Some((0.5, BASE, [0.5, 0.5])),
        ),
        // A start on a wall, one in the solid, and a grazed edge.
        (
            [0.0, 0.5, 0.25],
            [1.0, 0.0, 0.0],
            END,
            Some((0.0, WALL_X_LOW, [0.5, 0.25])),
        ),
        (
            [0.5, 0.5, 0.25],
            [1.0, 0.0, 0.0],
            END,
            Some((0.0, SURFACE, [0.5, 0.5])),
        ),
        (
            [-1.0, 0.5, 1.0],
            [1.0, 0.0, -0.25],
            END,
            Some((2.0, SURFACE, [1.0, 0.5])),
        ),
        // Above the surface between the sides, and to an end before and behind the surface.
        ([-1.0, 0.5, 0.75], [1.0, 0.0, 0.0], END, None),
        ([0.5, 0.5, 2.0], [0.0, 0.0, -1.0], 1.25, None),
        (
            [0.5, 0.5, 2.0],
            [0.0, 0.0, -1.0],
            1.75,
            Some((1.5, SURFACE, [0.5, 0.5])),
        ),
    ];
    for (origin, axis, end, wanted) in rows {
        let ray = LocalRay {
            origin: origin.into(),
            axis: axis.into(),
        };
        for own in exact(&flat) {
            let (step, hit, _) = run(&*own.tracer, &ray, end).unwrap();
            let found = (step == Step::Hit).then_some((hit.s, hit.face(), hit.uv));
            assert_eq!(found, wanted, "{} {ray:?}", own.name);
            assert!(step == Step::Hit || step == Step::Out);
        }
    }
}

#[test]
fn rays_of_no_numbers_end() {
    let all = exact(&cases()[3].surface);
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
        for own in &all {
            // The caller limits the steps; none of them panics.
            let mut work = Work::default();
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
    assert_eq!(tiled([1, 2]).unwrap_err(), HeightSurfaceError::Unwrapped(1));
    assert!(matches!(
        tiled([0, 1]),
        Err(HeightSurfaceError::Tiles { axis: 0, .. })
    ));
    assert!(matches!(
        tiled([1 << 20, 1]),
        Err(HeightSurfaceError::Tiles { .. })
    ));
    let block = Arc::new(tiled([2, 1]).unwrap());
    let settings = TracerKind::Walk.into();
    let made = |change: &dyn Fn(&mut ConeMap)| {
        let mut map = reference_map(&block, MapKind::Walk, 1.5);
        change(&mut map);
        tracer(&block, &settings, Some(Arc::new(map))).err()
    };
    assert_eq!(made(&|_| {}), None);
    assert_eq!(
        tracer(&block, &settings, None).unwrap_err(),
        TraceError::Missing("walk")
    );
    let refused = |change: &dyn Fn(&mut ConeMap)| made(change).unwrap();
    use TraceError::{Count, Kind, Number, Size, Wrap};
    assert!(matches!(
        refused(&|m| m.kind = MapKind::Samples),
        Kind { .. }
    ));
    assert!(matches!(refused(&|m| m.size = [4, 3]), Size { .. }));
    assert!(matches!(refused(&|m| m.wrap = [true; 2]), Wrap { .. }));
    assert!(matches!(refused(&|m| m.ratios.truncate(3)), Count { .. }));
    assert!(matches!(refused(&|m| m.ratios[2] = f64::NAN), Number(_)));
    assert!(matches!(refused(&|m| m.offset = -1.0), Number(_)));
}
