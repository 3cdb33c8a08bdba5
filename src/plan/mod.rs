//! The plan of a picture.
//!
//! A [`Plan`] is everything that decides a picture, as one plain value. It can be printed,
//! compared, written as a preset and tested without a GPU. It reads no file and makes no
//! map: [`Assets`] do.
//!
//! - [`camera`], [`march`], [`look`] with [`layers`], [`lamps`] and [`sky`]: the sections of a preset beside `[scene]`
//! - [`film`]: the plan at a moment of its film; [`stereo`]: the plans of two eyes
//! - `assets`: the files that a plan names, and the assets that serve it
//! - `cones`: whether cones pay; [`pyramid`]: the cone levels, and the blocks of a large image

mod assets;
pub mod camera;
pub mod cones;
pub mod film;
pub mod lamps;
pub mod layers;
pub mod look;
pub mod march;
pub mod pyramid;
pub mod sky;
pub mod stereo;

use std::borrow::Cow;

use crate::base::filter::RADIUS;
use crate::base::key::{Fault, Key, Redo, auto_count, count, number, size, text, word};
use crate::base::named::named_enum;
use crate::base::view::View;
use crate::heightfield::assets::Preparation;
use crate::keys;
use crate::scene::{AnySolid, Assets, Scene, Viewpoint};
use crate::time::clock::Timing;
use crate::time::track::Track;
use camera::Camera;
use look::{LightMode, Look};
use march::Marching;
use pyramid::{Block, Level};

/// The largest width and height of an image.
pub const MOST_PIXELS: u32 = 65_536;

/// The most samples of a pixel. Their sum has the precision of an f32.
pub const MOST_PIXEL_SAMPLES: u32 = 65_536;

/// Height of the picture whose details are shown by default: that of a large screen.
const REFERENCE: u32 = 2160;

/// Windows begin at multiples of this many pixels: the widest cell of any cone level.
pub const WINDOW_STEP: u32 = 64;

/// The edge in pixels of the tiles that end alone, see [`Plan::until`].
pub const UNTIL_TILE: u32 = WINDOW_STEP;

/// The fewest samples of a tile that ends before others: two halves of four.
pub const UNTIL_LEAST: u32 = 8;

named_enum! {
    /// What is behind the hits.
    #[derive(Default)]
    pub enum Background {
        /// The sky.
        #[default]
        Sky = "sky",
        /// Nothing: files have alpha.
        Transparent = "transparent",
    }
}

/// Samples of a pixel unless a preset says otherwise: edges are smooth, and a picture takes seconds.
const SAMPLES: u32 = 16;

/// Everything that decides a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// A line about the picture.
    pub title: String,
    /// What is in the picture.
    pub scene: Scene,
    /// Where it is seen from.
    pub camera: Camera,
    /// How it is marched.
    pub march: Marching,
    /// How it looks.
    pub look: Look,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Samples of each pixel, from 1 to [`MOST_PIXEL_SAMPLES`].
    pub samples: u32,
    /// The error of the shown picture, 0 to 1, below which a tile of [`UNTIL_TILE`] pixels gets no
    /// more samples; 0 for all samples everywhere.
    pub until: f64,
    /// The height in pixels of the picture whose details are shown, if it is higher than this one.
    pub reference: Option<u32>,
    /// What is behind the hits in files. A picture that is shown while it is made has the sky.
    pub background: Background,
    /// Pixels per inch of paper, which files tell printers.
    pub ppi: Option<u32>,
    /// When the frames of a film are.
    pub time: Timing,
    /// What changes in the film.
    pub tracks: Vec<Track>,
    /// The part of the image that is rendered, if not all of it. It begins at multiples of
    /// [`WINDOW_STEP`], and ends at such or at the end of the image. Its pixels are those of the
    /// whole picture, bit for bit. Presets know nothing of it.
    pub window: Option<Block>,
}

impl Plan {
    /// A plan of a scene, with defaults for everything else.
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
            samples: SAMPLES,
            until: 0.0,
            reference: Some(REFERENCE),
            background: Background::Sky,
            ppi: None,
            time: Timing::default(),
            tracks: Vec::new(),
            window: None,
        }
    }

    /// The pixels that are rendered: the window, or all.
    pub fn pixels(&self) -> Block {
        let all = Block {
            origin: [0; 2],
            size: self.size,
        };
        self.window.unwrap_or(all)
    }

    /// The keys of a section, or with an empty name those above all sections; `None` if there is
    /// no such section. `scene.kind` and `scene.formula` are not among them: they choose the
    /// [`Scene`].
    pub fn keys(&mut self, section: &str) -> Option<Vec<Key<'_>>> {
        let most = match section {
            "" | "time" => Redo::Nothing,
            "look" => Redo::Color,
            _ => Redo::March,
        };
        let mut keys = match section {
            "" => keys!["title" = text(&mut self.title), "a name of the picture, for people";],
            "scene" => self.scene.keys(),
            "camera" => self.camera.keys(),
            "march" => self.march.keys(),
            "look" => self.look.keys(),
            "image" => keys![
                "size" = size(&mut self.size, MOST_PIXELS), "width and height in pixels";
                "samples" = count(&mut self.samples, 1, MOST_PIXEL_SAMPLES), "rays through each pixel, whose colours are averaged: 1 is quick and has jagged edges, 16 is smooth, 64 is for print" => Program;
                "until" = number(&mut self.until, 0.0, 1.0), "error of the shown picture, from black 0 to white 1, below which a tile of 64 x 64 pixels gets no more samples, judged after 8, 16, 32 and so on: 0 for all samples everywhere, 0.004 for one level of 8 bits" => Program;
                "reference" = auto_count(&mut self.reference, 1, MOST_PIXELS), "height in pixels of the picture whose details are shown: a lower picture shows the same details, averaged by its samples, and a higher one those of its own pixels; auto is the picture's own height" => March;
                "background" = word(&mut self.background, &Background::WORDS), "what files have behind the hits: sky, or transparent for alpha, the share of a pixel's samples that hit, in PNG, WebP and EXR; fog still fades toward the sky's colour, and the window shows the sky" => Program;
                "ppi" = auto_count(&mut self.ppi, 1, 10_000), "pixels per inch on paper, which PNG, JPEG, WebP and EXR tell printers; auto tells none" => Nothing;
            ],
            "time" => self.time.keys(),
            _ => return None,
        };
        for key in &mut keys {
            key.redo.get_or_insert(most);
        }
        Some(keys)
    }

    /// Checks that all settings fit together. No file is read: [`Assets::load`](crate::scene::Assets::load) does that.
    ///
    /// # Errors
    /// The first value that does not fit, with a valid alternative.
    pub fn check(&self) -> Result<(), Fault> {
        self.scene.check()?;
        self.camera.check()?;
        self.check_stereo()?;
        self.march.check()?;
        self.look.check(self.scene.most_shadow_steps())?;
        Fault::unless(
            !self.look.layers.are_on() || self.scene.formula().is_some(),
            self.look.layers.first_on().unwrap_or("look.trap"),
            "only a formula has orbits that traps measure; over other scenes use trap = \"auto\" and no layers",
        )?;
        Fault::unless(
            self.look.glow == 0.0 || self.scene.tells_distance(),
            "look.glow",
            "only formulas tell the distance that the glow follows; over heightfields use glow 0, and fog with fog_height for mist",
        )?;
        let proves =
            !self.march.stepping().proven || self.scene.sharpest().is_none_or(|s| s == self.scene);
        Fault::unless(
            proves || self.scene.formula().is_none(),
            "march.mode",
            "there is a proof only for scene.estimate = \"tight\"; use that, or mode safe",
        )?;
        self.check_tracks()
    }

    /// The plan with one sample for each pixel, with the details and the light that this can show.
    #[must_use]
    pub fn one_sample(&self) -> Self {
        let mut plan = self.clone();
        (plan.samples, plan.reference, plan.look.mode) = (1, None, LightMode::Quick);
        plan
    }

    /// The camera over the image.
    pub fn view(&self) -> View {
        let view = self.camera.view(self.size);
        let [own, shown] = [self.size[1], self.reference.unwrap_or(0)].map(f64::from);
        View {
            filter_radius: if self.samples > 1 { RADIUS } else { 0.0 },
            lens: self.camera.lens().filter(|_| self.samples > 1),
            grain: view.grain * own / own.max(shown),
            ..view
        }
    }

    /// How often each pixel has a ray. Through a lens, its centre has one more, for the depth.
    pub fn visits(&self) -> u32 {
        self.samples + u32::from(self.view().lens.is_some())
    }

    /// Whether tiles may end before they have all samples.
    pub fn is_adaptive(&self) -> bool {
        self.until > 0.0 && self.samples > UNTIL_LEAST
    }

    /// Whether a frame has the variance of each pixel.
    pub fn has_variance(&self, extras: Extras) -> bool {
        extras.variance && self.samples > 1 && !extras.depth_only
    }

    /// Whether a frame has alpha in place of the sky.
    pub fn is_transparent(&self, extras: Extras) -> bool {
        self.background == Background::Transparent && !extras.depth_only && !extras.shown
    }

    /// The cone levels, coarsest first; none in modes without cones.
    pub fn levels(&self) -> Vec<Level> {
        self.march.levels()
    }

    /// The divisor of the first cone level; 1 without levels.
    pub fn coarsest(&self) -> u32 {
        self.levels().first().map_or(1, |level| level.divisor)
    }

    /// The eye, the finest pixel and the steps of the plan.
    pub fn viewpoint(&self) -> Viewpoint {
        let view = self.view();
        let corner = view.finest();
        Viewpoint {
            eye: self.camera.eye,
            grain0: corner.grain0,
            grain: corner.grain,
            spacing: view.spacing(),
            stepping: self.march.stepping(),
        }
    }

    /// A warning if f32 is too coarse for the picture.
    pub fn precision_warning(&self) -> Option<String> {
        if let Some(eyes) = self.eyes() {
            return eyes.iter().find_map(Self::precision_warning);
        }
        self.scene
            .precision_warning(&self.viewpoint(), &self.view())
    }

    /// The step limit of a ray through the scene.
    pub fn ray_steps(&self, solid: &AnySolid) -> u32 {
        self.march.ray_steps(solid.twin().most_steps())
    }

    /// The passes of a frame, in order. [`Pass::Prepare`] is not among them: it runs once for
    /// many frames.
    pub fn passes(&self, extras: Extras) -> Vec<Pass> {
        let levels = self.levels().into_iter().map(Pass::March);
        let colours = (!extras.depth_only).then_some(Pass::Color);
        levels.chain([Pass::Trace]).chain(colours).collect()
    }

    /// The plan as it is rendered. It has no maps and textures that only colours need, and a single
    /// sample, if these extras ask for no colours. It has no cones where they do not pay, unless the
    /// plan says how coarse they are. Over heights that the assets do not have yet, that is decided by
    /// the size of the picture alone.
    /// On a discrete GPU, the executor leaves cones out everywhere else too.
    pub fn resolved(&self, extras: Extras, assets: &Assets) -> Cow<'_, Self> {
        let mut plan = Cow::Borrowed(self);
        if let Some(scene) = self.scene.colorless()
            && extras.depth_only
        {
            plan.to_mut().scene = scene;
        }
        if extras.depth_only && self.samples > 1 {
            plan.to_mut().samples = 1;
        }
        if let Some(rays) = extras.rays
            && let Some(scene) = plan.scene.with_few_rays(rays, assets)
        {
            plan.to_mut().scene = scene;
        }
        if extras.depth_only && self.look.sky.path().is_some() {
            plan.to_mut().look.sky = self.look.sky.without();
        }
        if plan.march.may_drop_cones() && !cones::pay(&plan, assets) {
            plan.to_mut().march.coarsest = Some(1);
        }
        // What is left of it may get stages of cones that rays do without.
        if plan.march.shell.is_none() {
            plan.to_mut().march.shell = Some(plan.march.shell());
        }
        plan
    }

    /// The rays through all pixels of the whole picture, in all samples.
    pub fn rays(&self) -> u64 {
        let counts = self.size.into_iter().chain([self.samples]);
        counts.map(u64::from).product()
    }
}

/// One step of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pass {
    /// Makes a cone map, which is kept for later frames.
    Prepare(Preparation),
    /// Marches the cones of one level.
    March(Level),
    /// Follows one ray per pixel.
    Trace,
    /// Lights and colours the pixels.
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

    /// Cells along each axis over so many pixels; for a cone map, its places.
    pub fn cells(&self, pixels: [u32; 2]) -> [u32; 2] {
        match self {
            Self::Prepare(map) => map.places,
            Self::March(level) => level.cells(pixels),
            Self::Trace | Self::Color => pixels,
        }
    }

    /// Whether its time and its counts belong to march and trace.
    pub fn marches(&self) -> bool {
        matches!(self, Self::March(_) | Self::Trace)
    }
}

/// What a render yields beside colour and depth. It changes no picture, but for what `rays` tells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// Count evaluations and iterations.
    pub count: bool,
    /// Keep normals.
    pub normals: bool,
    /// Keep the variance of each pixel. One sample has none.
    pub variance: bool,
    /// Keep the fronts and states of every cone level.
    pub levels: bool,
    /// Skip the colour pass.
    pub depth_only: bool,
    /// Measure the device's time per pass.
    pub time: bool,
    /// Keep a picture on the device that can be shown while it is made.
    pub shown: bool,
    /// Show the fronts of the coarse levels in that picture before there are colours.
    pub sketched: bool,
    /// Read no layer back. The frame has figures only; the picture on the device is complete.
    pub unread: bool,
    /// Start from what the last frame left on the device: if only the look differs, from its
    /// rays, and if only tone and exposure differ, from its colours.
    pub reuse: bool,
    /// The rays of the whole picture, if the scene is to be rendered as suits so many: see
    /// [`Plan::rays`]. Soft edges of shadows over heightfields differ in single pixels.
    pub rays: Option<u64>,
    /// Keep the programs of the last frame when a number becomes zero: that of a feature of the look,
    /// the aperture or the rotation. The picture may differ in the last bits, and at edges.
    pub held: bool,
}
