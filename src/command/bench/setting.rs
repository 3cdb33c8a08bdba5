//! The settings that `bench error` measures: every mode without changes, and sweeps that
//! change one key of `[march]` or `[scene]` at a time.

use serde_json::{Map, json};
use toml::Value;

use crate::plan::Plan;
use crate::plan::march::Mode;

/// A mode, and keys of `[march]` or `[scene]` that are changed.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The mode.
    pub mode: Mode,
    /// The changed keys with their values.
    pub changes: Vec<(&'static str, Value)>,
}

impl Setting {
    /// A mode without changes.
    pub fn of(mode: Mode) -> Self {
        let changes = Vec::new();
        Self { mode, changes }
    }

    /// The mode without cones that starts its rays at the bounds.
    pub fn rival() -> Self {
        Self {
            mode: Mode::RayRelaxed,
            changes: vec![("clip", "on".into())],
        }
    }

    /// The rival with the estimate `scalar`.
    pub fn old_rival() -> Self {
        let mut rival = Self::rival();
        rival.changes.push(("estimate", "scalar".into()));
        rival
    }

    /// The mode's name, or `rival`, or `old rival`.
    pub fn name(&self) -> &'static str {
        match &self.changes[..] {
            [("clip", _)] if self.mode == Mode::RayRelaxed => "rival",
            [("clip", _), ("estimate", _)] => "old rival",
            _ => self.mode.name(),
        }
    }

    /// A plan with the setting, if it fits.
    pub fn apply(&self, plan: &Plan) -> Option<Plan> {
        let mut plan = plan.clone();
        plan.march.mode = self.mode;
        for (name, value) in &self.changes {
            let mut keys = plan.march.keys();
            keys.extend(plan.scene.keys());
            let key = keys.iter_mut().find(|k| k.name == *name)?;
            key.slot.set(value).ok()?;
            drop(keys);
        }
        plan.check().is_ok().then_some(plan)
    }

    /// The changes as JSON.
    pub fn parameters(&self) -> Map<String, serde_json::Value> {
        let pair = |(name, value): &(&str, Value)| ((*name).to_string(), json!(value));
        self.changes.iter().map(pair).collect()
    }
}

/// The *rival*, which the others are compared with, every mode without changes, and the old rival.
/// The rival has no cones, but the same estimate and relaxation as `safe`, and its rays start at the
/// bounds. The truth is left out: all are measured against it.
pub fn baselines() -> Vec<Setting> {
    let first = [Mode::Safe, Mode::Proven, Mode::Ray, Mode::RayRelaxed];
    let rest = Mode::ALL.into_iter();
    let rest = rest.filter(|m| !first.contains(m) && *m != Mode::Truth);
    let modes = first.into_iter().chain(rest).map(Setting::of);
    let mut all = vec![Setting::rival()];
    all.extend(modes);
    all.push(Setting::old_rival());
    all
}

/// One key changed at a time.
pub fn sweeps() -> Vec<Setting> {
    const FUDGES: [&[f64]; 4] = [&[0.9], &[0.8], &[0.6], &[1.0, 1.0, 0.8, 0.6]];
    let swept: [(Mode, &'static str, Vec<Value>); 8] = [
        (Mode::Safe, "coarsest", values([32, 8, 4, 2])),
        (Mode::Safe, "shell", values([0.0, 0.15, 0.3, 0.6, 0.8])),
        (
            Mode::Safe,
            "relaxation",
            vec!["off".into(), 1.2.into(), 1.5.into()],
        ),
        (Mode::Safe, "steps", values([16, 64, 1024])),
        (Mode::Safe, "lipschitz", values([1.1, 1.25, 1.45])),
        (
            Mode::Calibrated,
            "fudge",
            values(FUDGES.map(<[f64]>::to_vec)),
        ),
        (Mode::Safe, "detail", values([0.5, 2.0])),
        (Mode::Ray, "clip", values(["on"])),
    ];
    let settings = swept.into_iter().flat_map(|(mode, key, values)| {
        let changes = values.into_iter().map(move |value| vec![(key, value)]);
        changes.map(move |changes| Setting { mode, changes })
    });
    settings.collect()
}

fn values<const N: usize>(list: [impl Into<Value>; N]) -> Vec<Value> {
    list.map(Into::into).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset;

    #[test]
    fn every_setting_fits_the_benchmarks_and_changes_them() {
        let plan = preset::load("bench-far", &[]).expect("built in").plan;
        let mut seen = vec![plan.clone()];
        let all = baselines().into_iter().chain(sweeps());
        for setting in all.filter(|s| s.mode != Mode::Safe || !s.changes.is_empty()) {
            let changed = setting.apply(&plan).expect("fits");
            assert!(!seen.contains(&changed), "{setting:?}");
            seen.push(changed);
        }
        let wrong = Setting {
            mode: Mode::Safe,
            changes: vec![("shell", 2.0.into())],
        };
        assert!(wrong.apply(&plan).is_none());
    }
}
