//! First hits against closed forms: planes, boxes, corners of the map, walls and the floor.

use conemarch::heightfield::heights::Patches;
use conemarch::heightfield::tracer::{
    Accuracy, BASE, LocalRay, SURFACE, Step, TraceHit, Tracer, WALL_X_HIGH, WALL_X_LOW,
    WALL_Y_HIGH, WALL_Y_LOW,
};
use glam::{DVec2, DVec3};

use crate::cases::{END, alone, cell_of, first_box, rays, run, surface, tracers};
use crate::common::random::Random;

fn hit_of(tracer: &Tracer, ray: &LocalRay) -> Option<TraceHit> {
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
        let reference = Tracer::reference(block.clone());
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
        let z = (0..12).map(|_| random.unit() as f32).collect();
        let block = surface(alone([4, 3], Patches::Boxes), z);
        let reference = Tracer::reference(block.clone());
        for ray in rays(&block, 120, (random.unit() * 1e6) as u64) {
            let first = first_box(&block, &ray).map_or(f64::INFINITY, |(s, _)| s);
            let Some(hit) = hit_of(&reference, &ray) else {
                assert!(first.is_infinite(), "{ray:?}: none for {first}");
                continue;
            };
            met += 1;
            let touch = ray.at(hit.s);
            let z = block.heights().height(Patches::Boxes, touch.truncate());
            let early = hit.s < first - 1e-9 && touch.z > z + 1e-9;
            let edge = touch.x.fract() * touch.y.fract() == 0.0;
            assert!(hit.s < first + 1e-9, "{ray:?}: {} for {first}", hit.s);
            assert!(!early || edge, "{ray:?}: {} for {first}", hit.s);
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
            let reference = Tracer::reference(block.clone());
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
        for own in tracers(block, Accuracy::Exact) {
            let found = hit_of(&own.tracer, &ray).map(|hit| ray.height(hit.s));
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

/// Rays over a block of 2 x 2 cells and the height 1/2: origin, axis and end; and the parameter
/// of the hit, its face and its place, or `-`.
const RAYS: &str = "
    -1    0.75 0.25    1  0  0     9     1   x-low    0.75 0.25
     4    1.25 0.375  -2  0  0     9     1   x-high   0.25 0.375
     0.25 -3   0.5     0  1  0     9     3   y-low    0.25 0.5
     0.25  5   0.5     0 -1  0     9     3   y-high   0.25 0.5
     1.5  0.5  -2      0  0  4     9     0.5 base     0.5  0.5
     0    0.5  0.25    1  0  0     9     0   x-low    0.5  0.25
     0.5  0.5  0.25    1  0  0     9     0   surface  0.5  0.5
    -1    0.5  1       1  0 -0.25  9     2   surface  1    0.5
    -1    0.5  0.75    1  0  0     9     -
     0.5  0.5  2       0  0 -1     1.25  -
     0.5  0.5  2       0  0 -1     1.75  1.5 surface  0.5  0.5
";

#[test]
fn the_block_has_walls_and_a_floor() {
    let face = |word| match word {
        "surface" => SURFACE,
        "x-low" => WALL_X_LOW,
        "x-high" => WALL_X_HIGH,
        "y-low" => WALL_Y_LOW,
        "y-high" => WALL_Y_HIGH,
        _ => BASE,
    };
    let flat = surface(alone([3, 3], Patches::Bilinear), vec![0.5; 9]);
    for row in RAYS.trim().lines() {
        let words: Vec<&str> = row.split_whitespace().collect();
        let n = |i: usize| words[i].parse::<f64>().unwrap();
        let ray = LocalRay {
            origin: DVec3::new(n(0), n(1), n(2)),
            axis: DVec3::new(n(3), n(4), n(5)),
        };
        let wanted = (words[7] != "-").then(|| (n(7), face(words[8]), [n(9), n(10)]));
        for own in tracers(&flat, Accuracy::Exact) {
            let (step, hit, _) = run(&own.tracer, &ray, n(6)).unwrap();
            let found = (step == Step::Hit).then_some((hit.s, hit.face(), hit.uv));
            assert_eq!(found, wanted, "{}: {row}", own.name);
            assert!(step == Step::Hit || step == Step::Out);
        }
    }
}
