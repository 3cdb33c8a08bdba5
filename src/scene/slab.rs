//! A round slab between two parallel planes, solved in closed form.
//!
//! It is the smallest complete scene, without distance estimate, formula or map. It shows that
//! passes work with any scene. Twin: `wgsl/scene/slab.wgsl`.

use bytemuck::{Pod, Zeroable, bytes_of};
use glam::{DVec2, DVec3, Vec3};

use crate::base::cone::ConeRule;
use crate::base::key::{Fault, Key, number, triple};
use crate::base::outcome::Counts;
use crate::base::shader::Module;
use crate::base::view::Beam;
use crate::heightfield::tracer::settings::PrepareError;
use crate::scene::contract::{Advance, Hit, Solid, Step, Surface, Twin};
use crate::scene::{AnySolid, Assets, SceneSettings, Viewpoint};
use crate::{settings, wgsl};

/// The slab as WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct SlabUniform {
    /// Camera position.
    pub eye: Vec3,
    /// Half thickness.
    pub half: f32,
    /// Unit normal of the planes.
    pub normal: Vec3,
    /// Radius of the disc.
    pub radius: f32,
    /// Unit direction in the plane.
    pub side: Vec3,
    /// Nothing is farther from the eye.
    pub far: f32,
    /// The other unit direction in the plane.
    pub other: Vec3,
    /// Unused.
    pub pad: f32,
}

settings! {
    /// The settings of a slab about the origin.
    pub struct SlabSettings {
        normal: DVec3 = DVec3::Z, triple(-1e6, 1e6), "normal of the two flat faces: the direction at right angles to them; must not be [0, 0, 0]";
        half: f64 = 0.5, number(1e-6, 1e6), "half the thickness of the slab";
        radius: f64 = 6.0, number(1e-6, 1e6), "radius of the slab";
    }
}

impl SceneSettings for SlabSettings {
    fn kind(&self) -> &'static str {
        "slab"
    }

    fn all() -> Vec<Self> {
        vec![Self::default()]
    }

    fn keys(&mut self) -> Vec<Key<'_>> {
        self.keys()
    }

    /// Checks that the normal is a direction.
    fn check(&self) -> Result<(), Fault> {
        Fault::unless(
            self.normal.length() >= 1e-9,
            "scene.normal",
            "the normal must not be zero; try [0, 0, 1]",
        )
    }

    fn solid(&self, from: &Viewpoint, _: &Assets) -> Result<AnySolid, PrepareError> {
        let slab = Slab::new(self, from.eye, from.stepping.rule).spaced(from.spacing);
        Ok(AnySolid::Slab(slab))
    }
}

/// A slab seen from an eye.
#[derive(Clone, Debug, PartialEq)]
pub struct Slab {
    eye: DVec3,
    half: f64,
    radius: f64,
    normal: DVec3,
    side: DVec3,
    other: DVec3,
    far: f64,
    rule: ConeRule,
}

impl Slab {
    /// The same for rays that start at most so far from the eye.
    #[must_use]
    pub fn spaced(mut self, spacing: f64) -> Self {
        self.far += spacing;
        self
    }

    /// A slab seen from an eye. The settings must pass [`SceneSettings::check`].
    pub fn new(settings: &SlabSettings, eye: DVec3, rule: ConeRule) -> Self {
        let (half, radius) = (settings.half, settings.radius);
        let normal = settings.normal.normalize();
        let side = normal.any_orthonormal_vector();
        Self {
            eye,
            half,
            radius,
            normal,
            side,
            other: normal.cross(side),
            far: eye.length() + half.hypot(radius),
            rule,
        }
    }

    fn slab_distance(&self, q: DVec3) -> f64 {
        let p = self.eye + q;
        let z = p.dot(self.normal);
        let off = (p - z * self.normal).length();
        let o = DVec2::new(off - self.radius, z.abs() - self.half);
        o.max(DVec2::ZERO).length() + o.max_element().min(0.0)
    }

    /// Coordinates along the two unit directions in the plane, as in WGSL.
    fn along(&self, v: DVec3) -> DVec2 {
        DVec2::new(v.dot(self.side), v.dot(self.other))
    }
}

impl Twin for Slab {
    fn modules(&self) -> Vec<Module> {
        vec![
            self.rule.module(),
            wgsl!("scene/slab.wgsl", "HIT_CARRIES_MARK" = 1.0),
            wgsl!("scene/one_by_one.wgsl"),
        ]
    }

    fn uniforms(&self) -> Vec<(&'static str, Vec<u8>)> {
        let slab = SlabUniform {
            eye: self.eye.as_vec3(),
            half: self.half as f32,
            normal: self.normal.as_vec3(),
            radius: self.radius as f32,
            side: self.side.as_vec3(),
            far: (self.far * (1.0 + 1e-6)) as f32,
            other: self.other.as_vec3(),
            ..Zeroable::zeroed()
        };
        vec![("slab_parameters", bytes_of(&slab).to_vec())]
    }

    fn describe(&self) -> String {
        "slab, solved in closed form".into()
    }

    fn rounds(&self) -> u32 {
        0
    }
}

/// A ray whose hit is already known.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    t: f64,
    hit: Option<Hit>,
    end: f64,
}

impl Solid for Slab {
    type Walk = Walk;

    fn advance(&self, cone: &Beam, at: Advance, work: &mut Counts) -> Advance {
        let front = at.front;
        work.evaluations += 1;
        let d = self.slab_distance(cone.at(front)) - cone.r0;
        let next = self.rule.cone_front(front, front, d, cone.k);
        Advance::at(next, next > front)
    }

    fn begin(&self, ray: &Beam, front: f64, t_max: f64, work: &mut Counts) -> Walk {
        work.evaluations += 1;
        let p = self.eye + ray.origin;
        let (z, dz) = (p.dot(self.normal), ray.axis.dot(self.normal));
        let (s, ds) = (self.along(p), self.along(ray.axis));
        // The distance and the face of the hit.
        let inside = self.slab_distance(ray.at(front)) <= 0.0;
        let mut hit = inside.then_some((front, 0));
        if hit.is_none() && z.abs() > self.half && dz.abs() > 1e-12 {
            let t = (self.half.copysign(z) - z) / dz;
            if t >= front && (s + t * ds).length() <= self.radius {
                hit = Some((t, u32::from(z > 0.0)));
            }
        }
        let a = ds.length_squared();
        if hit.is_none() && a > 1e-12 {
            let middle = -s.dot(ds) / a;
            let q = self.radius.powi(2) - (s + middle * ds).length_squared();
            let t = middle - (q.max(0.0) / a).sqrt();
            if q > 0.0 && t >= front && (z + t * dz).abs() <= self.half {
                hit = Some((t, 2));
            }
        }
        let uv = |t: f64| (s + t * ds).to_array();
        Walk {
            t: front,
            hit: hit.map(|(t, id)| Hit { t, id, uv: uv(t) }),
            end: self.far.min(t_max),
        }
    }

    fn walk_step(&self, _ray: &Beam, walk: &mut Walk, _work: &mut Counts) -> Step {
        match walk.hit {
            Some(hit) if hit.t <= walk.end => {
                walk.t = hit.t;
                Step::Hit
            }
            _ => Step::Out,
        }
    }

    fn walk_hit(&self, walk: &Walk) -> Hit {
        Hit {
            t: walk.t,
            ..walk.hit.unwrap_or_default()
        }
    }

    fn clearance(&self, q: DVec3) -> f64 {
        self.slab_distance(q).max(0.0)
    }

    fn surface(&self, _ray: &Beam, hit: &Hit) -> Surface {
        let uv = DVec2::from_array(hit.uv);
        let normal = match hit.id {
            0 => -self.normal,
            1 => self.normal,
            _ => (uv.x * self.side + uv.y * self.other) / self.radius,
        };
        let square = uv.floor().element_sum();
        let light = square - 2.0 * (0.5 * square).floor();
        Surface {
            normal,
            pigment: DVec3::new(0.15 + 0.7 * light, 0.5, 0.5),
        }
    }

    fn bounds_far(&self) -> f64 {
        self.far
    }
}
