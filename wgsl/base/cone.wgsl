// The exact cone step (docs/method.md, 2): how far one empty ball carries a cone's front.

override CONE_TRUST: f32;
override CONE_ROUND_DOWN: f32;

/// All rays within the chord `k` of the axis are free up to `front`; the ball of
/// radius `d` about the axis point at `t` is empty. The new front, never below the
/// old one.
///
/// A ray at the cone's edge leaves the ball at `t cos + sqrt(d^2 - t^2 sin^2)` and
/// enters it at the same with a minus; inner rays are covered for longer. The ball
/// counts only if it leaves no gap behind: where it is entered beyond the front,
/// nothing follows.
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
