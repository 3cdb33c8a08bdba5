//! Everything that decides a picture, as one value.
//!
//! A [`Plan`] can be printed, compared, written as a preset and tested without a GPU.
//! It resolves to a [`Scene`], a [`View`], a [`Pyramid`] and a list of [`Pass`]es, each
//! with its [`Program`]. Nothing in it depends on a measurement.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::path::PathBuf;

use glam::DVec3;

use crate::base::key::{AutoCount, Fault, Key, Size};
use crate::base::shader::{Module, Program};
use crate::base::view::{self, View};
use crate::formula::Formula;
use crate::heightfield::conemap::generate::generator::Generator;
use crate::heightfield::conemap::generate::task::program_of;
use crate::heightfield::settings::HeightfieldSettings;
use crate::heightfield::tracer::settings::{Make, PrepareError};
use crate::pass::{self, look::Light};
use crate::plan::camera::Camera;
use crate::plan::look::Look;
use crate::plan::march::Marching;
use crate::plan::pyramid::{Level, Pyramid};
use crate::scene::Scene;
use crate::scene::distance::Distance;
use crate::scene::heightfield::Heightfield;
use crate::scene::slab::{Slab, SlabSettings};
use crate::wgsl;

pub mod camera;
pub mod look;
pub mod march;
pub mod pyramid;

/// Most iterations that a formula may run: past them `auto` stops following the
/// footprint.
pub const MOST_ITERATIONS: u32 = 1000;
/// Longest image edge.
pub const MOST_PIXELS: u32 = 65_536;

/// What is in the picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Subject {
    /// A formula; iterations follow the finest footprint where none are given.
    Distance {
        /// The formula and its parameters.
        shape: Formula,
        /// Iteration limit.
        iterations: Option<u32>,
    },
    /// A relief over a height map.
    Heightfield(HeightfieldSettings),
    /// A slab.
    Slab(SlabSettings),
}

impl Subject {
    /// The keys of `[scene]`, beside `kind` and `formula`.
    pub fn keys(&mut self) -> Vec<Key<'_>> {
        match self {
            Self::Distance { shape, iterations } => {
                let mut keys = shape.keys();
                keys.push(Key::new(
                    "iterations",
                    AutoCount(iterations, 1, MOST_ITERATIONS),
                    "iteration limit; auto follows the finest footprint, up to 1000",
                ));
                keys
            }
            Self::Heightfield(shape) => shape.keys(),
            Self::Slab(shape) => shape.keys(),
        }
    }

    /// Every subject with its defaults: each formula, and each other kind of scene.
    pub fn all() -> Vec<Self> {
        let formulas = Formula::all().into_iter().map(|shape| Self::Distance {
            shape,
            iterations: None,
        });
        let others = [
            Self::Heightfield(HeightfieldSettings::default()),
            Self::Slab(SlabSettings::default()),
        ];
        formulas.chain(others).collect()
    }

    /// `kind`, and `formula` where there is one.
    pub fn words(&self) -> (&'static str, Option<&'static str>) {
        match self {
            Self::Distance { shape, .. } => ("distance", Some(shape.name())),
            Self::Heightfield(_) => ("heightfield", None),
            Self::Slab(_) => ("slab", None),
        }
    }
}

/// Everything that decides a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// A line for people.
    pub title: String,
    /// What is in the picture.
    pub subject: Subject,
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
    /// A plan of a subject with defaults for everything else.
    pub fn new(subject: Subject) -> Self {
        let look = Look {
            // The papers' tracers run out of their own steps; a fractal's pixels that do
            // are next to what they would have met.
            flag_unconverged: matches!(subject, Subject::Heightfield(_)),
            ..Look::default()
        };
        Self {
            title: String::new(),
            subject,
            camera: Camera::default(),
            march: Marching::default(),
            look,
            size: [1280, 720],
        }
    }

    /// The keys of a section other than `scene`; `None` for an unknown one.
    pub fn keys(&mut self, section: &str) -> Option<Vec<Key<'_>>> {
        Some(match section {
            "scene" => self.subject.keys(),
            "camera" => self.camera.keys(),
            "march" => self.march.keys(),
            "look" => self.look.keys(),
            "image" => vec![Key::new(
                "size",
                Size(&mut self.size, MOST_PIXELS),
                "width and height in pixels",
            )],
            _ => return None,
        })
    }

    /// Whether all settings fit together.
    pub fn check(&self) -> Result<(), Fault> {
        match &self.subject {
            Subject::Distance { shape, .. } => shape.check()?,
            Subject::Heightfield(shape) => shape.check()?,
            Subject::Slab(shape) => shape.check()?,
        }
        self.camera.check()?;
        self.march.check()?;
        let formula = matches!(self.subject, Subject::Distance { .. });
        let most = look::MOST_SHADOW_STEPS_OF_FORMULAS;
        if formula && self.look.shadow_steps.is_some_and(|steps| steps > most) {
            return Err(Fault::new(
                "look.shadow_steps",
                format!("at most {most} steps for the shadows of a formula; \"auto\" would do"),
            ));
        }
        self.look.check()
    }

    /// Makes what the scene needs and takes long, by `make`; it is kept with the plan.
    ///
    /// # Errors
    /// Files that the plan names have changed since its check; what `make` fails with.
    pub fn prepare(&self, make: Make<'_>) -> Result<(), PrepareError> {
        match &self.subject {
            Subject::Heightfield(shape) => shape.prepare(make),
            _ => Ok(()),
        }
    }

    /// The camera fitted to the image.
    pub fn view(&self) -> View {
        self.camera.view(self.size)
    }

    /// The cone levels.
    pub fn pyramid(&self) -> Pyramid {
        self.march.pyramid()
    }

    /// The scene with everything resolved.
    pub fn scene(&self) -> Scene {
        let eye = self.camera.eye;
        let stepping = self.march.stepping();
        match &self.subject {
            Subject::Distance { shape, iterations } => {
                let most = iterations.unwrap_or_else(|| self.auto_iterations(shape));
                Scene::Distance(Distance::new(shape.clone(), most, eye, stepping))
            }
            Subject::Heightfield(shape) => {
                let ready = shape.ready(self.corner_grain());
                let ready = ready.expect("a plan that passes its check");
                Scene::Heightfield(Heightfield::new(ready, eye, stepping.rule))
            }
            Subject::Slab(shape) => Scene::Slab(Slab::new(shape, eye, stepping.rule)),
        }
    }

    /// The scene with the same programs, and without what takes long to make.
    fn outline(&self) -> Scene {
        let Subject::Heightfield(shape) = &self.subject else {
            return self.scene();
        };
        let ready = shape.outline(self.corner_grain());
        let ready = ready.expect("a plan that passes its check");
        let rule = self.march.stepping().rule;
        Scene::Heightfield(Heightfield::new(ready, self.camera.eye, rule))
    }

    /// Half a pixel's width per length of way, where pixels are finest: in the corners.
    fn corner_grain(&self) -> f64 {
        self.view().view_ray([0, 0]).grain
    }

    fn auto_iterations(&self, shape: &Formula) -> u32 {
        // A quarter of the hit threshold: the skin of an unconverged estimate must not
        // move the surface by what a comparison could see.
        let eps = 0.25 * self.march.detail * self.finest_footprint(shape);
        shape.iterations(eps).min(MOST_ITERATIONS)
    }

    /// The smallest footprint that any hit can have: that of the nearest point that
    /// could be hit, seen through the corner of the image.
    fn finest_footprint(&self, shape: &Formula) -> f64 {
        let eye = self.camera.eye;
        let bounds = shape.bounds();
        let (raw, _) = shape.estimate(eye, MOST_ITERATIONS);
        let clear = bounds.distance(eye).max(raw / shape.lipschitz());
        // A camera on the surface would ask for infinitely fine work.
        let least = 1e-7 * bounds.farthest(eye);
        self.corner_grain() * clear.max(least)
    }

    /// What the scene's steps divide the estimate by.
    pub fn lipschitz(&self) -> f64 {
        match &self.subject {
            Subject::Distance { shape, .. } => shape.lipschitz(),
            Subject::Heightfield(_) | Subject::Slab(_) => 1.0,
        }
    }

    /// A sentence about precision where f32 cannot hold what the plan asks for.
    ///
    /// The estimate's noise in f32 is about 2e-8 of the size of the coordinates
    /// (docs/method.md, 6), and those of an orbit are of the size of the bounds
    /// wherever it starts; a footprint under a hundred times that is damaged.
    pub fn precision_warning(&self) -> Option<String> {
        let Subject::Distance { shape, .. } = &self.subject else {
            return None;
        };
        let finest = self.finest_footprint(shape);
        let floor = 2e-6 * shape.bounds().half.max_element();
        (finest < 0.99 * floor).then(|| {
            format!(
                "the finest footprint, {finest:.1e}, is under the f32 floor of about {floor:.0e}: details that near are noise. Move the camera away, or render with --device cpu"
            )
        })
    }

    /// The look with lengths and colours resolved.
    pub fn light(&self) -> Light {
        let distance = (self.camera.target - self.camera.eye).length();
        let up = self.camera.up.try_normalize().unwrap_or(DVec3::Z);
        Light::new(&self.look, up, distance, self.crossing())
    }

    /// Steps that a ray may do.
    pub fn ray_steps(&self) -> u32 {
        self.march.ray_steps(self.crossing())
    }

    /// The most steps that a ray can take through the scene, where that is known.
    fn crossing(&self) -> Option<u32> {
        match &self.subject {
            Subject::Heightfield(shape) => shape.crossing(),
            _ => None,
        }
    }

    /// The passes over cells and pixels, in order.
    pub fn passes(&self) -> Vec<Pass> {
        self.passes_for(Extras::default())
    }

    /// The passes of a frame with extras, in order.
    pub fn passes_for(&self, extras: Extras) -> Vec<Pass> {
        let levels = self.pyramid().levels.into_iter().map(Pass::March);
        let colours = (!extras.depth_only).then_some(Pass::Color);
        levels.chain([Pass::Trace]).chain(colours).collect()
    }

    /// The plan without what a frame with extras has no use for: maps and pictures that
    /// only colours are picked by.
    pub fn lean(&self, extras: Extras) -> Cow<'_, Self> {
        match &self.subject {
            Subject::Heightfield(shape) if extras.depth_only => Cow::Owned(Self {
                subject: Subject::Heightfield(shape.colorless()),
                ..self.clone()
            }),
            _ => Cow::Borrowed(self),
        }
    }

    /// What is made before them: the cone maps that the scene needs.
    pub fn preparations(&self) -> Vec<Preparation> {
        let Subject::Heightfield(shape) = &self.subject else {
            return Vec::new();
        };
        let one = |generator| {
            let places = shape.places(generator)?;
            Some(Preparation { generator, places })
        };
        shape.generators().into_iter().filter_map(one).collect()
    }

    /// What is to be told of the files that it names: what was left out of them, and what
    /// is taken on trust.
    pub fn notes(&self) -> Vec<String> {
        match &self.subject {
            Subject::Heightfield(shape) => shape.notes(),
            _ => Vec::new(),
        }
    }

    /// The files that it names, each with the key that does.
    pub fn files(&self) -> Vec<(&'static str, PathBuf)> {
        match &self.subject {
            Subject::Heightfield(shape) => shape.files(),
            _ => Vec::new(),
        }
    }

    /// Numbers that decide the picture beside the plan's text: those of the files that it
    /// names.
    pub fn contents(&self) -> Vec<u8> {
        match &self.subject {
            Subject::Heightfield(shape) => shape.contents(),
            _ => Vec::new(),
        }
    }

    /// What would be run for a frame with extras, without a GPU: passes, programs, modules
    /// and constants.
    pub fn explain(&self, extras: Extras) -> String {
        let plan = &*self.lean(extras);
        let scene = plan.outline();
        let mut text = String::new();
        let [w, h] = self.size;
        let _ = writeln!(text, "{w} x {h}, mode {}", self.march.mode.name());
        let _ = writeln!(text, "{}", scene.twin().describe());
        let mut programs: Vec<Program> = Vec::new();
        text.push_str("passes\n");
        let mut line = |name: &str, [w, h]: [u32; 2], limit: &str| {
            let _ = writeln!(text, "  {name:<12} {w:>6} x {h:<6} steps {limit}");
        };
        for Preparation { generator, places } in plan.preparations() {
            line(PREPARE, places, "-");
            programs.push(program_of(generator));
        }
        for pass in plan.passes_for(extras) {
            let (cells, limit) = match pass {
                Pass::March(level) => (level.cells(self.size), level.steps.to_string()),
                Pass::Trace => (self.size, self.ray_steps().to_string()),
                Pass::Color => (self.size, "-".into()),
            };
            line(&pass.name(), cells, &limit);
            let program = self.program(&scene, pass, extras);
            if !programs.contains(&program) {
                programs.push(program);
            }
        }
        text.push_str("programs\n");
        for program in &programs {
            let _ = write!(text, "  {}\n{}", program.entry, program.describe());
        }
        text
    }

    /// The program of a pass.
    pub fn program(&self, scene: &Scene, pass: Pass, extras: Extras) -> Program {
        let mut modules = scene.twin().modules();
        modules.extend([view::module(), wgsl!("pass/shared.wgsl")]);
        let counted = extras.count && pass != Pass::Color;
        modules.push(counters(counted));
        let entry = match pass {
            Pass::March(_) => {
                modules.extend([pass::queue::module(), pass::march::module()]);
                "march"
            }
            Pass::Trace => {
                modules.extend([pass::queue::module(), pass::trace::module()]);
                "trace"
            }
            Pass::Color => {
                modules.extend([
                    pass::look::module(),
                    pass::shadow::module(self.look.shadow),
                    pass::occlusion::module(self.look.occlusion > 0.0),
                    pass::fog::module(self.look.fog > 0.0),
                    pass::color::module(extras.normals, scene.is_colored()),
                ]);
                "color"
            }
        };
        Program::new(entry, modules)
    }
}

fn counters(on: bool) -> Module {
    if on {
        wgsl!("base/counters.wgsl")
    } else {
        wgsl!("base/counters_off.wgsl")
    }
}

/// The name of what is made before the first pass.
pub const PREPARE: &str = "prepare";

/// A cone map that is made before the first pass, and kept for every later picture of the
/// same heights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preparation {
    /// Who makes it.
    pub generator: Generator,
    /// Places along each axis.
    pub places: [u32; 2],
}

/// One step of a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pass {
    /// Cones of one level.
    March(Level),
    /// Rays at full size.
    Trace,
    /// Light and colour.
    Color,
}

impl Pass {
    /// `march 1/16`, `trace` or `color`.
    pub fn name(&self) -> String {
        match self {
            Self::March(level) => format!("march 1/{}", level.divisor),
            Self::Trace => "trace".into(),
            Self::Color => "color".into(),
        }
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
