//! The highest point of the surface under a region. Coarse cones and empty balls are tested
//! against it. The pyramid of maxima answers with a few look-ups.
//! Twin: `wgsl/heightfield/region_max.wgsl`.

use glam::DVec2;

use crate::base::shader::Module;
use crate::heightfield::HeightSurface;
use crate::wgsl;

/// The WGSL module.
pub fn module() -> Module {
    wgsl!("heightfield/region_max.wgsl")
}

/// The largest apex of the cells that meet the rectangle `low..=high`, in texels; -1 if the
/// rectangle lies outside the block.
pub fn region_max(surface: &HeightSurface, low: DVec2, high: DVec2) -> f64 {
    let sides = DVec2::from_array(surface.domain().map(f64::from));
    if low.cmpgt(sides).any() || high.cmplt(DVec2::ZERO).any() {
        return -1.0;
    }
    let cells = surface.cells();
    let last = sides - DVec2::ONE;
    let first = low.floor().clamp(DVec2::ZERO, last);
    let end = high.floor().clamp(DVec2::ZERO, last);
    let x = region_runs(first.x as u32, end.x as u32, cells[0]);
    let y = region_runs(first.y as u32, end.y as u32, cells[1]);
    let mut top = 0.0_f32;
    for [x0, x1] in x {
        for [y0, y1] in y {
            // The finest level at which the run is at most two nodes wide and high.
            let (mut level, mut nodes) = (0, [x0, x1, y0, y1]);
            while nodes[1] - nodes[0] > 1 || nodes[3] - nodes[2] > 1 {
                level += 1;
                nodes = nodes.map(|n| n / 2);
            }
            let of = &surface.maxima().levels[level];
            let [x0, x1, y0, y1] = nodes;
            top = top.max(of.at(x0, y0)).max(of.at(x1, y0));
            top = top.max(of.at(x0, y1)).max(of.at(x1, y1));
        }
    }
    f64::from(top)
}

/// The cells `first..=end` of a tiled axis as cells of one tile of `count` cells: two runs, which
/// are equal unless the cells lie across a seam.
fn region_runs(first: u32, end: u32, count: u32) -> [[u32; 2]; 2] {
    if end - first + 1 >= count {
        return [[0, count - 1]; 2];
    }
    let (a, b) = (first % count, end % count);
    if a <= b {
        [[a, b]; 2]
    } else {
        [[a, count - 1], [0, b]]
    }
}
