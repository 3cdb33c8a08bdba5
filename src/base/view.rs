//! The camera: the ray of a pixel and the cone of a cell (docs/method.md, 1).
//!
//! World coordinates are right-handed. A distance t is measured along each ray's own unit
//! direction, so a distance proven for a cell holds for every ray in it. A cell's *chord* k is
//! the largest distance between the cone's unit axis and the unit direction of a ray in it.
//! The *footprint* at a distance is half a pixel's width there, or less if the image shows the
//! details of a larger one.
//! Points of a beam are relative to the eye; only scenes add the eye.
//! How directions are laid out in the image is a [`Projection`].
//! Twin: `wgsl/base/view.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3, Vec3};

use super::projection::Projection;
use super::shader::Module;
use crate::wgsl;

/// The view as WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ViewUniform {
    /// Unit vector to the right of the image.
    pub right: Vec3,
    /// A pixel's height in the image plane at distance 1, or in radians.
    pub pixel: f32,
    /// Unit vector to the top of the image.
    pub up: Vec3,
    /// Added to every cone's chord.
    pub slack: f32,
    /// Unit vector into the image.
    pub forward: Vec3,
    /// How far rays of a pixel go from its centre, in pixels.
    pub filter_radius: f32,
    /// Width and height of the full image in pixels.
    pub size: [u32; 2],
    /// The footprint at distance 1 along the view axis; of parallel rays, at any distance.
    pub grain: f32,
    /// Radius of the lens; 0 for none.
    pub lens: f32,
    /// Distance to the plane that is sharp.
    pub focus: f32,
    /// Added to the chords of cones, as rays start all over the lens.
    pub spread: f32,
    /// Blades of the lens; 0 if it is round.
    pub blades: u32,
    /// A pixel's width: of parallel rays a length, else as its height.
    pub across: f32,
    /// The point of the image plane at distance 1 in the middle of the image, to the right and up.
    pub shift: [f32; 2],
    /// Unused.
    pub unused: [u32; 2],
}

/// More than the rounding error of a chord in f32: two unit vectors are each off by up to
/// about 1.5 * 2^-24 along a component.
pub const CHORD_SLACK: f64 = 4e-7;

/// A factor on the lens of cones. It is more than the rounding of a point of the lens in f32.
pub(super) const LENS_SLACK: f64 = 1.0 + 1e-6;

/// A bundle of rays. At distance t they lie within `r0 + k t` of the axis, and the footprint
/// is `grain0 + grain t`.
///
/// A pinhole camera has `r0 = 0`. A lens and parallel rays have a positive `r0`. Cones of parallel
/// rays, which start in a plane across the axis, are those of `grain = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Start, relative to the eye.
    pub origin: DVec3,
    /// Unit direction.
    pub axis: DVec3,
    /// Radius at the start.
    pub r0: f64,
    /// Chord, 0 to 2.
    pub k: f64,
    /// Footprint at distance 0.
    pub grain0: f64,
    /// Growth of the footprint with distance.
    pub grain: f64,
}

impl Beam {
    /// A beam from the eye of a pinhole camera.
    pub(super) fn pinhole(axis: DVec3, k: f64, grain: f64) -> Self {
        Self {
            origin: DVec3::ZERO,
            axis,
            r0: 0.0,
            k,
            grain0: 0.0,
            grain,
        }
    }
    /// The point at distance t, relative to the eye.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.axis
    }
}

/// The footprint at distance t along the beam.
pub fn footprint(beam: &Beam, t: f64) -> f64 {
    beam.grain0 + beam.grain * t
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Its radius, at most a quarter of `focus`.
    pub radius: f64,
    /// Distance to the plane that is sharp, along the view axis.
    pub focus: f64,
    /// Its blades; 0 if it is round.
    pub blades: u32,
}

impl Lens {
    /// The largest chord between the rays of a place: the lens under the angle at which the plane
    /// of the focus sees it, by the same bound as the chord of a cone.
    pub fn spread(&self) -> f64 {
        2.0 * self.radius / (2.0 * self.focus - self.radius) * LENS_SLACK + CHORD_SLACK
    }

    /// The point of the unit lens at a share of it along the circumference and along the radius.
    pub fn point(&self, share: DVec2) -> DVec2 {
        let radius = share.y.sqrt();
        let corner = |turn: f64| DVec2::from_angle(std::f64::consts::TAU * turn);
        if self.blades == 0 {
            return radius * corner(share.x);
        }
        let blades = f64::from(self.blades);
        let at = share.x * blades;
        let [one, two] = [at.floor(), at.floor() + 1.0].map(|i| corner(i / blades));
        radius * one.lerp(two, at.fract())
    }
}

/// Two numbers from 0 to 1 that look random, for each pixel (`pcg2d` of Jarzynski and Olano, Hash
/// functions for GPU rendering, 2020).
fn hash(pixel: [u32; 2]) -> DVec2 {
    const BY: u32 = 1_664_525;
    let [mut x, mut y] = pixel.map(|p| p.wrapping_mul(BY).wrapping_add(1_013_904_223));
    for _ in 0..2 {
        x = x.wrapping_add(y.wrapping_mul(BY));
        y = y.wrapping_add(x.wrapping_mul(BY));
        x ^= x >> 16;
        y ^= y >> 16;
    }
    let part = |x: u32| f64::from(x >> 8) / 16_777_216.0;
    DVec2::new(part(x), part(y))
}

/// A camera over an image of a size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Position.
    pub eye: DVec3,
    /// Unit vector to the right of the image.
    pub right: DVec3,
    /// Unit vector to the top of the image.
    pub up: DVec3,
    /// Unit vector into the image.
    pub forward: DVec3,
    /// How directions are laid out in the image.
    pub projection: Projection,
    /// A pixel's height in the middle of the image: in the image plane at distance 1 if that is
    /// even, else in radians.
    pub pixel: f64,
    /// A pixel's width there. Parallel rays are so far apart; else it is measured as the height.
    pub across: f64,
    /// The point of the image plane at distance 1 in the middle of a perspective image, to the right
    /// and up.
    pub shift: DVec2,
    /// Width and height of the full image in pixels.
    pub size: [u32; 2],
    /// How far rays of a pixel go from its centre along each axis, in pixels.
    pub filter_radius: f64,
    /// What rays start from; `None` for the eye.
    pub lens: Option<Lens>,
    /// The footprint at distance 1 along the view axis, and of parallel rays at any distance: half a
    /// pixel's width, or less if the image shows the details of a larger one.
    pub grain: f64,
}

impl View {
    /// A perspective view from `eye` to `target` that is `fov` degrees high. `up` must not be along
    /// it.
    pub fn new(eye: DVec3, target: DVec3, up: DVec3, fov: f64, size: [u32; 2]) -> Self {
        let forward = (target - eye).normalize();
        let right = forward.cross(up.normalize()).normalize();
        let pixel = 2.0 * (fov.to_radians() * 0.5).tan() / f64::from(size[1]);
        Self {
            eye,
            right,
            up: right.cross(forward),
            forward,
            projection: Projection::Perspective,
            pixel,
            across: pixel,
            shift: DVec2::ZERO,
            size,
            filter_radius: 0.0,
            lens: None,
            grain: 0.5 * pixel,
        }
    }

    /// The values of the WGSL struct.
    pub fn uniform(&self) -> ViewUniform {
        ViewUniform {
            right: self.right.as_vec3(),
            pixel: self.pixel as f32,
            up: self.up.as_vec3(),
            slack: self.slack() as f32,
            forward: self.forward.as_vec3(),
            filter_radius: self.filter_radius as f32,
            size: self.size,
            grain: self.grain as f32,
            lens: self.lens.map_or(0.0, |lens| lens.radius) as f32,
            focus: self.lens.map_or(0.0, |lens| lens.focus) as f32,
            spread: self.lens.map_or(0.0, |lens| lens.spread()) as f32,
            blades: self.lens.map_or(0, |lens| lens.blades),
            across: self.across as f32,
            shift: self.shift.as_vec2().to_array(),
            unused: [0; 2],
        }
    }

    /// The WGSL modules of the view.
    pub fn modules(&self) -> Vec<Module> {
        let mut all = vec![wgsl!("base/view.wgsl")];
        all.push(match self.lens {
            Some(_) => wgsl!("base/lens.wgsl").neutral(),
            None => wgsl!("base/lens_off.wgsl"),
        });
        all.extend(self.projection.modules());
        all
    }

    /// How far from the eye rays start at most.
    pub fn spacing(&self) -> f64 {
        let lens = self.lens.map_or(0.0, |lens| lens.radius);
        let half = self.size.map(|n| 0.5 * f64::from(n) + self.filter_radius);
        match self.projection {
            Projection::Orthographic => lens + self.across * half[0].hypot(half[1]),
            _ => lens,
        }
    }

    /// Added to the chords of cones, as rays start all over the lens.
    pub(super) fn spread(&self) -> f64 {
        self.lens.map_or(0.0, |lens| lens.spread())
    }

    /// The direction through a point of the image plane of a perspective view, given in pixels from
    /// the upper left corner. Its length is not 1.
    pub fn view_direction(&self, x: f64, y: f64) -> DVec3 {
        let sx = (x - 0.5 * f64::from(self.size[0])) * self.pixel + self.shift.x;
        let sy = (0.5 * f64::from(self.size[1]) - y) * self.pixel + self.shift.y;
        self.forward + sx * self.right + sy * self.up
    }

    /// The ray through the corner of the image whose pixels are finest: the farthest one from the
    /// view axis.
    pub fn finest(&self) -> Beam {
        let far = |axis: usize, first: bool| match first {
            true => 0.5 - self.filter_radius,
            false => f64::from(self.size[axis]) - 0.5 + self.filter_radius,
        };
        let corner = DVec2::new(far(0, self.shift.x <= 0.0), far(1, self.shift.y >= 0.0));
        self.projection.view_through(self, corner)
    }

    /// The ray through the centre of a pixel.
    pub fn view_ray(&self, pixel: [u32; 2]) -> Beam {
        self.view_ray_at(pixel, DVec2::ZERO)
    }

    /// The ray through a place in pixels from the centre of a pixel.
    pub fn view_ray_at(&self, pixel: [u32; 2], offset: DVec2) -> Beam {
        let centre = DVec2::from_array(pixel.map(|p| f64::from(p) + 0.5));
        self.projection.view_through(self, centre + offset)
    }

    /// The ray through a place in pixels from the centre of a pixel, from a point of the lens. `share`
    /// is the place of the point, uniform from 0 to 1 along both axes; each pixel shifts it.
    pub fn view_ray_from(&self, pixel: [u32; 2], offset: DVec2, share: DVec2) -> Beam {
        let ray = self.view_ray_at(pixel, offset);
        let Some(lens) = self.lens else { return ray };
        let share = (share + hash(pixel)).fract();
        let point = lens.radius * lens.point(share);
        let aside = point.x * self.right + point.y * self.up;
        // All rays of a place meet in the plane of the focus.
        let ahead = lens.focus / ray.axis.dot(self.forward) * ray.axis - aside;
        Beam {
            origin: ray.origin + aside,
            axis: ahead.normalize(),
            ..ray
        }
    }

    /// The cone over all rays of the pixels of a cell. The image's border cuts the cell.
    pub fn view_cone(&self, cell: [u32; 2], divisor: u32) -> Beam {
        let low = cell.map(|c| c * divisor);
        let high = [0, 1].map(|i| (low[i] + divisor).min(self.size[i]));
        let middle = [0, 1].map(|i| 0.5 * f64::from(low[i] + high[i]));
        let span = [0, 1].map(|i| f64::from(high[i] - low[i] - 1) + 2.0 * self.filter_radius);
        self.projection.view_over(self, middle.into(), span.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cone_holds_all_rays_of_its_pixels() {
        let (eye, target) = (DVec3::new(4.0, -9.0, 6.0), DVec3::ZERO);
        for fov in [1.0_f64, 48.5, 120.0, 170.0] {
            for (filter_radius, radius) in
                [(0.0, 0.0), (0.25, 0.0), (1.5, 0.0), (1.5, 0.5), (1.5, 3.0)]
            {
                let lens = Lens {
                    radius,
                    focus: 12.0,
                    blades: 0,
                };
                let view = View {
                    // Off the axis, too, by the width of the image.
                    shift: DVec2::new(1.7, -1.0) * filter_radius * (0.5 * fov.to_radians()).tan(),
                    filter_radius,
                    lens: (radius > 0.0).then_some(lens),
                    ..View::new(eye, target, DVec3::Z, fov, [37, 21])
                };
                let mut widest: f64 = 0.0;
                for (x, y) in (0..21).flat_map(|y| (0..37).map(move |x| (x, y))) {
                    for divisor in [1, 2, 8, 32] {
                        let cone = view.view_cone([x / divisor, y / divisor], divisor);
                        for corner in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
                            let offset = filter_radius * DVec2::from(corner);
                            for share in [0.0, 0.3, 0.7].map(|x| DVec2::new(x, 1.0 - 1e-9)) {
                                let ray = view.view_ray_from([x, y], offset, share);
                                for t in [0.01, 1.0, 12.0, 24.0, 1e3] {
                                    let off = ray.at(t).distance(cone.at(t));
                                    let room = cone.r0 + cone.k * t;
                                    assert!(
                                        off <= room * (1.0 + 1e-12),
                                        "{fov} {filter_radius} {t} {off} {cone:?}"
                                    );
                                    widest = widest.max(off / room);
                                }
                                assert!(ray.grain <= cone.grain, "{fov} {filter_radius} {divisor}");
                            }
                        }
                    }
                }
                // Nor is it much wider than they need.
                assert!(widest > 0.9, "{fov} {filter_radius} {widest}");
            }
        }
    }

    #[test]
    fn rays_through_a_lens_meet_in_the_plane_of_the_focus() {
        let (eye, target) = (DVec3::new(4.0, -9.0, 6.0), DVec3::ZERO);
        for blades in [0, 3, 7] {
            let lens = Lens {
                radius: 0.7,
                focus: 3.0,
                blades,
            };
            let view = View {
                lens: Some(lens),
                ..View::new(eye, target, DVec3::Z, 50.0, [40, 30])
            };
            let (pixel, place) = ([7, 21], DVec2::new(0.3, -0.2));
            let middle = view.view_ray_at(pixel, place);
            let point = middle.at(lens.focus / middle.axis.dot(view.forward));
            let (mut sum, mut squares, mut most) = (DVec3::ZERO, 0.0, 0.0_f64);
            for i in 0..4096 {
                let ray = view.view_ray_from(pixel, place, crate::base::filter::lens_share(i));
                let there = ray.at(lens.focus / ray.axis.dot(view.forward));
                assert!(there.distance(point) < 1e-9, "{ray:?}");
                assert!(ray.origin.dot(view.forward).abs() < 1e-12);
                sum += ray.origin / 4096.0;
                squares += (ray.origin / lens.radius).length_squared() / 4096.0;
                most = most.max(ray.origin.length() / lens.radius);
            }
            // The mean square of the distances to the middle of a regular polygon.
            let sides = f64::from(blades);
            let expected = match blades {
                0 => 0.5,
                _ => (2.0 + (std::f64::consts::TAU / sides).cos()) / 6.0,
            };
            assert!(sum.length() < 2e-3 && most <= 1.0 + 1e-12, "{blades} {sum}");
            assert!(
                (squares - expected).abs() < 2e-3,
                "{blades} {squares} {expected}"
            );
        }
    }
}
