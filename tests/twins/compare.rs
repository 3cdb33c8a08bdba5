//! The GPU's answers against those of the CPU, quantity by quantity, with a twin that is
//! moved as a negative control.

use std::collections::BTreeMap;

use glam::DVec3;

use super::common::probe::{Errors, Numbers, Probe};

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

/// What is compared: its name, the size that errors are relative to where the number itself
/// is smaller, and the errors that are allowed.
pub type Quantity = (&'static str, f64, Allowed);

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

/// Questions to both sides, and the CPU's answers to them.
pub struct Twins<'a, F: Fn(&mut Pairs, &Numbers, &Numbers)> {
    /// What is asked.
    pub asked: &'a [Numbers],
    /// What is compared.
    pub quantities: &'a [Quantity],
    /// Adds what is wanted to what was got: pairs, question and the GPU's answer.
    pub pair: F,
}

impl<F: Fn(&mut Pairs, &Numbers, &Numbers)> Twins<'_, F> {
    /// The errors of a probe, in the order of the quantities.
    fn errors(&self, probe: &Probe) -> Vec<Errors> {
        let mut pairs = Pairs::default();
        for (question, answer) in self.asked.iter().zip(&probe.ask(self.asked)) {
            (self.pair)(&mut pairs, question, answer);
        }
        let of = |(name, floor, _): &Quantity| Errors::of(pairs.0[name].iter().copied(), *floor);
        self.quantities.iter().map(of).collect()
    }

    /// The names of the quantities that a probe has wrong.
    pub fn wrong(&self, what: &str, probe: &Probe) -> Vec<&'static str> {
        let pairs = self.quantities.iter().zip(self.errors(probe));
        let broken = |(quantity, errors): (&Quantity, Errors)| {
            println!("{what}, {}: {errors}", quantity.0);
            (!quantity.2.hold(errors)).then_some(quantity.0)
        };
        pairs.filter_map(broken).collect()
    }

    /// Asserts that a probe agrees in all quantities, and that each moved one is seen to be
    /// wrong in those that are named with it.
    pub fn assert_agree(&self, what: &str, own: &Probe, moved: &[(Probe, &[&str])]) {
        assert_eq!(self.wrong(what, own), [""; 0], "{what}");
        for (probe, seen) in moved {
            let wrong = self.wrong("moved", probe);
            for name in *seen {
                assert!(wrong.contains(name), "{what}: a moved {name} is not seen");
            }
        }
    }
}
