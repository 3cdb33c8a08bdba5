//! A ray's way through the grid of cells: clipping, crossing, landing, and solving a cell.
//! All tracers share it. Twin: `wgsl/heightfield/tracer/grid.wgsl`.
//!
//! A trace carries its cell as integers. Every tracer computes where a ray crosses the line
//! x = k by the same function of k, [`GridRay::crossing`]. So a ray that jumps into a cell and one
//! that walks there agree on where the cell begins, and no cell is lost between two (Amanatides
//! and Woo, A fast voxel traversal algorithm, 1987, with a quotient in place of their sum of
//! steps). The tracers decide which cells to look at.
//!
//! The functions `grid_*` of WGSL are methods of [`GridRay`] here.

use glam::DVec3;

use crate::heightfield::patch::{CellRay, patch_hit};
use crate::heightfield::tracer::{
    BASE, FACE_BITS, LocalRay, SURFACE, Step, Trace, WALL_X_LOW, WALL_Y_LOW,
};
use crate::heightfield::{HeightSurface, height_surface::Node};

/// A parameter beyond every other, and still finite.
pub const FAR: f64 = 1e30;
/// Slopes below this count as none, so that no quotient by a slope reaches [`FAR`].
pub const FLAT: f64 = 1e-20;

/// A start that is past a face by this share of its parameter is still on the face: a few
/// roundings of f32.
pub const ON_FACE: f64 = 5e-7;

/// A ray over a surface, and its trace.
#[derive(Debug)]
pub struct GridRay<'a> {
    /// The surface.
    pub surface: &'a HeightSurface,
    /// The ray.
    pub ray: &'a LocalRay,
    /// How far the ray has come.
    pub trace: &'a mut Trace,
}

/// The part of a ray over a node, from where the ray stands.
#[derive(Clone, Copy, Debug)]
pub struct NodeSpan {
    /// Where the ray leaves the node.
    pub exit: f64,
    /// The axis of the line by which it leaves.
    pub axis: usize,
    /// Where the part ends: at the exit, or at the end of the trace.
    pub to: f64,
    /// The ray's height above the node's maximum where the part begins.
    pub height: f64,
    /// The least height of the part above the node's maximum.
    pub gap: f64,
}

/// Starts a ray: finds the part of it inside the block and its first cell, and marks a hit where
/// it enters through a solid face.
pub fn grid_begin(surface: &HeightSurface, ray: &LocalRay, from: f64, to: f64) -> Trace {
    let mut trace = Trace {
        s: from,
        ..Trace::default()
    };
    let mut grid = GridRay {
        surface,
        ray,
        trace: &mut trace,
    };
    grid.begin(to);
    trace
}

impl GridRay<'_> {
    /// Whether the ray goes towards larger coordinates of an axis.
    fn forward(&self, axis: usize) -> bool {
        self.ray.axis[axis] > 0.0
    }

    /// The parameter at which the ray crosses a line of an axis; [`FAR`] if it never does.
    pub fn crossing(&self, axis: usize, line: i32) -> f64 {
        let slope = self.ray.axis[axis];
        if slope.abs() < FLAT {
            return FAR;
        }
        (f64::from(line) - self.ray.origin[axis]) / slope
    }

    /// The parameter at which the ray enters a column or row of cells; [`FAR`] if it never does.
    fn entry(&self, axis: usize, cell: i32) -> f64 {
        self.crossing(axis, cell + i32::from(!self.forward(axis)))
    }

    /// The part of the ray within `0..=high` along an axis, as (near, far).
    fn within(&self, axis: usize, high: i32) -> (f64, f64) {
        if self.ray.axis[axis].abs() < FLAT {
            let inside = (0.0..=f64::from(high)).contains(&self.ray.origin[axis]);
            return if inside { (-FAR, FAR) } else { (FAR, -FAR) };
        }
        let (a, b) = (self.crossing(axis, 0), self.crossing(axis, high));
        (a.min(b), a.max(b))
    }

    fn begin(&mut self, to: f64) {
        let from = self.trace.s;
        let [w, h] = self.surface.domain();
        let (x, y, z) = (self.within(0, w), self.within(1, h), self.within(2, 1));
        let start = from.max(x.0).max(y.0).max(z.0);
        let side = x.1.min(y.1).min(to);
        let end = side.min(z.1);
        // Written so that a ray with NaNs is out as well.
        if !(start <= end && end < FAR) {
            self.trace.state = Step::Out;
            return;
        }
        (self.trace.s, self.trace.enter, self.trace.end) = (start, start, end);
        // A ray that comes down to the bottom inside the domain hits, even if rounding hides the
        // crossing of the patch.
        self.trace.falls = self.ray.axis.z < 0.0 && z.1 <= side;
        self.trace.cell = self.cell(start);
        let [u, v] = self.uv(self.trace.cell, start);
        let height = self.ray.height(start);
        let under = height <= self.surface.height(self.trace.cell, u, v);
        // The ray enters by the last face that it passes. A start on that face counts as outside,
        // because a caller's bounds may lie there.
        let face = x.0.max(y.0).max(z.0);
        if from > face + ON_FACE * face.abs() {
            return;
        }
        let back = [0, 1].map(|axis| u32::from(self.ray.axis[axis] < 0.0));
        if face == z.0 && self.ray.axis.z > 0.0 {
            self.mark(BASE, [u, v]);
        } else if face == x.0 && under {
            self.mark(WALL_X_LOW + back[0], [v, height]);
        } else if face == y.0 && under {
            self.mark(WALL_Y_LOW + back[1], [u, height]);
        }
    }

    fn mark(&mut self, face: u32, uv: [f64; 2]) {
        self.trace.state = Step::Hit;
        self.trace.id = self.surface.number(self.trace.cell) | face << FACE_BITS;
        self.trace.uv = uv;
    }

    /// The cell of the domain that the ray is in at s: it enters the cell at s or before and
    /// leaves it after s. [`GridRay::crossing`] decides, not the rounded position.
    pub fn cell(&self, s: f64) -> [i32; 2] {
        let p = self.ray.at(s);
        [0, 1].map(|axis| {
            let last = self.surface.domain()[axis] - 1;
            let i = (p[axis].floor() as i32).clamp(0, last);
            let slope = self.ray.axis[axis];
            let [low, high] = [i, i + 1].map(|line| self.crossing(axis, line));
            let moved = if slope >= FLAT {
                i32::from(s >= high) - i32::from(s < low)
            } else if slope <= -FLAT {
                i32::from(s < high) - i32::from(s >= low)
            } else {
                0
            };
            (i + moved).clamp(0, last)
        })
    }

    /// The place in a cell at s, 0..=1. If the ray enters the cell at s, the coordinate of the
    /// line that it crosses is exact.
    pub fn uv(&self, cell: [i32; 2], s: f64) -> [f64; 2] {
        let p = self.ray.at(s);
        [0, 1].map(|axis| {
            let near = self.entry(axis, cell[axis]);
            if s <= near && near < FAR {
                return f64::from(u8::from(!self.forward(axis)));
            }
            (p[axis] - f64::from(cell[axis])).clamp(0.0, 1.0)
        })
    }

    /// The line of an axis by which the ray leaves a node.
    pub fn far_line(&self, axis: usize, node: &Node) -> i32 {
        if self.forward(axis) {
            node.high[axis]
        } else {
            node.low[axis]
        }
    }

    /// The part of the ray over a node.
    pub fn over(&self, node: &Node) -> NodeSpan {
        let [x, y] = [0, 1].map(|axis| self.crossing(axis, self.far_line(axis, node)));
        let (exit, axis) = if x <= y { (x, 0) } else { (y, 1) };
        let to = exit.min(self.trace.end);
        let z = self.ray.height(self.trace.s);
        NodeSpan {
            exit,
            axis,
            to,
            height: z - node.maximum,
            gap: z.min(self.ray.height(to)) - node.maximum,
        }
    }

    fn stand(&mut self, s: f64, enter: f64) {
        (self.trace.s, self.trace.enter) = (s, enter);
    }

    /// Moves to s, where the ray leaves its cell through an axis.
    pub fn cross(&mut self, s: f64, axis: usize) {
        self.trace.cell[axis] += if self.forward(axis) { 1 } else { -1 };
        self.stand(s, s);
    }

    /// The later one of a cell and the trace's own along an axis: rounding must not undo a
    /// crossing.
    fn onward(&self, axis: usize, cell: i32) -> i32 {
        let own = self.trace.cell[axis];
        if self.forward(axis) {
            cell.max(own)
        } else {
            cell.min(own)
        }
    }

    /// Moves to an s beyond the cell's exit, over cells that the tracer skips.
    pub fn land(&mut self, s: f64) {
        let found = self.cell(s);
        let mut enter = self.trace.enter;
        for (axis, cell) in found.into_iter().enumerate() {
            let cell = self.onward(axis, cell);
            self.trace.cell[axis] = cell;
            // A ray along an axis crosses no line of the other one.
            if self.ray.axis[axis].abs() >= FLAT {
                enter = enter.max(self.entry(axis, cell));
            }
        }
        self.stand(s, enter);
    }

    /// Moves to s, where the ray leaves a node through an axis. A ray that crosses a line of x and
    /// one of y at the same s crosses that of x first, as it does from cell to cell: so a corner
    /// leads into the neighbour along x.
    pub fn pass(&mut self, node: &Node, s: f64, axis: usize) {
        let other = 1 - axis;
        let mut cell = self.cell(s)[other];
        let near = self.entry(other, cell);
        if axis == 0 && near >= s && near < FAR {
            cell -= if self.forward(other) { 1 } else { -1 };
        }
        self.trace.cell[other] = self.onward(other, cell);
        self.trace.cell[axis] = self.far_line(axis, node) - i32::from(!self.forward(axis));
        self.stand(s, s);
    }

    /// Goes on to `next`, or to the node's exit if that is farther, after nothing was met there.
    pub fn leave(&mut self, node: &Node, over: &NodeSpan, next: f64) -> Step {
        if next.max(over.exit) >= self.trace.end {
            return self.end();
        }
        if next > over.exit {
            self.land(next);
        } else if node.level == 0 {
            self.cross(over.exit, over.axis);
        } else {
            self.pass(node, over.exit, over.axis);
        }
        Step::Moving
    }

    /// Looks for a hit in the trace's cell up to a parameter, and marks it. Returns whether there
    /// is one.
    pub fn solve(&mut self, to: f64) -> bool {
        let [x, y] = self.trace.cell.map(f64::from);
        let cell_ray = CellRay {
            start: (self.ray.origin - DVec3::new(x, y, 0.0)).to_array(),
            slope: self.ray.axis.to_array(),
        };
        let corners = self.surface.corners(self.trace.cell);
        let found = patch_hit(corners, cell_ray, self.trace.enter, to);
        if let Some(s) = found {
            self.hit(s);
        }
        found.is_some()
    }

    /// Marks a hit of the surface at s, in the trace's cell.
    pub fn hit(&mut self, s: f64) -> Step {
        self.trace.s = s;
        self.mark(SURFACE, self.uv(self.trace.cell, s));
        Step::Hit
    }

    /// Ends a trace that has met nothing before: with a hit of the ground, or with none.
    pub fn end(&mut self) -> Step {
        let end = self.trace.end;
        if self.trace.falls {
            self.land(end);
            return self.hit(end);
        }
        self.trace.s = end;
        self.trace.state = Step::Out;
        Step::Out
    }
}
