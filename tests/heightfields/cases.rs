//! Reliefs of every kind, and rays of every kind over them.

use std::f64::consts::TAU;
use std::sync::Arc;

use conemarch::base::work::Work;
use conemarch::heightfield::conemap::ConeMap;
use conemarch::heightfield::conemap::generate::cpu;
use conemarch::heightfield::conemap::generate::generator::{Generator, Options};
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::pattern::Pattern;
use conemarch::heightfield::tracer::max_mip::MaxMipTracer;
use conemarch::heightfield::tracer::relaxed::WalkRelaxed;
use conemarch::heightfield::tracer::walk::Walk;
use conemarch::heightfield::tracer::{AnyTracer, LocalRay, Step, TraceHit, Tracer};
use glam::DVec3;

use super::random::Random;
use super::reference_maps;

/// A relief and what to call it.
pub struct Case {
    /// Pattern, size and the rest.
    pub name: String,
    /// The block.
    pub relief: Arc<HeightSurface>,
}

/// A field as a block.
pub fn case(
    field: Pattern,
    size: [u32; 2],
    wrap: [bool; 2],
    tiles: [u32; 2],
    patches: Patches,
) -> Case {
    let heights = Heights::new(size, wrap, field.heights(size, 7, 2.6));
    let relief = HeightSurface::new(heights.expect("a field"), patches, tiles);
    Case {
        name: format!("{} {size:?} {wrap:?} {tiles:?} {patches:?}", field.name()),
        relief: Arc::new(relief.expect("a block")),
    }
}

/// Size, wrapping axes, tiles and surface of a relief.
type Setting = ([u32; 2], [bool; 2], [u32; 2], Patches);

/// No ray of a test is longer.
pub const END: f64 = 1e9;

/// A block of given heights.
pub fn block(
    size: [u32; 2],
    wrap: [bool; 2],
    tiles: [u32; 2],
    patches: Patches,
    z: Vec<f32>,
) -> Arc<HeightSurface> {
    let heights = Heights::new(size, wrap, z).unwrap();
    Arc::new(HeightSurface::new(heights, patches, tiles).unwrap())
}

/// Every field in every setting, and some that are large, tiny or degenerate.
pub fn cases() -> Vec<Case> {
    const SETTINGS: [Setting; 6] = [
        ([64, 64], [false, false], [1, 1], Patches::Bilinear),
        ([96, 65], [true, false], [1, 1], Patches::Bilinear),
        ([65, 80], [false, true], [1, 2], Patches::Bilinear),
        ([64, 48], [true, true], [3, 2], Patches::Bilinear),
        ([67, 64], [false, false], [1, 1], Patches::Boxes),
        ([80, 64], [true, true], [1, 2], Patches::Boxes),
    ];
    let mut all = Vec::new();
    for field in Pattern::ALL {
        for (size, wrap, tiles, patches) in SETTINGS {
            all.push(case(field, size, wrap, tiles, patches));
        }
    }
    let alone = [false, false];
    for (field, size) in [
        (Pattern::Fbm, [256, 256]),
        (Pattern::Ridges, [256, 190]),
        (Pattern::Spikes, [128, 128]),
        (Pattern::Noise, [1, 9]),
        (Pattern::Noise, [2, 2]),
        (Pattern::Noise, [5, 3]),
        (Pattern::Fbm, [1, 1]),
    ] {
        for patches in [Patches::Bilinear, Patches::Boxes] {
            all.push(case(field, size, alone, [1, 1], patches));
        }
    }
    all
}

/// Kinds of rays that [`ray`] knows.
pub const KINDS: u64 = 12;

/// A ray of a kind over a block.
pub fn ray(relief: &HeightSurface, kind: u64, random: &mut Random) -> LocalRay {
    let [w, h] = relief.domain().map(f64::from);
    let n = [0; 7].map(|_| random.unit());
    let between = |i: usize, low: f64, high: f64| low + (high - low) * n[i];
    let over = |z: f64| DVec3::new(n[0] * w, n[1] * h, z);
    let whole = |z: f64| over(z).floor().with_z(z);
    let round = |pace: f64, z: f64| {
        let (sin, cos) = (TAU * n[2]).sin_cos();
        DVec3::new(pace * cos, pace * sin, z)
    };
    // Texels per height of a view, the relief a quarter of its width deep.
    let pace = |degrees: f64| 0.25 * w * degrees.to_radians().tan();
    let (origin, axis) = match kind {
        // Views from above.
        0 => (over(1.0), round(pace(30.0), -1.0)),
        1 => (over(1.0), round(pace(60.0), -1.0)),
        2 => (over(1.5), round(pace(80.0), -1.0)),
        // From inside the slab any way; the start may lie in the solid.
        3 => (over(n[3]), round(30.0 * n[4], between(5, -1.0, 1.0))),
        // Rising from next to the surface.
        4 => {
            let p = over(0.0).truncate();
            let z = relief.heights().height(relief.patches(), p);
            (over(z + 0.1 * n[3].powi(3)), round(90.0 * n[4], n[5]))
        }
        // Level.
        5 => (over(n[3]), round(1.0, 0.0)),
        // Along an axis, from the middle of cells and along sample lines.
        6 => {
            let z = between(3, 0.2, 1.2);
            let p = if n[4] < 0.5 { whole(z) } else { over(z) };
            let pace = between(5, -60.0, 60.0);
            let [x, y] = if n[2] < 0.5 { [pace, 0.0] } else { [0.0, pace] };
            (p, DVec3::new(x, y, between(6, -1.0, 0.3)))
        }
        // Through vertices exactly: every sum of these is exact.
        7 => {
            let ways = [
                [1.0, 1.0],
                [1.0, -1.0],
                [-2.0, 1.0],
                [-1.0, -1.0],
                [3.0, 1.0],
            ];
            let [x, y] = ways[(n[3] * 5.0) as usize];
            let turns = [1.0, 4.0, 16.0][(n[4] * 3.0) as usize];
            (whole(1.0), DVec3::new(turns * x, turns * y, -0.125))
        }
        // From outside, through a point inside.
        8 => {
            let away = round(2.0 * (w + h), between(3, -2.0, 2.0));
            (over(between(4, -0.2, 1.2)) - away, away)
        }
        // Level at the height of a sample: along plateaus, and touching tops.
        9 => {
            let p = [n[3] * w, n[4] * h].map(|x| x as i64);
            let z = relief.heights().at(p[0], p[1]);
            let to = DVec3::new(p[0] as f64, p[1] as f64, z);
            (over(z), (to - over(z)) / 64.0)
        }
        // Straight down and up.
        10 if n[3] < 0.7 => (over(2.0), -DVec3::Z),
        10 => (over(-1.0), DVec3::Z),
        // Nearly level, and far away.
        _ => {
            let axis = round(1.0, between(3, -2e-3, 1e-3));
            (over(between(4, 0.3, 1.0)) - 3.0 * w * axis, axis)
        }
    };
    LocalRay { origin, axis }
}

/// Rays of all kinds over a block, the same in every run.
pub fn rays(relief: &HeightSurface, count: u64, seed: u64) -> Vec<LocalRay> {
    let mut random = Random::new(seed);
    (0..count)
        .map(|i| ray(relief, i % KINDS, &mut random))
        .collect()
}

/// A map by a generator, with an offset for the walks.
pub fn made(generator: Generator, relief: &HeightSurface, offset: f64) -> Arc<ConeMap> {
    let options = Options {
        offset,
        ..Options::default()
    };
    let (heights, patches) = (relief.heights(), relief.patches());
    let map = cpu::generate(generator, heights, patches, &options, &mut |_| true);
    Arc::new(map.expect("options in range"))
}

/// The exact tracers of a block, with cones of the plain makers and of the generators.
pub fn exact(relief: &Arc<HeightSurface>) -> Vec<(&'static str, AnyTracer)> {
    let walk = |map| AnyTracer::Walk(Walk::new(relief.clone(), map).expect("its map"));
    let relaxed = |map| {
        let own = WalkRelaxed::new(relief.clone(), map);
        AnyTracer::WalkRelaxed(own.expect("its map"))
    };
    let plain = reference_maps::walk(relief, 1.5);
    let plain_relaxed = reference_maps::walk_relaxed(relief, 1.5);
    vec![
        ("walk", walk(Arc::new(plain))),
        ("walk, generated", walk(made(Generator::Walk, relief, 3.0))),
        ("walk-relaxed", relaxed(Arc::new(plain_relaxed))),
        (
            "walk-relaxed, generated",
            relaxed(made(Generator::WalkRelaxed, relief, 2.0)),
        ),
        (
            "max-mip",
            AnyTracer::MaxMip(MaxMipTracer::new(relief.clone())),
        ),
    ]
}

/// What a ray comes to, with its hit and the steps that it took: `None` for a ray that
/// does not end.
pub fn run<T: Tracer>(tracer: &T, ray: &LocalRay, to: f64) -> Option<(Step, TraceHit, u32)> {
    let mut work = Work::default();
    let mut walk = tracer.begin(ray, 0.0, to, &mut work);
    for _ in 0..100_000 {
        let step = tracer.step(ray, &mut walk, &mut work);
        if step != Step::Moving {
            return Some((step, walk.hit(), work.evaluations));
        }
    }
    None
}
