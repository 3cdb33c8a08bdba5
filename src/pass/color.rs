//! The colour pass: the light of each hit ([`quick`] or [`path`]), fog and glow.
//! Twin: `wgsl/pass/color.wgsl`.

use glam::DVec3;

use crate::base::lanes::LANES;
use crate::base::outcome::State;
use crate::base::shader::Module;
use crate::base::view::Beam;
use crate::pass::features;
use crate::pass::look::Light;
use crate::pass::quick::Spot;
use crate::pass::turn::{background, until};
use crate::pass::{fog, glow, layers, path, quick, shafts};
use crate::plan::look::LightMode;
use crate::plan::{Extras, Plan};
use crate::scene::{AnySolid, Hit, Solid, Surface};
use crate::wgsl;

/// The entry point of the pass, and its own modules.
pub(super) fn program(
    plan: &Plan,
    solid: &AnySolid,
    extras: Extras,
) -> (&'static str, Vec<Module>) {
    let look = &plan.look;
    let switch = |on: bool| f64::from(u8::from(on));
    let mut all = vec![until(plan), background(plan, extras)];
    all.extend([wgsl!("pass/look.wgsl"), features::sky(look)]);
    all.extend(layers::modules(&look.layers, solid));
    all.extend(features::modules(look));
    all.push(wgsl!(
        "pass/color.wgsl",
        "COLOR_KEEPS_NORMALS" = switch(extras.normals || plan.has_variance(extras)),
        "COLOR_KEEPS_VARIANCE" = switch(plan.has_variance(extras)),
        "COLOR_IS_PIGMENT" = switch(solid.is_colored())
    ));
    ("color", all)
}

/// A pixel's colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaded {
    /// Radiance towards the eye.
    pub radiance: DVec3,
    /// Unit normal; zero for sky.
    pub normal: DVec3,
    /// Whether the shadow ray, if there was one, reached its end before its step limit.
    pub decided: bool,
}

/// The share of light that a surface sends back. `q` is relative to the eye.
pub fn albedo_of<S: Solid>(solid: &S, light: &Light, surface: &Surface, q: DVec3) -> DVec3 {
    match solid.is_colored() {
        true => surface.pigment,
        false => layers::albedo(solid, light, q, surface.pigment),
    }
}

/// A ray of a pixel that is coloured.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    /// The pixel.
    pub pixel: [u32; 2],
    /// The ray.
    pub ray: Beam,
    /// What it met.
    pub hit: Hit,
    /// What the pixel is.
    pub state: State,
}

/// Colours one sample of pixels. `before` is the number of their samples before this one.
pub fn colors<S: Solid>(
    (solid, light): (&S, &Light),
    before: u32,
    sights: &[Sight],
) -> Vec<Shaded> {
    let met: Vec<&Sight> = sights.iter().filter(|s| s.state != State::Sky).collect();
    let hits: Vec<(Beam, Hit)> = met.iter().map(|s| (s.ray, s.hit)).collect();
    let surfaces = hits.chunks(LANES).flat_map(|part| solid.surfaces(part));
    let spot = |(surface, sight): (Surface, &&Sight)| Spot {
        pixel: sight.pixel,
        ray: sight.ray,
        t: sight.hit.t,
        surface,
    };
    let spots: Vec<Spot> = surfaces.zip(&met).map(spot).collect();
    let lit = match light.look.mode {
        LightMode::Quick => quick::shade((solid, light), before, &spots),
        LightMode::Path => {
            let one = |(spot, sight): (&Spot, &&Sight)| {
                let sample = (sight.pixel, before);
                path::shade((solid, light), sample, &spot.ray, spot.t, &spot.surface)
            };
            spots.iter().zip(&met).map(one).collect()
        }
    };
    let mut lit = spots.iter().zip(lit);
    let one = |sight: &Sight| {
        let lit = if sight.state == State::Sky {
            None
        } else {
            lit.next()
        };
        finish((solid, light), before, sight, lit)
    };
    sights.iter().map(one).collect()
}

/// Adds what is between the eye and the surface, or the sky.
fn finish<S: Solid>(
    (solid, light): (&S, &Light),
    before: u32,
    Sight {
        pixel, ray, state, ..
    }: &Sight,
    lit: Option<(&Spot, (DVec3, bool))>,
) -> Shaded {
    let (t, normal, c, mut decided) = match lit {
        None => (solid.bounds_far(), DVec3::ZERO, light.sky(ray.axis), true),
        Some((spot, (mut c, decided))) => {
            let (t, normal) = (spot.t, spot.surface.normal);
            c = fog::fog(light, c, ray, t);
            (t, normal, c, decided)
        }
    };
    let (lit, clear) = shafts::shafts((solid, light), (*pixel, before), c, ray, t);
    let mut radiance = lit + glow::glow(solid, light, ray, t);
    decided &= clear || *state == State::Sky;
    // One of many paths says little of its pixel.
    let dark = light.look.mode == LightMode::Quick && !decided;
    if light.look.flag_unconverged && (*state == State::Unconverged || dark) {
        radiance = DVec3::new(1.0, 0.0, 1.0);
    }
    Shaded {
        radiance,
        normal,
        decided,
    }
}
