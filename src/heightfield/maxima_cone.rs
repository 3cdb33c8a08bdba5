//! A cone's way over the pyramid of maxima (docs/method.md, 4): how far all of its rays are
//! proven to pass above the surface. It needs no cone map.
//! Twin: `wgsl/heightfield/maxima_cone.wgsl`.
//!
//! All of it is linear in the distance t. The rays of the cone are in a box about the axis, whose
//! half sides grow with t. A *window* is two by two neighbouring nodes of one level that hold
//! the box seen from above. Until the box leaves the window, the rays are over its nodes, and the
//! underside of the box is lowest at one of the two ends of that part. So it is enough to test
//! both ends against the highest of the four nodes.

use glam::{BVec2, DVec2, DVec3};

use crate::base::outcome::{Advance, Counts};
use crate::base::shader::Module;
use crate::heightfield::HeightSurface;
use crate::wgsl;

/// The most windows in one call. Nearly all cones of the presets need fewer; the others go on in
/// another call.
pub const CONE_WINDOWS: u32 = 64;
/// A node is wider than the box by this factor at least, so that two of them hold it wherever
/// it lies.
const CONE_FIT: f64 = 2.0002;
/// Factors on exits, ways down and fronts, and a share of the ends of the clipped cone: more
/// than the roundings of f32. An exit is rounded up so that the next window is another one;
/// the slack of the box covers this.
const CONE_EXIT: f64 = 1.000_000_2;
const CONE_DESCENT: f64 = 1.0 - 1e-5;
const CONE_FRONT: f64 = 1.0 - 4e-7;
const CONE_CLIP: f64 = 1e-6;
/// An edge that no cone reaches, and the least speed by which a way is divided: no quotient
/// leaves the range of f32.
const CONE_NO_EDGE: f64 = 1e12;
const CONE_SLOW: f64 = 1e-20;
/// The least step, as a share of t. A shorter one would be lost in the roundings of f32, and the
/// slack of the box covers this one.
const CONE_LEAST: f64 = 2.4e-7;

/// A cone in local units. At t, its rays are at most `radius + t growth` off its axis along each
/// coordinate.
#[derive(Clone, Copy, Debug)]
pub struct LocalCone {
    /// Start.
    pub origin: DVec3,
    /// Change of the axis with t.
    pub axis: DVec3,
    /// Half sides of the box at the start, with twice the slack.
    pub radius: DVec3,
    /// Change of these with t.
    pub growth: DVec3,
    /// More than the rounding error of local coordinates.
    pub slack: DVec3,
}

/// Two by two nodes of a level.
pub struct Window {
    /// Its lower edges, in texels.
    pub low: DVec2,
    /// Its upper edges.
    pub high: DVec2,
    /// The highest point under it.
    pub maximum: f64,
}

/// The WGSL module.
pub fn module() -> Module {
    wgsl!(
        "heightfield/maxima_cone.wgsl",
        "CONE_WINDOWS" = f64::from(CONE_WINDOWS),
        "CONE_FIT" = CONE_FIT,
        "CONE_EXIT" = CONE_EXIT,
        "CONE_DESCENT" = CONE_DESCENT,
        "CONE_FRONT" = CONE_FRONT,
        "CONE_CLIP" = CONE_CLIP,
        "CONE_NO_EDGE" = CONE_NO_EDGE,
        "CONE_SLOW" = CONE_SLOW,
        "CONE_LEAST" = CONE_LEAST
    )
}

impl LocalCone {
    fn half(&self, t: f64) -> DVec3 {
        self.radius + t * self.growth
    }

    /// The part of `from..=to` in which the cone meets the block below the height `top`, a
    /// little longer; the end is before the start if there is none.
    fn within(&self, sides: DVec2, top: f64, from: f64, to: f64) -> [f64; 2] {
        let (mut near, mut far) = (from, to);
        // Each face is met where `room + t gain` is not negative.
        let below = sides.extend(top) - self.origin;
        for (room, gain) in [
            (self.origin + self.radius, self.growth + self.axis),
            (below + self.radius, self.growth - self.axis),
        ] {
            for i in 0..3 {
                let meets = -room[i] / gain[i].abs().max(CONE_SLOW);
                if gain[i] > CONE_SLOW {
                    near = near.max(meets - CONE_CLIP * meets.abs());
                } else if gain[i] < -CONE_SLOW {
                    far = far.min(-meets + CONE_CLIP * meets.abs());
                } else if room[i] < 0.0 {
                    far = -1.0;
                }
            }
        }
        [near, far]
    }
}

/// The window of a level whose node at the rear, seen along the cone's way, holds a place. Each
/// tile begins nodes of its own.
pub fn window(surface: &HeightSurface, level: u32, rear: DVec2, back: BVec2) -> Window {
    let (domain, cells) = (surface.domain(), surface.cells());
    let last = DVec2::from_array(domain.map(|n| f64::from(n - 1)));
    let rear = rear.floor();
    let inside = rear.clamp(DVec2::ZERO, last);
    let cell = inside.as_ivec2().to_array();
    let own = surface.tile_cell(cell);
    let windows = surface.windows(level);
    let axis = |i: usize| {
        // The window before the node or the one after it. Outside of the block it is the outer one.
        let after = rear[i] > inside[i] || rear[i] == inside[i] && !back.test(i);
        let at = (own[i] >> level) + u32::from(after);
        let (tile, cells) = (cell[i] - own[i] as i32, cells[i] as i32);
        let (at_cell, width) = ((at << level) as i32, 1 << level);
        let nodes = windows.size[i] - 1;
        let low = match at {
            // The last node of the tile before may be narrow.
            0 => ((nodes - 1) << level) as i32 - cells,
            _ => at_cell - width,
        };
        let high = match at == nodes {
            true => cells + width.min(cells),
            false => cells.min(at_cell + width),
        };
        // All tiles are alike.
        let whole = width >= cells;
        let edge = |open: bool, none: f64, edge: i32| if open { none } else { f64::from(edge) };
        let (low, high) = (tile + low, tile + high);
        let low = edge(whole || low <= 0, -CONE_NO_EDGE, low);
        (
            at,
            low,
            edge(whole || high >= domain[i], CONE_NO_EDGE, high),
        )
    };
    let [(x, left, right), (y, near, far)] = [axis(0), axis(1)];
    Window {
        low: DVec2::new(left, near),
        high: DVec2::new(right, far),
        maximum: f64::from(windows.at(x, y)),
    }
}

/// The front of a cone that starts at a proven one. It is `end` if all of the cone's rays pass
/// the block.
pub fn maxima_cone(
    surface: &HeightSurface,
    cone: &LocalCone,
    front: f64,
    end: f64,
    work: &mut Counts,
) -> Advance {
    let sides = DVec2::from_array(surface.domain().map(f64::from));
    let maxima = surface.maxima();
    let top = f64::from(maxima.top());
    let [mut t, far] = cone.within(sides, top, front, end);
    // Levels above the least one of a window that holds the box, and the fewest that do.
    let (mut lift, mut least) = (0, 0);
    let mut going = true;
    let [ahead, behind] = [cone.growth + cone.axis, cone.growth - cone.axis]
        .map(|gain| gain.truncate().max(DVec2::splat(CONE_SLOW)));
    let back = cone.axis.truncate().cmplt(DVec2::ZERO);
    for _ in 0..CONE_WINDOWS {
        if t >= far {
            return Advance::at(end, going);
        }
        work.evaluations += 1;
        let (p, half) = (cone.origin + t * cone.axis, cone.half(t));
        let wide = CONE_FIT * (half.truncate() + cone.slack.truncate()).max_element();
        // The least level with windows whose nodes are wider than that.
        let fits = (u32::BITS - (wide.min(1e6) as u32).leading_zeros()).max(surface.finest());
        lift = lift.min(maxima.coarsest().saturating_sub(fits));
        let level = (fits + lift).min(maxima.coarsest());
        let (low, high) = (p - half, p + half);
        let slack = cone.slack.truncate();
        let [left, right] = [low, high].map(DVec3::truncate);
        let rear = DVec2::select(back, right + slack, left - slack);
        let window = window(surface, level, rear, back);
        // Where a tile ends with a narrow node, the box may be too wide for two.
        if left.cmplt(window.low).any() || right.cmpgt(window.high).any() {
            lift += 1;
            least = lift;
            continue;
        }
        // Where the box leaves the window.
        let exits = ((window.high - right) / ahead).min((left - window.low) / behind);
        let step = (exits.min_element() * CONE_EXIT)
            .max(CONE_LEAST * t)
            .min(far - t);
        let over = low.z - window.maximum;
        let fall = cone.axis.z - cone.growth.z;
        if over > 0.0 && over + step * fall > 0.0 {
            t += step;
            lift += 1;
            least = 0;
            continue;
        }
        if over > 0.0 {
            t += over / -fall * CONE_DESCENT;
        }
        if lift <= least {
            going = false;
            break;
        }
        lift -= 1;
        if over > 0.0 {
            least = 0;
        }
    }
    Advance::at(front.max(t * CONE_FRONT), going)
}
