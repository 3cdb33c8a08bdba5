//! Light of the sun that fog scatters once.

use std::f64::consts::PI;

use conemarch::pass;
use conemarch::picture::frame::Frame;
use conemarch::plan::look::LightMode;
use conemarch::plan::{Extras, Plan};
use conemarch::scene::{Assets, Solid, Task};
use glam::DVec3;

use super::common::exact::{Exact, first_hit};
use super::common::plans::{preset, scene, sized, solid};
use super::work::{bits, bits_however_cut};
use crate::adapter::{EVERYTHING, both, render};

struct Far;

impl Task for Far {
    type Output = f64;
    fn run<S: Solid>(self, solid: &S) -> f64 {
        solid.bounds_far()
    }
}

/// A disc under the sun, seen from the side through fog, and no other light.
fn shaded() -> Plan {
    let mut plan = Plan::new(scene(
        "kind = 'slab'\nnormal = [0, 0, 1]\nhalf = 0.3\nradius = 4",
    ));
    plan.samples = 1;
    (plan.camera.eye, plan.camera.target) = (DVec3::new(0.5, -9.0, -2.0), DVec3::NEG_Z);
    (plan.size, plan.camera.fov) = ([160, 100], 70.0);
    let look = &mut plan.look;
    (look.mode, look.bounces, look.fog, look.shafts) = (LightMode::Path, 0, 1.2, 0.8);
    (look.sky_high, look.sky_low, look.fill) = (DVec3::ZERO, DVec3::ZERO, 0.0);
    (look.light, look.light_size) = (DVec3::new(0.3, 0.5, 1.0), 0.05);
    // The disc is black.
    (look.palette, look.gloss) = (vec![DVec3::ZERO], 0.0);
    plan
}

/// The light of a pixel by a sum of many points of its ray.
fn summed(plan: &Plan, frame: &Frame, i: usize, far: f64) -> f64 {
    const PARTS: u32 = 600;
    const G: f64 = 0.6;
    let (view, look) = (plan.view(), &plan.look);
    let ray = frame.ray(&view, i);
    let is_sky = frame.depth[i].is_infinite();
    let end = if is_sky {
        far
    } else {
        f64::from(frame.depth[i])
    };
    let distance = plan.camera.eye.distance(plan.camera.target);
    let density = |t: f64| {
        let height = (view.eye + ray.at(t) - plan.camera.target).z / distance;
        let thin = match look.fog_height {
            0.0 => 1.0,
            scale => (-height / scale).exp(),
        };
        look.fog / distance * thin
    };
    let sun = look.light.normalize();
    let disc = [Exact::Disc(DVec3::Z, 0.3, 4.0)];
    let (mut depth, mut lit) = (0.0, 0.0);
    let part = end / f64::from(PARTS);
    for k in 0..PARTS {
        let t = part * (f64::from(k) + 0.5);
        let own = density(t) * part;
        let at = view.eye + ray.at(t);
        if first_hit(&disc, at, sun).is_infinite() {
            // The light of the part, through half of it.
            lit += own * f64::exp(-depth - 0.5 * own);
        }
        depth += own;
    }
    let cosine = ray.axis.dot(sun);
    let phase = (1.0 - G * G) / (4.0 * PI * (1.0 + G * G - 2.0 * G * cosine).powf(1.5));
    // Red light is that of the strength.
    let halo = 0.12 * cosine.max(0.0).powi(6) * f64::from(u8::from(is_sky));
    (-depth).exp() * halo + look.shafts * PI * look.key * phase * lit
}

#[test]
fn the_mean_of_the_shafts_is_the_light_that_one_scattering_brings() {
    let mut plan = shaded();
    for height in [0.0, 0.3] {
        plan.look.fog_height = height;
        let far = solid(&plan).run(Far);
        let frames = both(&plan);
        let want: Vec<f64> = (0..frames[1].depth.len())
            .map(|i| summed(&plan, &frames[1], i, far))
            .collect();
        let n = want.len() as f64;
        for frame in &frames {
            let off = frame.radiance.iter().zip(&want);
            let off: Vec<f64> = off.map(|(c, want)| f64::from(c[0]) - want).collect();
            let mean = off.iter().sum::<f64>() / n;
            let spread = (off.iter().map(|x| x * x).sum::<f64>() / n - mean * mean).sqrt();
            let all = want.iter().sum::<f64>() / n;
            println!(
                "{height}: {mean:.2e} of {:.2e}, {all:.3}",
                spread / n.sqrt()
            );
            // The noise is small enough to see a fault of two percent.
            assert!(spread / n.sqrt() < 5e-3 * all, "{height}: {spread}");
            assert!(mean.abs() < 4.0 * spread / n.sqrt(), "{height}: {mean}");
        }
        // Both have the same random numbers.
        let pairs = frames[0].radiance.iter().zip(&frames[1].radiance);
        let same = pairs.filter(|(a, b)| (a[0] - b[0]).abs() < 1e-3).count();
        assert!(same as f64 > 0.99 * n, "{same}");
        let lit = frames[1].radiance.iter().filter(|c| c[0] > 0.05).count() as f64;
        assert!(lit > 0.2 * n && lit < 0.9 * n, "{lit}");
    }
}

#[test]
fn quick_light_has_the_shafts_of_paths() {
    let mut paths = shaded();
    paths.samples = 3;
    let mut quick = paths.clone();
    quick.look.mode = LightMode::Quick;
    // Both take the same points of the fog and of the sun.
    for shadow in [true, false] {
        quick.look.shadow = shadow;
        for (a, b) in both(&paths).iter().zip(&both(&quick)) {
            assert!(a.radiance == b.radiance);
        }
    }
    // One sample has no noise.
    quick.samples = 1;
    let far = solid(&quick).run(Far);
    for frame in both(&quick) {
        let lit = frame.radiance.iter().filter(|c| c[0] > 0.05).count();
        assert!(lit > 3_000, "{lit}");
        let (width, row) = (quick.size[0] as usize, 95);
        let light = |x: usize| f64::from(frame.radiance[row * width + x][0]);
        let jumps = (1..width).filter(|&x| (light(x) - light(x - 1)).abs() > 0.02);
        assert!(jumps.count() <= 2);
        let one = summed(&quick, &frame, row * width, far);
        assert!((light(0) - one).abs() < 0.02, "{} {one}", light(0));
    }
}

/// A sun without strength has no shafts, and the fog keeps the sky's halo.
#[test]
fn a_dark_sun_leaves_the_fog_as_it_is() {
    let mut plan = shaded();
    plan.look.mode = LightMode::Quick;
    plan.look.key = 0.0;
    let with = both(&plan);
    plan.look.shafts = 0.0;
    for (with, without) in with.iter().zip(&both(&plan)) {
        assert!(with.radiance == without.radiance);
        assert!(with.radiance.iter().any(|c| c[0] > 0.0));
    }
}

#[test]
fn shafts_are_the_same_in_blocks_and_cost_nothing_when_off() {
    let mut plan = sized("mandelbox-gate", [70, 44]);
    let explained = |plan: &Plan| {
        let text = pass::explain(plan, &Assets::default(), Extras::default()).unwrap();
        text.contains("wgsl/pass/shafts.wgsl")
    };
    plan.look.fog = 1.0;
    plan.samples = 3;
    for mode in [LightMode::Quick, LightMode::Path] {
        plan.look.mode = mode;
        plan.look.shafts = 0.0;
        assert!(!explained(&plan));
        let foggy = bits(&render(&plan, EVERYTHING));
        plan.look.shafts = 1.0;
        assert!(explained(&plan));
        assert!(bits_however_cut(&plan) != foggy);
        // Without fog nothing scatters.
        let mut clear = plan.clone();
        clear.look.fog = 0.0;
        assert!(!explained(&clear));
        let unlit = bits(&render(&clear, EVERYTHING));
        clear.look.shafts = 0.0;
        assert!(unlit == bits(&render(&clear, EVERYTHING)));
    }
    // A plan of the defaults has none.
    assert!(!explained(&preset("mandelbox", &[])));
}
