//! The first crossing of a ray and the bilinear patch of a cell.
//! Twin: `wgsl/heightfield/patch.wgsl`.
//!
//! Over a cell the surface is `h(u, v) = a + b u + c v + d u v`. Along a ray u, v and z are linear
//! in s, so `z - h` is a quadratic in s. Its first root over the cell is the hit. Roots are
//! computed without cancellation, and the signs at both ends are tested, so that no crossing is
//! lost between two cells.

/// A ray in the coordinates of one cell: u and v are 0..=1 over it, z is a height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellRay {
    /// (u, v, z) at s = 0.
    pub start: [f64; 3],
    /// Their change per unit of s.
    pub slope: [f64; 3],
}

/// The smallest s in `from..=to` at which the ray is on the patch or under it.
/// `corners` are the heights at (0, 0), (1, 0), (0, 1), (1, 1).
pub fn patch_hit(corners: [f64; 4], ray: CellRay, from: f64, to: f64) -> Option<f64> {
    let [c00, c10, c01, c11] = corners;
    let (b, c, d) = (c10 - c00, c01 - c00, c11 - c10 - c01 + c00);
    let ([u, v, z], [du, dv, dz]) = (ray.start, ray.slope);
    // Above the patch by q0 + q1 s + q2 s^2, about s = from.
    let (u, v, z) = (u + from * du, v + from * dv, z + from * dz);
    let q0 = z - (c00 + b * u + c * v + d * u * v);
    if q0 <= 0.0 {
        return Some(from);
    }
    let q1 = dz - (b * du + c * dv + d * (u * dv + v * du));
    let q2 = -d * du * dv;
    let length = to - from;
    let end = q0 + length * (q1 + length * q2);
    // First root of a quadratic that is positive at 0.
    let disc = q1 * q1 - 4.0 * q0 * q2;
    if disc >= 0.0 {
        let root = disc.sqrt();
        let s = if q1 <= 0.0 {
            // Free of cancellation: q1 and -root have the same sign.
            2.0 * q0 / (root - q1)
        } else if q2 < 0.0 {
            (-q1 - root) / (2.0 * q2)
        } else {
            f64::INFINITY
        };
        if s >= 0.0 && s <= length {
            return Some(from + s);
        }
    }
    // If rounding hides the root, the sign at the end decides.
    (end <= 0.0).then_some(to)
}
