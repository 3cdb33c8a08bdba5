//! Heights and ratios as whole numbers, rounded so that no cone becomes wider.
//!
//! A reader may trace with the heights in the file or with those that the map was made
//! from. Ratios are safe for both:
//!
//! - A ratio becomes the largest number that stands for no more than it. (Rounding to
//!   the nearest, as the papers' programs do, widens up to half of all cones.) A number
//!   is read as the largest f32 that is not above its share of 1, so that an EXR holds it
//!   exactly. Maps remember that they were read from numbers, also in EXRs: what was read
//!   from a number becomes the same number again, and no other ratio becomes one that stands
//!   for more. (Shares of 8 bits are shares of 16 bits, and f32 tells all shares of 16 bits
//!   apart, and their squares; but not shares from squares.) So maps may change layouts any
//!   number of times.
//! - A height becomes the smallest number that decodes to no less than it, so that the
//!   surface in the file is never below the true one. But neighbours rise by different
//!   amounts: the height of sample p by `a(p)`, from 0 to one step. A sample q at a
//!   distance d >= m that was `d / R` higher than p is now up to `d / R + s` higher,
//!   where `s` is the largest rise of all less `a(p)`. The widest cone that keeps clear is
//!   the least `d / (d / R + s)` over d, which is at d = m: `R / (1 + s R / m)`.
//!   m is one texel between samples; between cells it is the offset that
//!   their distances include. Heights that the file can hold exactly have rises of 0
//!   and leave the ratios alone.
//!
//! That argument holds for maps of empty cones. For relaxed maps only its first half
//! does: rounding may raise new edges in the surface of the file, which the map does not
//! know. Over the heights that they were made from, relaxed maps stay what they were; over
//! those in the file, which the papers trace them with, a ray may cross more than once.

use crate::heightfield::conemap::file::RatioScale;
use crate::raster::png::BitDepth;

impl BitDepth {
    /// The height that a number stands for: the same as a height map reads.
    pub fn height(self, number: u16) -> f32 {
        (f64::from(number) / f64::from(self.most())) as f32
    }

    /// The smallest number whose height is no less, for heights in 0..=1.
    pub fn height_up(self, height: f32) -> u16 {
        let above = (f64::from(height) * f64::from(self.most())).ceil();
        let mut number = (above as u16).min(self.most());
        // Decoded heights are rounded to f32, so that the quotient may miss by one.
        while number > 0 && self.height(number - 1) >= height {
            number -= 1;
        }
        while number < self.most() && self.height(number) < height {
            number += 1;
        }
        number
    }

    /// The nearest number to a share of 0..=1, for shading channels.
    pub fn nearest(self, share: f64) -> u16 {
        // The cast saturates, and NaN becomes 0.
        (share.clamp(0.0, 1.0) * f64::from(self.most()) + 0.5) as u16
    }
}

/// How a channel of whole numbers stands for ratios.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratios {
    /// The numbers.
    pub bits: BitDepth,
    /// How they stand for ratios.
    pub scaling: RatioScale,
    /// Texels that a ratio of 1 in the file means.
    pub scale: f64,
    /// Whether the ratios were read from such numbers.
    pub reread: bool,
}

impl Ratios {
    /// The share of 1 that a number stands for.
    fn share(self, number: u16) -> f64 {
        let share = f64::from(number) / f64::from(self.bits.most());
        match self.scaling {
            RatioScale::Sqrt => share * share,
            RatioScale::Linear => share,
        }
    }

    /// The ratio in texels that a number is read as.
    pub fn ratio(self, number: u16) -> f64 {
        f64::from(share_down(self.share(number), 1.0)) * self.scale
    }

    /// The largest number that stands for no more than a ratio; if ratios were read from such
    /// numbers, the number that was read as this ratio.
    pub fn ratio_down(self, ratio: f64) -> u16 {
        let share = (ratio / self.scale).clamp(0.0, 1.0);
        let share = match self.scaling {
            RatioScale::Sqrt => share.sqrt(),
            RatioScale::Linear => share,
        };
        let most = self.bits.most();
        let mut number = (share * f64::from(most)).floor() as u16;
        // The quotient and the root may miss by one either way.
        while number < most && self.share(number + 1) * self.scale <= ratio {
            number += 1;
        }
        while number > 0 && self.share(number) * self.scale > ratio {
            number -= 1;
        }
        let was_read = self.reread && number < most && self.ratio(number + 1) == ratio;
        if was_read { number + 1 } else { number }
    }
}

/// The largest f32 share whose ratio `share * scale` is no more than a ratio.
pub fn share_down(ratio: f64, scale: f64) -> f32 {
    let mut share = (ratio / scale) as f32;
    // The nearest f32 is at most one off.
    while share > 0.0 && f64::from(share) * scale > ratio {
        share = share.next_down();
    }
    share.max(0.0)
}

/// The ratio of a cone that stays empty when other places, all at least `nearest` texels away,
/// may rise by `slack` more than the apex.
pub fn narrowed(ratio: f64, slack: f64, nearest: f64) -> f64 {
    if slack <= 0.0 {
        return ratio;
    }
    if nearest <= 0.0 {
        return 0.0;
    }
    // A few roundings of f64 must not widen it.
    ratio / (1.0 + slack * ratio / nearest) * (1.0 - 4.0 * f64::EPSILON)
}
