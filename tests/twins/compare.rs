//! The GPU's answers against those of the CPU, quantity by quantity, with a twin that is
//! moved as a negative control.

use std::collections::BTreeMap;

use glam::DVec3;

use super::common::probe::{Errors, Numbers, Probe};
use super::common::random::Random;

/// What is multiplied into a constant to show that a check sees it.
pub const MOVED: f64 = 1.0001;

/// Errors that are allowed: of the median, and of all but one in a hundred.
#[derive(Clone, Copy, Debug)]
pub struct Allowed(pub f64, pub f64);

impl Allowed {
    /// Whether errors are within these.
    pub fn hold(self, errors: Errors) -> bool {
        errors.median <= self.0 && errors.p99 <= self.1
    }
}

/// No error but in one answer of a hundred: decisions agree but for a few at a threshold.
pub const DECIDED: Allowed = Allowed(0.0, 0.0);

/// What is compared: names separated by blanks, the size that errors are relative to where
/// the number itself is smaller, and the errors that are allowed.
pub type Quantities<'a> = &'a [(&'a str, f64, Allowed)];

/// Pairs of got and wanted numbers, by quantity.
#[derive(Default)]
pub struct Pairs(BTreeMap<&'static str, Vec<(f32, f64)>>);

impl Pairs {
    /// Adds a pair of numbers.
    pub fn add(&mut self, quantity: &'static str, got: f32, want: f64) {
        self.0.entry(quantity).or_default().push((got, want));
    }

    /// Adds the pairs of a vector.
    pub fn add_vector(&mut self, quantity: &'static str, got: [f32; 4], want: DVec3) {
        for i in 0..3 {
            self.add(quantity, got[i], want[i]);
        }
    }
}

/// As many questions as quantiles want, at random.
pub fn questions(seed: u64, mut of: impl FnMut(&mut Random) -> Numbers) -> Vec<Numbers> {
    let mut random = Random::new(seed);
    (0..8192).map(|_| of(&mut random)).collect()
}

/// Questions to both sides, what is compared, and the CPU's answers.
pub struct Twins<'a, F> {
    asked: &'a [Numbers],
    quantities: Quantities<'a>,
    pair: F,
}

impl<'a, F: Fn(&mut Pairs, &Numbers, &Numbers)> Twins<'a, F> {
    /// `pair` adds what is wanted to what was got, for a question and the GPU's answer.
    pub fn new(asked: &'a [Numbers], quantities: Quantities<'a>, pair: F) -> Self {
        Self {
            asked,
            quantities,
            pair,
        }
    }

    /// The names of the quantities that a probe has wrong.
    pub fn wrong(&self, what: &str, probe: &Probe) -> Vec<&'a str> {
        let mut pairs = Pairs::default();
        for (question, answer) in self.asked.iter().zip(&probe.ask(self.asked)) {
            (self.pair)(&mut pairs, question, answer);
        }
        let mut wrong = Vec::new();
        for (names, floor, allowed) in self.quantities {
            for name in names.split(' ') {
                let errors = Errors::of(pairs.0[name].iter().copied(), *floor);
                println!("{what}, {name}: {errors}");
                wrong.extend((!allowed.hold(errors)).then_some(name));
            }
        }
        wrong
    }

    /// Asserts that a probe agrees in all quantities, and that each moved one is seen to be
    /// wrong in those that are named with it.
    pub fn assert_agree(&self, what: &str, own: &Probe, moved: &[(&str, Probe)]) {
        assert_eq!(self.wrong(what, own), [""; 0], "{what}");
        for (seen, probe) in moved {
            let wrong = self.wrong("moved", probe);
            for name in seen.split(' ') {
                assert!(wrong.contains(&name), "{what}: a moved {name} is not seen");
            }
        }
    }
}
