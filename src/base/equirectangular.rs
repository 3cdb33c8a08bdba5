//! The equirectangular projection: longitude from left to right, latitude upward, all about the
//! eye. Twin: `wgsl/base/equirectangular.wgsl`.

use glam::{DVec2, DVec3};

use super::angle::angle_turn;
use super::view::{Beam, LENS_SLACK, View};

/// A distance from the middle of the image, less whole turns, in pixels.
fn view_wrapped(x: f64, turn: f64) -> f64 {
    x - turn * (x / turn).round()
}

/// The direction through a point of the image, in pixels from its upper left corner. Places beyond
/// a pole are on its other side.
fn view_direction(view: &View, place: DVec2) -> DVec3 {
    let [w, h] = view.size.map(f64::from);
    let longitude = angle_turn(view.across * view_wrapped(place.x - 0.5 * w, w));
    let latitude = angle_turn(view.pixel * view_wrapped(0.5 * h - place.y, 2.0 * h));
    let level = longitude.x * view.forward + longitude.y * view.right;
    (latitude.x * level + latitude.y * view.up).normalize()
}

/// The ray through a place of the image.
pub fn view_through(view: &View, place: DVec2) -> Beam {
    Beam::pinhole(view_direction(view, place), 0.0, view.grain)
}

/// The cone over the places of a cell, given by their middle and their span in pixels.
///
/// The straight way in the image from the middle to a place becomes a way on the sphere. A small
/// part of it has the length `hypot(dlat, cos(lat) dlon)`, and the cosine is at most that of the
/// least latitude in the cell. The middle is no farther from the equator than the pole, so beyond
/// the pole the way gets no nearer to the equator than on this side.
pub fn view_over(view: &View, middle: DVec2, span: DVec2) -> Beam {
    let half = 0.5 * span * DVec2::new(view.across, view.pixel);
    let latitude = (0.5 * f64::from(view.size[1]) - middle.y).abs() * view.pixel;
    let widest = angle_turn((latitude - half.y).max(0.0)).x;
    let k = DVec2::new(widest * half.x, half.y).length() * LENS_SLACK + view.slack();
    Beam::pinhole(view_direction(view, middle), k.min(2.0), view.grain)
}
