// Numbers that look random and are spread evenly: the Sobol sequence in pairs, shuffled and
// scrambled for each pixel and each purpose (Burley, Practical hash-based Owen scrambling, JCGT
// 2020). Any count of samples is spread evenly, and pairs of two purposes are independent.

/// A hash of 32 bits (Wellons, lowbias32).
fn random_hash(x: u32) -> u32 {
    var h = x;
    h = (h ^ (h >> 16u)) * 0x7feb352du;
    h = (h ^ (h >> 15u)) * 0x846ca68bu;
    return h ^ (h >> 16u);
}

fn random_seed(pixel: vec2<u32>) -> u32 {
    return random_hash(pixel.x ^ random_hash(pixel.y));
}

/// Owen's scrambling of a number whose bits are reversed: each bit is flipped or not by a hash of the
/// bits below it (Laine and Karras, with Burley's constants).
fn random_scramble(x: u32, seed: u32) -> u32 {
    var v = x + seed;
    v ^= v * 0x6c50b47cu;
    v ^= v * 0xb82f1e52u;
    v ^= v * 0xc7afe638u;
    return v ^ (v * 0x8d22f6e6u);
}

/// Two numbers from 0 to below 1 for a sample and a purpose, with 24 bits each.
fn random_pair(seed: u32, sample: u32, purpose: u32) -> vec2<f32> {
    let key = random_hash(seed ^ (purpose * 0x9e3779b9u));
    let index = reverseBits(random_scramble(reverseBits(sample), key));
    // The second dimension is Pascal's triangle modulo 2 times the bits of the index.
    var other = index;
    other ^= (other >> 16u) & 0x0000ffffu;
    other ^= (other >> 8u) & 0x00ff00ffu;
    other ^= (other >> 4u) & 0x0f0f0f0fu;
    other ^= (other >> 2u) & 0x33333333u;
    other ^= (other >> 1u) & 0x55555555u;
    let x = reverseBits(random_scramble(index, random_hash(key + 1u)));
    let y = reverseBits(random_scramble(other, random_hash(key + 2u)));
    return vec2<f32>(vec2<u32>(x, y) >> vec2<u32>(8u)) / 16777216.0;
}
