//! The orthographic projection: parallel rays start in the plane of the eye.
//! Twin: `wgsl/base/orthographic.wgsl`.

use glam::{DVec2, DVec3};

use super::view::{Beam, LENS_SLACK, View};

/// More than the rounding of two origins in f32, in diagonals of the image.
pub const ORTHOGRAPHIC_SLACK: f64 = 5e-7;

/// Where a ray starts, relative to the eye.
fn view_origin(view: &View, place: DVec2) -> DVec3 {
    let [w, h] = view.size.map(f64::from);
    let sx = (place.x - 0.5 * w) * view.across;
    let sy = (0.5 * h - place.y) * view.across;
    sx * view.right + sy * view.up
}

/// The ray through a place of the image, in pixels from its upper left corner.
pub fn view_through(view: &View, place: DVec2) -> Beam {
    Beam {
        origin: view_origin(view, place),
        grain0: view.grain,
        ..Beam::pinhole(view.forward, 0.0, 0.0)
    }
}

/// The cone over the places of a cell, given by their middle and their span in pixels. Its radius
/// is half the diagonal.
pub fn view_over(view: &View, middle: DVec2, span: DVec2) -> Beam {
    let [w, h] = view.size.map(f64::from);
    let rounding = ORTHOGRAPHIC_SLACK * w.hypot(h);
    let lens = view.lens.map_or(0.0, |lens| LENS_SLACK * lens.radius);
    Beam {
        r0: view.across * (0.5 * span.length() * LENS_SLACK + rounding) + lens,
        k: view.slack() + view.spread(),
        ..view_through(view, middle)
    }
}
