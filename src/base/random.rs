//! Numbers that look random and are spread evenly: the Sobol sequence in pairs, shuffled and
//! scrambled for each pixel and each purpose (Burley, Practical hash-based Owen scrambling, JCGT
//! 2020). Any count of samples is spread evenly, and pairs of two purposes are independent.
//!
//! Both executors get the same numbers. Twin: `wgsl/base/random.wgsl`.

use glam::DVec2;

/// A hash of 32 bits (Wellons, lowbias32).
fn random_hash(x: u32) -> u32 {
    let mut h = x;
    h = (h ^ (h >> 16)).wrapping_mul(0x7FEB_352D);
    h = (h ^ (h >> 15)).wrapping_mul(0x846C_A68B);
    h ^ (h >> 16)
}

/// The seed of a pixel.
pub fn random_seed([x, y]: [u32; 2]) -> u32 {
    random_hash(x ^ random_hash(y))
}

/// Owen's scrambling of a number whose bits are reversed: each bit is flipped or not by a hash of the
/// bits below it (Laine and Karras, with Burley's constants).
fn random_scramble(x: u32, seed: u32) -> u32 {
    let by = [0x6C50_B47C, 0xB82F_1E52, 0xC7AF_E638, 0x8D22_F6E6];
    let start = x.wrapping_add(seed);
    by.into_iter()
        .fold(start, |v: u32, by| v ^ v.wrapping_mul(by))
}

/// Two numbers from 0 to below 1 for a sample and a purpose, with 24 bits each.
pub fn random_pair(seed: u32, sample: u32, purpose: u32) -> DVec2 {
    let key = random_hash(seed ^ purpose.wrapping_mul(0x9E37_79B9));
    let index = random_scramble(sample.reverse_bits(), key).reverse_bits();
    // The second dimension is Pascal's triangle modulo 2 times the bits of the index.
    let mut other = index;
    other ^= (other >> 16) & 0x0000_FFFF;
    other ^= (other >> 8) & 0x00FF_00FF;
    other ^= (other >> 4) & 0x0F0F_0F0F;
    other ^= (other >> 2) & 0x3333_3333;
    other ^= (other >> 1) & 0x5555_5555;
    let at = |bits: u32, nth: u32| {
        let seed = random_hash(key.wrapping_add(nth));
        f64::from(random_scramble(bits, seed).reverse_bits() >> 8) / f64::from(1 << 24)
    };
    DVec2::new(at(index, 1), at(other, 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In each power of two of samples, every box of that area with sides of powers of two has one
    /// of them: the sequence is a (0, 2)-sequence, which scrambling keeps.
    #[test]
    fn every_box_has_its_share() {
        for (pixel, purpose) in [([0, 0], 0), ([7, 1999], 3), ([40_000, 5], 61)] {
            let seed = random_seed(pixel);
            for power in [4, 7] {
                let n = 1_u32 << power;
                let pairs: Vec<DVec2> = (0..n).map(|i| random_pair(seed, i, purpose)).collect();
                for across in 0..=power {
                    let [w, h] = [1 << across, n >> across];
                    let mut seen = vec![0; n as usize];
                    for p in &pairs {
                        let at = |x: f64, n: u32| (x * f64::from(n)) as u32;
                        seen[(at(p.x, w) * h + at(p.y, h)) as usize] += 1;
                    }
                    assert!(seen.iter().all(|n| *n == 1), "{pixel:?} {w} x {h}");
                }
            }
        }
    }

    #[test]
    fn purposes_and_pixels_are_independent() {
        let n = 4096;
        let product = |a: fn(u32) -> DVec2, b: fn(u32) -> DVec2| {
            let of = |i: u32| (a(i) - 0.5).x * (b(i) - 0.5).x;
            (0..n).map(of).sum::<f64>() / f64::from(n)
        };
        let one = |i| random_pair(random_seed([3, 4]), i, 0);
        // The spread of a mean of 4096 such products is 0.0013.
        assert!(product(one, |i| random_pair(random_seed([3, 4]), i, 1)).abs() < 0.005);
        assert!(product(one, |i| random_pair(random_seed([4, 4]), i, 0)).abs() < 0.005);
        assert!(product(one, one) > 0.08);
    }
}
