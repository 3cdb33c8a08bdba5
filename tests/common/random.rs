//! Random numbers that are the same on every machine and in every run.

use glam::DVec3;

/// A 64-bit linear congruential generator (Knuth's MMIX); only its upper bits are used.
pub struct Random(u64);

impl Random {
    /// A generator of its own for each seed.
    pub fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        random.unit();
        random
    }

    /// Uniform in 0..1.
    #[allow(clippy::cast_precision_loss, reason = "24 bits fit")]
    pub fn unit(&mut self) -> f64 {
        let factor = 6_364_136_223_846_793_005;
        let term = 1_442_695_040_888_963_407;
        self.0 = self.0.wrapping_mul(factor).wrapping_add(term);
        (self.0 >> 40) as f64 / 16_777_216.0
    }

    /// Uniform in a range.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// One of so many numbers, from 0.
    pub fn index(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// Uniform in the cube of a half extent.
    pub fn cube(&mut self, half: f64) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| self.between(-half, half)))
    }

    /// A unit vector, every direction as likely.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.cube(1.0);
            if (0.01..1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }
}
