// The step of the 2012 slides, for comparison: `t += d` while `d > k t`.
//
// It is not conservative: between two balls it leaves lenses at the cone's edge
// uncovered, and hands on a distance up to a cone's radius beyond the proven one.
// The stand-in of `base/cone.wgsl` in the `slides-*` modes.

fn cone_front(front: f32, t: f32, d: f32, k: f32) -> f32 {
    if d <= k * t {
        return front;
    }
    return max(front, t + d);
}
