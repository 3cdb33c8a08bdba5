//! A heightfield: a block whose top is a height map (docs/method.md, 4).
//!
//! A tracer of [`crate::heightfield::tracer`] follows the rays, in local units: texels along
//! the sides of the block, and heights from 0 to 1. Cones and empty balls are tested against
//! the highest point of the map below them ([`mod@maxima_cone`]), so nothing finer than a cell
//! limits them.
//! Twin: `wgsl/scene/heightfield.wgsl`.

use bytemuck::{Pod, Zeroable, bytes_of};
use glam::{BVec2, DVec2, DVec3, Vec3};

use crate::base::array::SceneArray;
use crate::base::outcome::Counts;
use crate::base::shader::Module;
use crate::base::view::Beam;
use crate::heightfield::assets::Ready;
use crate::heightfield::height_surface::HeightmapUniform;
use crate::heightfield::heights::{Normals, Patches};
use crate::heightfield::maxima_cone::{self, CONE_WINDOWS, LocalCone, maxima_cone, window};
use crate::heightfield::paint::Colors;
use crate::heightfield::settings::HeightfieldSettings;
use crate::heightfield::tracer::grid::{FAR, FLAT};
use crate::heightfield::tracer::{self, Accuracy, LocalRay, Trace, TraceHit};
use crate::scene::Viewpoint;
use crate::scene::contract::{Advance, Hit, Solid, Step, Surface, Twin};
use crate::wgsl;

/// What roundings in f32 may take from the square of a sine, and from the growth of a cone.
const SQUARE_SLACK: f64 = 1e-6;
const GROWTH_SLACK: f64 = 4e-7;
/// The most windows in the search of an empty ball: the levels of the pyramid of a map of 8192.
const HEIGHTFIELD_SEARCHES: u32 = 14;
/// Shadow rays start off the surface by this share of a texel, or by a few roundings if these are
/// larger.
const HEIGHTFIELD_LIFT: f64 = 1e-3;
/// Weight of the height above the surface in a guess of the free room; the rest is the proven
/// clearance.
const HEIGHTFIELD_GUESS: f64 = 0.5;
/// Linear grey of the walls of a textured block: earth.
const HEIGHTFIELD_WALL: f64 = 0.06;
/// An upper bound of the loop rounds in one step: the windows of a cone. The last step of a ray
/// has fewer: up to 32 refinements and those that settle a box.
const HEIGHTFIELD_ROUNDS: u32 = CONE_WINDOWS;

/// The scene as WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct HeightfieldUniform {
    /// World directions to texels along x.
    pub row_x: Vec3,
    /// World length of a texel.
    pub texel: f32,
    /// World directions to texels along y.
    pub row_y: Vec3,
    /// World length of the height 1.
    pub depth: f32,
    /// World directions to heights.
    pub row_z: Vec3,
    /// Nothing is farther from the eye.
    pub far: f32,
    /// The eye in local units.
    pub eye: Vec3,
    /// Shadow rays start at this distance from exact hits.
    pub lift: f32,
    /// More than the rounding error of local coordinates.
    pub slack: Vec3,
    /// Unused.
    pub pad1: f32,
    /// The height map.
    pub map: HeightmapUniform,
}

/// A heightfield seen from an eye.
#[derive(Clone, Debug)]
pub struct Heightfield {
    made: Ready,
    eye: DVec3,
    far: f64,
    /// An upper bound of the rounding error of local coordinates in f32: a few roundings of
    /// numbers as large as the block and the distance of the eye.
    slack: DVec3,
    /// Shadow rays start at this distance from exact hits.
    lift: f64,
    /// Whether normals change steadily from patch to patch.
    is_smooth: bool,
}

impl Heightfield {
    /// The heightfield of settings that are ready, seen from a viewpoint.
    pub(super) fn of(settings: &HeightfieldSettings, made: Ready, from: &Viewpoint) -> Self {
        let is_smooth = settings.normals == Normals::Smooth;
        Self {
            is_smooth: is_smooth && settings.patches == Patches::Bilinear,
            ..Self::new(made, from.eye).spaced(from.spacing)
        }
    }

    /// The same for rays that start at most so far from the eye.
    #[must_use]
    pub fn spaced(mut self, spacing: f64) -> Self {
        self.far += spacing;
        self.slack += 5e-7 * spacing / self.made.placement.units();
        self
    }

    /// A heightfield seen from an eye.
    pub fn new(made: Ready, eye: DVec3) -> Self {
        let place = &made.placement;
        let far = place.farthest(eye);
        let sum = place.position(eye).abs() + place.sides.extend(1.0) + far / place.units();
        let slack = 5e-7 * sum;
        Self {
            is_smooth: false,
            lift: (HEIGHTFIELD_LIFT * place.texel).max(4.0 * (slack * place.units()).length()),
            slack,
            far,
            made,
            eye,
        }
    }

    fn local(&self, ray: &Beam) -> LocalRay {
        LocalRay {
            origin: self.made.placement.position(self.eye + ray.origin),
            axis: self.made.placement.direction(ray.axis),
        }
    }

    fn is_exact(&self) -> bool {
        self.made.kind.facts().accuracy == Accuracy::Exact
    }

    /// The pigment at a place in a cell, where the surface has a height and its normal an
    /// upward part `up`.
    fn pigment(&self, cell: [i32; 2], uv: [f64; 2], height: f64, up: f64) -> DVec3 {
        let hue = match &self.made.colors {
            Colors::Height => height,
            Colors::Cones(paint) => paint.at(&self.made.surface, cell, uv),
            Colors::Texture(texture) => return texture.at(&self.made.surface, cell, uv),
        };
        // Steep ground is darker.
        DVec3::new(hue, up, 0.5)
    }

    /// The radius of a ball about a local position that is proven empty, from windows of maxima.
    /// The search ends where the radius is at least `enough`, or where no window has more room.
    fn empty_radius(&self, p: DVec3, enough: f64, work: &mut Counts) -> f64 {
        let (surface, place) = (&self.made.surface, &self.made.placement);
        let slack = self.slack.truncate().max_element();
        let mut free = place.distance(p);
        // The least level with windows whose nodes are wider than such a ball.
        let wide = 2.0 * (enough.max(0.0) / place.texel + slack);
        let fits = u32::BITS - (wide.min(1e6) as u32).leading_zeros();
        let finest = surface.finest();
        let most = fits.max(finest).min(surface.maxima().coarsest());
        for level in (finest..=most).rev() {
            // Within the map, the room in a window is at most as wide as one of its nodes.
            let node = f64::from(1 << level);
            if free >= enough.min(place.texel * node) {
                break;
            }
            work.evaluations += 1;
            // The point is at least half a node from every side of the window.
            let window = window(surface, level, p.truncate() - 0.5 * node, BVec2::FALSE);
            let sides = (p.truncate() - window.low).min(window.high - p.truncate());
            let room = (sides.min_element() - slack) * place.texel;
            let gap = (p.z - self.slack.z - window.maximum) * place.depth;
            free = free.max(room.min(gap));
            // A smaller window has less room.
            if gap >= room {
                break;
            }
        }
        free.max(0.0)
    }

    /// The world distance from a local position to the surface straight below it. Beside the
    /// block it is the distance to the edge of the top, or to the wall below that edge.
    fn surface_gap(&self, p: DVec3) -> f64 {
        let (xy, place) = (p.truncate(), &self.made.placement);
        let inside = xy.clamp(DVec2::ZERO, place.sides);
        let cell = inside.floor().min((place.sides - 1.0).max(DVec2::ZERO));
        let at = inside - cell;
        let cell = cell.as_ivec2().to_array();
        let height = self.made.surface.height(cell, at.x, at.y);
        let above = ((p.z - height) * place.depth).max(0.0);
        let off = (xy - inside) * place.texel;
        off.extend(above).length()
    }
}

/// The local normal of the side through which a ray entered a box: that of the grid line
/// that it crossed last before the place `uv`.
fn box_side(axis: DVec3, uv: [f64; 2]) -> DVec3 {
    let since = |a: usize| {
        let way = if axis[a] > 0.0 { uv[a] } else { 1.0 - uv[a] };
        if axis[a].abs() < FLAT {
            FAR
        } else {
            way / axis[a].abs()
        }
    };
    let side = if since(0) <= since(1) {
        DVec3::X
    } else {
        DVec3::Y
    };
    if side.dot(axis) > 0.0 { -side } else { side }
}

impl Twin for Heightfield {
    fn modules(&self) -> Vec<Module> {
        let mut all = vec![
            maxima_cone::module(),
            wgsl!(
                "scene/heightfield.wgsl",
                "HEIGHTFIELD_SEARCHES" = f64::from(HEIGHTFIELD_SEARCHES),
                "HEIGHTFIELD_EXACT" = f64::from(u8::from(self.is_exact())),
                "HEIGHTFIELD_GUESS" = HEIGHTFIELD_GUESS,
                "HEIGHTFIELD_COLORED" = f64::from(u8::from(self.is_colored())),
                "HEIGHTFIELD_SMOOTH" = f64::from(u8::from(self.is_smooth)),
                "HEIGHTFIELD_WALL" = HEIGHTFIELD_WALL,
                "HIT_CARRIES_MARK" = 1.0
            ),
            wgsl!("scene/one_by_one.wgsl"),
        ];
        all.push(self.made.colors.module());
        all.extend(self.made.tracer.modules());
        all
    }

    fn uniforms(&self) -> Vec<(&'static str, Vec<u8>)> {
        let [row_x, row_y, row_z] = self.made.placement.rows().map(|r| r.as_vec3());
        let scene = HeightfieldUniform {
            row_x,
            texel: self.made.placement.texel as f32,
            row_y,
            depth: self.made.placement.depth as f32,
            row_z,
            // Rounded up: the farthest corner must not lie beyond it.
            far: (self.far * (1.0 + 1e-6)) as f32,
            eye: self.made.placement.position(self.eye).as_vec3(),
            lift: self.lift as f32,
            slack: self.slack.as_vec3(),
            map: self.made.tracer.uniform(),
            ..Zeroable::zeroed()
        };
        vec![("heightfield_parameters", bytes_of(&scene).to_vec())]
    }

    fn arrays(&self) -> Vec<SceneArray> {
        let mut all = self.made.tracer.arrays();
        all.extend(self.made.colors.array());
        all
    }

    fn describe(&self) -> String {
        let ([w, h], name) = (self.made.surface.heights().size(), self.made.kind.name());
        format!("heightfield: {w} x {h} samples, traced by {name}")
    }

    fn most_steps(&self) -> Option<u32> {
        Some(self.made.most_steps)
    }

    fn rounds(&self) -> u32 {
        HEIGHTFIELD_ROUNDS
    }
}

/// A ray between two steps.
#[derive(Clone, Copy)]
pub struct Walk {
    ray: LocalRay,
    trace: Trace,
}

impl Solid for Heightfield {
    type Walk = Walk;

    fn advance(&self, cone: &Beam, at: Advance, work: &mut Counts) -> Advance {
        let LocalRay { origin, axis } = self.local(cone);
        let units = self.made.placement.units();
        // Unit vectors that differ by k differ by k²/2 along either of them.
        let along = (axis * units).abs();
        let across = (DVec3::ONE - along * along).max(DVec3::ZERO) + SQUARE_SLACK;
        let growth = cone.k * (across.map(f64::sqrt) + 0.5 * cone.k * along) + GROWTH_SLACK;
        let cone = LocalCone {
            origin,
            axis,
            radius: cone.r0 / units + 2.0 * self.slack,
            growth: growth.min(DVec3::splat(cone.k)) / units,
            slack: self.slack,
        };
        // Nothing is as far as that.
        let end = self.far * 1.0001;
        maxima_cone(&self.made.surface, &cone, at.front, end, work)
    }

    fn begin(&self, ray: &Beam, front: f64, t_max: f64, _work: &mut Counts) -> Walk {
        let ray = self.local(ray);
        // The tracer ends the ray where the block ends.
        let trace = self.made.tracer.begin(&ray, front, t_max);
        Walk { ray, trace }
    }

    fn walk_step(&self, _: &Beam, walk: &mut Walk, work: &mut Counts) -> Step {
        self.made.tracer.step(&walk.ray, &mut walk.trace, work)
    }

    fn walk_hit(&self, walk: &Walk) -> Hit {
        let TraceHit { s: t, id, uv } = walk.trace.hit();
        Hit { t, id, uv }
    }

    fn shadow_lift(&self, grain: f64) -> f64 {
        if self.is_exact() {
            return self.lift;
        }
        // The hit may be below the surface.
        self.lift.max(4.0 * grain)
    }

    fn clearance(&self, q: DVec3) -> f64 {
        let p = self.made.placement.position(self.eye + q);
        // The ball cannot reach below the surface.
        self.empty_radius(p, self.surface_gap(p), &mut Counts::default())
    }

    /// A mean of two values: the proven radius is far too small over steep ground, and the height
    /// above the surface ignores what stands beside the point.
    fn room(&self, q: DVec3, enough: f64, work: &mut Counts) -> f64 {
        let p = self.made.placement.position(self.eye + q);
        let gap = self.surface_gap(p);
        let rest = (enough - HEIGHTFIELD_GUESS * gap) / (1.0 - HEIGHTFIELD_GUESS);
        let proven = self.empty_radius(p, rest, work);
        proven + HEIGHTFIELD_GUESS * (gap - proven)
    }

    fn surface(&self, ray: &Beam, hit: &Hit) -> Surface {
        let (place, surface) = (&self.made.placement, &self.made.surface);
        let Hit { t: s, id, uv } = *hit;
        let hit = TraceHit { s, id, uv };
        if hit.face() != tracer::SURFACE {
            let side = match hit.face() {
                tracer::WALL_X_LOW => -DVec3::X,
                tracer::WALL_X_HIGH => DVec3::X,
                tracer::WALL_Y_LOW => -DVec3::Y,
                tracer::WALL_Y_HIGH => DVec3::Y,
                _ => -DVec3::Z,
            };
            return Surface {
                normal: place.side(side),
                pigment: if self.is_colored() {
                    DVec3::splat(HEIGHTFIELD_WALL)
                } else {
                    DVec3::new(0.0, 0.3, 0.3)
                },
            };
        }
        let (cell, width) = (hit.cell(), surface.cells()[0]);
        let cell = [cell % width, cell / width].map(|n| n as i32);
        let [a, b, c, d] = surface.corners(cell);
        let ray = self.local(ray);
        let z = ray.height(hit.s);
        // Below the top of its box by more than rounding: the hit is on a side.
        if surface.patches() == Patches::Boxes && z < a - self.slack.z {
            return Surface {
                normal: place.side(box_side(ray.axis, hit.uv)),
                pigment: self.pigment(cell, hit.uv, z, 0.0),
            };
        }
        let [u, v] = hit.uv;
        let slope = match self.is_smooth {
            true => surface.smooth_slope(cell, hit.uv),
            false => DVec2::new(
                (b - a) + v * ((d - c) - (b - a)),
                (c - a) + u * ((d - b) - (c - a)),
            ),
        };
        let up = (slope * (place.depth / place.texel))
            .extend(1.0)
            .length()
            .recip();
        Surface {
            normal: place.normal(slope),
            pigment: self.pigment(cell, hit.uv, surface.height(cell, u, v), up),
        }
    }

    fn bounds_far(&self) -> f64 {
        self.far
    }

    fn is_colored(&self) -> bool {
        matches!(self.made.colors, Colors::Texture(_))
    }
}
