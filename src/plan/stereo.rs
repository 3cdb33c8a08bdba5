//! Stereo pairs: two pictures side by side, one for each eye (docs/method.md, 1, Stereo).
//!
//! The eyes look along parallel axes. Each has its image plane shifted, so that the two pictures
//! meet in the plane of the target. Turned axes would shift points vertically. An executor renders
//! one eye at a time, as a plan of its own: [`Plan::eyes`].

use glam::DVec3;

use super::Plan;
use super::camera::Camera;
use crate::base::key::Fault;
use crate::base::named::named_enum;
use crate::base::projection::Projection;
use crate::base::view::{Beam, View};

named_enum! {
    /// Whether a picture has a view for each eye.
    #[derive(Default)]
    pub enum Stereo {
        /// One view, from between the eyes.
        #[default]
        Off = "off",
        /// The left eye's view is on the left.
        Pair = "pair",
        /// The left eye's view is on the right.
        Cross = "cross",
    }
}

impl Camera {
    /// The camera of an eye: -1 for the left one, 1 for the right one.
    fn of_eye(&self, side: f64) -> Self {
        let away = 0.5 * self.eyes * side;
        let aside = away * self.eye.distance(self.target) * self.view([1, 1]).right;
        Self {
            eye: self.eye + aside,
            target: self.target + aside,
            shift: self.shift - away / (2.0 * (0.5 * self.fov.to_radians()).tan()),
            stereo: Stereo::Off,
            // The lens of both eyes is sharp in the same plane, and their axes are parallel.
            ..self.clone()
        }
    }
}

impl Plan {
    /// Whether the picture has a view for each eye.
    pub fn is_stereo(&self) -> bool {
        self.camera.stereo != Stereo::Off
    }

    /// Checks that the picture can have two views, if it shall.
    ///
    /// # Errors
    /// The projection has no eyes, or the width is odd.
    pub fn check_stereo(&self) -> Result<(), Fault> {
        let name = self.camera.projection.name();
        Fault::unless(
            !self.is_stereo() || self.camera.projection == Projection::Perspective,
            "camera.stereo",
            format!(
                "two eyes need camera.projection perspective, and it is {name}; use that, or stereo off"
            ),
        )?;
        let width = self.size[0];
        Fault::unless(
            !self.is_stereo() || width.is_multiple_of(2),
            "camera.stereo",
            format!(
                "two views need an even width, and the picture is {width} pixels wide; use {}, or stereo off",
                width + 1
            ),
        )
    }

    /// The plans of the two views, from left to right, each of half the width; `None` for a picture
    /// of one view. Their scene, light and lamps are the same. The plan must pass
    /// [`Plan::check_stereo`], and a window must be whole rows.
    pub fn eyes(&self) -> Option<[Self; 2]> {
        let sides = match self.camera.stereo {
            Stereo::Off => return None,
            Stereo::Pair => [-1.0, 1.0],
            Stereo::Cross => [1.0, -1.0],
        };
        let look = &self.look;
        // Lamps at the eye stay between the eyes, and shine to the same target.
        let at = |lamp: Option<DVec3>| Some(lamp.unwrap_or(self.camera.eye));
        let toward = |point: Option<DVec3>| Some(point.unwrap_or(self.camera.target));
        Some(sides.map(|side| {
            let mut plan = self.clone();
            plan.camera = self.camera.of_eye(side);
            plan.size[0] = self.size[0] / 2;
            if let Some(rows) = &mut plan.window {
                rows.size[0] = plan.size[0];
            }
            plan.look.lamp_at = at(look.lamp_at);
            plan.look.lamp_toward = toward(look.lamp_toward);
            let (lamps, old) = (&mut plan.look.lamps, &look.lamps);
            (lamps.lamp2_at, lamps.lamp3_at) = (at(old.lamp2_at), at(old.lamp3_at));
            (lamps.lamp2_toward, lamps.lamp3_toward) =
                (toward(old.lamp2_toward), toward(old.lamp3_toward));
            plan
        }))
    }

    /// The rays of the picture's pixels.
    pub fn picture_rays(&self) -> PictureRays {
        let all = self.eyes().map_or(vec![self.clone()], Vec::from);
        PictureRays {
            width: self.size[0] / all.len() as u32,
            views: all.iter().map(Self::view).collect(),
        }
    }
}

/// The rays of a picture of one view, or of two side by side.
#[derive(Clone, Debug)]
pub struct PictureRays {
    views: Vec<View>,
    width: u32,
}

impl PictureRays {
    /// Where the ray of a pixel's centre starts from, and the ray.
    pub fn ray(&self, [x, y]: [u32; 2]) -> (DVec3, Beam) {
        let at = (x / self.width) as usize;
        let view = &self.views[at.min(self.views.len() - 1)];
        (view.eye, view.view_ray([x - at as u32 * self.width, y]))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::scene::slab::SlabSettings;

    fn plan() -> Plan {
        let mut plan = Plan::new(SlabSettings::default());
        plan.camera.eye = DVec3::new(3.0, -4.0, 2.0);
        plan.camera.target = DVec3::new(0.3, 0.1, -0.2);
        plan.camera.stereo = Stereo::Pair;
        (plan.camera.shift, plan.camera.rise) = (0.2, -0.1);
        plan.size = [1280, 720];
        plan
    }

    /// A point is seen by the right eye `eyes distance (1/z - 1/distance)` image planes farther to the
    /// left, where z is its depth along the axis: zero at the target.
    #[test]
    fn the_parallax_of_a_point_follows_from_its_depth() {
        let plan = plan();
        let middle = plan.view();
        let [left, right] = plan.eyes().expect("a pair").map(|eye| eye.view());
        let distance = plan.camera.eye.distance(plan.camera.target);
        let apart = plan.camera.eyes * distance;
        assert!((right.eye - left.eye - apart * middle.right).length() < 1e-12);
        assert!(left.forward.distance(middle.forward) < 1e-15 && left.size == [640, 720]);
        let mut nearest: f64 = 1.0;
        for pixel in [[320, 360], [12, 700], [600, 5]] {
            for z in [0.1 * distance, distance, 30.0 * distance] {
                let ray = left.view_ray(pixel);
                let point = left.eye + ray.axis * (z / ray.axis.dot(left.forward));
                let parallax = apart * (1.0 / z - 1.0 / distance) / left.pixel;
                let there = right.view_ray_at(pixel, DVec2::new(-parallax, 0.0));
                let seen = (point - right.eye).normalize();
                assert!(seen.distance(there.axis) < 1e-12, "{pixel:?} {z}");
                nearest = nearest.min(parallax.abs());
            }
        }
        assert!(nearest < 1e-12, "the target has the parallax {nearest}");
        // What the middle sees at the target's depth, all eyes see at the same place.
        let ray = middle.view_ray([640, 360]);
        let at = middle.eye + ray.axis * (distance / ray.axis.dot(middle.forward));
        for eye in [&left, &right] {
            let axis = eye.view_ray([320, 360]).axis;
            assert!((at - eye.eye).normalize().distance(axis) < 1e-12);
        }
    }

    #[test]
    fn the_rays_of_a_pair_are_those_of_its_eyes() {
        let mut plan = plan();
        for stereo in [Stereo::Pair, Stereo::Cross, Stereo::Off] {
            plan.camera.stereo = stereo;
            let rays = plan.picture_rays();
            for pixel in [[0, 0], [639, 7], [640, 7], [1279, 719]] {
                let (eye, ray) = rays.ray(pixel);
                let (view, at) = match plan.eyes() {
                    Some(eyes) => {
                        let half = pixel[0] / 640;
                        let eye = &eyes[half as usize];
                        (eye.view(), [pixel[0] - 640 * half, pixel[1]])
                    }
                    None => (plan.view(), pixel),
                };
                assert_eq!((eye, ray), (view.eye, view.view_ray(at)));
            }
        }
    }
}
