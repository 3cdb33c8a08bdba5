//! A scene of a relief: a block whose top is a height map (docs/method.md, 4).
//!
//! Rays are traced by one of the tracers of [`crate::heightfield::tracer`], in local
//! units. Coarse cones and empty balls ask the maxima under them; what these prove holds
//! for any surface under the cells' apexes. Occlusion by `clearance` therefore knows
//! nothing finer than a cell. Twin: `wgsl/scene/heightfield.wgsl`.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable, bytes_of};
use glam::{DVec2, DVec3, Vec3};

use crate::base::cone::ConeRule;
use crate::base::key::{Fault, Key};
use crate::base::shader::Module;
use crate::base::view::Beam;
use crate::base::work::Work;
use crate::heightfield::assets::{Assets, Preparation, Ready};
use crate::heightfield::height_surface::HeightSurface;
use crate::heightfield::heights::Patches;
use crate::heightfield::paint::Colors;
use crate::heightfield::placement::Placement;
use crate::heightfield::region_max::{self, region_max};
use crate::heightfield::settings::HeightfieldSettings;
use crate::heightfield::tracer::grid::{FAR, FLAT};
use crate::heightfield::tracer::settings::{Make, PrepareError};
use crate::heightfield::tracer::{self, LocalRay, Trace, TraceHit, Tracer};
use crate::scene::contract::{Advance, Hit, Solid, Step, Surface, Twin};
use crate::scene::{AnySolid, MOST_SHADOW_STEPS, Scene, SceneSettings, Viewpoint};
use crate::wgsl;
use std::path::{Path, PathBuf};

/// Halvings of the longest sweep, and doublings of the least ball: enough to come from
/// a map of 8192 texels down to a quarter of one.
const HEIGHTFIELD_HALVINGS: u32 = 15;
/// Share of the height above the surface in a guess of the room there is.
const HEIGHTFIELD_GUESS: f64 = 0.5;
/// Linear grey of the walls under a texture, which has nothing to say of them: earth.
const HEIGHTFIELD_WALL: f64 = 0.06;
/// Rounds of all loops in one step: of `advance` that many sweeps, each a walk over the
/// levels of the pyramid in up to four runs.
const HEIGHTFIELD_ROUNDS: u32 = HEIGHTFIELD_HALVINGS * 4 * 16;

/// The scene as WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct HeightfieldUniform {
    /// World directions to texels along x.
    pub row_x: Vec3,
    /// Length of a texel.
    pub texel: f32,
    /// World directions to texels along y.
    pub row_y: Vec3,
    /// Length of the whole height.
    pub depth: f32,
    /// World directions to heights.
    pub row_z: Vec3,
    /// Nothing is farther from the eye.
    pub far: f32,
    /// The eye in local units.
    pub eye: Vec3,
    /// Unused.
    pub pad0: f32,
    /// More than what local coordinates are rounded by.
    pub slack: Vec3,
    /// Unused.
    pub pad1: f32,
}

impl SceneSettings for HeightfieldSettings {
    fn kind(&self) -> &'static str {
        "heightfield"
    }

    fn keys(&mut self) -> Vec<Key<'_>> {
        Self::keys(self)
    }

    fn check(&self) -> Result<(), Fault> {
        Self::check(self)
    }

    fn solid(&self, from: &Viewpoint, assets: &Assets) -> Result<AnySolid, PrepareError> {
        let ready = assets.ready(self, from.grain)?;
        let solid = Heightfield::new(ready, from.eye, from.stepping.rule);
        Ok(AnySolid::Heightfield(solid))
    }

    fn outline(&self, from: &Viewpoint, assets: &Assets) -> Result<AnySolid, PrepareError> {
        let ready = assets.outline(self, from.grain)?;
        let solid = Heightfield::new(ready, from.eye, from.stepping.rule);
        Ok(AnySolid::Heightfield(solid))
    }

    fn most_shadow_steps(&self) -> u32 {
        MOST_SHADOW_STEPS
    }

    /// The papers' tracers run out of their own steps; a fractal's pixels that run out are
    /// next to what they would have met.
    fn flags_unconverged(&self) -> bool {
        true
    }

    fn exact(&self) -> Option<Scene> {
        Some(Self::exact(self).into())
    }

    fn colorless(&self) -> Option<Scene> {
        Some(Self::colorless(self).into())
    }

    fn set_folder(&mut self, folder: &Path) {
        self.source.folder = folder.to_path_buf();
    }

    fn files(&self) -> Vec<(&'static str, PathBuf)> {
        Self::files(self)
    }

    fn load(&self, assets: &Assets) -> Result<(), Fault> {
        assets.load(self)
    }

    fn prepare(&self, assets: &Assets, make: Make<'_>) -> Result<(), PrepareError> {
        assets.prepare(self, make)
    }

    fn preparations(&self, assets: &Assets) -> Vec<Preparation> {
        assets.preparations(self)
    }

    fn notes(&self, assets: &Assets) -> Vec<String> {
        assets.notes(self)
    }

    fn contents(&self, assets: &Assets) -> Vec<u8> {
        assets.contents(self)
    }

    fn most_steps(&self, assets: &Assets) -> Option<u32> {
        assets.most_steps(self)
    }
}

/// A relief seen from an eye.
#[derive(Clone, Debug)]
pub struct Heightfield {
    relief: Arc<HeightSurface>,
    tracer: Arc<dyn Tracer>,
    colors: Colors,
    name: &'static str,
    placed: Placement,
    eye: DVec3,
    far: f64,
    rule: ConeRule,
}

impl Heightfield {
    /// A heightfield seen from an eye.
    pub fn new(ready: Ready, eye: DVec3, rule: ConeRule) -> Self {
        let Ready {
            surface: relief,
            tracer,
            colors,
            placement: placed,
            name,
        } = ready;
        Self {
            relief,
            tracer,
            colors,
            name,
            far: placed.farthest(eye),
            placed,
            eye,
            rule,
        }
    }

    fn local(&self, ray: &Beam) -> LocalRay {
        LocalRay {
            origin: self.placed.position(self.eye + ray.origin),
            axis: self.placed.direction(ray.axis),
        }
    }

    /// The pigment at a place of a cell, of a surface so high that faces up so much.
    fn pigment(&self, cell: [i32; 2], uv: [f64; 2], height: f64, up: f64) -> DVec3 {
        let hue = match &self.colors {
            Colors::Height => height,
            Colors::Cones(paint) => paint.at(&self.relief, cell, uv),
            Colors::Texture(texture) => return texture.at(&self.relief, cell, uv),
        };
        // Steep ground is darker.
        DVec3::new(hue, up, 0.5)
    }

    fn units(&self) -> DVec3 {
        DVec3::new(self.placed.texel, self.placed.texel, self.placed.depth)
    }

    /// Whether a ball of a world radius swept from one local position to another meets
    /// no part of the block that is filled.
    fn sweep_is_free(&self, one: DVec3, two: DVec3, radius: f64, work: &mut Work) -> bool {
        work.evaluations += 1;
        let room = radius / self.units();
        let (low, high) = (one.min(two) - room, one.max(two) + room);
        let top = || region_max(&self.relief, low.truncate(), high.truncate());
        high.z < 0.0 || low.z > 1.0 || low.z > top()
    }

    /// Room between a local position and the surface, in the world's length: its height
    /// above the surface under it, or above the rim that is nearest and how far off that is.
    fn surface_gap(&self, p: DVec3) -> f64 {
        let xy = p.truncate();
        let inside = xy.clamp(DVec2::ZERO, self.placed.sides);
        let last = (self.placed.sides - 1.0).max(DVec2::ZERO);
        let cell = inside.floor().min(last);
        let at = inside - cell;
        let height = self
            .relief
            .height([cell.x as i32, cell.y as i32], at.x, at.y);
        let above = ((p.z - height) * self.placed.depth).max(0.0);
        let off = (xy - inside) * self.placed.texel;
        off.extend(above).length()
    }

    /// What f32 may be off by in local coordinates: some roundings of numbers of the size
    /// of the eye's distance and of the block.
    fn slack(&self) -> DVec3 {
        let eye = self.placed.position(self.eye).abs();
        let sides = self.placed.sides.extend(1.0);
        5e-7 * (eye + sides + self.far / self.units())
    }
}

/// The normal that faces out of the side by which a ray came into a box: that of the line
/// which it crossed last on its way to a place in the box.
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
            self.rule.module(),
            region_max::module(),
            wgsl!(
                "scene/heightfield.wgsl",
                "HEIGHTFIELD_HALVINGS" = f64::from(HEIGHTFIELD_HALVINGS),
                "HEIGHTFIELD_GUESS" = HEIGHTFIELD_GUESS,
                "HEIGHTFIELD_COLORED" = f64::from(u8::from(self.is_colored())),
                "HEIGHTFIELD_WALL" = HEIGHTFIELD_WALL,
                "HIT_CARRIES_MARK" = 1.0
            ),
        ];
        all.push(self.colors.module());
        all.extend(self.tracer.modules());
        all
    }

    #[allow(clippy::cast_possible_truncation, reason = "f32 is what the GPU takes")]
    fn uniforms(&self) -> Vec<(&'static str, Vec<u8>)> {
        let [row_x, row_y, row_z] = self.placed.rows().map(|r| r.as_vec3());
        let scene = HeightfieldUniform {
            row_x,
            texel: self.placed.texel as f32,
            row_y,
            depth: self.placed.depth as f32,
            row_z,
            // Rounded up: the corner itself must not count as past everything.
            far: (self.far * (1.0 + 1e-6)) as f32,
            eye: self.placed.position(self.eye).as_vec3(),
            pad0: 0.0,
            slack: self.slack().as_vec3(),
            pad1: 0.0,
        };
        let mut all = vec![("heightfield_parameters", bytes_of(&scene).to_vec())];
        all.extend(self.tracer.buffers());
        all.extend(self.colors.buffer());
        all
    }

    fn describe(&self) -> String {
        let [w, h] = self.relief.heights().size();
        format!("heightfield: {w} x {h} samples, traced by {}", self.name)
    }

    fn rounds(&self) -> u32 {
        HEIGHTFIELD_ROUNDS
    }
}

impl Solid for Heightfield {
    type Walk = Trace;

    fn advance(&self, cone: &Beam, front: f64, work: &mut Work) -> Advance {
        let ray = self.local(cone);
        let here = ray.at(front);
        let away = self.placed.distance(here) - cone.r0;
        // Far outside, the distance to the block carries the cone farther.
        let carried = self.rule.cone_front(front, front, away, cone.k);
        if away > 0.0 && carried - front > 0.5 * away {
            return Advance {
                front: carried,
                going: true,
            };
        }
        let thick = cone.r0 + cone.k * front;
        let mut length = self.far * 1.0001 - front;
        for _ in 0..HEIGHTFIELD_HALVINGS {
            let end = front + length;
            if self.sweep_is_free(here, ray.at(end), cone.r0 + cone.k * end, work) {
                return Advance {
                    front: end,
                    going: true,
                };
            }
            length *= 0.5;
            // A short gain is better left to the four thinner children.
            if length < 0.5 * thick {
                break;
            }
        }
        Advance {
            front: front.max(carried),
            going: false,
        }
    }

    fn begin(&self, ray: &Beam, front: f64, t_max: f64, _work: &mut Work) -> Trace {
        // The tracer ends it with the block.
        self.tracer.begin(&self.local(ray), front, t_max)
    }

    fn walk_step(&self, ray: &Beam, walk: &mut Trace, work: &mut Work) -> Step {
        self.tracer.step(&self.local(ray), walk, work)
    }

    fn walk_hit(&self, walk: &Trace) -> Hit {
        let hit = walk.hit();
        Hit {
            t: hit.s,
            id: hit.id,
            uv: hit.uv,
        }
    }

    fn walk_radius(&self, ray: &Beam, walk: &Trace) -> f64 {
        let t = walk.hit().s;
        self.surface_gap(self.local(ray).at(t))
    }

    fn clearance(&self, q: DVec3) -> f64 {
        let p = self.placed.position(self.eye + q);
        let mut free = self.placed.distance(p);
        let mut radius = 0.5 * self.placed.texel;
        for _ in 0..HEIGHTFIELD_HALVINGS {
            let room = DVec2::splat(radius / self.placed.texel);
            let top = region_max(&self.relief, p.truncate() - room, p.truncate() + room);
            let gap = (p.z - top) * self.placed.depth;
            free = free.max(radius.min(gap));
            if gap < radius {
                break;
            }
            radius *= 2.0;
        }
        free.max(0.0)
    }

    /// Proven balls are far too small over steep ground, heights above it know nothing of
    /// what stands beside it: halfway between them is a good guess.
    fn room(&self, q: DVec3) -> f64 {
        let gap = self.surface_gap(self.placed.position(self.eye + q));
        let proven = self.clearance(q);
        proven + HEIGHTFIELD_GUESS * (gap - proven)
    }

    fn surface(&self, ray: &Beam, hit: &Hit) -> Surface {
        let hit = TraceHit {
            s: hit.t,
            id: hit.id,
            uv: hit.uv,
        };
        let wall = match hit.face() {
            tracer::SURFACE => None,
            tracer::WALL_X_LOW => Some(-DVec3::X),
            tracer::WALL_X_HIGH => Some(DVec3::X),
            tracer::WALL_Y_LOW => Some(-DVec3::Y),
            tracer::WALL_Y_HIGH => Some(DVec3::Y),
            _ => Some(-DVec3::Z),
        };
        if let Some(side) = wall {
            return Surface {
                normal: self.placed.side(side),
                pigment: if self.is_colored() {
                    DVec3::splat(HEIGHTFIELD_WALL)
                } else {
                    DVec3::new(0.0, 0.3, 0.3)
                },
            };
        }
        let (cell, width) = (hit.cell(), self.relief.cells()[0]);
        let cell = [cell % width, cell / width].map(|n| n as i32);
        let [a, b, c, d] = self.relief.corners(cell);
        let ray = self.local(ray);
        let z = ray.height(hit.s);
        // Under the top of its box by more than a rounding: on a side.
        if self.relief.patches() == Patches::Boxes && z < a - self.slack().z {
            return Surface {
                normal: self.placed.side(box_side(ray.axis, hit.uv)),
                pigment: self.pigment(cell, hit.uv, z, 0.0),
            };
        }
        let [u, v] = hit.uv;
        let slope = DVec2::new(
            (b - a) + v * ((d - c) - (b - a)),
            (c - a) + u * ((d - b) - (c - a)),
        );
        let low = a + u * (b - a);
        let high = c + u * (d - c);
        let steep = slope * (self.placed.depth / self.placed.texel);
        let up = steep.extend(1.0).length().recip();
        Surface {
            normal: self.placed.normal(slope),
            pigment: self.pigment(cell, hit.uv, low + v * (high - low), up),
        }
    }

    fn bounds_far(&self) -> f64 {
        self.far
    }

    fn is_colored(&self) -> bool {
        matches!(self.colors, Colors::Texture(_))
    }
}
