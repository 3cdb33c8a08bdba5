//! The colour pass: the light of each hit ([`quick`] or [`path`]), fog and glow.
//! Twin: `wgsl/pass/color.wgsl`.

use glam::DVec3;

use crate::base::outcome::State;
use crate::base::shader::Module;
use crate::base::view::Beam;
use crate::pass::features;
use crate::pass::look::Light;
use crate::pass::turn::{background, until};
use crate::pass::{fog, glow, layers, path, quick, shafts};
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

/// Colours one sample of a pixel. `before` is the number of its samples before this one.
pub fn color<S: Solid>(
    (solid, light): (&S, &Light),
    (pixel, before): ([u32; 2], u32),
    ray: &Beam,
    hit: &Hit,
    state: State,
) -> Shaded {
    if state == State::Sky {
        let end = solid.bounds_far();
        let sky = light.sky(ray.axis);
        let (lit, _) = shafts::shafts((solid, light), (pixel, before), sky, ray, end);
        return Shaded {
            radiance: lit + glow::glow(solid, light, ray, end),
            normal: DVec3::ZERO,
            decided: true,
        };
    }
    let surface = solid.surface(ray, hit);
    let (mut c, decided) = match &light.substance {
        None => quick::shade(solid, light, ray, hit.t, &surface),
        Some(of) => path::shade((solid, light, of), (pixel, before), ray, hit.t, &surface),
    };
    c = fog::fog(light, c, ray, hit.t);
    let (lit, clear) = shafts::shafts((solid, light), (pixel, before), c, ray, hit.t);
    c = lit + glow::glow(solid, light, ray, hit.t);
    let decided = decided && clear;
    // One of many paths says little of its pixel.
    let dark = light.substance.is_none() && !decided;
    if light.look.flag_unconverged && (state == State::Unconverged || dark) {
        c = DVec3::new(1.0, 0.0, 1.0);
    }
    Shaded {
        radiance: c,
        normal: surface.normal,
        decided,
    }
}
