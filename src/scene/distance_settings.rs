//! The settings of a scene given by a distance estimate.

use super::distance::Distance;
use super::stepping::Stepping;
use super::{AnySolid, Assets, Scene, SceneSettings, Solid, Step, Viewpoint};
use crate::base::key::{Fault, Key, auto_count};
use crate::base::outcome::Counts;
use crate::base::view::{View, footprint};
use crate::formula::Formula;
use crate::heightfield::tracer::settings::PrepareError;
use crate::keys;

/// The settings of a distance scene: a formula and its iteration limit.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceSettings {
    /// The formula and its parameters.
    pub formula: Formula,
    /// Iteration limit; `None` for as many as the finest footprint needs.
    pub iterations: Option<u32>,
}

/// The largest iteration limit.
pub const MOST_ITERATIONS: u32 = 1000;
/// The largest step limit of a shadow ray. Each step iterates the formula, and Mesa's software
/// Vulkan ends loops after 65 535 rounds.
const MOST_SHADOW_STEPS: u32 = 512;
/// Columns and rows of the rays that look for the nearest hit. They take a few milliseconds.
const PROBES: [u32; 2] = [48, 27];
/// Steps of each.
const PROBE_STEPS: u32 = 256;

impl DistanceSettings {
    /// The scene from a viewpoint.
    pub fn seen(&self, from: &Viewpoint) -> Distance {
        let formula = self.formula.clone();
        Distance::new(formula, self.limit(from), from.eye, from.stepping).spaced(from.spacing)
    }

    /// The iteration limit: the given one, or as many as the finest footprint needs.
    fn limit(&self, from: &Viewpoint) -> u32 {
        // A quarter of the hit threshold: too little to see in a comparison.
        let eps = 0.25 * from.stepping.detail * self.finest_footprint(from);
        let auto = || self.formula.iterations(eps).min(MOST_ITERATIONS);
        self.iterations.unwrap_or_else(auto)
    }

    /// The smallest footprint that any hit can have: in a corner of the image, at the
    /// nearest point that a ray could hit.
    fn finest_footprint(&self, from: &Viewpoint) -> f64 {
        let bounds = self.formula.bounds();
        let evaluator = self.formula.evaluator();
        let inside = evaluator.step(from.eye, MOST_ITERATIONS, 0.0).radius;
        let clear = bounds.distance(from.eye).max(inside);
        from.grain0 + from.grain * clear.max(self.least_distance(from))
    }

    /// The smallest footprint of the hits of [`PROBES`] rays over the image. Parts between them may
    /// be nearer.
    fn finest_hit(&self, from: &Viewpoint, view: &View) -> f64 {
        // The truth's steps are too short for so few of them.
        let stepping = Stepping {
            stride: 1.0,
            ..from.stepping
        };
        let solid = self.seen(&Viewpoint { stepping, ..*from });
        let [across, down] = PROBES;
        let rays = (0..across * down).map(|i| {
            let places = [(i % across, across, 0), (i / across, down, 1)];
            let pixel = places.map(|(nth, all, axis)| {
                let place = u64::from(2 * nth + 1) * u64::from(view.size[axis]);
                (place / u64::from(2 * all)) as u32
            });
            view.view_ray(pixel)
        });
        let footprints = rays.filter_map(|ray| {
            let mut work = Counts::default();
            let mut walk = solid.begin(&ray, 0.0, f64::INFINITY, &mut work);
            let mut steps = (0..PROBE_STEPS).map(|_| solid.walk_step(&ray, &mut walk, &mut work));
            let end = steps.find(|step| *step != Step::Moving);
            let t = solid.walk_hit(&walk).t.max(self.least_distance(from));
            (end == Some(Step::Hit)).then(|| footprint(&ray, t))
        });
        footprints.fold(f64::INFINITY, f64::min)
    }

    /// Hits that are nearer count as this far, as the footprint of a hit at the eye is zero.
    fn least_distance(&self, from: &Viewpoint) -> f64 {
        1e-10 * self.formula.bounds().farthest(from.eye)
    }
}

impl From<Formula> for DistanceSettings {
    fn from(formula: Formula) -> Self {
        Self {
            formula,
            iterations: None,
        }
    }
}

impl From<Formula> for Scene {
    fn from(formula: Formula) -> Self {
        Self::Distance(formula.into())
    }
}

impl SceneSettings for DistanceSettings {
    fn kind(&self) -> &'static str {
        "distance"
    }

    fn all() -> Vec<Self> {
        Formula::all().into_iter().map(Self::from).collect()
    }

    fn formula(&self) -> Option<&'static str> {
        Some(self.formula.name())
    }

    fn keys(&mut self) -> Vec<Key<'_>> {
        let mut keys = self.formula.keys();
        keys.extend(keys![
            "iterations" = auto_count(&mut self.iterations, 1, MOST_ITERATIONS),
                "limit of the iterations of the formula; auto is as many as the finest footprint needs, up to 1000";
        ]);
        keys
    }

    fn check(&self) -> Result<(), Fault> {
        self.formula.check()
    }

    fn solid(&self, from: &Viewpoint, _: &Assets) -> Result<AnySolid, PrepareError> {
        Ok(AnySolid::Distance(self.seen(from)))
    }

    fn lipschitz(&self) -> f64 {
        self.formula.lipschitz()
    }

    fn iterations(&self, from: &Viewpoint) -> u32 {
        self.limit(from)
    }

    fn most_shadow_steps(&self) -> u32 {
        MOST_SHADOW_STEPS
    }

    fn sharpest(&self) -> Option<Scene> {
        let mut sharpest = self.clone();
        sharpest.formula.sharpen();
        Some(sharpest.into())
    }

    fn probed(&self, from: &Viewpoint, _assets: &Assets) -> Option<AnySolid> {
        Some(AnySolid::Distance(self.seen(from)))
    }

    /// The estimate's noise in f32 is about 2e-8 of the coordinates (docs/method.md, 6), and
    /// the coordinates of any orbit are as large as the bounds. A footprint below a hundred
    /// times this noise is damaged.
    fn precision_warning(&self, from: &Viewpoint, view: &View) -> Option<String> {
        let floor = 2e-6 * self.formula.bounds().half.max_element();
        let too_fine = |footprint: f64| footprint < 0.99 * floor;
        // The bound is cheap, but often far too low.
        let bound = self.finest_footprint(from);
        let finest = too_fine(bound).then(|| self.finest_hit(from, view))?;
        too_fine(finest).then(|| {
            format!(
                "the finest footprint, {finest:.1e}, is below the f32 limit of about {floor:.0e}, so the nearest details are noise. Move the camera away, or render with --device cpu"
            )
        })
    }
}
