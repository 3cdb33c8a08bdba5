//! Pictures by the light of lamps alone.

use conemarch::picture::frame::Frame;
use conemarch::plan::look::{LightMode, Look};
use conemarch::plan::{Extras, Plan};
use glam::DVec3;

use super::common::plans::{scene, sized};
use super::work::bits;
use crate::adapter::{HIT, both, on_cpu, render};

/// The plan in a mode, without any light.
fn dark(mut plan: Plan, mode: LightMode) -> Plan {
    let look = &mut plan.look;
    (look.mode, look.bounces) = (mode, 0);
    (look.key, look.fill, look.gloss, look.fog) = (0.0, 0.0, 0.0, 0.0);
    (look.lamp_size, look.lamps.lamp2_size) = (1e-4, 1e-4);
    plan
}

/// A flat white ground would have this radiance under a lamp of strength 1, if `at` is where the lamp is
/// relative to a point: inverse square, cosine, and the share within a cone of two half angles.
fn closed_form(at: DVec3, unit: f64, toward: DVec3, [full, none]: [f64; 2]) -> f64 {
    let away = (-at).normalize().dot(toward.normalize());
    let t = (away - none.cos()) / (full.cos() - none.cos());
    let t = t.clamp(0.0, 1.0);
    let share = t * t * (3.0 - 2.0 * t);
    share * (at.z / at.length()) * (unit * unit) / at.length_squared()
}

#[test]
fn a_spot_on_a_plane_has_its_closed_form() {
    const EYE: DVec3 = DVec3::new(0.0, 0.0, 5.0);
    let spot = DVec3::new(1.0, -0.5, 2.5);
    let toward = DVec3::new(0.3, 0.2, 0.5);
    let mut plan = Plan::new(scene("kind = 'slab'")).one_sample();
    (plan.camera.eye, plan.camera.target) = (EYE, DVec3::ZERO);
    (plan.camera.up, plan.size) = (DVec3::Y, [64, 36]);
    // Rays to light start as near the ground as those of a large picture.
    plan.reference = Some(65_536);
    let distance = 5.0;
    // Path mode asks a little above the ground, and for points of a disc.
    for (mode, slack) in [(LightMode::Quick, 1e-5), (LightMode::Path, 1e-3)] {
        let mut lit = dark(plan.clone(), mode);
        // The sun from above shows the colour of the ground.
        let mut sun = lit.clone();
        (sun.look.key, sun.look.light, sun.look.light_size) = (1.0, DVec3::Z, 0.05);
        sun.look.light_color = DVec3::ONE;
        let look = &mut lit.look;
        (look.lamp, look.lamp_color, look.lamp_at) = (1.0, DVec3::ONE, Some(spot));
        for cone in [Some(50.0), None, Some(360.0)] {
            (lit.look.lamp_cone, lit.look.lamp_toward) = (cone, Some(toward));
            // Full light ends at 0.8 of the cone's angle. Beyond a turn there is no edge.
            let half = cone.map_or(180.0, |cone: f64| 0.5 * cone).to_radians();
            let everywhere = half > 3.0;
            for (lamp, sun) in both(&lit).iter().zip(&both(&sun)) {
                let mut seen = [0; 3];
                for (i, state) in lamp.state.iter().enumerate() {
                    let pixel = [i as u32 % 64, i as u32 / 64];
                    assert_eq!(*state, HIT);
                    let axis = plan.view().view_ray(pixel).axis;
                    let at = spot - (EYE + axis * ((0.5 - EYE.z) / axis.z));
                    let aim = toward - spot;
                    let all = closed_form(at, distance, -at, [0.5, 1.0]);
                    let want = match everywhere {
                        true => all,
                        false => closed_form(at, distance, aim, [0.8 * half, half]),
                    };
                    let part = usize::from(want > 0.0) + usize::from(want > 0.999 * all);
                    seen[part] += 1;
                    for c in 0..3 {
                        let got = f64::from(lamp.radiance[i][c] / sun.radiance[i][c]);
                        let off = (got - want).abs();
                        assert!(
                            off <= 2e-3 * want + slack && (want > 0.0 || got == 0.0),
                            "{mode:?} {cone:?} {pixel:?}: {got} for {want}"
                        );
                    }
                }
                println!("{mode:?} {cone:?}: {seen:?}");
                match everywhere {
                    true => assert_eq!(seen[..2], [0, 0]),
                    false => assert!(seen.iter().all(|n| *n > 60), "{seen:?}"),
                }
            }
        }
    }
}

/// The share of pixels whose light is off by more than a hundredth.
fn apart(one: &[[f32; 3]], two: &[[f32; 3]]) -> f64 {
    let off = |(a, b): &(&[f32; 3], &[f32; 3])| {
        (0..3).any(|c| (a[c] - b[c]).abs() > 1e-2 * b[c].abs() + 1e-5)
    };
    one.iter().zip(two).filter(off).count() as f64 / one.len() as f64
}

fn sum(a: &Frame, b: &Frame) -> Vec<[f32; 3]> {
    let pairs = a.radiance.iter().zip(&b.radiance);
    let one = |(a, b): (&[f32; 3], &[f32; 3])| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    pairs.map(one).collect()
}

#[test]
fn lamps_add_up_and_their_order_is_nothing() {
    for mode in [LightMode::Quick, LightMode::Path] {
        let mut none = sized("mandelbox-gate", [96, 54]);
        none.look = Look::default();
        let none = dark(none, mode);
        let (eye, target) = (none.camera.eye, none.camera.target);
        let side = (target - eye).cross(none.camera.up).normalize();
        let beside = |share: f64| Some(eye + share * (target - eye).length() * side);
        // One shines everywhere, the other in a cone.
        let mut first = none.clone();
        (first.look.lamp, first.look.lamp_at) = (0.7, beside(0.1));
        let mut second = none.clone();
        let lamps = &mut second.look.lamps;
        (lamps.lamp2, lamps.lamp2_at) = (1.3, beside(-0.2));
        lamps.lamp2_cone = Some(40.0);
        let mut both_lamps = first.clone();
        both_lamps.look.lamps = second.look.lamps.clone();
        let mut moved = none.clone();
        (moved.look.lamp, moved.look.lamp_at) = (1.3, beside(-0.2));
        (moved.look.lamp_cone, moved.look.lamp_color) = (Some(40.0), second.look.lamps.lamp2_color);
        let mut twice = second.clone();
        let lamps = &mut twice.look.lamps;
        (lamps.lamp3, lamps.lamp3_at) = (lamps.lamp2, lamps.lamp2_at);
        (lamps.lamp3_color, lamps.lamp3_size) = (lamps.lamp2_color, lamps.lamp2_size);
        lamps.lamp3_cone = lamps.lamp2_cone;
        let on_gpu: fn(&Plan) -> Frame = |plan| render(plan, Extras::default());
        let frames = [on_gpu, |plan| on_cpu(plan, Extras::default())].map(|made| {
            let [one, two, all] = [&first, &second, &both_lamps].map(made);
            let [zero, again, twice] = [&none, &moved, &twice].map(made);
            // There is something to add, and the cone leaves something out.
            let bright = |frame: &Frame| apart(&frame.radiance, &zero.radiance);
            println!("{mode:?}: {} {}", bright(&one), bright(&two));
            assert!(bright(&one) > 0.3 && bright(&two) > 0.1 && bright(&two) < 0.95);
            assert!(apart(&one.radiance, &two.radiance) > 0.3);
            // A lamp that is alone is the first one.
            assert!(bits(&two) == bits(&again), "{mode:?}");
            let doubled = apart(&twice.radiance, &sum(&two, &two));
            let added = apart(&all.radiance, &sum(&one, &two));
            println!("{mode:?}: {added} {doubled}");
            // In path mode the rays to further lamps have numbers of their own.
            let most = if mode == LightMode::Quick { 0.0 } else { 0.02 };
            assert!(
                added <= most && doubled <= most,
                "{mode:?}: {added} {doubled}"
            );
            all
        });
        let [gpu, cpu] = frames;
        let off = apart(&gpu.radiance, &cpu.radiance);
        println!("{mode:?}: {off} between executors");
        assert!(off < 0.05, "{mode:?}: {off}");
    }
}
