//! The settings that `bench error` measures: every mode without changes, and sweeps that
//! change one key of `[march]` at a time.

use serde_json::{Map, json};
use toml::Value;

use crate::plan::Plan;
use crate::plan::march::Mode;

/// A mode, and keys of `[march]` that are changed.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The mode.
    pub mode: Mode,
    /// Keys and values.
    pub changes: Vec<(&'static str, Value)>,
}

impl Setting {
    /// A mode without changes.
    pub fn of(mode: Mode) -> Self {
        Self {
            mode,
            changes: Vec::new(),
        }
    }

    fn new(mode: Mode, key: &'static str, value: impl Into<Value>) -> Self {
        Self {
            mode,
            changes: vec![(key, value.into())],
        }
    }

    /// A plan with the setting, if it fits.
    pub fn apply(&self, plan: &Plan) -> Option<Plan> {
        let mut plan = plan.clone();
        plan.march.mode = self.mode;
        for (name, value) in &self.changes {
            let mut keys = plan.march.keys();
            let key = keys.iter_mut().find(|k| k.name == *name)?;
            key.slot.set(value).ok()?;
        }
        plan.check().is_ok().then_some(plan)
    }

    /// The changes as JSON.
    pub fn parameters(&self) -> Map<String, serde_json::Value> {
        let pair = |(name, value): &(&str, Value)| ((*name).to_string(), json!(value));
        self.changes.iter().map(pair).collect()
    }
}

/// Every mode without changes; `ray` first, which the others are compared with. The truth is
/// left out: all are measured against it.
pub fn baselines() -> Vec<Setting> {
    let first = [Mode::Ray, Mode::RayRelaxed, Mode::Safe];
    let rest = Mode::ALL.into_iter();
    let rest = rest.filter(|m| !first.contains(m) && *m != Mode::Truth);
    first.into_iter().chain(rest).map(Setting::of).collect()
}

/// One key changed at a time.
pub fn sweeps() -> Vec<Setting> {
    let safe = |key, value: Value| Setting::new(Mode::Safe, key, value);
    let mut all = Vec::new();
    for divisor in [32, 8, 4, 2] {
        all.push(safe("coarsest", Value::Integer(divisor)));
    }
    for shell in [0.0, 0.15, 0.3, 0.6, 0.8] {
        all.push(safe("shell", Value::Float(shell)));
    }
    all.push(safe("relaxation", "off".into()));
    for factor in [1.2, 1.5] {
        all.push(safe("relaxation", Value::Float(factor)));
    }
    for steps in [16, 64, 1024] {
        all.push(safe("steps", Value::Integer(steps)));
    }
    for schedule in [&[0.9][..], &[0.8], &[0.6], &[1.0, 1.0, 0.8, 0.6]] {
        all.push(Setting::new(Mode::Calibrated, "fudge", schedule.to_vec()));
    }
    for detail in [0.5, 2.0] {
        all.push(safe("detail", Value::Float(detail)));
    }
    for mode in [Mode::Ray, Mode::RayRelaxed] {
        all.push(Setting::new(mode, "clip", "on"));
    }
    all
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
        let wrong = Setting::new(Mode::Safe, "shell", 2.0);
        assert!(wrong.apply(&plan).is_none());
    }
}
