//! Palette, sky, surfaces and their light agree.

use bytemuck::bytes_of;
use conemarch::base::random::{random_pair, random_seed};
use conemarch::base::view::{Beam, footprint};
use conemarch::pass::aim::aim;
use conemarch::pass::lamp::{Lamp, lamp_from, lamp_light};
use conemarch::pass::look::Place;
use conemarch::pass::material::{Substance, material_frame};
use conemarch::pass::{LookFeature, fog, occlusion, shadow};
use conemarch::plan::Plan;
use conemarch::plan::look::{LightMode, Look};
use conemarch::scene::{Hit, Solid};
use glam::DVec3;

use super::beams::beam;
use super::common::plans::{distance, distance_solid, light, scene};
use super::common::probe::{Probe, probe};
use super::common::setups::{four, probe_of, seen_from};
use super::compare::{Allowed, DECIDED, MOVED, Twins, questions};
use super::{balls, three};

/// Adds the look of a plan to what a probe binds.
fn with_look(mut probe: Probe, plan: &Plan) -> Probe {
    let look = bytes_of(&light(plan).parameters()).to_vec();
    probe.modules.push(conemarch::wgsl!("pass/look.wgsl"));
    probe.modules.push(conemarch::wgsl!("pass/sky.wgsl"));
    probe.parameters.push(("look_parameters", look));
    probe
}

/// A plan with a change.
fn changed(plan: &Plan, change: fn(&mut Plan)) -> Plan {
    let mut moved = plan.clone();
    change(&mut moved);
    moved
}

#[test]
fn palette_pigment_and_sky_agree() {
    let plan = seen_from([4.0, -9.0, 6.0], scene("kind = 'slab'"));
    let asked = questions(7, |random| {
        let x = random.between(-1.0, 4.0);
        let sky = random.direction();
        let pigment = DVec3::new(random.unit(), random.unit(), random.unit());
        [DVec3::X * x, sky, pigment].map(|v| four(v, 0.0))
    });
    let light = light(&plan);
    let quantities = [("palette_at sky pigment_color", 0.01, Allowed(1e-6, 1e-5))];
    let twins = Twins::new(&asked, &quantities, |pairs, q, a| {
        pairs.add_vector("palette_at", a[0], light.palette_at(f64::from(q[0][0])));
        pairs.add_vector("sky", a[1], light.sky(three(q[1])));
        pairs.add_vector("pigment_color", a[2], light.pigment_color(three(q[2])));
    });
    let mut bare = Probe::default();
    bare.modules.push(probe!("look"));
    let probe = |change| with_look(bare.clone(), &changed(&plan, change));
    let cycles = probe(|p| p.look.palette_cycles *= MOVED);
    let sky = probe(|p| {
        p.look.sky_high *= MOVED;
        p.look.sky_low *= MOVED;
    });
    let moved = [("palette_at pigment_color", cycles), ("sky", sky)];
    twins.assert_agree("look", &probe(|_| ()), &moved);
}

#[test]
fn materials_agree() {
    let look = Look {
        roughness: 0.3,
        metal: 0.3,
        mode: LightMode::Path,
        ..Look::default()
    };
    let asked = questions(9, |random| {
        let v = random.direction();
        let v = DVec3::new(v.x, v.y, v.z.abs() + 0.05).normalize();
        let albedo = DVec3::new(random.unit(), random.unit(), random.unit());
        // Numbers that are floats of their own bits.
        let mut bits = || f32::from_bits((random.unit() * 4000.0) as u32);
        let whole = [bits(), bits(), bits(), bits()];
        [four(v, random.unit()), four(albedo, 0.0), whole]
    });
    let substance = Substance::of(&look);
    let quantities = [
        ("random", 1e-9, Allowed(0.0, 0.0)),
        ("scatter", 0.1, Allowed(1e-5, 1e-3)),
        ("reflects density", 0.01, Allowed(1e-4, 1e-2)),
        ("frame", 0.1, Allowed(1e-6, 1e-5)),
    ];
    let twins = Twins::new(&asked, &quantities, |pairs, q, a| {
        let [x, y, sample, purpose] = q[2].map(f32::to_bits);
        let numbers = random_pair(random_seed([x, y]), sample, purpose);
        let (v, albedo) = (three(q[0]), three(q[1]));
        let material = substance.material_at(albedo, v);
        let l = substance.material_scatter(&material, v, numbers, f64::from(q[0][3]));
        let up = DVec3::new(l.x, l.y, l.z.abs() + 0.01).normalize();
        let (light, density) = substance.material_reflects(&material, v, up, f64::from(q[0][3]));
        pairs.add("random", a[0][0], numbers.x);
        pairs.add("random", a[0][1], numbers.y);
        pairs.add("scatter", a[0][2], l.x);
        pairs.add("scatter", a[0][3], l.y);
        pairs.add("scatter", a[2][3], l.z);
        pairs.add_vector("reflects", a[1], light);
        pairs.add("density", a[1][3], density);
        pairs.add_vector("frame", a[2], material_frame(v) * albedo);
    });
    let probe = |look: &Look| {
        let mut plan = seen_from([4.0, -9.0, 6.0], scene("kind = 'slab'"));
        plan.look = look.clone();
        let modules = [
            conemarch::wgsl!("base/random.wgsl"),
            conemarch::wgsl!("pass/material.wgsl"),
            probe!("material"),
        ];
        let bare = Probe {
            modules: modules.to_vec(),
            ..Probe::default()
        };
        with_look(bare, &plan)
    };
    let moved = |change: fn(&mut Look)| {
        let mut look = look.clone();
        change(&mut look);
        probe(&look)
    };
    let moved = [
        ("reflects", moved(|look| look.roughness *= 1.01)),
        ("density", moved(|look| look.metal *= 1.05)),
    ];
    twins.assert_agree("material", &probe(&look), &moved);
}

#[test]
fn rays_go_to_the_same_points_of_lights() {
    let plan = seen_from([4.0, -9.0, 6.0], scene("kind = 'slab'"));
    let asked = questions(13, |random| {
        let pair = DVec3::new(random.unit(), random.unit(), 0.0);
        let softness = random.between(1e-3, 1.0);
        [
            four(random.direction(), softness),
            four(pair, 0.0),
            [0.0; 4],
        ]
    });
    let quantities = [("aim", 0.01, Allowed(1e-6, 1e-5))];
    let twins = Twins::new(&asked, &quantities, |pairs, q, a| {
        let lamp = Lamp {
            axis: three(q[0]),
            far: 0.0,
            softness: f64::from(q[0][3]),
        };
        pairs.add_vector("aim", a[0], aim(&lamp, three(q[1]).truncate()));
    });
    let bare = Probe {
        modules: vec![
            conemarch::wgsl!("pass/material.wgsl"),
            conemarch::wgsl!("pass/aim.wgsl"),
            probe!("aim"),
        ],
        ..Probe::default()
    };
    let mut uneven = bare.clone();
    let source = &mut uneven.modules[1].source;
    *source = source.replace("sqrt(pair.y)", "pair.y").into();
    let moved = [("aim", with_look(uneven, &plan))];
    let bare = with_look(bare, &plan);
    twins.assert_agree("aim", &bare, &moved);
}

#[test]
fn lamps_agree() {
    let mut plan = seen_from([4.0, -9.0, 6.0], scene("kind = 'slab'"));
    let spots = [[1.0, 2.0, 3.0], [-2.0, 0.5, 3.0], [0.0, -1.0, 2.0]].map(DVec3::from_array);
    let look = &mut plan.look;
    (look.lamp, look.lamp_at) = (0.5, Some(spots[0]));
    let more = &mut look.lamps;
    (more.lamp2, more.lamp2_at, more.lamp2_cone) = (1.0, Some(spots[1]), Some(70.0));
    (more.lamp3, more.lamp3_at, more.lamp3_cone) = (2.0, Some(spots[2]), Some(1.5));
    more.lamp2_toward = Some(DVec3::new(-1.0, 1.0, 0.0));
    more.lamp3_toward = Some(DVec3::new(1.0, 0.0, -3.0));
    let asked = questions(10, |random| {
        let axis = DVec3::new(1.0, 1.0, -5.0).normalize();
        // Within and around the thin cone.
        let within = spots[2] + 4.0 * (axis + random.cube(0.015));
        let points = [random.cube(3.0), random.cube(3.0), within];
        points.map(|point| four(point - plan.camera.eye, 0.0))
    });
    let light = light(&plan);
    let lit = asked.iter().filter(|q| {
        let lamp = lamp_from(&light, 2, three(q[2]));
        lamp_light(&light, 2, &lamp) != DVec3::ZERO
    });
    let lit = lit.count();
    assert!(lit > 2000 && lit < 6000, "{lit}");
    let quantities = [
        ("first second size", 0.01, Allowed(2e-6, 1e-4)),
        // Its edge is as thin as a thousand roundings of a direction.
        ("third", 1.0, Allowed(1e-4, 1e-2)),
    ];
    let twins = Twins::new(&asked, &quantities, |pairs, q, a| {
        for (nth, name) in ["first", "second", "third"].into_iter().enumerate() {
            let lamp = lamp_from(&light, nth, three(q[nth]));
            pairs.add_vector(name, a[nth], lamp_light(&light, nth, &lamp));
            pairs.add("size", a[nth][3], lamp.softness);
        }
    });
    let bare = Probe {
        modules: vec![conemarch::wgsl!("pass/lamp.wgsl"), probe!("lamps")],
        ..Probe::default()
    };
    let probe = |change| with_look(bare.clone(), &changed(&plan, change));
    let moved = [
        ("first", probe(|p| p.look.lamp *= MOVED)),
        ("second", probe(|p| p.look.lamps.lamp2_cone = Some(71.0))),
        ("third", probe(|p| p.look.lamps.lamp3_cone = Some(1.6))),
        ("second", probe(|p| p.look.lamps.lamp2_toward = None)),
        ("size", probe(|p| p.look.lamps.lamp3_size *= 1.01)),
    ];
    twins.assert_agree("lamps", &probe(|_| ()), &moved);
}

#[test]
fn surfaces_and_their_light_agree() {
    for fog_height in [0.0, 0.2] {
        surfaces_agree(fog_height);
    }
}

/// The comparison, with fog that thins out over a height, or as dense everywhere.
fn surfaces_agree(fog_height: f64) {
    let eye = DVec3::new(1.0, -6.0, 2.5);
    let mut plan = seen_from(eye, distance(balls(1.0), Some(1)));
    plan.look.fog = 1.0;
    plan.look.lamp = 1.0;
    plan.look.fog_height = fog_height;
    plan.look.fog_level = -0.1;
    plan.look.occlusion_reach = 0.3;
    let asked = questions(8, |random| {
        // Points on the sphere about the largest ball, seen from the eye.
        let normal = random.direction();
        let point = normal * random.between(1.001, 1.3) - eye;
        let (t, grain) = (point.length(), 0.002);
        [four(point, t), four(point / t, grain), four(normal, 0.0)]
    });
    let (scene, light) = (distance_solid(&plan), light(&plan));
    let quantities = [
        ("normal", 0.1, Allowed(5e-5, 5e-4)),
        ("pigment", 0.1, Allowed(2e-6, 3e-5)),
        ("shadow", 0.1, DECIDED),
        ("occlusion", 0.1, Allowed(1e-5, 1e-4)),
        ("fog", 0.1, Allowed(1e-6, 1e-5)),
        ("lamp", 0.01, Allowed(1e-6, 1e-5)),
    ];
    let twins = Twins::new(&asked, &quantities, |pairs, q, a| {
        let ray = Beam {
            origin: DVec3::ZERO,
            grain: f64::from(q[1][3]),
            r0: 0.0,
            k: 0.0,
            ..beam(q)
        };
        let t = f64::from(q[0][3]);
        let hit = Hit {
            t,
            ..Hit::default()
        };
        let at = scene.surface(&ray, &hit);
        let point = three(q[0]);
        let place = Place {
            q: point,
            normal: three(q[2]),
            grain: footprint(&ray, t),
        };
        let sun = light.sun(scene.bounds_far());
        let shaded = shadow::shadow((&scene, &light), place, &sun).open;
        let near = lamp_from(&light, 0, point);
        // Along the normal of the device.
        let along = Place {
            normal: three(a[0]),
            ..place
        };
        let hidden = occlusion::occlusion(&scene, &light, along);
        let fogged = fog::fog(&light, DVec3::new(0.2, 0.5, 0.9), &ray, t);
        pairs.add_vector("normal", a[0], at.normal);
        pairs.add_vector("pigment", a[1], at.pigment);
        pairs.add("shadow", a[0][3], shaded);
        pairs.add("occlusion", a[1][3], hidden);
        pairs.add_vector("fog", a[2], fogged);
        pairs.add("lamp", a[2][3], near.softness);
    });
    let probe = |change| {
        let plan = changed(&plan, change);
        let mut lit = probe_of(&plan, probe!("lit"));
        let features = LookFeature::ALL.iter();
        lit.modules
            .extend(features.map(|feature| feature.module(feature.is_on(&plan.look))));
        with_look(lit, &plan)
    };
    let mut moved = vec![
        (
            "normal pigment",
            probe(|p| p.camera.eye += DVec3::splat(0.05)),
        ),
        ("shadow", probe(|p| p.look.light.z += 0.3)),
        ("occlusion", probe(|p| p.look.occlusion *= MOVED)),
        ("fog", probe(|p| p.look.fog *= MOVED)),
        ("lamp", probe(|p| p.look.lamp_size *= MOVED)),
    ];
    if fog_height > 0.0 {
        moved.push(("fog", probe(|p| p.look.fog_height *= MOVED)));
        moved.push(("fog", probe(|p| p.look.fog_level *= 1.0 + 1e-2)));
    }
    twins.assert_agree("balls", &probe(|_| ()), &moved);
}
