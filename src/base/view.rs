//! The camera: the ray of a pixel and the cone of a cell (docs/method.md, 1).
//!
//! World coordinates are right-handed. Distances are radial: t is measured along each
//! ray's own unit direction, so that a number proven for a cell holds for every ray
//! under it. Beams start at the eye's offset, zero for a pinhole; only the scene adds
//! the eye itself. Twin: `wgsl/base/view.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

use crate::base::shader::Module;
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
    wgsl!("base/view.wgsl")
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
    /// A view from `eye` to `target`, `fov` degrees high; `up` lies not along it.
    pub fn new(eye: DVec3, target: DVec3, up: DVec3, fov: f64, size: [u32; 2]) -> Self {
        let forward = (target - eye).normalize();
        let right = forward.cross(up.normalize()).normalize();
        Self {
            eye,
            right,
            up: right.cross(forward),
            forward,
            pixel: 2.0 * (fov.to_radians() * 0.5).tan() / f64::from(size[1]),
            size,
        }
    }

    /// The values that WGSL gets, for one block of the image.
    pub fn uniform(&self, origin: [u32; 2], block: [u32; 2]) -> ViewUniform {
        ViewUniform {
            right: self.right.as_vec3(),
            #[allow(clippy::cast_possible_truncation, reason = "f32 is what the GPU takes")]
            pixel: self.pixel as f32,
            up: self.up.as_vec3(),
            slack: CHORD_SLACK as f32,
            forward: self.forward.as_vec3(),
            pad: 0.0,
            size: self.size,
            block_origin: origin,
            block_size: block,
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
}
