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

use bytemuck::cast_slice;

use crate::base::shader::Module;
use crate::base::work::Work;
use crate::heightfield::conemap::ConeMap;
use crate::heightfield::conemap::generate::mips::{ConeLevel, mips, rounded_down};
use crate::heightfield::height_surface::{HeightSurface, Node, TracerParameters};
use crate::heightfield::tracer::{
    GridRay, Over, Parts, Step, TraceError, Tracer, TracerKind,
    cone::{WALK_TRUST, check_map, cone_end},
};
use crate::wgsl;

/// The cones of all nodes over a surface, level by level.
pub type NodeCones = Arc<Vec<ConeLevel>>;

/// Makes the cones of nodes from a cone map of the walk.
///
/// # Errors
/// The map is of another kind, or was made for another surface.
pub fn node_cones(surface: &HeightSurface, map: &ConeMap) -> Result<NodeCones, TraceError> {
    check_map(TracerKind::ConeMip, surface, map)?;
    let levels = mips(&surface.maxima().levels[0].max, map);
    // A map that fits has a ratio for each cell.
    Ok(Arc::new(levels.unwrap_or_default()))
}

/// The cone walk over nodes.
#[derive(Debug)]
pub struct WalkMip {
    surface: Arc<HeightSurface>,
    map: Arc<ConeMap>,
    /// The cones of nodes, if the tracer takes those.
    nodes: Option<NodeCones>,
    /// The parameter at which a texel is as wide as a pixel; 0 for never.
    lod: f64,
}

fn with(parts: &Parts<'_>, nodes: Option<NodeCones>) -> Result<Arc<dyn Tracer>, TraceError> {
    Ok(Arc::new(WalkMip {
        surface: parts.surface.clone(),
        map: parts.map()?,
        nodes,
        lod: parts.settings.lod.unwrap_or(parts.pixel),
    }))
}

/// Makes `walk-mip`.
pub fn make(parts: &Parts<'_>) -> Result<Arc<dyn Tracer>, TraceError> {
    with(parts, None)
}

/// Makes `cone-mip`.
pub fn make_with_nodes(parts: &Parts<'_>) -> Result<Arc<dyn Tracer>, TraceError> {
    let nodes = match parts.cones.and_then(|cones| cones.nodes.clone()) {
        Some(nodes) => nodes,
        None => node_cones(parts.surface, &*parts.map()?)?,
    };
    with(parts, Some(nodes))
}

/// The level whose nodes are as wide as a pixel at a parameter, or narrower by less than half.
/// `lod` is the parameter at which a texel is as wide as a pixel; 0 for never.
pub fn walk_mip_level(surface: &HeightSurface, lod: f64, s: f64) -> u32 {
    if lod <= 0.0 {
        return 0;
    }
    // The conversion takes negative numbers and NaN for 0.
    let texels = (s / lod) as u32;
    let top = surface.maxima().levels.len() as u32 - 1;
    texels.max(1).ilog2().min(top)
}

/// Marks the hit of a node: where the ray comes down to its maximum, or at once.
fn walk_mip_meet(grid: &mut GridRay<'_>, node: &Node, over: &Over) -> Step {
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

impl WalkMip {
    /// Ratio and apex of the cone over a cell in a node.
    fn cone(&self, cell: [i32; 2], node: &Node) -> (f64, f64) {
        if let Some(nodes) = &self.nodes {
            let own = &nodes[node.level as usize];
            let [x, y] = node.place.map(|i| i as usize);
            return (own.ratios[y * own.size[0] as usize + x], node.maximum);
        }
        let ratio = self.map.ratios[self.surface.number(cell) as usize];
        (ratio, self.surface.apex(cell))
    }
}

impl Tracer for WalkMip {
    fn surface(&self) -> &HeightSurface {
        &self.surface
    }

    fn advance(&self, grid: &mut GridRay<'_>, _work: &mut Work) -> Step {
        grid.trace.level = walk_mip_level(grid.surface, self.lod, grid.trace.s);
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
        let (ratio, apex) = self.cone(grid.trace.cell, &node);
        let height = grid.ray.height(grid.trace.s) - apex;
        let next = cone_end(grid, ratio, height, self.map.offset);
        grid.leave(&node, &over, next)
    }

    fn map(&self) -> Option<&ConeMap> {
        Some(&self.map)
    }

    fn parameters(&self) -> TracerParameters {
        TracerParameters {
            lod: self.lod,
            ..TracerParameters::default()
        }
    }

    fn own_modules(&self) -> Vec<Module> {
        vec![
            wgsl!("heightfield/tracer/cone.wgsl"),
            wgsl!(
                "heightfield/tracer/walk_mip.wgsl",
                "WALK_MIP_NODES" = f64::from(u8::from(self.nodes.is_some())),
            ),
        ]
    }

    fn buffers(&self) -> Vec<(&'static str, Vec<u8>)> {
        let mut all = self.surface.buffers(Some(&self.map), self.parameters());
        if let Some(nodes) = &self.nodes {
            // Level after level, as the maxima are stored.
            let ratios = nodes.iter().flat_map(|level| &level.ratios);
            let ratios: Vec<f32> = ratios.map(|r| rounded_down(*r)).collect();
            all.retain(|(name, _)| *name != "ratios");
            all.push(("ratios", cast_slice(&ratios).to_vec()));
        }
        all
    }
}
