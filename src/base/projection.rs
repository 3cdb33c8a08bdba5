//! How directions are laid out in the image: the projections, and the view in each.
//!
//! A projection has the ray through a place of the image and the cone over a cell's places. The
//! bounds of the cones rest on the map from the image to the sphere of directions: in radians, no
//! two directions are farther apart than their places. So the chord of a cell is at most half the
//! diagonal of its places. docs/method.md, 1, has the proofs.

use glam::DVec2;

use super::view::{Beam, CHORD_SLACK, View};
use super::{equirectangular, fisheye, orthographic, perspective};
use crate::base::shader::Module;
use crate::wgsl;

/// A projection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Projection {
    /// Rays go from the eye through an even image plane. Straight lines stay straight.
    #[default]
    Perspective,
    /// Rays are parallel.
    Orthographic,
    /// The angle to the view axis is proportional to the distance from the middle (equidistant).
    Fisheye,
    /// Longitude from left to right, latitude upward: all that is about the eye.
    Equirectangular,
}

/// More than the error of a direction by [`angle`](super::angle) in f32, per radian of the largest
/// angle: of two of them, 2e-7 each, and the rounding of their angles.
const ANGLE_SLACK: f64 = 1e-6;

impl Projection {
    /// The words that choose one.
    pub const WORDS: &[(&str, Self)] = &[
        ("perspective", Self::Perspective),
        ("orthographic", Self::Orthographic),
        ("fisheye", Self::Fisheye),
        ("equirectangular", Self::Equirectangular),
    ];

    /// Its word.
    pub fn name(self) -> &'static str {
        let word = Self::WORDS.iter().find(|(_, own)| *own == self);
        word.map_or("", |(word, _)| word)
    }

    /// The largest vertical field of view in degrees.
    pub fn widest(self) -> f64 {
        match self {
            Self::Perspective | Self::Orthographic => 170.0,
            Self::Fisheye | Self::Equirectangular => 360.0,
        }
    }

    /// Whether rays may start all over a lens: it needs a plane that is sharp.
    pub fn has_lens(self) -> bool {
        matches!(self, Self::Perspective | Self::Orthographic)
    }

    /// Its WGSL modules.
    pub(super) fn modules(self) -> Vec<Module> {
        let angle = wgsl!("base/angle.wgsl");
        match self {
            Self::Perspective => vec![wgsl!("base/perspective.wgsl")],
            Self::Orthographic => vec![wgsl!(
                "base/orthographic.wgsl",
                "ORTHOGRAPHIC_SLACK" = orthographic::ORTHOGRAPHIC_SLACK
            )],
            Self::Fisheye => vec![angle, wgsl!("base/fisheye.wgsl")],
            Self::Equirectangular => vec![angle, wgsl!("base/equirectangular.wgsl")],
        }
    }

    /// The ray through a place of the image, in pixels from its upper left corner.
    pub(super) fn view_through(self, view: &View, place: DVec2) -> Beam {
        match self {
            Self::Perspective => perspective::view_through(view, place),
            Self::Orthographic => orthographic::view_through(view, place),
            Self::Fisheye => fisheye::view_through(view, place),
            Self::Equirectangular => equirectangular::view_through(view, place),
        }
    }

    /// The cone over the places of a cell, given by their middle and their span in pixels.
    pub(super) fn view_over(self, view: &View, middle: DVec2, span: DVec2) -> Beam {
        match self {
            Self::Perspective => perspective::view_over(view, middle, span),
            Self::Orthographic => orthographic::view_over(view, middle, span),
            Self::Fisheye => fisheye::view_over(view, middle, span),
            Self::Equirectangular => equirectangular::view_over(view, middle, span),
        }
    }
}

impl View {
    /// The view by another projection. `fov` is its height in degrees. Parallel rays show as much
    /// at `distance` as a perspective view does.
    #[must_use]
    pub fn by(self, projection: Projection, fov: f64, distance: f64) -> Self {
        use std::f64::consts::{PI, TAU};
        let [w, h] = self.size.map(f64::from);
        let (pixel, across) = match projection {
            Projection::Perspective => (self.pixel, self.across),
            Projection::Orthographic => (self.pixel, distance * self.pixel),
            Projection::Fisheye => (fov.to_radians() / h, fov.to_radians() / h),
            Projection::Equirectangular => (PI / h, TAU / w),
        };
        let grain = match projection {
            Projection::Orthographic => 0.5 * across,
            _ => 0.5 * pixel,
        };
        Self {
            projection,
            pixel,
            across,
            grain,
            ..self
        }
    }

    /// Added to every cone's chord: more than the rounding of two directions in f32.
    pub(super) fn slack(&self) -> f64 {
        let [w, h] = self.size.map(f64::from);
        let widest = match self.projection {
            Projection::Perspective | Projection::Orthographic => 0.0,
            Projection::Fisheye => 0.5 * self.pixel * w.hypot(h),
            Projection::Equirectangular => std::f64::consts::PI,
        };
        CHORD_SLACK + ANGLE_SLACK * widest.min(std::f64::consts::PI)
    }
}
