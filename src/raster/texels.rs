//! Colours between the pixels of an image.

use glam::DVec3;

/// Bilinear interpolation at (x, y). Whole numbers are the middles of texels; `texel` answers for
/// any column and row, also beyond the image.
pub fn bilinear(x: f64, y: f64, texel: impl Fn(i64, i64) -> DVec3) -> DVec3 {
    let (column, row) = (x.floor(), y.floor());
    let at = |dx, dy| texel(column as i64 + dx, row as i64 + dy);
    let [fx, fy] = [x - column, y - row];
    let first = at(0, 0).lerp(at(1, 0), fx);
    first.lerp(at(0, 1).lerp(at(1, 1), fx), fy)
}
