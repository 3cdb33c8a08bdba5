//! The cone walk for distant views: over nodes of a pyramid that are about as wide as a
//! pixel. Twin: `wgsl/heightfield/tracer/walk_mip.wgsl`.
//!
//! A step looks at the node of a level that follows the ray's parameter: cells as long as a
//! texel is wider than a pixel, then nodes of as many texels as a pixel is wide, rounded
//! down to a power of two. A ray above the node's maximum goes on to its exit at least, or as
//! far as a cone lets it. Over cells it is the walk.
//!
//! There are two cones to choose from. `walk-mip` takes that of the cell under the ray, which
//! is the wider one. `cone-mip` takes the node's own, with the highest apex and the least
//! ratio under it ([`mips`]): it reads nothing finer than the nodes that it looks at, so that
//! what is far away needs little of a large map, and pays for it with more steps.
//!
//! Over a larger node a ray that comes down to its maximum has hit it. That is never behind
//! the first hit of the surface, as no surface lies higher; and the surface does reach the
//! ray's height somewhere under the node, so the hit is off by a node sideways at most,
//! which is no more than a pixel. Rays that pass closer than that to a summit may hit it. A
//! shadow's ray counts its own way: near where it starts it looks at cells.

use std::sync::Arc;

use bytemuck::cast_slice;

use crate::base::shader::Module;
use crate::base::work::Work;
use crate::heightfield::conemap::generate::mips::{ConeLevel, mips, rounded_down};
use crate::heightfield::conemap::{ConeMap, MapKind};
use crate::heightfield::height_surface::{HeightSurface, Node, Numbers};
use crate::heightfield::tracer::contract::{LocalRay, Step, Trace, TraceError, Tracer};
use crate::heightfield::tracer::course::{
    course_begin, course_cross, course_end, course_exit, course_hit, course_land, course_pass,
    course_solve,
};
use crate::heightfield::tracer::walk::{WALK_TRUST, check_map, cone_way};
use crate::wgsl;

/// The cones of all nodes over a relief, level by level.
pub type NodeCones = Arc<Vec<ConeLevel>>;

/// The cones of nodes, made from those of a walk's map of the relief.
///
/// # Errors
/// The map is of another kind, or of another relief.
pub fn node_cones(relief: &HeightSurface, map: &ConeMap) -> Result<NodeCones, TraceError> {
    check_map("cone-mip", &[MapKind::Walk], relief, map)?;
    let levels = mips(&relief.maxima().levels[0].max, map);
    // A map that passes has a ratio for each cell.
    Ok(Arc::new(levels.unwrap_or_default()))
}

/// Cone walk over nodes of a relief.
#[derive(Clone, Debug)]
pub struct WalkMip {
    relief: Arc<HeightSurface>,
    map: Arc<ConeMap>,
    /// The cones of nodes, level by level; none to take those of cells.
    nodes: Option<NodeCones>,
    lod: f64,
}

impl WalkMip {
    /// A walk with the cones of a map: `walk-mip`. `lod` is the parameter of the ray at which
    /// a texel is as wide as a pixel; 0 for cells at any distance.
    ///
    /// # Errors
    /// The map is of another kind, or of another relief.
    pub fn new(
        relief: Arc<HeightSurface>,
        map: Arc<ConeMap>,
        lod: f64,
    ) -> Result<Self, TraceError> {
        check_map("walk-mip", &[MapKind::Walk], &relief, &map)?;
        Ok(Self {
            relief,
            map,
            nodes: None,
            lod,
        })
    }

    /// A walk with the cones of nodes, which [`node_cones`] makes from those of the map:
    /// `cone-mip`. As [`WalkMip::new`] otherwise.
    ///
    /// # Errors
    /// The map is of another kind, or of another relief.
    pub fn of_nodes(
        relief: Arc<HeightSurface>,
        map: Arc<ConeMap>,
        nodes: NodeCones,
        lod: f64,
    ) -> Result<Self, TraceError> {
        check_map("cone-mip", &[MapKind::Walk], &relief, &map)?;
        Ok(Self {
            relief,
            map,
            nodes: Some(nodes),
            lod,
        })
    }

    /// The ratio and the apex of the cone over a cell in a node.
    fn cone(&self, cell: [i32; 2], level: u32, node: &Node) -> (f64, f64) {
        match &self.nodes {
            Some(nodes) => {
                let own = &nodes[level as usize];
                let [x, y] = node.place.map(|i| i as usize);
                (own.ratios[y * own.size[0] as usize + x], node.maximum)
            }
            None => {
                let ratio = self.map.ratios[self.relief.number(cell) as usize];
                (ratio, self.relief.apex(cell))
            }
        }
    }

    /// The level whose nodes are as wide as a pixel at a parameter of the ray, or narrower by
    /// less than half.
    pub fn level(&self, s: f64) -> u32 {
        if self.lod <= 0.0 {
            return 0;
        }
        // The conversion takes what is negative or no number for 0.
        let texels = (s / self.lod) as u32;
        let top = self.relief.maxima().levels.len() as u32 - 1;
        texels.max(1).ilog2().min(top)
    }
}

/// The hit of a node, over whose maximum the ray is by so much: where it comes down to that,
/// up to a parameter, or at once.
fn meet(
    relief: &HeightSurface,
    ray: &LocalRay,
    trace: &mut Trace,
    node: &Node,
    over: f64,
    to: f64,
) {
    let mut s = trace.s;
    if over > 0.0 && ray.axis.z < 0.0 {
        s = (s + over / -ray.axis.z * WALK_TRUST).min(to);
        course_land(relief, ray, trace, s);
        // The line by which it leaves the node belongs to it.
        trace.cell = [0, 1].map(|a| trace.cell[a].clamp(node.low[a], node.high[a] - 1));
    }
    course_hit(relief, ray, trace, s);
}

impl Tracer for WalkMip {
    fn begin(&self, ray: &LocalRay, from: f64, to: f64, _work: &mut Work) -> Trace {
        course_begin(&self.relief, ray, from, to)
    }

    fn look(&self, ray: &LocalRay, trace: &mut Trace, _work: &mut Work) -> Step {
        let relief = &*self.relief;
        let level = self.level(trace.s);
        trace.level = level;
        let node = relief.node(trace.cell, level);
        let (exit, axis) = course_exit(ray, node.low, node.high);
        let to = exit.min(trace.end);
        let z = ray.height(trace.s);
        trace.gap = z.min(ray.height(to)) - node.maximum;
        if trace.gap <= 0.0 {
            if level > 0 {
                meet(relief, ray, trace, &node, z - node.maximum, to);
                return Step::Hit;
            }
            if course_solve(relief, ray, trace, to) {
                return Step::Hit;
            }
        }
        let (ratio, apex) = self.cone(trace.cell, level, &node);
        let way = cone_way(ray, ratio * WALK_TRUST, z - apex, self.map.offset);
        let next = trace.s + way * WALK_TRUST;
        if next.max(exit) >= trace.end {
            return course_end(relief, ray, trace);
        }
        if next > exit {
            course_land(relief, ray, trace, next);
        } else if level == 0 {
            course_cross(ray, trace, exit, axis);
        } else {
            let forward = ray.axis[axis] > 0.0;
            let line = if forward { node.high } else { node.low }[axis];
            course_pass(relief, ray, trace, exit, axis, line);
        }
        Step::Moving
    }

    fn modules(&self) -> Vec<Module> {
        let mut all = self.relief.modules();
        all.push(wgsl!("heightfield/tracer/cone.wgsl"));
        let nodes = f64::from(u8::from(self.nodes.is_some()));
        all.push(wgsl!(
            "heightfield/tracer/walk_mip.wgsl",
            "WALK_MIP_NODES" = nodes
        ));
        all
    }

    fn buffers(&self) -> Vec<(&'static str, Vec<u8>)> {
        let numbers = Numbers {
            lod: self.lod,
            ..Numbers::default()
        };
        let mut all = self.relief.buffers(Some(&self.map), numbers);
        if let Some(nodes) = &self.nodes {
            // Level after level, as the maxima lie.
            let ratios = nodes.iter().flat_map(|level| &level.ratios);
            let ratios: Vec<f32> = ratios.map(|r| rounded_down(*r)).collect();
            all.retain(|(name, _)| *name != "ratios");
            all.push(("ratios", cast_slice(&ratios).to_vec()));
        }
        all
    }
}
