//! Everything that decides a picture, as one value.
//!
//! A [`Plan`] is a plain value: it can be printed, compared, written as a preset and tested
//! without a GPU. It touches no file and makes no map; that is the explicit step of
//! [`Assets`]. Nothing in it depends on a measurement.

pub mod camera;
pub mod look;
pub mod march;
pub mod pyramid;

use std::borrow::Cow;

use crate::base::key::{Fault, Key, Size};
use crate::base::view::View;
use crate::heightfield::assets::Preparation;
use crate::heightfield::tracer::settings::PrepareError;
use crate::keys;
use crate::scene::{AnySolid, Assets, Scene, Viewpoint};
use camera::Camera;
use look::Look;
use march::Marching;
use pyramid::{Level, Pyramid};

/// Longest image edge.
pub const MOST_PIXELS: u32 = 65_536;

/// Everything that decides a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// A line for people.
    pub title: String,
    /// What is in the picture.
    pub scene: Scene,
    /// Where it is seen from.
    pub camera: Camera,
    /// How it is marched.
    pub march: Marching,
    /// How it looks.
    pub look: Look,
    /// Pixels along each axis.
    pub size: [u32; 2],
}

impl Plan {
    /// A plan of a scene with defaults for everything else.
    pub fn new(scene: impl Into<Scene>) -> Self {
        let scene = scene.into();
        let look = Look {
            flag_unconverged: scene.flags_unconverged(),
            ..Look::default()
        };
        Self {
            title: String::new(),
            scene,
            camera: Camera::default(),
            march: Marching::default(),
            look,
            size: [1280, 720],
        }
    }

    /// The keys of a section; `None` for an unknown one. `scene.kind` and `scene.formula`
    /// are none: they choose the [`Scene`] itself.
    pub fn keys(&mut self, section: &str) -> Option<Vec<Key<'_>>> {
        Some(match section {
            "scene" => self.scene.keys(),
            "camera" => self.camera.keys(),
            "march" => self.march.keys(),
            "look" => self.look.keys(),
            "image" => keys![
                "size" = Size(&mut self.size, MOST_PIXELS), "width and height in pixels";
            ],
            _ => return None,
        })
    }

    /// Checks that all settings fit together. No file is read: [`Assets::load`] does that.
    ///
    /// # Errors
    /// The key of the first value that does not fit, and a valid alternative.
    pub fn check(&self) -> Result<(), Fault> {
        self.scene.check()?;
        self.camera.check()?;
        self.march.check()?;
        self.look.check(self.scene.most_shadow_steps())
    }

    /// The camera fitted to the image.
    pub fn view(&self) -> View {
        self.camera.view(self.size)
    }

    /// The cone levels.
    pub fn pyramid(&self) -> Pyramid {
        self.march.pyramid()
    }

    /// From where, how finely and by which steps the scene is looked at.
    pub fn viewpoint(&self) -> Viewpoint {
        Viewpoint {
            eye: self.camera.eye,
            grain: self.view().view_ray([0, 0]).grain,
            stepping: self.march.stepping(),
        }
    }

    /// The scene resolved to numbers. What the assets lack is loaded, or made on the CPU.
    ///
    /// # Errors
    /// A named file cannot be read or does not fit; a cone map cannot be made.
    pub fn solid(&self, assets: &Assets) -> Result<AnySolid, PrepareError> {
        self.scene.solid(&self.viewpoint(), assets)
    }

    /// A sentence about precision, where f32 cannot hold what the plan asks for.
    pub fn precision_warning(&self) -> Option<String> {
        self.scene.precision_warning(&self.viewpoint())
    }

    /// Steps that a ray may do.
    pub fn ray_steps(&self, assets: &Assets) -> u32 {
        self.march.ray_steps(self.scene.most_steps(assets))
    }

    /// The passes of a frame, in order. [`Pass::Prepare`] is done once for all frames.
    pub fn passes(&self, extras: Extras) -> Vec<Pass> {
        let levels = self.pyramid().levels.into_iter().map(Pass::March);
        let colours = (!extras.depth_only).then_some(Pass::Color);
        levels.chain([Pass::Trace]).chain(colours).collect()
    }

    /// The plan without what a frame with these extras does not need: maps and pictures by
    /// which only colours are picked.
    pub fn lean(&self, extras: Extras) -> Cow<'_, Self> {
        match self.scene.colorless() {
            Some(scene) if extras.depth_only => Cow::Owned(Self {
                scene,
                ..self.clone()
            }),
            _ => Cow::Borrowed(self),
        }
    }
}

/// One step of a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pass {
    /// A cone map, made before all others and kept for later frames.
    Prepare(Preparation),
    /// Cones of one level.
    March(Level),
    /// Rays at full size.
    Trace,
    /// Light and colour.
    Color,
}

impl Pass {
    /// `prepare`, `march 1/16`, `trace` or `color`.
    pub fn name(&self) -> String {
        match self {
            Self::Prepare(_) => "prepare".into(),
            Self::March(level) => format!("march 1/{}", level.divisor),
            Self::Trace => "trace".into(),
            Self::Color => "color".into(),
        }
    }

    /// Cells along each axis, over so many pixels; places of a cone map.
    pub fn cells(&self, pixels: [u32; 2]) -> [u32; 2] {
        match self {
            Self::Prepare(map) => map.places,
            Self::March(level) => level.cells(pixels),
            Self::Trace | Self::Color => pixels,
        }
    }

    /// Whether its time and its counts are told as march and trace.
    pub fn marches(&self) -> bool {
        matches!(self, Self::March(_) | Self::Trace)
    }
}

/// What a render yields beside colour and depth. It never changes a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// Count evaluations and iterations.
    pub count: bool,
    /// Keep normals.
    pub normals: bool,
    /// Keep the fronts and states of every cone level.
    pub levels: bool,
    /// Leave the colour pass out.
    pub depth_only: bool,
    /// Ask the device for its time per pass.
    pub time: bool,
}
