//! Random cones over heightfields of every kind, in f64 and on the device: no ray of a cone meets
//! anything before the front that is claimed for it, and fronts come near what is met.

use std::ops::Range;
use std::sync::Arc;

use bytemuck::cast_slice;
use conemarch::base::outcome;
use conemarch::base::shader::Module;
use conemarch::base::view::{Beam, CHORD_SLACK};
use conemarch::heightfield::MaxMip;
use conemarch::heightfield::assets::Ready;
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::Patches;
use conemarch::heightfield::paint::Colors;
use conemarch::heightfield::pattern::Pattern;
use conemarch::heightfield::placement::Placement;
use conemarch::heightfield::tracer::{LocalRay, Step, Tracer, TracerKind};
use conemarch::scene::Twin;
use conemarch::scene::heightfield::Heightfield;
use conemarch::wgsl;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::cases::{END, alone, run, surface, tracer};
use crate::common::cones::{claimed, cone, ray_of};
use crate::common::probe::{Numbers, Probe, probe};
use crate::common::random::Random;

/// Rays of each cone.
const RAYS: usize = 40;

/// A heightfield and an eye.
struct Seen {
    name: String,
    ready: Ready,
    /// Finds the first hit cell by cell.
    truth: Tracer,
    eye: DVec3,
}

/// A heightfield of any size and kind anywhere, seen from any side and from within.
fn any(seed: u64) -> Seen {
    let random = &mut Random::new(seed);
    let field = Pattern::ALL[random.index(Pattern::ALL.len())];
    let size = [0; 2].map(|_| match random.index(3) {
        0 => 1 + random.index(9) as u32,
        1 => 1 << (2 + random.index(5)),
        _ => 1 + random.index(90) as u32,
    });
    let wrap = [0; 2].map(|_| random.unit() < 0.5);
    let tiles = wrap.map(|wraps| if wraps { 1 + random.index(4) as u32 } else { 1 });
    let patches = [Patches::Bilinear, Patches::Boxes][random.index(2)];
    let power = random.between(2.0, 4.0);
    let setting = (size, wrap, tiles, patches);
    let surface = surface(setting, field.heights(size, seed as u32, power));
    anywhere(
        format!("{seed}: {} {setting:?}", field.name()),
        surface,
        random,
    )
}

/// A surface of any width and depth anywhere, seen from any side and from within.
fn anywhere(name: String, surface: Arc<HeightSurface>, random: &mut Random) -> Seen {
    let width = 10.0_f64.powf(random.between(-1.0, 2.0));
    let depth = width * 10.0_f64.powf(random.between(-2.0, 0.3));
    let turn = if random.unit() < 0.3 {
        DVec3::ZERO
    } else {
        random.cube(180.0)
    };
    let sides = DVec2::from_array(surface.domain().map(f64::from));
    let placement = Placement::new(sides, width, depth, random.cube(width), turn);
    let n = random.cube(1.0) * 0.5 + 0.5;
    let (x, y) = (n.x * sides.x, n.y * sides.y);
    let eye = match random.index(6) {
        // In the block or a little above it.
        0 | 1 => DVec3::new(x, y, 1.2 * n.z),
        // Beside it, above or below.
        2 => DVec3::new(3.0 * x - sides.x, 3.0 * y - sides.y, 4.0 * n.z - 1.5),
        // At a corner of a cell, at a height of its own or on the floor.
        3 => DVec3::new(x.floor(), y.floor(), (2.0 * n.z).floor()),
        4 => DVec3::new(x, y, -2.0 * n.z),
        // Far off.
        _ => DVec3::new(
            30.0 * (x - 0.5 * sides.x),
            30.0 * (y - 0.5 * sides.y),
            30.0 * n.z,
        ),
    };
    let corner = -placement.position(DVec3::ZERO);
    let eye = placement.side((eye + corner) * placement.units());
    let kind = TracerKind::MaxMip.into();
    let tracer = tracer(&surface, &kind, None).unwrap();
    Seen {
        name: format!("{name}, eye {eye}"),
        truth: Tracer::reference(surface.clone()),
        ready: Ready {
            tracer,
            colors: Colors::Height,
            placement,
            kind: TracerKind::MaxMip,
            most_steps: 1,
            surface,
        },
        eye,
    }
}

impl Seen {
    fn solid(&self) -> Heightfield {
        Heightfield::new(self.ready.clone(), self.eye)
    }

    /// A cone from near the eye, most of them towards the block.
    fn cone(&self, random: &mut Random) -> Beam {
        let place = &self.ready.placement;
        let mut cone = cone(random);
        let unit = place.texel * 10.0_f64.powf(random.between(-2.0, 1.0));
        (cone.origin, cone.r0) = (unit * cone.origin, unit * cone.r0);
        // Narrow ones are what the finest cells are.
        if random.unit() < 0.5 {
            cone.k *= 0.05;
        }
        if random.unit() < 0.8 {
            let aim = (0.5 * random.cube(1.0) + 0.5) * place.sides.extend(1.0);
            let aim = aim - place.position(self.eye);
            cone.axis = place.side(aim * place.units()).normalize_or(DVec3::X);
        }
        cone
    }

    /// How far a ray, origin and direction, goes before it meets the block; it starts in the
    /// solid, or meets nothing.
    fn met(&self, (origin, axis): (DVec3, DVec3)) -> f64 {
        let Ready {
            surface, placement, ..
        } = &self.ready;
        let ray = LocalRay {
            origin: placement.position(self.eye + origin),
            axis: placement.direction(axis),
        };
        let p = ray.origin;
        let inside = p.truncate().cmpge(DVec2::ZERO).all()
            && p.truncate().cmple(placement.sides).all()
            && p.z >= 0.0;
        let cell = p.truncate().floor().min(placement.sides - 1.0);
        let at = p.truncate() - cell;
        if inside && p.z <= surface.height(cell.as_ivec2().to_array(), at.x, at.y) {
            return 0.0;
        }
        match run(&self.truth, &ray, END) {
            Some((Step::Hit, hit, _)) => hit.s,
            _ => f64::INFINITY,
        }
    }

    /// What the nearest of many rays of a cone meets.
    fn nearest(&self, cone: &Beam, random: &mut Random) -> f64 {
        let met = (0..RAYS).map(|_| self.met(ray_of(cone, random)));
        met.fold(f64::INFINITY, f64::min)
    }
}

/// What claims came to.
#[derive(Clone, Debug, Default)]
struct Told {
    /// The first claim beyond what a ray of the cone meets.
    behind: Option<String>,
    /// The share of what is met that the fronts of narrow cones reach, summed and counted.
    reached: f64,
    count: usize,
}

/// Holds claims against the rays of their cones.
fn told(seen: &Seen, claims: &[(Beam, f64)], seed: u64) -> Told {
    let one = |(i, (cone, front)): (usize, &(Beam, f64))| {
        let nearest = seen.nearest(cone, &mut Random::new(seed + i as u64));
        let counts = cone.k < 0.02 && nearest.is_finite() && nearest > 0.0;
        Told {
            behind: (*front > nearest)
                .then(|| format!("{front} beyond {nearest}, {}, {cone:?}", seen.name)),
            reached: if counts { front / nearest } else { 0.0 },
            count: usize::from(counts),
        }
    };
    let sum = |a: Told, b: Told| Told {
        behind: a.behind.or(b.behind),
        reached: a.reached + b.reached,
        count: a.count + b.count,
    };
    let all = claims.par_iter().enumerate().map(one);
    all.reduce(Told::default, sum)
}

#[test]
fn no_ray_meets_a_heightfield_before_the_front() {
    let (mut sum, mut count) = (0.0, 0);
    for seed in 0..600 {
        let told = told_of(&any(seed), seed);
        assert_eq!(told.behind, None);
        (sum, count) = (sum + told.reached, count + told.count);
    }
    // Nor do fronts keep to the truth by claiming next to nothing.
    let share = sum / count as f64;
    println!("fronts reach {share} of {count}");
    assert!(count > 3000 && share > 0.7, "{share} of {count}");
}

/// What the CPU claims of cones over a heightfield.
fn told_of(seen: &Seen, seed: u64) -> Told {
    let (solid, random) = (seen.solid(), &mut Random::new(1000 + seed));
    let claim = |random: &mut Random| {
        let cone = seen.cone(random);
        (cone, claimed(&solid, &cone, 1 + random.index(3) as u32))
    };
    let claims: Vec<_> = (0..60).map(|_| claim(random)).collect();
    told(seen, &claims, 100 * seed)
}

#[test]
fn no_ray_meets_a_large_heightfield_whose_cells_have_no_windows() {
    let setting = alone([3600, 3600], Patches::Bilinear);
    let surface = surface(setting, Pattern::Spikes.heights(setting.0, 7, 2.6));
    assert_eq!((surface.finest(), surface.windows(0).max.len()), (1, 0));
    // WebGPU promises buffers of 128 MiB.
    let arrays = surface.arrays();
    let bytes = arrays.iter().map(|array| array.bytes().len());
    assert!(bytes.max().unwrap() <= 128 << 20);
    let see = |seed| anywhere("large".into(), surface.clone(), &mut Random::new(seed));
    for seed in 0..20 {
        assert_eq!(told_of(&see(seed), seed).behind, None);
    }
    assert_eq!(told_by_device(0..4, &see, &|_, _| ()), [""; 0]);
}

/// The cone of a question, as f32 holds it.
fn narrowed(cone: &Beam) -> (Beam, Numbers) {
    let [o, d] = [cone.origin, cone.axis].map(|v| v.as_vec3());
    let (r0, k) = (cone.r0 as f32, cone.k as f32);
    let question = [
        [o.x, o.y, o.z, 0.0],
        [d.x, d.y, d.z, k],
        [r0, 3.0, 0.0, 0.0],
    ];
    let cone = Beam {
        origin: o.as_dvec3(),
        axis: d.as_dvec3().normalize(),
        r0: f64::from(r0),
        // The rest is for the rounding of the axis.
        k: (f64::from(k) - CHORD_SLACK).max(0.0),
        ..*cone
    };
    (cone, question)
}

/// A change of the shaders or of what they read, of a heightfield.
type Change<'a> = &'a dyn Fn(&Seen, &mut Probe);

/// What the device claims of cones over some heightfields, with a change.
fn told_by_device(seeds: Range<u64>, see: &dyn Fn(u64) -> Seen, change: Change) -> Vec<String> {
    let mut behind = Vec::new();
    for seed in seeds {
        let (seen, random) = (see(7000 + seed), &mut Random::new(8000 + seed));
        let solid = seen.solid();
        let mut modules = solid.modules();
        modules.extend(outcome::modules(false));
        modules.extend([
            wgsl!("base/view.wgsl"),
            wgsl!("base/perspective.wgsl"),
            wgsl!("scene/contract.wgsl"),
            probe!("advance"),
        ]);
        let mut parameters = solid.uniforms();
        let arrays = solid.arrays();
        parameters.extend(arrays.iter().map(|array| (array.name, array.bytes())));
        let mut probe = Probe {
            modules,
            parameters,
        };
        change(&seen, &mut probe);
        let cones: Vec<_> = (0..2000).map(|_| narrowed(&seen.cone(random))).collect();
        let asked: Vec<Numbers> = cones.iter().map(|c| c.1).collect();
        let answers = probe.ask(&asked).into_iter();
        let claims: Vec<_> = cones.iter().zip(answers).collect();
        let claims = claims.iter().map(|(c, a)| (c.0, f64::from(a[0][0])));
        let told = told(&seen, &claims.collect::<Vec<_>>(), 10_000 * seed);
        behind.extend(told.behind);
    }
    behind
}

#[test]
fn no_ray_meets_a_heightfield_before_the_front_on_the_device() {
    assert_eq!(told_by_device(0..24, &any, &|_, _| ()), [""; 0]);
}

/// Replaces a text of the shader.
fn edit(probe: &mut Probe, old: &str, new: &str) {
    let of = |m: &&mut Module| m.path == "wgsl/heightfield/maxima_cone.wgsl";
    let module = probe.modules.iter_mut().find(of).unwrap();
    assert_eq!(module.source.matches(old).count(), 1, "{old}");
    module.source = module.source.replace(old, new).into();
}

#[test]
fn the_check_sees_what_is_wrong_with_a_walk() {
    // An exit is not tested; the window is the one before.
    for (old, new) in [
        ("over > 0.0 && over + step * fall > 0.0", "over > 0.0"),
        ("nodes.x + 1) + at.x", "nodes.x + 1) + at.x - 1"),
    ] {
        let behind = told_by_device(0..24, &any, &|_, probe| edit(probe, old, new));
        println!("{old}: {} of 24", behind.len());
        assert!(!behind.is_empty(), "{old}");
    }
    // The next tile is not read; maxima of the samples in place of those of the cells.
    let tiled = |seen: &Seen| {
        let surface = &seen.ready.surface;
        let (domain, cells) = (surface.domain(), surface.cells());
        [0, 1].map(|i| domain[i] > cells[i] as i32)
    };
    let alone = |seen: &Seen, probe: &mut Probe| {
        replace_maxima(probe, seen.ready.surface.maxima(), [false; 2]);
    };
    let samples = |seen: &Seen, probe: &mut Probe| {
        let heights = seen.ready.surface.heights();
        if heights.wrap() == [true; 2] {
            let maxima = MaxMip::new(heights.size(), heights.data().to_vec());
            replace_maxima(probe, &maxima, tiled(seen));
        }
    };
    assert!(!told_by_device(0..24, &any, &alone).is_empty());
    assert!(!told_by_device(0..24, &any, &samples).is_empty());
}

/// Replaces the pyramid and its windows, of a map whose axes go round or not.
fn replace_maxima(probe: &mut Probe, maxima: &MaxMip, round: [bool; 2]) {
    let windows = maxima.windows(round, 0);
    let levels = maxima.levels.iter().chain(&windows);
    let all = levels.flat_map(|level| &level.max);
    let bytes = cast_slice(&all.copied().collect::<Vec<f32>>()).to_vec();
    let own = probe.parameters.iter_mut().find(|p| p.0 == "maxima");
    own.unwrap().1 = bytes;
}
