//! The camera: the keys of `[camera]`.

use glam::DVec3;

use crate::base::key::{Fault, Key, Number, Triple};
use crate::base::view::View;
use crate::keys;

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
        keys![
            "eye" = Triple(&mut self.eye, -1e9, 1e9),
                "position";
            "target" = Triple(&mut self.target, -1e9, 1e9),
                "point in the middle of the image";
            "up" = Triple(&mut self.up, -1e9, 1e9),
                "direction that is up in the image";
            "fov" = Number(&mut self.fov, 1.0, 170.0),
                "vertical field of view, degrees";
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

    /// The camera fitted to an image; it passes [`Camera::check`].
    pub fn view(&self, size: [u32; 2]) -> View {
        View::new(self.eye, self.target, self.up, self.fov, size)
    }
}
