//! Palette, sky, surfaces and their light agree.

use super::probe::{Allowed, Errors, Numbers, Probe, agree_unless_moved, probe};
use super::random::Random;
use super::setups::{
    MOVED, balls, beam, four, lit_probe_of, look_parameter, shape_plan, slab_plan, three,
};
use conemarch::base::view::{Beam, footprint};
use conemarch::pass::look::Light;
use conemarch::pass::{fog, look, occlusion, shadow};
use conemarch::plan::Plan;
use conemarch::scene::AnySolid;
use conemarch::scene::Assets;
use conemarch::scene::slab::SlabSettings;
use conemarch::scene::{Hit, Solid, Surface};
use glam::DVec3;

/// A change of a plan, by name.
type Change = (&'static str, fn(&mut Plan));

#[test]
fn palette_pigment_and_sky_agree() {
    let plan = slab_plan(SlabSettings::default());
    let mut random = Random::new(7);
    let question = |_| {
        let x = random.between(-1.0, 4.0);
        let pigment = DVec3::new(random.unit(), random.unit(), random.unit());
        [
            four(DVec3::X * x, 0.0),
            four(random.direction(), 0.0),
            four(pigment, 0.0),
        ]
    };
    let asked: Vec<Numbers> = (0..8192).map(question).collect();
    let light = Light::of(&plan, &Assets::default());
    let errors = |gpu: &Plan| {
        let probe = Probe {
            modules: vec![look::module(), probe!("look")],
            parameters: vec![look_parameter(gpu)],
        };
        let told = probe.ask(&asked);
        let mut all = [vec![], vec![], vec![]];
        for (q, a) in asked.iter().zip(&told) {
            let want = [
                light.palette_at(f64::from(q[0][0])),
                light.sky(three(q[1])),
                light.pigment_color(three(q[2])),
            ];
            for (i, want) in want.into_iter().enumerate() {
                all[i].extend((0..3).map(|j| (a[i][j], want[j])));
            }
        }
        all.map(|pairs| Errors::of(pairs, 0.01))
    };
    let allowed = Allowed {
        median: 1e-6,
        p99: 1e-5,
    };
    let own = errors(&plan);
    let changes: [Change; 3] = [
        ("palette_at", |p| p.look.palette_cycles *= MOVED),
        ("sky", |p| {
            p.look.sky_high *= MOVED;
            p.look.sky_low *= MOVED;
        }),
        ("pigment_color", |p| p.look.palette_cycles *= MOVED),
    ];
    for (i, (name, change)) in changes.into_iter().enumerate() {
        let mut moved = plan.clone();
        change(&mut moved);
        agree_unless_moved(name, allowed, own[i], errors(&moved)[i]);
    }
}

/// Errors of a lit point: normal, pigment, shadow, occlusion, fog.
fn lit_errors<S: Solid>(solid: &S, cpu: &Plan, asked: &[Numbers], told: &[Numbers]) -> [Errors; 5] {
    let light = Light::of(&cpu, &Assets::default());
    let mut all = [vec![], vec![], vec![], vec![], vec![]];
    for (q, a) in asked.iter().zip(told) {
        let ray = Beam {
            origin: DVec3::ZERO,
            grain: f64::from(q[1][3]),
            r0: 0.0,
            k: 0.0,
            ..beam(q)
        };
        let t = f64::from(q[0][3]);
        let at: Surface = solid.surface(
            &ray,
            &Hit {
                t,
                ..Hit::default()
            },
        );
        let (point, normal, grain) = (three(q[0]), three(q[2]), footprint(&ray, t));
        let fogged = fog::fog(&light, DVec3::new(0.2, 0.5, 0.9), ray.axis, t);
        for i in 0..3 {
            all[0].push((a[0][i], at.normal[i]));
            all[1].push((a[1][i], at.pigment[i]));
            all[4].push((a[2][i], fogged[i]));
        }
        let lit = shadow::shadow(solid, &light, point, normal, grain);
        all[2].push((a[0][3], lit.open));
        all[3].push((
            a[1][3],
            occlusion::occlusion(solid, &light, point, normal, grain),
        ));
    }
    all.map(|pairs| Errors::of(pairs, 0.1))
}

#[test]
fn surfaces_and_their_light_agree() {
    let eye = DVec3::new(1.0, -6.0, 2.5);
    let mut plan = shape_plan(balls(1.0), 1, eye);
    plan.look.fog = 1.0;
    plan.look.light_size = 20.0;
    plan.look.occlusion_reach = 0.3;
    let mut random = Random::new(8);
    let question = |_| {
        // Points on the sphere about the largest ball, seen from the eye.
        let normal = random.direction();
        let point = normal * random.between(1.001, 1.3) - eye;
        let (t, grain) = (point.length(), 0.002);
        [four(point, t), four(point / t, grain), four(normal, 0.0)]
    };
    let asked: Vec<Numbers> = (0..8192).map(question).collect();
    let AnySolid::Distance(scene) = plan.solid(&Assets::default()).unwrap() else {
        unreachable!("a distance scene");
    };
    let errors = |gpu: &Plan| {
        let told = lit_probe_of(gpu, probe!("lit")).ask(&asked);
        lit_errors(&scene, &plan, &asked, &told)
    };
    let own = errors(&plan);
    let allowed = [
        (
            "normal",
            Allowed {
                median: 5e-5,
                p99: 5e-4,
            },
        ),
        (
            "pigment",
            Allowed {
                median: 2e-6,
                p99: 3e-5,
            },
        ),
        (
            "shadow",
            Allowed {
                median: 1e-6,
                p99: 5e-5,
            },
        ),
        (
            "occlusion",
            Allowed {
                median: 1e-5,
                p99: 1e-4,
            },
        ),
        (
            "fog",
            Allowed {
                median: 1e-6,
                p99: 1e-5,
            },
        ),
    ];
    let changes: [Option<fn(&mut Plan)>; 5] = [
        None,
        None,
        Some(|p| p.look.light_size *= MOVED),
        Some(|p| p.look.occlusion *= MOVED),
        Some(|p| p.look.fog *= MOVED),
    ];
    for (i, (name, allowed)) in allowed.into_iter().enumerate() {
        let mut moved = plan.clone();
        match changes[i] {
            Some(change) => change(&mut moved),
            None => moved.camera.eye += DVec3::splat(0.05),
        }
        agree_unless_moved(name, allowed, own[i], errors(&moved)[i]);
    }
}
