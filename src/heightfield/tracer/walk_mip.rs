//! The cone walk for distant views: it steps over nodes of a pyramid that are about as wide as
//! a pixel. Twin: `wgsl/heightfield/tracer/walk_mip.wgsl`.
//!
//! The level of a step follows the ray's parameter. While a texel is wider than a pixel, a step
//! looks at a cell, and the tracer is the cone walk. Farther away it looks at a node of as many
//! texels as a pixel is wide, rounded down to a power of two. A ray above the node's maximum
//! goes on to the node's exit, or as far as a cone lets it.
//!
//! There are two choices of cones. `walk-mip` takes the cone of the cell under the ray, which is
//! wider. `cone-mip` takes the cone of the node, with the highest apex and the least ratio under
//! it ([`mips`]). It reads nothing finer than the nodes that it looks at, so that distant parts
//! of a large map need little memory traffic, but it takes more steps.
//!
//! A ray that comes down to the maximum of a node larger than a cell hits it. Such a hit is
//! never behind the first hit of the surface, because no surface lies higher. The surface does
//! reach the ray's height somewhere under the node, so the hit is off sideways by at most one
//! node, which is at most one pixel. A ray that passes closer than that to a summit may hit it.
//! A shadow ray counts its own parameter: near its start it looks at cells.

use std::sync::Arc;

use crate::base::array::SceneArray;
use crate::base::{outcome::Counts, shader::Module};
use crate::heightfield::conemap::generate::mips::{ConeLevel, mips, stored};
use crate::heightfield::height_surface::{Node, TracerParameters};
use crate::heightfield::tracer::cone::{WALK_TRUST, cone_end};
use crate::heightfield::tracer::settings::{TracerCones, TracerSettings};
use crate::heightfield::tracer::{GridRay, Method, NodeSpan, Step, Tracer};
use crate::heightfield::{ConeMap, HeightSurface};
use crate::wgsl;

/// The cones of all nodes over a surface, level by level.
pub type NodeCones = Arc<Vec<ConeLevel>>;

/// Makes the cones of nodes from a cone map of the walk. There are none for a map that was made
/// for another surface.
fn node_cones(surface: &HeightSurface, map: &ConeMap) -> NodeCones {
    let levels = mips(&surface.maxima().levels[0].max, map);
    Arc::new(levels.unwrap_or_default())
}

/// The cone walk over nodes.
#[derive(Debug)]
pub struct WalkMip {
    /// Whether it takes the cones of nodes instead of those of cells.
    of_nodes: bool,
}

/// The walk with the cones of cells.
pub const WALK_MIP: WalkMip = WalkMip { of_nodes: false };
/// The walk with the cones of nodes.
pub const CONE_MIP: WalkMip = WalkMip { of_nodes: true };

/// The level whose nodes are as wide as a pixel at a parameter, or narrower by less than half.
/// `lod` is the parameter at which a texel is as wide as a pixel; 0 for never.
pub fn walk_mip_level(surface: &HeightSurface, lod: f64, s: f64) -> u32 {
    if lod <= 0.0 {
        return 0;
    }
    // The conversion takes negative numbers and NaN for 0.
    let texels = (s / lod) as u32;
    texels.max(1).ilog2().min(surface.maxima().coarsest())
}

/// Marks the hit of a node: where the ray comes down to its maximum, or at once.
fn walk_mip_meet(grid: &mut GridRay<'_>, node: &Node, over: &NodeSpan) -> Step {
    let mut s = grid.trace.s;
    let fall = -grid.ray.axis.z;
    if over.height > 0.0 && fall > 0.0 {
        s = (s + over.height / fall * WALK_TRUST).min(over.to);
        grid.land(s);
        // The line by which the ray leaves the node belongs to the node.
        let cell = grid.trace.cell;
        grid.trace.cell = [0, 1].map(|a| cell[a].clamp(node.low[a], node.high[a] - 1));
    }
    grid.hit(s)
}

/// Ratio and apex of the cone over the ray's cell in a node.
fn cone(tracer: &Tracer, cell: [i32; 2], node: &Node) -> (f64, f64) {
    if let Some(nodes) = &tracer.nodes {
        let own = &nodes[node.level as usize];
        let [x, y] = node.place.map(|i| i as usize);
        return (own.ratios[y * own.size[0] as usize + x], node.maximum);
    }
    let ratio = tracer.map.ratios[tracer.surface.number(cell) as usize];
    (ratio, tracer.surface.apex(cell))
}

impl Method for WalkMip {
    fn numbers(&self, settings: &TracerSettings, pixel: f64) -> TracerParameters {
        TracerParameters {
            lod: settings.lod.unwrap_or(pixel),
            ..TracerParameters::default()
        }
    }

    fn nodes(&self, surface: &HeightSurface, cones: &TracerCones) -> Option<NodeCones> {
        let made = || node_cones(surface, cones.map());
        self.of_nodes
            .then(|| cones.nodes.clone().unwrap_or_else(made))
    }

    fn advance(&self, tracer: &Tracer, grid: &mut GridRay<'_>, _work: &mut Counts) -> Step {
        grid.trace.level = walk_mip_level(grid.surface, tracer.numbers.lod, grid.trace.s);
        let node = grid.surface.node(grid.trace.cell, grid.trace.level);
        let over = grid.over(&node);
        if over.gap <= 0.0 {
            if node.level > 0 {
                return walk_mip_meet(grid, &node, &over);
            }
            if grid.solve(over.to) {
                return Step::Hit;
            }
        }
        let (ratio, apex) = cone(tracer, grid.trace.cell, &node);
        let height = grid.ray.height(grid.trace.s) - apex;
        let next = cone_end(grid, ratio, height, tracer.map.offset);
        grid.leave(&node, &over, next)
    }

    fn modules(&self, tracer: &Tracer) -> Vec<Module> {
        let nodes = f64::from(u8::from(tracer.nodes.is_some()));
        vec![
            wgsl!("heightfield/tracer/cone.wgsl"),
            wgsl!("heightfield/tracer/walk_mip.wgsl", "WALK_MIP_NODES" = nodes),
        ]
    }

    fn ratios(&self, tracer: &Tracer) -> SceneArray {
        // Level after level, as the maxima are stored.
        match &tracer.nodes {
            Some(nodes) => SceneArray::new("ratios", nodes, |nodes| {
                stored(nodes.iter().flat_map(|level| &level.ratios))
            }),
            None => SceneArray::new("ratios", &tracer.map, |map| stored(&map.ratios)),
        }
    }
}
