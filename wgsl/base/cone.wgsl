// The exact cone step: how far one empty ball carries a cone's front (docs/method.md, 2).

override CONE_TRUST: f32;
override CONE_ROUND_DOWN: f32;

/// The new front, never below the old one. All rays within the chord `k` of the axis are free
/// up to `front`, and the ball of radius `d` about the axis point at `t` is empty.
///
/// A ray at the cone's edge enters the ball at `t cos - sqrt(d^2 - t^2 sin^2)` and leaves it at
/// `t cos + sqrt(d^2 - t^2 sin^2)`; inner rays are in the ball for longer. The ball counts only
/// if it leaves no gap: rays must enter it before the front.
fn cone_front(front: f32, t: f32, d: f32, k: f32) -> f32 {
    let ball = d * CONE_TRUST;
    if !(ball > 0.0) {
        return front;
    }
    let reach = t * k * sqrt(max(0.0, 1.0 - 0.25 * k * k));
    let q = (ball - reach) * (ball + reach);
    if q < 0.0 {
        return front;
    }
    let middle = t * (1.0 - 0.5 * k * k);
    let root = sqrt(q);
    if middle - root > front {
        return front;
    }
    return max(front, (middle + root) * CONE_ROUND_DOWN);
}

/// The same for rays that start within `r0` of the axis in a plane across it, with the chord `k`,
/// from an empty ball about the axis point at the front `t`.
fn cone_parallel(t: f32, d: f32, r0: f32, k: f32) -> f32 {
    let ball = d * CONE_TRUST - k * (t + d);
    if !(ball > r0) {
        return t;
    }
    return max(t, (t + sqrt((ball - r0) * (ball + r0))) * CONE_ROUND_DOWN);
}
