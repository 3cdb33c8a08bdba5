//! Patterns as one word: `fbm`, `fbm:512x256`, or `ridges:512x512,seed=7,power=2.2`.
//!
//! After the name and a colon follow, in any order and separated by commas, the size,
//! `seed=N` and `power=P`. The defaults are 256x256, 1 and 2.6.

use std::fmt;

use crate::base::units::{size, whole};
use crate::heightfield::{heights::MOST_SAMPLES, pattern::Pattern};

/// A pattern with everything that decides its heights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatternSpec {
    /// The pattern.
    pub field: Pattern,
    /// Samples along each axis.
    pub size: [u32; 2],
    /// Seed of its random numbers.
    pub seed: u32,
    /// Exponent by which the power of the waves falls with the wave number.
    pub power: f64,
}

/// Useful exponents: from white noise to one smooth hill.
const POWERS: std::ops::RangeInclusive<f64> = 0.0..=8.0;

impl PatternSpec {
    /// A pattern with the default size, seed and power.
    pub fn new(field: Pattern) -> Self {
        Self {
            field,
            size: [256, 256],
            seed: 1,
            // Rough terrain.
            power: 2.6,
        }
    }

    /// Reads the word; `None` if it does not begin with the name of a pattern.
    ///
    /// # Errors
    /// In words: what follows the colon is wrong.
    pub fn read(text: &str) -> Option<Result<Self, String>> {
        let (name, rest) = match text.split_once(':') {
            Some((name, rest)) => (name, Some(rest)),
            None => (text, None),
        };
        let named = Self::new(Pattern::named(name)?);
        Some(rest.map_or(Ok(named), |rest| named.with(rest)))
    }

    fn with(mut self, rest: &str) -> Result<Self, String> {
        for part in rest.split(',') {
            match part.split_once('=') {
                Some(("seed", n)) => {
                    let why = || format!("seed={n} is not a whole number from 0 to {}", u32::MAX);
                    self.seed = whole(n).ok_or_else(why)?;
                }
                Some(("power", p)) => {
                    let read: Option<f64> = p.parse().ok().filter(|p| POWERS.contains(p));
                    let (low, high) = (POWERS.start(), POWERS.end());
                    let why = || format!("power={p} is not a number from {low} to {high}");
                    self.power = read.ok_or_else(why)?;
                }
                None if part.contains(['x', 'X']) => self.size = read_size(part)?,
                _ => {
                    return Err(format!(
                        "`{part}` is not a size, seed or power; write {}:512x512,seed=7,power=2.2",
                        self.field.name()
                    ));
                }
            }
        }
        Ok(self)
    }
}

impl fmt::Display for PatternSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [w, h] = self.size;
        write!(f, "{}:{w}x{h},seed={}", self.field.name(), self.seed)?;
        match self.field {
            Pattern::Spikes | Pattern::Checker | Pattern::Sine | Pattern::Noise => Ok(()),
            _ => write!(f, ",power={}", self.power),
        }
    }
}

/// Reads `512x256` as samples along each axis.
///
/// # Errors
/// In words: the text has another form, or a side is out of range.
pub(crate) fn read_size(text: &str) -> Result<[u32; 2], String> {
    size(text, MOST_SAMPLES).ok_or_else(|| {
        format!(
            "`{text}` is not a size: width x height, each from 1 to {MOST_SAMPLES}, like 512x256"
        )
    })
}
