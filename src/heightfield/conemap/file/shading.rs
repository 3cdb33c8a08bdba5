//! Slopes and normals as shading channels hold them.

use crate::raster::png::BitDepth;

/// Slopes as Dummer's text and shader take them: 0.5 flat, 0 and 1 half the height down or up
/// over one texel, which is what `(share - 0.5) * texture size` makes a slope per texture again
/// (Dummer 2006). His rows are in the order of OpenGL, where y goes up.
pub(crate) fn whole([x, y]: [f32; 2], bits: BitDepth) -> [u16; 2] {
    [x, -y].map(|slope| bits.nearest(0.5 + f64::from(slope)))
}

/// Slopes of heights as Dummer's program stores them: `127 + (a - b) / 2 / 2` in whole
/// numbers, a and b being the neighbours along an axis, or at a border the sample itself.
pub(crate) fn half(heights: &[u16], size: [u32; 2], bits: BitDepth) -> Vec<[u16; 2]> {
    let [w, h] = size.map(|n| n as usize);
    let number = |x: usize, y: usize| i32::from(heights[y * w + x]);
    let middle = i32::from(bits.most() / 2);
    let one = |i: usize| {
        let (x, y) = (i % w, i / w);
        let along_x = number((x + 1).min(w - 1), y) - number(x.saturating_sub(1), y);
        let along_y = number(x, (y + 1).min(h - 1)) - number(x, y.saturating_sub(1));
        // Each division loses its fraction towards 0; the sum is in 0..=most.
        [middle + along_x / 2 / 2, middle - along_y / 2 / 2].map(|n| n as u16)
    };
    (0..w * h).map(one).collect()
}

/// Unit normal as shares: red x, green y upwards in the picture, as OpenGL wants it.
/// `depth` is the height of 1 in texels.
pub(crate) fn normal_shares(slope: [f32; 2], depth: f64) -> [f64; 2] {
    let [x, y] = slope.map(f64::from);
    let (nx, ny) = (-x * depth, y * depth);
    let length = (nx * nx + ny * ny + 1.0).sqrt();
    [nx, ny].map(|n| 0.5 + 0.5 * n / length)
}
