//! Surfaces of every kind, rays of every kind over them, and every tracer of them.

use std::f64::consts::TAU;
use std::sync::Arc;

use conemarch::base::outcome::Counts;
use conemarch::heightfield::conemap::generate::cpu;
use conemarch::heightfield::conemap::generate::generator::{Generator, Options};
use conemarch::heightfield::conemap::{ConeMap, MapKind};
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::pattern::Pattern;
use conemarch::heightfield::tracer::cones::Lookup;
use conemarch::heightfield::tracer::settings::{TracerCones, TracerSettings};
use conemarch::heightfield::tracer::{
    Accuracy, LocalRay, Step, Trace, TraceError, TraceHit, Tracer, TracerKind,
};
use glam::DVec3;

use crate::common::random::Random;
use crate::common::reference_maps;

/// A surface and what to call it.
pub struct Case {
    pub name: String,
    pub surface: Arc<HeightSurface>,
}

/// Size, wrapping axes, tiles and patches of a surface.
pub type Setting = ([u32; 2], [bool; 2], [u32; 2], Patches);

/// A setting without tiles and wrapping.
pub fn alone(size: [u32; 2], patches: Patches) -> Setting {
    (size, [false; 2], [1, 1], patches)
}

/// A field as a surface.
pub fn case(field: Pattern, setting: Setting) -> Case {
    Case {
        name: format!("{} {setting:?}", field.name()),
        surface: surface(setting, field.heights(setting.0, 7, 2.6)),
    }
}

/// No ray of a test is longer.
pub const END: f64 = 1e9;

/// A surface of given heights.
pub fn surface((size, wrap, tiles, patches): Setting, z: Vec<f32>) -> Arc<HeightSurface> {
    let heights = Heights::new(size, wrap, z).unwrap();
    Arc::new(HeightSurface::new(heights, patches, tiles).unwrap())
}

/// Every field in every setting, and some that are large, tiny or degenerate.
pub fn cases() -> Vec<Case> {
    const SETTINGS: [Setting; 6] = [
        ([64, 64], [false; 2], [1, 1], Patches::Bilinear),
        ([96, 65], [true, false], [1, 1], Patches::Bilinear),
        ([65, 80], [false, true], [1, 2], Patches::Bilinear),
        ([64, 48], [true, true], [3, 2], Patches::Bilinear),
        ([67, 64], [false; 2], [1, 1], Patches::Boxes),
        ([80, 64], [true, true], [1, 2], Patches::Boxes),
    ];
    let mut all = Vec::new();
    for field in Pattern::ALL {
        all.extend(SETTINGS.map(|setting| case(field, setting)));
    }
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
            all.push(case(field, alone(size, patches)));
        }
    }
    all
}

/// Kinds of rays that [`ray`] knows.
pub const KINDS: u64 = 12;

/// A ray of a kind over a surface.
pub fn ray(surface: &HeightSurface, kind: u64, random: &mut Random) -> LocalRay {
    let [w, h] = surface.domain().map(f64::from);
    let n = [0; 7].map(|_| random.unit());
    let between = |i: usize, low: f64, high: f64| low + (high - low) * n[i];
    let over = |z: f64| DVec3::new(n[0] * w, n[1] * h, z);
    let whole = |z: f64| over(z).floor().with_z(z);
    let round = |pace: f64, z: f64| {
        let (sin, cos) = (TAU * n[2]).sin_cos();
        DVec3::new(pace * cos, pace * sin, z)
    };
    // Texels per height of a view, the surface a quarter of its width deep.
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
            let z = surface.heights().height(surface.patches(), p);
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
            let z = surface.heights().at(p[0], p[1]);
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

/// Rays of all kinds over a surface, the same in every run.
pub fn rays(surface: &HeightSurface, count: u64, seed: u64) -> Vec<LocalRay> {
    let mut random = Random::new(seed);
    let kinds = (0..count).map(|i| i % KINDS);
    kinds.map(|kind| ray(surface, kind, &mut random)).collect()
}

/// A tracer and what to call it.
pub struct Named {
    pub kind: TracerKind,
    pub name: String,
    pub tracer: Arc<Tracer>,
}

/// A reference map of a kind, with an offset for the walks.
pub fn reference_map(surface: &HeightSurface, kind: MapKind, offset: f64) -> ConeMap {
    match kind {
        MapKind::Walk => reference_maps::walk(surface, offset),
        MapKind::WalkRelaxed => reference_maps::walk_relaxed(surface, offset),
        kind => reference_maps::samples(surface, kind),
    }
}

/// A map by a generator, with an offset for the walks.
pub fn made(generator: Generator, surface: &HeightSurface, offset: f64) -> Arc<ConeMap> {
    let options = Options {
        offset,
        ..Options::default()
    };
    let (heights, patches) = (surface.heights(), surface.patches());
    let map = cpu::generate(generator, heights, patches, &options, &mut |_| true);
    Arc::new(map.expect("options in range"))
}

/// A tracer with settings and a map.
pub fn tracer(
    surface: &Arc<HeightSurface>,
    settings: &TracerSettings,
    map: Option<Arc<ConeMap>>,
) -> Result<Arc<Tracer>, TraceError> {
    let cones = map.map(TracerCones::from);
    settings.kind().make(surface, cones.as_ref(), settings, 0.0)
}

/// The kinds of tracers whose accuracy is wanted.
pub fn of_accuracy(wanted: impl Fn(Accuracy) -> bool) -> impl Iterator<Item = TracerKind> {
    let kinds = TracerKind::ALL.into_iter();
    kinds.filter(move |kind| wanted(kind.facts().accuracy))
}

/// Every tracer of an accuracy with a reference map, and each in all its variants.
pub fn tracers(surface: &Arc<HeightSurface>, accuracy: Accuracy) -> Vec<Named> {
    let kinds = of_accuracy(|own| own == accuracy);
    kinds.flat_map(|kind| variants(surface, kind)).collect()
}

fn variants(surface: &Arc<HeightSurface>, kind: TracerKind) -> Vec<Named> {
    let settings = TracerSettings::from(kind);
    let mut all = Vec::new();
    let mut add = |note: &str, settings: &TracerSettings, map| {
        let tracer = tracer(surface, settings, map).expect("a map of its kind");
        let name = format!("{}{note}", kind.name());
        all.push(Named { kind, name, tracer });
    };
    let Some(map) = kind.facts().kinds.first() else {
        add("", &settings, None);
        return all;
    };
    let plain = Some(Arc::new(reference_map(surface, *map, 1.5)));
    match kind.facts().accuracy {
        Accuracy::Exact => {
            let generator = settings.generator().expect("of the first kind");
            let generated = Some(made(generator, surface, 3.0));
            add(", generated", &settings, generated);
            add("", &settings, plain);
        }
        // Cells alone, and nodes that soon or late grow with the distance: rays have a height or
        // a texel to a unit of their parameter.
        Accuracy::Pixel => {
            for lod in [0.0, 0.1, 3.0] {
                let own = TracerSettings {
                    lod: Some(lod),
                    ..settings.clone()
                };
                add(&format!(", lod {lod}"), &own, plain.clone());
            }
        }
        Accuracy::Approximate => {
            for lookup in [Lookup::Nearest, Lookup::Bilinear] {
                let own = TracerSettings {
                    lookup,
                    ..settings.clone()
                };
                add(&format!(", {lookup:?}"), &own, plain.clone());
            }
        }
    }
    all
}

/// Column and row of a hit's cell.
pub fn cell_of(surface: &HeightSurface, hit: &TraceHit) -> [u32; 2] {
    let width = surface.cells()[0];
    [hit.cell() % width, hit.cell() / width]
}

/// The first of all boxes that a ray meets, each by its three pairs of planes: where, and the
/// normal of the side.
pub fn first_box(surface: &HeightSurface, ray: &LocalRay) -> Option<(f64, DVec3)> {
    let [w, h] = surface.domain();
    let mut first: Option<(f64, DVec3)> = None;
    for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
        let low = DVec3::new(f64::from(x), f64::from(y), 0.0);
        let high = low + DVec3::new(1.0, 1.0, surface.apex([x, y]));
        let (mut near, mut far, mut normal) = (0.0_f64, f64::INFINITY, DVec3::ZERO);
        for a in 0..3 {
            let (p, d) = (ray.origin[a], ray.axis[a]);
            if d == 0.0 {
                // A ray between two boxes runs in the one with the higher index.
                if p < low[a] || p > high[a] || (a < 2 && p == high[a]) {
                    near = f64::INFINITY;
                }
                continue;
            }
            let [s, t] = [(low[a] - p) / d, (high[a] - p) / d];
            if s.min(t) > near {
                near = s.min(t);
                normal = -d.signum() * DVec3::AXES[a];
            }
            far = far.min(s.max(t));
        }
        // A point that is touched on an edge may be met or not.
        if far - near > 1e-9 && first.is_none_or(|(s, _)| near < s) {
            first = Some((near, normal));
        }
    }
    first
}

/// How a ray ends: its state, its hit and its steps; `None` for a ray that does not end.
pub fn run(tracer: &Tracer, ray: &LocalRay, to: f64) -> Option<(Step, TraceHit, u32)> {
    let (trace, steps) = traced(tracer, ray, to)?;
    Some((trace.state, trace.hit(), steps))
}

/// The trace of a ray at its end, and its steps.
pub fn traced(tracer: &Tracer, ray: &LocalRay, to: f64) -> Option<(Trace, u32)> {
    let mut work = Counts::default();
    let mut trace = tracer.begin(ray, 0.0, to);
    for _ in 0..100_000 {
        let step = tracer.step(ray, &mut trace, &mut work);
        assert_eq!(step, trace.state);
        if step != Step::Moving {
            return Some((trace, work.evaluations));
        }
    }
    None
}
