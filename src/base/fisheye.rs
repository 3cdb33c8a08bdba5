//! The fisheye projection: the angle to the view axis is proportional to the distance from the
//! middle of the image (equidistant). Places beyond 180 degrees all look straight back.
//! Twin: `wgsl/base/fisheye.wgsl`.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::angle::angle_parts;
use super::view::{Beam, View};

/// The direction through a point of the image, in pixels from its upper left corner.
fn view_direction(view: &View, place: DVec2) -> DVec3 {
    let [w, h] = view.size.map(f64::from);
    let a = DVec2::new(place.x - 0.5 * w, 0.5 * h - place.y) * view.pixel;
    let [along, aside] = angle_parts(0.25 * a.length_squared().min(PI * PI));
    let u = along * view.forward + aside * (a.x * view.right + a.y * view.up);
    u.normalize()
}

/// The ray through a place of the image.
pub fn view_through(view: &View, place: DVec2) -> Beam {
    Beam::pinhole(view_direction(view, place), 0.0, view.grain)
}

/// The cone over the places of a cell, given by their middle and their span in pixels.
///
/// Two directions are no farther apart than their places, in radians. Of a small way in the image,
/// the part away from the middle keeps its length on the sphere, and the part about the middle is
/// multiplied by `sin(r) / r <= 1`. So the straight way between two places within `r <= pi` becomes
/// a way on the sphere that is not longer, and the angle is at most its length. A place beyond is
/// drawn to the edge of that disc, which brings no two places farther apart, as the disc is convex.
pub fn view_over(view: &View, middle: DVec2, span: DVec2) -> Beam {
    let k = 0.5 * view.pixel * span.length() + view.slack();
    Beam::pinhole(view_direction(view, middle), k.min(2.0), view.grain)
}
