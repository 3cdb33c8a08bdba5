//! The camera: the ray of a pixel and the cone of a cell (docs/method.md, 1).
//!
//! World coordinates are right-handed. Distances are radial: t is measured along each
//! ray's own unit direction, so that a number proven for a cell holds for every ray
//! under it. Beams start at the eye's offset, zero for a pinhole; only the scene adds
//! the eye itself. Twin: `wgsl/view.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

use crate::frame::Frame;
use crate::key::{Fault, Key, Number, Triple};
use crate::pyramid::Block;
use crate::shader::Module;
use crate::wgsl;

/// The view as WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ViewUniform {
    /// Unit vector to the right of the image.
    pub right: Vec3,
    /// Width of a pixel in the image plane at distance 1.
    pub pixel: f32,
    /// Unit vector to the top of the image.
    pub up: Vec3,
    /// Added to every cone's chord.
    pub slack: f32,
    /// Unit vector into the image.
    pub forward: Vec3,
    /// Unused.
    pub pad: f32,
    /// Pixels of the full image.
    pub size: [u32; 2],
    /// First pixel of the block.
    pub block_origin: [u32; 2],
    /// Pixels of the block.
    pub block_size: [u32; 2],
    /// Unused.
    pub pad2: [u32; 2],
}

/// Two unit vectors in f32 are each off by up to about 1.5 * 2^-24 along a component;
/// their chord by less than this.
pub const CHORD_SLACK: f64 = 4e-7;

/// The WGSL module of the view.
pub fn module() -> Module {
    wgsl!("view.wgsl")
}

/// Where the camera stands and how it looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Position.
    pub eye: DVec3,
    /// Point in the middle of the image.
    pub target: DVec3,
    /// Direction that is up in the image; not along the view.
    pub up: DVec3,
    /// Vertical field of view in degrees, 1 to 170.
    pub fov: f64,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            eye: DVec3::new(10.0, -17.0, 12.0),
            target: DVec3::ZERO,
            up: DVec3::Z,
            fov: 40.0,
        }
    }
}

impl Camera {
    /// The keys of `[camera]`.
    pub fn keys(&mut self) -> Vec<Key<'_>> {
        vec![
            Key::new("eye", Triple(&mut self.eye, -1e9, 1e9), "position"),
            Key::new(
                "target",
                Triple(&mut self.target, -1e9, 1e9),
                "point in the middle of the image",
            ),
            Key::new(
                "up",
                Triple(&mut self.up, -1e9, 1e9),
                "direction that is up in the image",
            ),
            Key::new(
                "fov",
                Number(&mut self.fov, 1.0, 170.0),
                "vertical field of view, degrees",
            ),
        ]
    }

    /// Whether the camera has a direction to look in.
    pub fn check(&self) -> Result<(), Fault> {
        let forward = self.target - self.eye;
        if forward.length() <= 1e-12 * self.eye.length() || forward == DVec3::ZERO {
            return Err(Fault::new(
                "camera.target",
                "the eye and the target are the same point; move one of them",
            ));
        }
        let side = forward.normalize().cross(self.up.normalize_or_zero());
        if side.length() < 1e-9 {
            return Err(Fault::new(
                "camera.up",
                "up must not be zero or along the view; choose another direction, like [0, 0, 1] or [0, 1, 0]",
            ));
        }
        Ok(())
    }
}

/// A bundle of rays: at distance t they lie within `r0 + k t` of the axis, and the
/// pixel that a ray stands for has the half width `grain0 + grain t`.
///
/// A pinhole has `r0 = 0`; a positive `r0` lets the rays start apart, as orthographic
/// and stereo views do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Start, relative to the eye.
    pub origin: DVec3,
    /// Unit direction.
    pub axis: DVec3,
    /// Radius at the start.
    pub r0: f64,
    /// Largest chord between the axis and the direction of a ray, 0 to 2.
    pub k: f64,
    /// Half width of a pixel at distance 0.
    pub grain0: f64,
    /// Growth of that half width with distance.
    pub grain: f64,
}

impl Beam {
    /// The point at distance t, relative to the eye.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.axis
    }
}

/// Half a pixel's width at distance t, seen along the beam.
pub fn footprint(beam: &Beam, t: f64) -> f64 {
    beam.grain0 + beam.grain * t
}

/// A camera fitted to an image of a size.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Position.
    pub eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Width of a pixel in the image plane at distance 1.
    pub pixel: f64,
    /// Pixels of the full image.
    pub size: [u32; 2],
}

impl View {
    /// The view of a camera that passes [`Camera::check`].
    pub fn new(camera: &Camera, size: [u32; 2]) -> Self {
        let forward = (camera.target - camera.eye).normalize();
        let right = forward.cross(camera.up.normalize()).normalize();
        Self {
            eye: camera.eye,
            right,
            up: right.cross(forward),
            forward,
            pixel: 2.0 * (camera.fov.to_radians() * 0.5).tan() / f64::from(size[1]),
            size,
        }
    }

    /// The values that WGSL gets, for one block of the image.
    pub fn uniform(&self, block: &Block) -> ViewUniform {
        ViewUniform {
            right: self.right.as_vec3(),
            #[allow(clippy::cast_possible_truncation, reason = "f32 is what the GPU takes")]
            pixel: self.pixel as f32,
            up: self.up.as_vec3(),
            slack: CHORD_SLACK as f32,
            forward: self.forward.as_vec3(),
            pad: 0.0,
            size: self.size,
            block_origin: block.origin,
            block_size: block.size,
            pad2: [0; 2],
        }
    }

    /// Un-normalised direction through a point of the image, in pixels from its
    /// upper left corner.
    pub fn view_direction(&self, x: f64, y: f64) -> DVec3 {
        let sx = (x - 0.5 * f64::from(self.size[0])) * self.pixel;
        let sy = (0.5 * f64::from(self.size[1]) - y) * self.pixel;
        self.forward + sx * self.right + sy * self.up
    }

    /// The ray through the centre of a pixel.
    pub fn view_ray(&self, pixel: [u32; 2]) -> Beam {
        let u = self.view_direction(f64::from(pixel[0]) + 0.5, f64::from(pixel[1]) + 0.5);
        let n = u.length();
        Beam {
            origin: DVec3::ZERO,
            axis: u / n,
            r0: 0.0,
            k: 0.0,
            grain0: 0.0,
            grain: 0.5 * self.pixel / n,
        }
    }

    /// The cone over the centres of a cell's pixels, the cell cut by the image.
    ///
    /// `k = min(2, 2|h| / (2|u| - |h|))` with h the half diagonal and u the
    /// un-normalised axis; 2 where the cell is wider than that (docs/method.md, 1).
    pub fn view_cone(&self, cell: [u32; 2], divisor: u32) -> Beam {
        let low = cell.map(|c| c * divisor);
        let high = [0, 1].map(|i| (low[i] + divisor).min(self.size[i]));
        let middle = [0, 1].map(|i| 0.5 * f64::from(low[i] + high[i]));
        let u = self.view_direction(middle[0], middle[1]);
        let n = u.length();
        let span = [0, 1].map(|i| f64::from(high[i] - low[i] - 1));
        let h = 0.5 * self.pixel * span[0].hypot(span[1]);
        let k = if h < n {
            (2.0 * h / (2.0 * n - h) + CHORD_SLACK).min(2.0)
        } else {
            2.0
        };
        Beam {
            origin: DVec3::ZERO,
            axis: u / n,
            r0: 0.0,
            k,
            grain0: 0.0,
            grain: 0.5 * self.pixel / (n - h).max(1.0),
        }
    }

    /// World position of each pixel's hit in a frame of this view; zero for sky, as normals
    /// are: only depth says how far that is.
    pub fn positions(&self, frame: &Frame) -> Vec<[f32; 3]> {
        let width = frame.size[0] as usize;
        let at = |(i, t): (usize, &f32)| {
            if t.is_infinite() {
                return [0.0; 3];
            }
            #[allow(clippy::cast_possible_truncation, reason = "indices of a u32 size")]
            let ray = self.view_ray([(i % width) as u32, (i / width) as u32]);
            let p: DVec3 = self.eye + ray.at(f64::from(*t));
            p.as_vec3().to_array()
        };
        frame.depth.iter().enumerate().map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_lie_on_the_rays() {
        let camera = Camera {
            eye: DVec3::new(1.0, -2.0, 3.0),
            ..Camera::default()
        };
        let view = View::new(&camera, [3, 1]);
        let frame = Frame {
            size: [3, 1],
            depth: vec![2.0, 4.0, f32::INFINITY],
            ..Frame::default()
        };
        let found = view.positions(&frame);
        for (x, t) in [(0, 2.0), (1, 4.0)] {
            let want = camera.eye + t * view.view_ray([x, 0]).axis;
            let got = DVec3::from_array(found[x as usize].map(f64::from));
            assert!((got - want).length() < 1e-6, "{got} {want}");
        }
        assert_eq!(found[2], [0.0; 3]);
    }
}
