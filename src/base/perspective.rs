//! The perspective projection: rays go from the eye through an even image plane.
//! Twin: `wgsl/base/perspective.wgsl`.

use glam::DVec2;

use super::view::{Beam, CHORD_SLACK, LENS_SLACK, View};

/// The ray through a place of the image, in pixels from its upper left corner.
pub fn view_through(view: &View, place: DVec2) -> Beam {
    let u = view.view_direction(place.x, place.y);
    let n = u.length();
    Beam::pinhole(u / n, 0.0, view.grain / n)
}

/// The cone over the places of a cell, given by their middle and their span in pixels.
///
/// `k = min(2, 2|h| / (2|u| - |h|))`, where h is half the diagonal and u the axis in the
/// image plane, and 2 for a cell wider than that (docs/method.md, 1).
pub fn view_over(view: &View, middle: DVec2, span: DVec2) -> Beam {
    let u = view.view_direction(middle.x, middle.y);
    let n = u.length();
    let h = 0.5 * view.pixel * span.x.hypot(span.y);
    let k = if h < n {
        (2.0 * h / (2.0 * n - h) + CHORD_SLACK + view.spread()).min(2.0)
    } else {
        2.0
    };
    let cone = Beam::pinhole(u / n, k, view.grain / (n - h).max(1.0));
    let r0 = view.lens.map_or(0.0, |lens| LENS_SLACK * lens.radius);
    Beam { r0, ..cone }
}
