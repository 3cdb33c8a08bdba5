//! How a surface reflects light: a diffuse base under a coat of tiny mirrors (GGX, with Smith's
//! correlated shadowing and Schlick's Fresnel term). Light that goes from mirror to mirror is given
//! back (Turquin, Practical multiple scattering compensation for microfacet models, 2019), and
//! the base gets what the coat lets through. So only the albedo absorbs light.
//!
//! Vectors are in the frame of the surface, whose normal is z. Twin: `wgsl/pass/material.wgsl`.

use std::f64::consts::PI;
use std::sync::{Arc, Mutex, PoisonError};

use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec2, DVec3, Vec4};

use crate::base::random::random_pair;
use crate::plan::look::Look;

/// Directions of the table of shares. The square root of `v.z` is evenly spaced.
const DIRECTIONS: usize = 64;
/// Mirrors per direction: their mean is off by less than 1e-3.
const MIRRORS: u32 = 1024;

/// The material as WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct MaterialUniform {
    /// The square of the roughness.
    pub alpha: f32,
    /// 0 for a coat over a base, 1 for a bare metal.
    pub metal: f32,
    /// What the coat reflects of light along the normal.
    pub specular: f32,
    /// Unused.
    pub pad: u32,
    /// The table of shares, two directions to an entry.
    pub shares: [Vec4; 32],
}

/// What all surfaces of a picture are made of, but for their albedo.
#[derive(Clone, Debug, PartialEq)]
pub struct Substance {
    /// The square of the roughness, from 0.0025 to 1.
    pub alpha: f64,
    /// 0 for a coat over a base, 1 for a bare metal.
    pub metal: f64,
    /// What the coat reflects of light along the normal, from 0 to 1.
    pub specular: f64,
    /// The share of light that mirrors without absorption reflect, without and with the factor
    /// `(1 - v.h)^5`, for each direction.
    shares: Arc<[DVec2]>,
}

/// The latest table of shares and its `alpha`: plans that follow one another mostly have the same.
static LATEST: Mutex<Option<(f64, Arc<[DVec2]>)>> = Mutex::new(None);

/// A point of a surface seen from a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Albedo of the base.
    pub base: DVec3,
    /// What a mirror reflects along its normal, with what goes from mirror to mirror.
    mirror: DVec3,
    /// The same at grazing angles.
    grazing: DVec3,
    /// The share of light from all sides that the coat sends towards the direction.
    pub coat: DVec3,
    /// The share of the next rays that mirrors choose.
    chosen: f64,
}

/// A direction to the eye in the frame of a surface. Its z is at least 1e-3, as the normal of a rough
/// surface may face away from the eye.
pub fn material_view(v: DVec3) -> DVec3 {
    v.truncate().extend(v.z.max(1e-3)).normalize()
}

/// The unit vector at an angle, in turns.
pub fn material_turn(turns: f64) -> DVec2 {
    DVec2::from_angle(2.0 * PI * turns)
}

/// A vector of length 1 along a direction across which it is stretched.
fn stretched(v: DVec3, alpha: f64) -> DVec3 {
    DVec3::new(alpha * v.x, alpha * v.y, v.z).normalize()
}

/// `sqrt(z^2 + alpha^2 (1 - z^2))`, a part of Smith's shadowing.
fn smith(z: f64, aa: f64) -> f64 {
    (z * z * (1.0 - aa) + aa).sqrt()
}

/// What mirrors reflect along their normal and at grazing angles, given the first.
fn material_coat(specular: DVec3, all: f64) -> [DVec3; 2] {
    let again = 1.0 + specular * ((1.0 - all) / all);
    // Without a coat there is nothing at grazing angles either.
    let grazing = (50.0 * specular.max_element()).min(1.0);
    [specular * again, grazing * again]
}

/// The normal of a mirror that is seen from `v` (Dupuy and Benyoub, Sampling visible GGX normals
/// with spherical caps, 2023).
fn material_mirror(alpha: f64, v: DVec3, pair: DVec2) -> DVec3 {
    let s = stretched(v, alpha);
    let z = (1.0 - pair.y) * (1.0 + s.z) - s.z;
    let cap = (1.0 - z * z).clamp(0.0, 1.0).sqrt() * material_turn(pair.x);
    stretched(cap.extend(z) + s, alpha)
}

/// The share of light that mirrors without absorption reflect towards directions: the table of
/// [`Substance`].
fn shares_of(alpha: f64) -> Arc<[DVec2]> {
    let mut latest = LATEST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, shares)) = latest.as_ref().filter(|(of, _)| *of == alpha) {
        return Arc::clone(shares);
    }
    let pairs: Vec<DVec2> = (0..MIRRORS).map(|i| random_pair(0, i, 0)).collect();
    let aa = alpha * alpha;
    let share = |i: usize| {
        let x = i as f64 / (DIRECTIONS - 1) as f64;
        let z = (x * x).max(1e-5);
        let v = DVec3::new((1.0 - z * z).sqrt(), 0.0, z);
        let mut sum = DVec2::ZERO;
        for pair in &pairs {
            let h = material_mirror(alpha, v, *pair);
            let l = 2.0 * v.dot(h) * h - v;
            if l.z > 0.0 {
                let (sv, sl) = (smith(v.z, aa), smith(l.z, aa));
                let weight = l.z * (v.z + sv) / (l.z * sv + v.z * sl);
                let grazing = (1.0 - v.dot(h)).clamp(0.0, 1.0).powi(5);
                sum += weight * DVec2::new(1.0 - grazing, grazing);
            }
        }
        sum / f64::from(MIRRORS)
    };
    let shares: Arc<[DVec2]> = (0..DIRECTIONS).map(share).collect();
    *latest = Some((alpha, Arc::clone(&shares)));
    shares
}

impl Substance {
    /// The substance of a look.
    pub fn of(look: &Look) -> Self {
        let alpha = look.roughness * look.roughness;
        Self {
            alpha,
            metal: look.metal,
            // The usual 4 % for the default.
            specular: (0.5 * look.gloss).min(1.0),
            shares: shares_of(alpha),
        }
    }

    /// The values of the WGSL struct.
    pub fn uniform(&self) -> MaterialUniform {
        let mut shares = [Vec4::ZERO; DIRECTIONS / 2];
        for (to, from) in shares.iter_mut().zip(self.shares.chunks(2)) {
            let [one, two] = [from[0].as_vec2(), from[1].as_vec2()];
            *to = Vec4::new(one.x, one.y, two.x, two.y);
        }
        MaterialUniform {
            alpha: self.alpha as f32,
            metal: self.metal as f32,
            specular: self.specular as f32,
            pad: 0,
            shares,
        }
    }

    /// The entry of the table for a direction.
    fn share(&self, v: DVec3) -> DVec2 {
        let at = v.z.clamp(0.0, 1.0).sqrt() * (DIRECTIONS - 1) as f64;
        let i = (at as usize).min(DIRECTIONS - 2);
        self.shares[i].lerp(self.shares[i + 1], at - i as f64)
    }

    /// The point of a surface of an albedo, seen from a direction.
    pub fn material_at(&self, albedo: DVec3, v: DVec3) -> Material {
        let share = self.share(v);
        let all = share.x + share.y;
        let paint = material_coat(DVec3::splat(self.specular), all);
        let bare = material_coat(albedo, all);
        let passed = DVec3::ONE - paint[0] * share.x - paint[1] * share.y;
        let base = (1.0 - self.metal) * albedo * passed.max(DVec3::ZERO);
        let [mirror, grazing] = [0, 1].map(|i| paint[i].lerp(bare[i], self.metal));
        let coat = mirror * share.x + grazing * share.y;
        let [of_coat, of_base] = [coat, base].map(DVec3::element_sum);
        Material {
            base,
            mirror,
            grazing,
            coat,
            chosen: of_coat / (of_coat + of_base).max(1e-20),
        }
    }

    /// The share of light from a direction that leaves towards `v`, times the cosine: the
    /// reflectance times `l.z`; and the density of the directions of
    /// [`material_scatter`](Self::material_scatter). Light of a disc, `radius` the tangent of its angular
    /// radius, comes from its centre, and mirrors are rougher by that. Then the density is of no use.
    pub fn material_reflects(
        &self,
        material: &Material,
        v: DVec3,
        l: DVec3,
        radius: f64,
    ) -> (DVec3, f64) {
        let diffuse = l.z / PI;
        if material.chosen == 0.0 {
            return (material.base * diffuse, diffuse);
        }
        let h = (v + l).normalize();
        let aa = (self.alpha * self.alpha + 0.25 * radius * radius).min(1.0);
        let spread = aa * h.z * h.z + h.truncate().length_squared();
        let density = aa / (PI * spread * spread);
        let (sv, sl) = (smith(v.z, aa), smith(l.z, aa));
        let seen = 0.5 / (l.z * sv + v.z * sl);
        let grazing = (1.0 - v.dot(h)).clamp(0.0, 1.0).powi(5);
        let fresnel = material.mirror.lerp(material.grazing, grazing);
        let coat = fresnel * (density * seen * l.z);
        let mirrored = density * 0.5 / (v.z + sv);
        let all = diffuse + (mirrored - diffuse) * material.chosen;
        (material.base * diffuse + coat, all)
    }

    /// A direction in which light may come that leaves towards `v`, and below 0 along z for none.
    /// `pair` and `choice` are from 0 to 1.
    pub fn material_scatter(
        &self,
        material: &Material,
        v: DVec3,
        pair: DVec2,
        choice: f64,
    ) -> DVec3 {
        if choice < material.chosen {
            let h = material_mirror(self.alpha, v, pair);
            return 2.0 * v.dot(h) * h - v;
        }
        (pair.y.sqrt() * material_turn(pair.x)).extend((1.0 - pair.y).sqrt())
    }
}

/// Two unit vectors across a unit normal (Duff et al., Building an orthonormal basis, revisited,
/// 2017), and the normal.
pub fn material_frame(n: DVec3) -> DMat3 {
    let sign = if n.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    let x = DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    let y = DVec3::new(b, sign + n.y * n.y * a, -n.y);
    DMat3::from_cols(x, y, n)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A white surface in white light is white, from any side, smooth or rough, coated or bare: the
    /// mean of what a path is multiplied by is 1.
    #[test]
    fn a_white_surface_loses_no_light() {
        for roughness in [0.05, 0.1, 0.2, 0.45, 0.7, 1.0] {
            for (metal, gloss) in [
                (0.0, 0.0),
                (0.0, 0.08),
                (0.5, 0.08),
                (1.0, 0.08),
                (0.0, 2.0),
            ] {
                let look = Look {
                    roughness,
                    metal,
                    gloss,
                    ..Look::default()
                };
                let substance = Substance::of(&look);
                for z in [0.05, 0.2, 0.5, 0.8, 1.0_f64] {
                    let v = DVec3::new((1.0 - z * z).sqrt(), 0.0, z);
                    let material = substance.material_at(DVec3::ONE, v);
                    let n = 1 << 14;
                    let mut mean = 0.0;
                    for i in 0..n {
                        let choice = random_pair(1, i, 1).x;
                        let pair = random_pair(1, i, 2);
                        let l = substance.material_scatter(&material, v, pair, choice);
                        if l.z > 0.0 {
                            let (light, density) =
                                substance.material_reflects(&material, v, l, 0.0);
                            mean += light.x / density / f64::from(n);
                        }
                    }
                    let of = (roughness, metal, gloss, z);
                    assert!((mean - 1.0).abs() < 5e-3, "{of:?}: {mean}");
                }
            }
        }
    }

    /// A smooth mirror shows the disc of a light as bright as it is.
    #[test]
    fn a_mirrored_disc_is_as_bright_as_the_light() {
        let look = Look {
            roughness: 0.05,
            metal: 1.0,
            ..Look::default()
        };
        let substance = Substance::of(&look);
        let material = substance.material_at(DVec3::ONE, DVec3::Z);
        for radius in [0.05, 0.2] {
            let (light, _) = substance.material_reflects(&material, DVec3::Z, DVec3::Z, radius);
            let bright = light.x * PI * radius * radius;
            assert!((bright - 1.0).abs() < 0.02, "{radius}: {bright}");
        }
    }

    #[test]
    fn the_frame_of_a_normal_is_orthonormal() {
        for n in [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(0.6, -0.48, -0.64)] {
            let frame = material_frame(n);
            assert!((frame.transpose() * frame).abs_diff_eq(DMat3::IDENTITY, 1e-12));
            assert_eq!(frame.z_axis, n);
        }
    }
}
