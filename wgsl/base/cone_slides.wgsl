// The step of the 2012 slides, for comparison: `t += d` while `d > k t`.
//
// It is not conservative: it leaves gaps between two balls at the cone's edge, and its front
// can be a cone's radius beyond the proven one. It replaces `base/cone.wgsl` in the modes
// `slides-*`.

fn cone_front(front: f32, t: f32, d: f32, k: f32) -> f32 {
    if d <= k * t {
        return front;
    }
    return max(front, t + d);
}

fn cone_parallel(t: f32, d: f32, r0: f32, k: f32) -> f32 {
    return cone_front(t, t, d - r0, k);
}
