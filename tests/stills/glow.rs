//! Light of the air near the surface.

use conemarch::base::outcome::State;
use conemarch::gpu::render::Cutting;
use conemarch::picture::frame::Frame;
use conemarch::plan::look::Look;
use conemarch::plan::{Extras, Plan};
use glam::DVec3;

use super::common::plans::{preset, scene};
use super::work::bits;
use crate::adapter::{EVERYTHING, both, render, render_cut};

/// The plan with no light but its glow.
fn dark(mut plan: Plan, glow: f64) -> Plan {
    let look = &mut plan.look;
    (look.key, look.fill, look.gloss) = (0.0, 0.0, 0.0);
    (look.glow, look.glow_color) = (glow, DVec3::ONE);
    (look.sky_high, look.sky_low) = (DVec3::ZERO, DVec3::ZERO);
    look.light_color = DVec3::ZERO;
    plan
}

/// Over a wall at the height h, the glow is that of a way straight down, divided by the cosine. In fog of
/// one density it ends as the fog's light does.
#[test]
fn glow_over_a_wall_has_its_closed_form() {
    let mut plan = dark(Plan::new(scene("kind = 'slab'")).one_sample(), 0.7);
    (plan.camera.eye, plan.camera.target) = (DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO);
    (plan.camera.up, plan.size) = (DVec3::Y, [64, 36]);
    // A ray ends as near the wall as in a large picture.
    plan.reference = Some(65_536);
    for (width, fog) in [(0.01, 0.0), (0.2, 0.0), (1.0, 0.0), (0.2, 1.5)] {
        (plan.look.glow_width, plan.look.fog) = (width, fog);
        let (height, width, fog) = (4.5, 5.0 * width, fog / 5.0);
        for frame in both(&plan) {
            for (i, found) in frame.radiance.iter().enumerate() {
                let pixel = [i as u32 % 64, i as u32 / 64];
                let cosine = -plan.view().view_ray(pixel).axis.z;
                // The distance falls by the cosine, and the fog before a place grows by 1.
                let [fall, way] = [cosine / width - fog, height / cosine];
                let all = ((-fog * way).exp() - (-height / width).exp()) / fall;
                let want = 0.7 * all / width;
                let off = (f64::from(found[0]) / want - 1.0).abs();
                assert!(off < 1e-3, "{width} {fog} {pixel:?}: {found:?} {want}");
            }
        }
    }
}

/// What the sky shows of the glow does not know how its rays were marched, and blocks have the
/// bits of the whole.
#[test]
fn glow_knows_nothing_of_cones_and_blocks() {
    let plan = dark(preset("mandelbox", &["image.size=[320, 180]"]), 0.5);
    let of_cones = |coarsest| {
        let mut plan = plan.clone();
        plan.march.coarsest = Some(coarsest);
        render(&plan, EVERYTHING)
    };
    let [cones, rays] = [32, 1].map(of_cones);
    let is_sky = |frame: &Frame, i: usize| frame.state[i] == State::Sky as u8;
    let sky = (0..cones.state.len()).filter(|i| is_sky(&cones, *i) && is_sky(&rays, *i));
    let sky: Vec<usize> = sky.collect();
    let bright = sky.iter().filter(|i| cones.radiance[**i][0] > 0.01).count();
    assert!(bright > 1000 && bright < sky.len(), "{bright}");
    assert!(sky.iter().all(|i| cones.radiance[*i] == rays.radiance[*i]));
    let whole = bits(&render(&plan, EVERYTHING));
    let cut = Cutting {
        block: 64,
        chunk: 3,
    };
    assert!(bits(&render_cut(&plan, EVERYTHING, cut)) == whole);
    let none = bits(&render(&dark(plan.clone(), 0.0), EVERYTHING));
    assert!(whole != none);
}

/// The glow is added to the light of a picture.
#[test]
fn glow_adds_up() {
    let mut plan = preset("mandelbox-gate", &["image.size=[96, 54]"]);
    plan.look = Look::default();
    let without = render(&plan, Extras::default());
    (plan.look.glow, plan.look.glow_color) = (0.5, DVec3::ONE);
    let with = render(&plan, Extras::default());
    let glow = render(&dark(plan.clone(), 0.5), Extras::default());
    for i in 0..with.radiance.len() {
        let sum = without.radiance[i][1] + glow.radiance[i][1];
        let off = (with.radiance[i][1] - sum).abs();
        // Other programs round otherwise.
        assert!(off <= 1e-4 * sum.max(1.0), "{i}: {off}");
    }
}
