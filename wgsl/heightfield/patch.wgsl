// The first crossing of a ray and the bilinear patch of a cell. Along the ray the height above
// h(u, v) = a + b u + c v + d u v is a quadratic in s. Its first root is computed without
// cancellation. If rounding hides the root, the sign at the end decides.

/// No hit: beyond every parameter.
const PATCH_NONE = 1e30;
/// A divisor below this share of the dividend would leave the range of f32.
const PATCH_SLIGHT = 1e-29;

/// The smallest s in front..to at which the ray is on the patch or under it. `p` is (u, v, z)
/// at s = 0, `d` its change per unit of s.
fn patch_hit(corners: vec4<f32>, p: vec3<f32>, d: vec3<f32>, front: f32, to: f32) -> f32 {
    let b = corners.y - corners.x;
    let c = corners.z - corners.x;
    let e = (corners.w - corners.z) - b;
    // Above the patch by q0 + q1 s + q2 s^2, about s = front.
    let q = p + front * d;
    let q0 = q.z - (corners.x + b * q.x + c * q.y + e * q.x * q.y);
    if q0 <= 0.0 {
        return front;
    }
    let q1 = d.z - (b * d.x + c * d.y + e * (q.x * d.y + q.y * d.x));
    let q2 = -e * d.x * d.y;
    let length = to - front;
    let disc = q1 * q1 - 4.0 * q0 * q2;
    var s = PATCH_NONE;
    if disc >= 0.0 {
        let root = sqrt(disc);
        // q1 and -root have one sign. A ray that climbs from a patch that does not curve
        // towards it has no root.
        let falling = q1 < 0.0;
        let over = select(q1 + root, 2.0 * q0, falling);
        let under = select(-2.0 * q2, root - q1, falling);
        if under > PATCH_SLIGHT * over && (falling || q2 < 0.0) {
            s = over / under;
        }
    }
    if s <= length {
        return front + s;
    }
    return select(PATCH_NONE, to, q0 + length * (q1 + length * q2) <= 0.0);
}
