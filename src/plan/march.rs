//! How a picture is marched: the modes, and the settings of `[march]`.

use crate::base::cone::ConeRule;
use crate::base::key::{AutoCount, AutoNumber, Count, Fault, Key, List, Number, Slot, Word};
use crate::keys;
use crate::plan::pyramid::Pyramid;
use crate::scene::distance::{Relaxation, Stepping};
use toml::Value;

/// A way to spend work, for pictures and comparisons alike.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Exact cones at full chord, relaxed rays.
    #[default]
    Safe,
    /// Exact cones with the fudge factors that a calibration recorded.
    Calibrated,
    /// The slides' rule, 128 steps split evenly over all passes.
    SlidesEven,
    /// The slides' rule, 512 steps per coarse pass and 128 for the rays.
    SlidesDeep,
    /// The slides' rule, 512 steps per coarse pass and 32 for the rays.
    SlidesFast,
    /// Classical sphere tracing: no cones, no relaxation, no shell.
    Ray,
    /// Sphere tracing with relaxation.
    RayRelaxed,
    /// Tiny steps, no cones, no relaxation: what the others are measured against.
    Truth,
}

/// Every mode with its name.
pub const MODES: &[(&str, Mode)] = &[
    ("safe", Mode::Safe),
    ("calibrated", Mode::Calibrated),
    ("slides-even", Mode::SlidesEven),
    ("slides-deep", Mode::SlidesDeep),
    ("slides-fast", Mode::SlidesFast),
    ("ray", Mode::Ray),
    ("ray-relaxed", Mode::RayRelaxed),
    ("truth", Mode::Truth),
];

impl Mode {
    /// The mode's name.
    pub fn name(self) -> &'static str {
        MODES.iter().find(|(_, m)| *m == self).map_or("", |m| m.0)
    }

    fn slides(self) -> bool {
        matches!(self, Self::SlidesEven | Self::SlidesDeep | Self::SlidesFast)
    }

    fn cones(self) -> bool {
        !matches!(self, Self::Ray | Self::RayRelaxed | Self::Truth)
    }
}

/// Steps per level and of a ray, where nothing is known of the scene: the slowest rays of
/// the presets end well before.
const STEPS: u32 = 256;

/// The settings of `[march]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Marching {
    /// Which mode.
    pub mode: Mode,
    /// Divisor of the first cone pass, a power of two; 1 for none.
    pub coarsest: u32,
    /// Hit where `estimate <= detail * footprint`.
    pub detail: f64,
    /// Share of the hit threshold that steps keep clear of.
    pub shell: f64,
    /// How rays stretch their steps.
    pub relaxation: Relaxation,
    /// Factors on the cones' chords in mode `calibrated`, coarse to fine; the last is
    /// repeated. The other modes march full cones.
    pub fudge: Vec<f64>,
    /// Steps per level and of a ray; auto is 256, and over a heightfield for rays as many as
    /// one can take.
    pub steps: Option<u32>,
    /// Factor on ray steps; auto is 1, and 0.1 for the truth.
    pub stride: Option<f64>,
    /// Whether rays start where they enter the bounds; auto is yes after cones, no
    /// where rays are marched alone.
    pub clip: Option<bool>,
}

impl Default for Marching {
    fn default() -> Self {
        Self {
            mode: Mode::Safe,
            coarsest: 16,
            detail: 1.0,
            shell: 0.45,
            relaxation: Relaxation::Auto,
            fudge: vec![1.0],
            steps: None,
            stride: None,
            clip: None,
        }
    }
}

/// `"off"`, `"auto"` or a factor.
struct RelaxationSlot<'a>(&'a mut Relaxation);

impl Slot for RelaxationSlot<'_> {
    fn get(&self) -> Value {
        match &*self.0 {
            Relaxation::Off => Value::String("off".into()),
            Relaxation::Auto => Value::String("auto".into()),
            Relaxation::Factor(f) => Value::Float(*f),
        }
    }
    fn put(&mut self, value: &Value) -> Option<()> {
        *self.0 = match value.as_str() {
            Some("off") => Relaxation::Off,
            Some("auto") => Relaxation::Auto,
            _ => {
                let mut f = 0.0;
                Number(&mut f, 1.0, 1.99).put(value)?;
                Relaxation::Factor(f)
            }
        };
        Some(())
    }
    fn expects(&self) -> String {
        "\"off\", \"auto\" or a factor from 1 to 1.99".into()
    }
}

/// A power of two in a range.
struct Divisor<'a>(&'a mut u32);

impl Slot for Divisor<'_> {
    fn get(&self) -> Value {
        Value::Integer(i64::from(*self.0))
    }
    fn put(&mut self, value: &Value) -> Option<()> {
        let mut n = 0;
        Count(&mut n, 1, 64).put(value)?;
        *self.0 = Some(n).filter(|n| n.is_power_of_two())?;
        Some(())
    }
    fn expects(&self) -> String {
        "a power of two: 1 (no cones), 2, 4, 8, 16, 32 or 64".into()
    }
}

impl Marching {
    /// The keys of `[march]`.
    pub fn keys(&mut self) -> Vec<Key<'_>> {
        keys![
            "mode" = Word(&mut self.mode, MODES),
                "how the work is spent";
            "coarsest" = Divisor(&mut self.coarsest),
                "divisor of the first cone pass";
            "detail" = Number(&mut self.detail, 1e-3, 1e3),
                "hit where the estimate is below this many footprints";
            "shell" = Number(&mut self.shell, 0.0, 0.99),
                "share of that threshold that steps keep clear of: time against error";
            "relaxation" = RelaxationSlot(&mut self.relaxation),
                "how rays stretch their steps";
            "fudge" = List(&mut self.fudge, 1..=6, 0.01, 1.0),
                "factors on the cones' width in mode calibrated, coarse to fine, the last repeated";
            "steps" = AutoCount(&mut self.steps, 1, 1_000_000),
                "steps per level and of a ray; auto is 256, and for rays over a heightfield as many as they can take";
            "stride" = AutoNumber(&mut self.stride, 1e-3, 1.0),
                "factor on ray steps; auto is 1, and 0.1 for the truth";
            "clip" = Word(&mut self.clip, &[("auto", None), ("on", Some(true)), ("off", Some(false))]),
                "start rays where they enter the bounds; auto: on after cones";
        ]
    }

    /// Whether the fudge list fits the pyramid.
    pub fn check(&self) -> Result<(), Fault> {
        let levels = self.coarsest.ilog2() as usize;
        // Elsewhere nothing reads the list, and a coarser or finer start is no fault.
        if self.mode == Mode::Calibrated && self.fudge.len() > levels.max(1) {
            return Err(Fault::new(
                "march.fudge",
                format!(
                    "{} factors for {levels} cone passes; give at most {levels}, or a larger march.coarsest",
                    self.fudge.len()
                ),
            ));
        }
        Ok(())
    }

    /// The cone levels that the mode marches.
    pub fn pyramid(&self) -> Pyramid {
        if !self.mode.cones() {
            return Pyramid::default();
        }
        let passes = self.coarsest.ilog2() + 1;
        let fudge: &[f64] = match self.mode {
            Mode::Calibrated => &self.fudge,
            _ => &[],
        };
        Pyramid::new(self.coarsest, fudge, |_| match self.mode {
            Mode::SlidesEven => (128 / passes).max(1),
            Mode::SlidesDeep | Mode::SlidesFast => 512,
            _ => self.steps.unwrap_or(STEPS),
        })
    }

    /// Steps that a ray may do, `crossing` being the most that one can take through the
    /// scene, where that is known.
    pub fn ray_steps(&self, crossing: Option<u32>) -> u32 {
        let steps = self
            .steps
            .unwrap_or_else(|| STEPS.max(crossing.unwrap_or(0)));
        match self.mode {
            Mode::SlidesEven => (128 / (self.coarsest.ilog2() + 1)).max(1),
            Mode::SlidesDeep => 128,
            Mode::SlidesFast => 32,
            // As far as the steps of the others reach, in steps so much shorter.
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped"
            )]
            Mode::Truth => (f64::from(steps) * 16.0 / self.stride()).min(1e6) as u32,
            _ => steps,
        }
    }

    /// The factor on ray steps.
    pub fn stride(&self) -> f64 {
        self.stride
            .unwrap_or(if self.mode == Mode::Truth { 0.1 } else { 1.0 })
    }

    /// What the scene needs to know to take its steps.
    pub fn stepping(&self) -> Stepping {
        let plain = self.mode.slides() || matches!(self.mode, Mode::Ray | Mode::Truth);
        Stepping {
            detail: self.detail,
            shell: if plain || self.mode == Mode::RayRelaxed {
                0.0
            } else {
                self.shell
            },
            relaxation: if plain {
                Relaxation::Off
            } else {
                self.relaxation
            },
            stride: self.stride(),
            clip: self.clip.unwrap_or(self.mode.cones()),
            rule: if self.mode.slides() {
                ConeRule::Slides
            } else {
                ConeRule::Exact
            },
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
            let levels = march.pyramid().levels;
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

    #[test]
    fn factors_are_counted_only_where_they_are_read() {
        let mut march = Marching {
            coarsest: 8,
            fudge: vec![1.0; 4],
            ..Marching::default()
        };
        assert!(march.check().is_ok());
        march.mode = Mode::Calibrated;
        assert!(march.check().is_err());
        march.fudge.pop();
        assert!(march.check().is_ok());
    }
}
