//! Plans that are hard on numbers: cameras too near, too far, inside and on folds, scales
//! and radii at the ends of their ranges, lenses and sizes that nobody uses.

use conemarch::formula::DistanceEstimate;
use conemarch::formula::mandelbox::{Estimate, Mandelbox};
use conemarch::plan::Plan;
use conemarch::plan::march::Mode;
use conemarch::scene::slab::SlabSettings;
use glam::{DVec3, Vec3Swizzles};

use super::plans::{bench_views, boxed, camera, limit_iterations, mandelbox, mandelbox_of, sized};
use super::random::Random;
use super::solved::{balls, slab};

/// Pixels of a hard picture, where its size is not what is hard.
pub const SIZE: [u32; 2] = [64, 48];

/// A hard plan and its name.
pub type Case = (String, Plan);

/// The shell with which the bounds of the groups were measured.
const SHELL: f64 = 0.45;

/// The distance that a Mandelbox's bounds reach.
fn extent(m: &Mandelbox) -> f64 {
    m.bounds().half.max_element().min(m.bounds().radius)
}

/// A Mandelbox twice: from outside, where its bounds fill the picture, and from the
/// emptiest place within that a search finds.
fn twice(name: &str, change: impl FnOnce(&mut Mandelbox)) -> [Case; 2] {
    let mut m = Mandelbox::default();
    change(&mut m);
    let far = extent(&m);
    // An eye off every axis and fold.
    let outside = from(m.clone(), DVec3::new(1.13, -1.71, 1.22) * far, DVec3::ZERO);
    let mut random = Random::new(21);
    let places = (0..2000).map(|_| random.cube(0.97 * far));
    let room = |p: &DVec3| m.estimate(*p, 60).0;
    let emptiest = places.max_by(|a, b| room(a).total_cmp(&room(b)));
    let eye = emptiest.expect("there are places");
    let mut inside = from(m, eye, eye.zxy());
    inside.camera.fov = 90.0;
    [("outside", outside), ("inside", inside)].map(|(from, plan)| (format!("{name}, {from}"), plan))
}

/// A Mandelbox seen from one point towards another, with cones.
pub fn from(m: Mandelbox, eye: impl Into<DVec3>, target: impl Into<DVec3>) -> Plan {
    let mut plan = Plan::new(boxed(m, None)).one_sample();
    // The details of its own pixels.
    plan.reference = None;
    plan.camera = camera(eye, target);
    plan.size = SIZE;
    (plan.march.coarsest, plan.march.shell) = (Some(16), Some(SHELL));
    plan
}

/// A built-in preset, with the same shell.
fn preset_with_shell(name: &str) -> Plan {
    let mut plan = sized(name, SIZE);
    plan.march.shell = Some(SHELL);
    plan
}

/// The first point on the way from one point to another whose estimate, in f64 with more
/// iterations than can matter, is the distance that is asked for, to a tenth.
fn before_surface(m: &Mandelbox, from: DVec3, to: DVec3, distance: f64) -> DVec3 {
    let axis = (to - from).normalize();
    let mut t = 0.0;
    for _ in 0..50_000 {
        let (d, _) = m.estimate(from + t * axis, 500);
        if d <= 1.1 * distance {
            assert!(d > 0.9 * distance, "{d} for {distance}");
            return from + t * axis;
        }
        t += 0.3 * (d - distance);
    }
    panic!("no surface from {from} to {to}");
}

/// Cameras ever nearer to the surface, looking on in the direction that led there.
pub fn near() -> Vec<Case> {
    let mut julia = mandelbox(2.0);
    (julia.julia, julia.julia_constant) = (true, DVec3::new(0.7, -0.4, 1.1));
    let mut rotated = mandelbox(2.0);
    rotated.rotation = DVec3::new(20.0, -35.0, 50.0);
    let mut large = mandelbox(2.0);
    (large.min_radius, large.fixed_radius, large.fold_limit) = (500.0, 1000.0, 1000.0);
    let boxes = [
        ("scale 2", mandelbox(2.0)),
        ("scale -1.5", mandelbox(-1.5)),
        ("scale 3", mandelbox(3.0)),
        ("scale 1.05", mandelbox(1.05)),
        ("rotated", rotated),
        ("julia", julia),
        ("lengths times 1000", large),
    ];
    let mut all = Vec::new();
    for (name, m) in boxes {
        let eye = DVec3::new(0.15, 0.3, -2.3) * extent(&m);
        let target = DVec3::new(0.12, 0.2, 0.1) * extent(&m);
        for n in 1..=9 {
            let at = before_surface(&m, eye, target, 10.0_f64.powi(-n) * m.fold_limit);
            let on = at + m.fold_limit * (target - eye).normalize();
            all.push((format!("{name}, 1e-{n} away"), from(m.clone(), at, on)));
        }
    }
    all
}

/// Eyes in places where a renderer may stumble.
pub fn eyes() -> Vec<Case> {
    let mut all = Vec::new();
    for scale in [2.0, -1.5] {
        let m = mandelbox(scale);
        let mut add = |name: &str, eye: DVec3, target: [f64; 3], change: fn(&mut Plan)| {
            let mut plan = from(m.clone(), eye, target);
            change(&mut plan);
            all.push((format!("scale {scale}, {name}"), plan));
        };
        let (l, corner) = (m.fold_limit, m.bounds().half);
        for (name, eye, target) in [
            ("at the origin", [0.0; 3], [1.0, 0.0, 0.0]),
            ("in the set", corner.to_array(), [0.0; 3]),
            ("on a fold plane", [l, 0.3, -2.5 * l], [l, 0.3, 0.0]),
            ("on three fold planes", [l, l, l], [0.2, 0.1, 3.0]),
            ("on the fixed sphere", [0.0, 0.0, 1.0], [0.3, 3.0, 1.2]),
            ("on the bounds", [corner.x, 0.3, 0.2], [0.0; 3]),
        ] {
            add(name, eye.into(), target, |p| {
                p.camera.up = DVec3::new(0.1, 1.0, 0.2)
            });
        }
        // One ray goes straight into the light, which half-way vectors do not survive.
        add(
            "looking into the light",
            DVec3::new(-4.0, 0.0, 0.0),
            [0.0; 3],
            |p| {
                (p.look.light, p.size) = (DVec3::X, [65, 47]);
            },
        );
        // Odd sizes, so that one ray goes through the middle, however small the set is there.
        let aside = DVec3::new(0.5, -0.7, 0.51);
        let narrow: fn(&mut Plan) = |p| (p.camera.fov, p.size) = (1.0, [65, 47]);
        add("1e3 away, fov 1", aside * 1e3, [0.0; 3], narrow);
        add("1e6 away, fov 1", aside * 1e6, [0.0; 3], narrow);
        add("1e9 away, fov 170", aside * 1e9, [0.0; 3], |p| {
            (p.camera.fov, p.size) = (170.0, [65, 47]);
        });
    }
    all
}

/// Planes that are seen at next to no angle: faces of cubes and of a slab.
pub fn grazing() -> Vec<Case> {
    let mut all = Vec::new();
    for height in [1e-1, 1e-2, 1e-3, 1e-4, 0.0] {
        // Along the upper face of the large cube, whose centre is (-1.6, 1.0, -0.4).
        let z = -0.4 + 0.7 + height;
        let face = balls(0.05, &camera([-4.5, 1.2, z], [-1.6, 1.0, z]), SIZE);
        all.push((format!("a cube's face, {height} above"), face));
        let s = SlabSettings::default();
        let (u, _) = s.normal.normalize().any_orthonormal_pair();
        let up = s.normal.normalize() * (s.half + height);
        let plan = slab(&camera(up - 2.0 * s.radius * u, up), SIZE);
        all.push((format!("a slab, {height} above"), plan));
    }
    all
}

/// A rod, thinner and thinner than a pixel.
pub fn rods() -> Vec<Case> {
    let camera = camera([4.0, -6.0, 3.0], [0.4, -2.0, 0.3]);
    let one = |radius: f64| {
        let mut plan = balls(radius, &camera, SIZE);
        plan.camera.fov = 40.0;
        (format!("radius {radius}"), plan)
    };
    [1e-2, 1e-3, 1e-4, 1e-5, 1e-6].map(one).to_vec()
}

/// Scales from next to 1 to 10, both signs.
pub fn scales() -> Vec<Case> {
    let sizes = [1.01, 1.05, 1.2, 1.5, 2.0, 2.5, 3.0, 5.0, 10.0];
    let both = sizes.into_iter().flat_map(|s| [s, -s]);
    both.flat_map(|s| twice(&format!("scale {s}"), |m| m.scale = s))
        .collect()
}

/// Inner radii from nothing to the outer one, and lengths far from 1.
pub fn radii() -> Vec<Case> {
    let mut all = Vec::new();
    for scale in [2.0, -1.5] {
        for min in [1e-6, 1e-3, 0.1, 0.9, 0.999_999, 1.0] {
            let name = format!("scale {scale}, min radius {min}");
            all.extend(twice(&name, |m| (m.scale, m.min_radius) = (scale, min)));
        }
        for unit in [1e-3, 1e-2, 1e2, 1e3] {
            all.extend(twice(
                &format!("scale {scale}, lengths times {unit}"),
                |m| {
                    m.scale = scale;
                    (m.min_radius, m.fixed_radius, m.fold_limit) = (0.5 * unit, unit, unit);
                },
            ));
        }
    }
    all
}

/// Iteration limits from 1 to 500.
pub fn iterations() -> Vec<Case> {
    let mut all = Vec::new();
    for scale in [2.0, -1.5, 1.1] {
        for most in [1, 2, 5, 20, 100, 500] {
            let mut cases = twice(&format!("scale {scale}, {most} iterations"), |m| {
                m.scale = scale
            });
            cases
                .iter_mut()
                .for_each(|(_, plan)| limit_iterations(plan, most));
            all.extend(cases);
        }
    }
    // More rounds of loops in 256 steps than a software device does at once.
    let mut m = mandelbox(-1.01);
    m.rotation = DVec3::new(17.7, -86.5, -54.2);
    let r = m.bounds().radius;
    let (eye, target) = (DVec3::new(1.3, -0.5, 0.2), DVec3::new(-0.2, -0.15, 0.1));
    let mut long = from(m, eye * r, target * r);
    (long.size, long.march.mode) = ([16, 12], Mode::Truth);
    limit_iterations(&mut long, 1000);
    all.push(("rotated, scale -1.01, 1000 iterations, truth".into(), long));
    all
}

/// Solids and a Mandelbox, both with a change.
fn near_and_far(name: &str, change: impl Fn(&mut Plan)) -> [Case; 2] {
    let solids = balls(0.05, &camera([4.0, -6.0, 3.0], [0.1, 0.2, 0.0]), SIZE);
    let plans = [
        ("solids", solids),
        ("scale -1.5", preset_with_shell("bench-outside")),
    ];
    plans.map(|(what, mut plan)| {
        change(&mut plan);
        (format!("{what}, {name}"), plan)
    })
}

/// Lenses from 1 to 170 degrees, on solids and on a Mandelbox.
pub fn lenses() -> Vec<Case> {
    let of = |fov| near_and_far(&format!("{fov} degrees"), |p| p.camera.fov = fov);
    [1.0, 5.0, 90.0, 150.0, 170.0]
        .into_iter()
        .flat_map(of)
        .collect()
}

/// Sizes from one pixel to a line of 4096.
pub fn sizes() -> Vec<Case> {
    let sizes = [
        [1, 1],
        [2, 1],
        [3, 2],
        [33, 17],
        [1, 4096],
        [4096, 1],
        [65, 63],
    ];
    let of = |size: [u32; 2]| near_and_far(&format!("{}x{}", size[0], size[1]), |p| p.size = size);
    sizes.into_iter().flat_map(of).collect()
}

/// One step for every cell and ray, in every mode; and a few.
pub fn limits() -> Vec<Case> {
    let mut all = Vec::new();
    for mode in [Mode::Safe, Mode::Ray, Mode::RayRelaxed] {
        for steps in [1, 2, 4] {
            for coarsest in [1, 16, 64] {
                let mut plan = preset_with_shell("bench-outside");
                (plan.march.mode, plan.march.coarsest) = (mode, Some(coarsest));
                plan.march.steps = Some(steps);
                let name = format!("{}, from 1/{coarsest}, {steps} steps", mode.name());
                all.push((name, plan));
            }
        }
    }
    all
}

/// The bench views with their Lipschitz constant multiplied: at 2 steps are half as long as
/// they may be, at 0.5 twice.
pub fn sloped(factor: f64) -> Vec<Case> {
    let one = |name: &str| {
        let mut plan = preset_with_shell(name);
        let m = mandelbox_of(&mut plan);
        // The steps of the sharper estimate are bounded by more than this constant.
        m.estimate = Estimate::Scalar;
        m.lipschitz = Some(factor * m.lipschitz());
        (name.to_string(), plan)
    };
    bench_views().map(one).collect()
}

/// The same plans with a shell that hardly lets a step into the hit threshold.
pub fn shelled(mut cases: Vec<Case>) -> Vec<Case> {
    cases
        .iter_mut()
        .for_each(|(_, plan)| plan.march.shell = Some(0.9));
    cases
}
