//! How a picture is marched: the modes, and the section `[march]` of a preset.

use toml::Value;

use crate::base::cone::ConeRule;
use crate::base::key::{
    Fault, Kind, Slot, ValueSlot, auto, auto_count, auto_number, count_in, number, number_in,
    numbers, word,
};
use crate::base::named::named_enum;
use crate::plan::pyramid::{Level, levels};
use crate::scene::stepping::{Relaxation, Stepping};
use crate::settings;

/// What sets a mode apart.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    /// What it does, in words.
    about: &'static str,
    /// The rule of its cones; `None` for rays alone.
    cones: Option<ConeRule>,
    /// Whether steps keep the shell of `march.shell`.
    shell: bool,
    /// Whether rays go by proven balls, as cones do.
    proven: bool,
    /// Whether it does without cones where rays alone are faster.
    optional: bool,
    /// Whether rays are relaxed as `march.relaxation` says.
    relaxed: bool,
    /// The factor on ray steps where `march.stride` is `"auto"`.
    stride: f64,
    /// The steps of a cone and of a ray over so many passes; `None` for `march.steps`.
    budget: Option<fn(u32) -> [u32; 2]>,
}

const SAFE: Facts = Facts {
    about: "the default: cones that are proven empty, where they make it faster, and rays with longer steps",
    cones: Some(ConeRule::Exact),
    shell: true,
    proven: false,
    optional: true,
    relaxed: true,
    stride: 1.0,
    budget: None,
};
const RAY: Facts = Facts {
    about: "classical sphere tracing: rays alone, each step as long as the distance estimate",
    cones: None,
    shell: false,
    optional: false,
    relaxed: false,
    ..SAFE
};
const fn slides(about: &'static str, budget: fn(u32) -> [u32; 2]) -> Facts {
    Facts {
        about,
        cones: Some(ConeRule::Slides),
        budget: Some(budget),
        ..RAY
    }
}

named_enum! {
    /// A way to spend work on a picture.
    #[derive(Default)]
    pub enum Mode: Facts {
        /// Exact cones at full width, relaxed rays.
        #[default]
        Safe = "safe" => SAFE,
        /// As safe, and no step of a ray is longer than a proof allows.
        Proven = "proven" => Facts {
            about: "as safe, and no step of a ray is longer than a proof allows",
            proven: true,
            ..SAFE
        },
        /// Exact cones, narrowed by the factors that a calibration found.
        Calibrated = "calibrated" => Facts {
            about: "cones everywhere, made narrower by the factors of march.fudge",
            optional: false,
            ..SAFE
        },
        /// The slides' rule. 128 steps are split evenly over all passes.
        SlidesEven = "slides-even" => slides(
            "cones by the rule of slides from 2012, which leaves gaps; 128 steps for all passes",
            |passes| [(128 / passes).max(1); 2],
        ),
        /// The slides' rule. Each coarse pass has 512 steps, a ray 128.
        SlidesDeep = "slides-deep" =>
            slides("the same rule; 512 steps for each cone pass, 128 for a ray", |_| [512, 128]),
        /// The slides' rule. Each coarse pass has 512 steps, a ray 32.
        SlidesFast = "slides-fast" =>
            slides("the same rule; 512 steps for each cone pass, 32 for a ray", |_| [512, 32]),
        /// Classical sphere tracing: no cones, no relaxation, no shell.
        Ray = "ray" => RAY,
        /// Sphere tracing with relaxation.
        RayRelaxed = "ray-relaxed" => Facts {
            about: "rays alone, with longer steps that are taken back where they went too far",
            relaxed: true,
            ..RAY
        },
        /// Tiny steps, no cones, no relaxation. The other modes are measured against it.
        Truth = "truth" => Facts {
            about: "rays alone in tiny steps; the other modes are measured against it",
            stride: 0.1,
            ..RAY
        },
    }
}

impl Mode {
    /// What it does, in words.
    pub fn about(self) -> &'static str {
        self.facts().about
    }
}

/// Steps of a cone and of a ray where `march.steps` and the scene do not say. The slowest rays
/// of the presets end well before.
pub const STEPS: u32 = 256;
/// The divisor of the first cone level by default. More levels above it cost little and bring
/// little.
pub const COARSEST: u32 = 16;
/// The shell with cones: rays that start behind them are wrong on as few pixels as rays alone.
const SHELL: f64 = 0.2;
/// The shell of rays alone: a quarter as much keeps them within 3 % of the time of rays without a shell.
const SHELL_ALONE: f64 = 0.05;

settings! {
    /// How a picture is marched.
    pub struct Marching {
        mode: Mode = Mode::Safe, word(&Mode::WORDS), "the method; benchmarks.md explains and compares the modes; proven needs scene.estimate = \"tight\" over a formula" => Program;
        coarsest: Option<u32> = None, divisor(),
            "side in pixels of the blocks of the first cone pass, 1 for no cones; auto is 16, or 1 in modes safe and proven where a few rays tell that cones cost more than they save, or over a heightfield below 100000 pixels, and always on a discrete GPU";
        detail: f64 = 1.0, number(1e-3, 1e3),
            "hit threshold in footprints: a ray ends where the estimate is at most this";
        shell: Option<f64> = None, auto_number(0.0, 0.99),
            "share of the hit threshold by which steps keep away from the surface; more costs time and lowers the error; auto is 0.2, and 0.05 without cones";
        relaxation: Relaxation = Relaxation::Auto, relaxation(), "factor on the steps of rays; auto follows the change of the estimate from step to step, and off is 1";
        fudge: Vec<f64> = vec![1.0], numbers(6, 0.01, 1.0),
            "factors on the width of the cones in mode calibrated, for each pass from coarse to fine; at most one for each pass, and the last one repeats";
        steps: Option<u32> = None, auto_count(1, 1_000_000),
            "step limit of each cone in a pass, and of each ray; auto is 256, and for rays over a heightfield as many as they can need";
        stride: Option<f64> = None, auto_number(1e-3, 1.0),
            "factor on the steps of rays, for shorter steps; auto is 1, and 0.1 in mode truth";
        clip: Option<bool> = None, word(&[("auto", None), ("on", Some(true)), ("off", Some(false))]),
            "whether rays start where they enter the bounds; auto is on in modes with cones";
    }
}

/// `"off"`, `"auto"` or a factor.
fn relaxation(at: &mut Relaxation) -> impl Slot {
    let write = |relaxation: &Relaxation| match relaxation {
        Relaxation::Off => "off".into(),
        Relaxation::Auto => "auto".into(),
        Relaxation::Factor(f) => (*f).into(),
    };
    let read = |value: &Value| match value.as_str() {
        Some("off") => Some(Relaxation::Off),
        Some("auto") => Some(Relaxation::Auto),
        _ => number_in(value, 1.0, 1.99).map(Relaxation::Factor),
    };
    let expects = "\"off\", \"auto\" or a factor from 1 to 1.99";
    ValueSlot::new(at, expects, write, read)
}

/// A power of two, or `"auto"`.
fn divisor(at: &mut Option<u32>) -> impl Slot {
    let expects = "a power of two: 1 (no cones), 2, 4, 8, 16, 32 or 64";
    let read = |value: &Value| count_in(value, 1, 64).filter(|n| n.is_power_of_two());
    auto(at, expects.into(), Kind::Other, read)
}

impl Marching {
    /// Checks that the fudge list fits the pyramid.
    pub fn check(&self) -> Result<(), Fault> {
        let levels = self.first_divisor().ilog2() as usize;
        let given = self.fudge.len();
        // The other modes ignore the list.
        let fits = self.mode != Mode::Calibrated || given <= levels.max(1);
        let why = format!(
            "{given} factors for {levels} cone passes; give at most {levels}, or a larger march.coarsest"
        );
        Fault::unless(fits, "march.fudge", why)
    }

    /// The divisor of the first cone level, if there are any.
    fn first_divisor(&self) -> u32 {
        self.coarsest.unwrap_or(COARSEST)
    }

    /// Whether the scene decides if there are cones.
    pub fn may_drop_cones(&self) -> bool {
        self.coarsest.is_none() && self.mode.facts().optional
    }

    /// The step limits of a cone and of a ray that the mode sets.
    fn budget(&self) -> Option<[u32; 2]> {
        let passes = self.first_divisor().ilog2() + 1;
        Some(self.mode.facts().budget?(passes))
    }

    /// The cone levels that the mode marches, coarsest first; none without cones.
    pub fn levels(&self) -> Vec<Level> {
        if self.mode.facts().cones.is_none() {
            return Vec::new();
        }
        let fudge: &[f64] = match self.mode {
            Mode::Calibrated => &self.fudge,
            _ => &[],
        };
        let set = self.steps.unwrap_or(STEPS);
        let steps = self.budget().map_or(set, |[cone, _]| cone);
        levels(self.first_divisor(), fudge, steps)
    }

    /// The step limit of a ray. `crossing` is the largest number of steps that a ray can take
    /// through the scene, where that is known.
    pub fn ray_steps(&self, crossing: Option<u32>) -> u32 {
        let auto = STEPS.max(crossing.unwrap_or(0));
        let steps = self.steps.unwrap_or(auto);
        match self.budget() {
            Some([_, ray]) => ray,
            // Shorter steps need more of them to come as far.
            None if self.mode == Mode::Truth => {
                (f64::from(steps) * 16.0 / self.stride()).min(1e6) as u32
            }
            None => steps,
        }
    }

    /// The share of the hit threshold by which steps keep away, in modes that have a shell.
    pub fn shell(&self) -> f64 {
        let auto = match self.levels().is_empty() {
            true => SHELL_ALONE,
            false => SHELL,
        };
        self.shell.unwrap_or(auto)
    }

    /// The factor on ray steps.
    pub fn stride(&self) -> f64 {
        self.stride.unwrap_or(self.mode.facts().stride)
    }

    /// What the scene needs to know to take its steps.
    pub fn stepping(&self) -> Stepping {
        let facts = self.mode.facts();
        let relaxation = facts.relaxed.then_some(self.relaxation);
        Stepping {
            detail: self.detail,
            shell: if facts.shell { self.shell() } else { 0.0 },
            relaxation: relaxation.unwrap_or(Relaxation::Off),
            stride: self.stride(),
            clip: self.clip.unwrap_or(facts.cones.is_some()),
            proven: facts.proven,
            rule: facts.cones.unwrap_or_default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slides_budgets_are_theirs() {
        let budget = |mode| {
            let march = Marching {
                mode,
                ..Marching::default()
            };
            let levels = march.levels();
            let steps: Vec<u32> = levels.iter().map(|l| l.steps).collect();
            (steps, march.ray_steps(None))
        };
        assert_eq!(budget(Mode::SlidesEven), (vec![25; 4], 25));
        assert_eq!(budget(Mode::SlidesDeep), (vec![512; 4], 128));
        assert_eq!(budget(Mode::SlidesFast), (vec![512; 4], 32));
        assert_eq!(budget(Mode::Safe), (vec![256; 4], 256));
        assert_eq!(budget(Mode::Ray), (vec![], 256));
    }

    #[test]
    fn rays_have_as_many_steps_as_they_can_take_unless_told_otherwise() {
        let mut march = Marching::default();
        let steps = |march: &Marching| [None, Some(100), Some(900)].map(|n| march.ray_steps(n));
        assert_eq!(steps(&march), [256, 256, 900]);
        march.steps = Some(77);
        assert_eq!(steps(&march), [77; 3]);
        march.mode = Mode::SlidesFast;
        assert_eq!(steps(&march), [32; 3]);
    }
}
