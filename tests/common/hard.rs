//! Plans that are hard on numbers: cameras too near, too far, inside and on folds, scales
//! and radii at the ends of their ranges, lenses and sizes that nobody uses.

use conemarch::formula::mandelbox::Mandelbox;
use conemarch::formula::{DistanceEstimate, Formula};
use conemarch::plan::camera::Camera;
use conemarch::plan::march::Mode;
use conemarch::plan::{Plan, Subject};
use conemarch::preset::load;
use conemarch::scene::slab::SlabSettings;
use glam::{DVec3, Vec3Swizzles};

use super::random::Random;
use super::solved::{balls, camera};

/// Pixels of a hard picture, where its size is not what is hard.
pub const SIZE: [u32; 2] = [64, 48];

/// A hard plan and its name.
pub type Case = (String, Plan);

/// A Mandelbox twice: from outside, where its bounds fill the picture, and from the
/// emptiest place within that a search finds.
pub fn twice(name: &str, change: impl FnOnce(&mut Mandelbox)) -> [Case; 2] {
    let mut m = Mandelbox::default();
    change(&mut m);
    let bounds = m.bounds();
    let far = bounds.half.max_element().min(bounds.radius);
    // An eye off every axis and fold.
    let outside = from(m.clone(), DVec3::new(1.13, -1.71, 1.22) * far, DVec3::ZERO);
    let mut random = Random::new(21);
    let places = (0..2000).map(|_| random.cube(0.97 * far));
    let room = |p: &DVec3| m.estimate(*p, 60).0;
    let emptiest = places.max_by(|a, b| room(a).total_cmp(&room(b)));
    let eye = emptiest.expect("there are places");
    let mut inside = from(m, eye, eye.zxy());
    inside.camera.fov = 90.0;
    [
        (format!("{name}, outside"), outside),
        (format!("{name}, inside"), inside),
    ]
}

/// A Mandelbox seen from one point towards another.
pub fn from(m: Mandelbox, eye: DVec3, target: DVec3) -> Plan {
    let mut plan = Plan::new(Subject::Distance {
        shape: Formula::Mandelbox(m),
        iterations: None,
    });
    plan.camera = Camera {
        fov: 48.5,
        ..camera(eye.to_array(), target.to_array())
    };
    plan.size = SIZE;
    plan
}

fn scaled(scale: f64) -> Mandelbox {
    Mandelbox {
        scale,
        ..Mandelbox::default()
    }
}

/// The first point on the way from one point to another whose estimate, in f64 with more
/// iterations than can matter, is the distance that is asked for, to a tenth.
///
/// # Panics
/// Where the way meets no surface.
pub fn before_surface(
    shape: &dyn DistanceEstimate,
    from: DVec3,
    to: DVec3,
    distance: f64,
) -> DVec3 {
    let axis = (to - from).normalize();
    let mut t = 0.0;
    for _ in 0..50_000 {
        let (d, _) = shape.estimate(from + t * axis, 500);
        if d <= 1.1 * distance {
            assert!(d > 0.9 * distance, "{d} for {distance}");
            return from + t * axis;
        }
        t += 0.3 * (d - distance);
    }
    panic!("no surface from {from} to {to}");
}

/// Distances of a camera from the surface: 1e-1 to 1e-9.
pub fn distances() -> impl Iterator<Item = (i32, f64)> {
    (1..=9).map(|n| (n, 10.0_f64.powi(-n)))
}

/// Cameras ever nearer to the surface, looking on in the direction that led there.
pub fn near() -> Vec<Case> {
    let julia = Mandelbox {
        julia: true,
        julia_constant: DVec3::new(0.7, -0.4, 1.1),
        ..scaled(2.0)
    };
    let rotated = Mandelbox {
        rotation: DVec3::new(20.0, -35.0, 50.0),
        ..scaled(2.0)
    };
    let large = Mandelbox {
        min_radius: 500.0,
        fixed_radius: 1000.0,
        fold_limit: 1000.0,
        ..scaled(2.0)
    };
    let shapes = [
        ("scale 2", scaled(2.0)),
        ("scale -1.5", scaled(-1.5)),
        ("scale 3", scaled(3.0)),
        ("scale 1.05", scaled(1.05)),
        ("rotated", rotated),
        ("julia", julia),
        ("lengths times 1000", large),
    ];
    let mut all = Vec::new();
    for (name, m) in shapes {
        let bounds = m.bounds();
        let far = bounds.half.max_element().min(bounds.radius);
        let (eye, target) = (
            DVec3::new(0.15, 0.3, -2.3) * far,
            DVec3::new(0.12, 0.2, 0.1) * far,
        );
        for (n, distance) in distances() {
            let at = before_surface(&m, eye, target, distance * m.fold_limit);
            let on = at + m.fold_limit * (target - eye).normalize();
            let name = format!("{name}, 1e-{n} away");
            all.push((name, from(m.clone(), at, on)));
        }
    }
    all
}

/// Eyes in places where a renderer may stumble.
pub fn eyes() -> Vec<Case> {
    let mut all = Vec::new();
    for scale in [2.0, -1.5] {
        let m = scaled(scale);
        let l = m.fold_limit;
        let corner = m.bounds().half;
        let places = [
            ("at the origin", DVec3::ZERO, DVec3::X),
            ("in the set", corner, DVec3::ZERO),
            (
                "on a fold plane",
                DVec3::new(l, 0.3, -2.5 * l),
                DVec3::new(l, 0.3, 0.0),
            ),
            (
                "on three fold planes",
                DVec3::new(l, l, l),
                DVec3::new(0.2, 0.1, 3.0),
            ),
            (
                "on the fixed sphere",
                DVec3::new(0.0, 0.0, 1.0),
                DVec3::new(0.3, 3.0, 1.2),
            ),
            ("on the bounds", DVec3::new(corner.x, 0.3, 0.2), DVec3::ZERO),
        ];
        for (name, eye, target) in places {
            let mut plan = from(m.clone(), eye, target);
            plan.camera.up = DVec3::new(0.1, 1.0, 0.2);
            all.push((format!("scale {scale}, {name}"), plan));
        }
        // One ray goes straight into the light, which half-way vectors do not survive.
        let mut plan = from(m.clone(), DVec3::new(-4.0, 0.0, 0.0), DVec3::ZERO);
        (plan.look.light, plan.size) = (DVec3::X, [65, 47]);
        all.push((format!("scale {scale}, looking into the light"), plan));
        // Odd sizes, so that one ray goes through the middle, however small the set is there.
        for (name, away, fov) in [("1e3", 1e3, 1.0), ("1e6", 1e6, 1.0), ("1e9", 1e9, 170.0)] {
            let eye = DVec3::new(0.5, -0.7, 0.51) * away;
            let mut plan = from(m.clone(), eye, DVec3::ZERO);
            (plan.camera.fov, plan.size) = (fov, [65, 47]);
            all.push((format!("scale {scale}, {name} away, fov {fov}"), plan));
        }
    }
    all
}

/// Planes that are seen at next to no angle: faces of cubes and of a slab.
pub fn grazing() -> Vec<Case> {
    let mut all = Vec::new();
    for height in [1e-1, 1e-2, 1e-3, 1e-4, 0.0] {
        // Along the upper face of the large cube, whose centre is (-1.6, 1.0, -0.4).
        let z = -0.4 + 0.7 + height;
        let camera_on = camera([-4.5, 1.2, z], [-1.6, 1.0, z]);
        all.push((
            format!("a cube's face, {height} above"),
            balls(0.05, &camera_on, SIZE),
        ));
        let slab = SlabSettings::default();
        let (u, _) = slab.normal.normalize().any_orthonormal_pair();
        let up = slab.normal.normalize() * (slab.half + height);
        let mut plan = balls(0.05, &camera_on, SIZE);
        plan.camera.eye = up - 2.0 * slab.radius * u;
        plan.camera.target = up;
        plan.subject = Subject::Slab(slab);
        all.push((format!("a slab, {height} above"), plan));
    }
    all
}

/// A rod, thinner and thinner than a pixel.
pub fn rods() -> Vec<Case> {
    let radii = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
    let one = |radius: f64| {
        let camera = camera([4.0, -6.0, 3.0], [0.4, -2.0, 0.3]);
        let mut plan = balls(radius, &camera, SIZE);
        plan.camera.fov = 40.0;
        (format!("radius {radius}"), plan)
    };
    radii.map(one).to_vec()
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
            for (name, mut plan) in twice(&format!("scale {scale}, {most} iterations"), |m| {
                m.scale = scale
            }) {
                if let Subject::Distance { iterations, .. } = &mut plan.subject {
                    *iterations = Some(most);
                }
                all.push((name, plan));
            }
        }
    }
    // More rounds of loops in 256 steps than a software device does at once.
    let m = Mandelbox {
        rotation: DVec3::new(17.7, -86.5, -54.2),
        ..scaled(-1.01)
    };
    let r = m.bounds().radius;
    let mut long = from(
        m,
        DVec3::new(1.3, -0.5, 0.2) * r,
        DVec3::new(-0.2, -0.15, 0.1) * r,
    );
    (long.size, long.march.mode) = ([16, 12], Mode::Truth);
    if let Subject::Distance { iterations, .. } = &mut long.subject {
        *iterations = Some(1000);
    }
    all.push(("rotated, scale -1.01, 1000 iterations, truth".into(), long));
    all
}

/// Lenses from 1 to 170 degrees, on solids and on a Mandelbox.
pub fn lenses() -> Vec<Case> {
    let mut all = Vec::new();
    for fov in [1.0, 5.0, 90.0, 150.0, 170.0] {
        let mut plan = balls(0.05, &camera([4.0, -6.0, 3.0], [0.1, 0.2, 0.0]), SIZE);
        plan.camera.fov = fov;
        all.push((format!("solids, {fov} degrees"), plan));
        let mut plan = load("bench-outside", &[]).expect("built in").plan;
        plan.size = SIZE;
        plan.camera.fov = fov;
        all.push((format!("scale -1.5, {fov} degrees"), plan));
    }
    all
}

/// Sizes from one pixel to a line of 4096.
pub fn sizes() -> Vec<Case> {
    let mut all = Vec::new();
    for size in [
        [1, 1],
        [2, 1],
        [3, 2],
        [33, 17],
        [1, 4096],
        [4096, 1],
        [65, 63],
    ] {
        let near = camera([4.0, -6.0, 3.0], [0.1, 0.2, 0.0]);
        let [w, h] = size;
        let mut plan = balls(0.05, &near, size);
        all.push((format!("solids, {w}x{h}"), plan));
        plan = load("bench-outside", &[]).expect("built in").plan;
        plan.size = size;
        all.push((format!("scale -1.5, {w}x{h}"), plan));
    }
    all
}

/// One step for every cell and ray, in every mode; and a few.
pub fn limits() -> Vec<Case> {
    let mut all = Vec::new();
    for mode in [Mode::Safe, Mode::Ray, Mode::RayRelaxed] {
        for steps in [1, 2, 4] {
            for coarsest in [1, 16, 64] {
                let mut plan = load("bench-outside", &[]).expect("built in").plan;
                plan.size = SIZE;
                plan.march.mode = mode;
                plan.march.steps = Some(steps);
                plan.march.coarsest = coarsest;
                let name = format!("{}, from 1/{coarsest}, {steps} steps", mode.name());
                all.push((name, plan));
            }
        }
    }
    all
}

/// The bench views with their Lipschitz constant multiplied.
fn sloped(factor: f64) -> Vec<Case> {
    let one = |name: &str| {
        let mut plan = load(format!("bench-{name}"), &[]).expect("built in").plan;
        plan.size = SIZE;
        if let Subject::Distance {
            shape: Formula::Mandelbox(m),
            ..
        } = &mut plan.subject
        {
            m.lipschitz = Some(factor * m.lipschitz());
        }
        (format!("bench-{name}"), plan)
    };
    ["far", "graze", "inside", "outside", "thin"]
        .map(one)
        .to_vec()
}

/// Steps half as long as they may be.
pub fn cautious() -> Vec<Case> {
    sloped(2.0)
}

/// Steps twice as long as they may be.
pub fn reckless() -> Vec<Case> {
    sloped(0.5)
}

/// The same plans with a shell that hardly lets a step into the hit threshold.
pub fn shelled(cases: Vec<Case>) -> Vec<Case> {
    let one = |(name, mut plan): Case| {
        plan.march.shell = 0.9;
        (name, plan)
    };
    cases.into_iter().map(one).collect()
}
