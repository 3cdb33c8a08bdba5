//! The camera: the section `[camera]` of a preset.

use glam::{DVec2, DVec3};

use crate::base::key::{Fault, auto_count, auto_number, number, triple, word};
use crate::base::projection::Projection;
use crate::base::view::{Lens, View};
use crate::plan::stereo::Stereo;
use crate::settings;

settings! {
    /// Where the camera stands and where it looks.
    pub struct Camera {
        eye: DVec3 = DVec3::new(10.0, -17.0, 12.0), triple(-1e9, 1e9), "position of the camera; must differ from the target";
        target: DVec3 = DVec3::ZERO, triple(-1e9, 1e9), "point that the camera looks at, in the middle of the image";
        up: DVec3 = DVec3::Z, triple(-1e9, 1e9), "direction that points up in the image; must be neither [0, 0, 0] nor along the view";
        fov: f64 = 40.0, number(1.0, 360.0), "vertical field of view in degrees, at most 170 unless the projection is fisheye; an orthographic view shows as much at the target as a perspective one does, and an equirectangular one shows everything";
        projection: Projection = Projection::Perspective, word(Projection::WORDS), "how directions become an image: perspective; orthographic, by parallel rays from the plane of the eye; fisheye, where the angle to the view is proportional to the distance from the middle, up to 180 degrees; equirectangular, a panorama of 360 x 180 degrees for an image twice as wide as high" => Program;
        aperture: f64 = 0.0, number(0.0, 0.25), "radius of the lens as a share of the distance to the focus: 0 for none, 0.01 for a blurred background; a picture of one sample has no blur, and a fisheye or an equirectangular view has no lens" => Program;
        focus: Option<f64> = None, auto_number(1e-9, 1e9), "distance to the plane that is sharp, along the view axis; auto is that of the target";
        blades: Option<u32> = None, auto_count(3, 16), "blades of the lens, which are the corners of blurred lights; auto is a round lens";
        shift: f64 = 0.0, number(-5.0, 5.0), "how far the image plane of a perspective view is shifted to the right, as a share of the image's height: the view turns there, and keeps its lines parallel";
        rise: f64 = 0.0, number(-5.0, 5.0), "how far the image plane of a perspective view is shifted up; 0.3 shows the top of a tower whose walls stay upright";
        stereo: Stereo = Stereo::Off, word(&Stereo::WORDS), "two views side by side, perspective only, each half as wide as the picture, whose width is even: pair with the left eye's view on the left, for glasses and parallel viewing, or cross with it on the right, for crossed eyes; the target is at the depth of the screen, and the window shows one view from between the eyes" => Nothing;
        eyes: f64 = 0.03, number(0.0, 0.5), "distance between the eyes of stereo as a share of the distance from eye to target" => Nothing;
    }
}

impl Camera {
    /// Checks that eye and target differ, and that `up` is not along the view.
    pub fn check(&self) -> Result<(), Fault> {
        let forward = self.target - self.eye;
        Fault::unless(
            forward.length() > 1e-12 * self.eye.length(),
            "camera.target",
            "the eye and the target are the same point; move one of them",
        )?;
        let side = forward.normalize().cross(self.up.normalize_or_zero());
        Fault::unless(
            side.length() >= 1e-9,
            "camera.up",
            "up must not be zero or along the view; choose another direction, like [0, 0, 1] or [0, 1, 0]",
        )?;
        let (widest, name) = (self.projection.widest(), self.projection.name());
        Fault::unless(
            self.fov <= widest,
            "camera.fov",
            format!(
                "camera.projection {name} shows at most {widest} degrees; use that, or projection fisheye"
            ),
        )?;
        Fault::unless(
            self.aperture == 0.0 || self.projection.has_lens(),
            "camera.aperture",
            format!(
                "camera.projection {name} has no lens; use aperture 0, or projection perspective"
            ),
        )?;
        let moved = [("camera.shift", self.shift), ("camera.rise", self.rise)];
        let moved = moved.into_iter().find(|(_, by)| *by != 0.0);
        Fault::unless(
            moved.is_none() || self.projection == Projection::Perspective,
            moved.map_or("camera.shift", |(key, _)| key),
            format!(
                "camera.projection {name} has no image plane to shift; move eye and target, or use projection perspective"
            ),
        )
    }

    /// The lens of a picture with several samples, if there is one.
    pub fn lens(&self) -> Option<Lens> {
        let focus = self.focus.unwrap_or(self.eye.distance(self.target));
        (self.aperture > 0.0).then_some(Lens {
            radius: self.aperture * focus,
            focus,
            blades: self.blades.unwrap_or(0),
        })
    }

    /// The camera over an image of a size, without a lens. The camera must pass [`Camera::check`].
    pub fn view(&self, size: [u32; 2]) -> View {
        let distance = self.eye.distance(self.target);
        let view = View::new(self.eye, self.target, self.up, self.fov, size);
        let height = view.pixel * f64::from(size[1]);
        View {
            shift: height * DVec2::new(self.shift, self.rise),
            ..view
        }
        .by(self.projection, self.fov, distance)
    }
}
