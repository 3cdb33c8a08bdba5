//! From light to display values: exposure, white balance, saturation, and a tone map.
//!
//! *Filmic* and *none* work on each channel alone, so a table on the device has the bytes of the
//! file ([`tone`](crate::pass::tone)). The other maps mix channels, and so does a white balance.
//! Twin: `wgsl/pass/tone_map.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec2, DVec3, Vec3};

use crate::base::srgb::{LUMA, srgb};
use crate::pass::look::tone;
use crate::plan::look::{DAYLIGHT, Look, ToneMap};

/// The brightest light that maps see. All are white there, and squares do not overflow in f32.
const MOST_LIGHT: f64 = 1e6;

/// Linear sRGB to CIE XYZ, white at a luminance of 1 (IEC 61966-2-1).
const TO_XYZ: DMat3 = DMat3::from_cols(
    DVec3::new(0.412_390_8, 0.212_639_0, 0.019_330_8),
    DVec3::new(0.357_584_3, 0.715_168_7, 0.119_194_8),
    DVec3::new(0.180_480_8, 0.072_192_3, 0.950_532_2),
);

/// CIE XYZ to the responses that the Bradford adaptation scales (Lam 1985).
const BRADFORD: DMat3 = DMat3::from_cols(
    DVec3::new(0.8951, -0.7502, 0.0389),
    DVec3::new(0.2664, 1.7135, -0.0685),
    DVec3::new(-0.1614, 0.0367, 1.0296),
);

/// What tone maps read on a device.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ToneUniform {
    /// Rows of white balance and saturation.
    pub red: Vec3,
    /// The position of the map in [`ToneMap::ALL`].
    pub map: u32,
    /// The second row.
    pub green: Vec3,
    /// 1 if channels are mixed.
    pub mixes: u32,
    /// The third row.
    pub blue: Vec3,
    /// The factor of exposure, if channels are mixed.
    pub exposure: f32,
}

/// The way from light to display values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tone {
    /// The curve.
    pub map: ToneMap,
    /// The factor of exposure.
    pub exposure: f64,
    /// White balance and saturation.
    balance: DMat3,
    /// Whether a channel depends on the others.
    pub mixes: bool,
}

impl Tone {
    /// The tone of a look.
    pub fn of(look: &Look) -> Self {
        let is_mixing = !matches!(look.tone, ToneMap::Filmic | ToneMap::None);
        let balanced = look.white != DAYLIGHT || look.saturation != 1.0;
        let grey = DMat3::from_cols(LUMA, LUMA, LUMA).transpose();
        let saturation = grey + (DMat3::IDENTITY - grey) * look.saturation;
        let white = match look.white == DAYLIGHT {
            true => DMat3::IDENTITY,
            false => white_balance(look.white),
        };
        Self {
            map: look.tone,
            exposure: look.exposure.exp2(),
            balance: saturation * white,
            mixes: is_mixing || balanced,
        }
    }

    /// Radiance as display values from 0 to 1, encoded for an sRGB screen.
    ///
    /// ```
    /// # use conemarch::{pass::tone_map::Tone, plan::look::Look};
    /// # use glam::DVec3;
    /// let tone = Tone::of(&Look::default());
    /// assert_eq!(tone.shown(DVec3::ZERO), DVec3::ZERO);
    /// assert!(tone.shown(DVec3::splat(1e9)).abs_diff_eq(DVec3::ONE, 1e-12));
    /// ```
    pub fn shown(&self, c: DVec3) -> DVec3 {
        if !self.mixes {
            return self.channels((c * self.exposure).min(DVec3::splat(MOST_LIGHT)));
        }
        let most = DVec3::splat(MOST_LIGHT);
        // Light that is no number is black.
        let light = |x: f64| (x * self.exposure).max(0.0);
        let v = self.balance * c.map(light).min(most);
        let v = v.clamp(DVec3::ZERO, most);
        let shown = match self.map {
            ToneMap::Filmic | ToneMap::None => return self.channels(v),
            ToneMap::Agx => agx(v),
            ToneMap::Punchy => punchy(v),
            ToneMap::Neutral => srgb(neutral(v).clamp(DVec3::ZERO, DVec3::ONE)),
            ToneMap::Aces => srgb(aces(v)),
        };
        shown.clamp(DVec3::ZERO, DVec3::ONE)
    }

    /// The maps that treat each channel alone; others are linear here. Without exposure.
    pub fn channels(&self, c: DVec3) -> DVec3 {
        match self.map {
            ToneMap::Filmic => srgb(tone(1.0, c)),
            _ => srgb(c.max(DVec3::ZERO).min(DVec3::ONE)),
        }
    }

    /// The values of the WGSL struct.
    pub fn uniform(&self) -> ToneUniform {
        let at = ToneMap::ALL.iter().position(|map| *map == self.map);
        let row = |i| self.balance.row(i).as_vec3();
        ToneUniform {
            red: row(0),
            map: at.unwrap_or(0) as u32,
            green: row(1),
            mixes: u32::from(self.mixes),
            blue: row(2),
            exposure: self.exposure as f32,
        }
    }
}

/// The chromaticity of a black body in CIE 1960 UCS, from 1000 to 15 000 kelvins (Krystek 1985).
fn black_body(kelvins: f64) -> DVec2 {
    let t = kelvins;
    DVec2::new(
        (0.860_117_757 + t * (1.541_182_54e-4 + t * 1.286_412_12e-7))
            / (1.0 + t * (8.424_202_35e-4 + t * 7.081_451_63e-7)),
        (0.317_398_726 + t * (4.228_062_45e-5 + t * 4.204_816_91e-8))
            / (1.0 + t * (-2.897_418_16e-5 + t * 1.614_560_53e-7)),
    )
}

/// What makes light of a temperature in kelvins white: the Bradford adaptation to D65. Black
/// bodies are shifted so that daylight is D65 itself.
pub fn white_balance(kelvins: f64) -> DMat3 {
    let d65 = TO_XYZ * DVec3::ONE;
    let own = DVec2::new(4.0 * d65.x, 6.0 * d65.y) / d65.dot(DVec3::new(1.0, 15.0, 3.0));
    let [u, v] = (own + black_body(kelvins) - black_body(DAYLIGHT)).to_array();
    // From CIE 1960 UCS at a luminance of 1.
    let white = DVec3::new(1.5 * u, v, 2.0 - 0.5 * u - 5.0 * v) / v;
    let ratio = (BRADFORD * d65) / (BRADFORD * white);
    let responses = BRADFORD * TO_XYZ;
    responses.inverse() * DMat3::from_diagonal(ratio) * responses
}

/// The rotation of AgX into its working colours, and back (Wrensch 2023, after Sobotka).
const AGX_IN: DMat3 = DMat3::from_cols(
    DVec3::new(0.842_479_062, 0.042_328_242, 0.042_375_655),
    DVec3::new(0.078_433_600, 0.878_468_636, 0.078_433_600),
    DVec3::new(0.079_223_745, 0.079_166_127, 0.879_142_974),
);
const AGX_OUT: DMat3 = DMat3::from_cols(
    DVec3::new(1.196_879_005, -0.052_896_852, -0.052_971_636),
    DVec3::new(-0.098_020_881, 1.151_903_130, -0.098_043_450),
    DVec3::new(-0.099_029_744, -0.098_961_177, 1.151_073_673),
);

/// The curve of AgX after its rotation: 16.5 stops about middle grey, as display values.
fn agx_curve(v: DVec3) -> DVec3 {
    let one = |v: f64| {
        let x = ((v.max(1e-10).log2() + 12.473_93) / 16.5).clamp(0.0, 1.0);
        // The sixth degree is Wrensch's fit.
        let high = (15.5 * x - 40.14) * x + 31.96;
        (((high * x - 6.868) * x + 0.4298) * x + 0.1191) * x - 0.002_32
    };
    (AGX_IN * v).map(one)
}

/// AgX: display values, without a further transfer function.
fn agx(v: DVec3) -> DVec3 {
    AGX_OUT * agx_curve(v)
}

/// AgX with more contrast and colour, its look "punchy".
fn punchy(v: DVec3) -> DVec3 {
    let x = agx_curve(v).map(|x| x.max(0.0).powf(1.35));
    AGX_OUT * DVec3::splat(x.dot(LUMA)).lerp(x, 1.4)
}

/// The neutral map of the Khronos group (2024): colours below a peak of 0.8 stay, but for the 4 %
/// that a surface reflects.
fn neutral(v: DVec3) -> DVec3 {
    let low = v.min_element();
    let v = v - if low < 0.08 {
        low - 6.25 * low * low
    } else {
        0.04
    };
    let peak = v.max_element();
    if peak < 0.76 {
        return v;
    }
    let shown = 1.0 - 0.0576 / (peak - 0.52);
    let white = 1.0 - 1.0 / (0.15 * (peak - shown) + 1.0);
    (v * (shown / peak)).lerp(DVec3::splat(shown), white)
}

/// Stephen Hill's fit of ACES, its reference rendering and its output for sRGB.
fn aces(v: DVec3) -> DVec3 {
    const IN: DMat3 = DMat3::from_cols(
        DVec3::new(0.59719, 0.07600, 0.02840),
        DVec3::new(0.35458, 0.90834, 0.13383),
        DVec3::new(0.04823, 0.01566, 0.83777),
    );
    const OUT: DMat3 = DMat3::from_cols(
        DVec3::new(1.60475, -0.10208, -0.00327),
        DVec3::new(-0.53108, 1.10813, -0.07276),
        DVec3::new(-0.07367, -0.00605, 1.07602),
    );
    let v = IN * v;
    let one =
        (v * (v + 0.024_578_6) - 0.000_090_537) / (v * (0.983_729 * v + 0.432_951) + 0.238_081);
    (OUT * one).clamp(DVec3::ZERO, DVec3::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tone(map: ToneMap) -> Tone {
        Tone::of(&Look {
            tone: map,
            ..Look::default()
        })
    }

    /// Grey, two primaries, a blue, and a very bright colour.
    const LIGHTS: [[f64; 3]; 4] = [
        [0.18; 3],
        [1.0, 0.0, 0.0],
        [0.02, 0.1, 2.0],
        [8.0, 6.0, 4.0],
    ];

    #[test]
    fn maps_are_those_that_were_published() {
        // By the shader texts of Wrensch, of the Khronos group and of Hill, run in f64.
        let published = [
            (
                ToneMap::Agx,
                [
                    [0.49668, 0.49674, 0.49675],
                    [0.86098, 0.23016, 0.23032],
                    [0.45878, 0.52636, 0.90939],
                    [0.97199, 0.95847, 0.93615],
                ],
            ),
            (
                ToneMap::Punchy,
                [
                    [0.38881, 0.38884, 0.38884],
                    [1.0, 0.07484, 0.07502],
                    [0.29641, 0.39838, 1.0],
                    [0.96979, 0.94439, 0.90296],
                ],
            ),
            (
                ToneMap::Neutral,
                [
                    [0.41002; 3],
                    [0.94528, 0.13118, 0.13118],
                    [0.39403, 0.43961, 0.98248],
                    [0.99659, 0.94069, 0.88002],
                ],
            ),
            (
                ToneMap::Aces,
                [
                    [0.35846; 3],
                    [0.84779, 0.0, 0.0341],
                    [0.19877, 0.25671, 0.91642],
                    [0.98406, 0.97571, 0.96223],
                ],
            ),
            (
                ToneMap::None,
                [
                    [0.46136; 3],
                    [1.0, 0.0, 0.0],
                    [0.15170, 0.34919, 1.0],
                    [1.0; 3],
                ],
            ),
        ];
        for (map, wanted) in published {
            for (light, wanted) in LIGHTS.into_iter().zip(wanted) {
                let shown = tone(map).shown(light.into());
                let off = (shown - DVec3::from(wanted)).abs().max_element();
                assert!(off < 1e-5, "{map:?} {light:?}: {shown}");
            }
        }
    }

    #[test]
    fn no_light_breaks_a_map() {
        let lights = [0.0, -0.0, -1.0, -1e30, 1e-40, 1.0, 1e6, 1e30, 1e300];
        let lights = [&lights[..], &[f64::NAN, f64::INFINITY]].concat();
        for (map, white) in ToneMap::ALL
            .iter()
            .flat_map(|m| [(m, DAYLIGHT), (m, 3000.0)])
        {
            let tone = Tone::of(&Look {
                tone: *map,
                white,
                exposure: 5.0,
                ..Look::default()
            });
            for [r, g, b] in lights
                .iter()
                .flat_map(|x| [[*x; 3], [*x, 0.5, 0.0], [0.0, *x, 7.0]])
            {
                let shown = tone.shown(DVec3::new(r, g, b));
                let fits = shown.cmpge(DVec3::ZERO).all() && shown.cmple(DVec3::ONE).all();
                // A byte of a NaN is black, which suits a NaN.
                assert!(
                    fits || r.is_nan() || g.is_nan(),
                    "{tone:?} {r} {g} {b}: {shown}"
                );
            }
            // Black is black, and more light is not darker.
            let grey = |x: f64| tone.shown(DVec3::splat(x)).element_sum();
            assert_eq!(grey(0.0), 0.0, "{map:?}");
            assert!(
                (0..400)
                    .map(|i| 1.05_f64.powi(i - 250))
                    .all(|x| grey(x) <= grey(1.05 * x) + 1e-9)
            );
        }
    }

    #[test]
    fn the_white_balance_makes_its_light_white_and_leaves_daylight() {
        let daylight = white_balance(DAYLIGHT);
        assert!(daylight.abs_diff_eq(DMat3::IDENTITY, 1e-12));
        // Illuminant A of CIE 15 is a black body of 2856 K.
        let a = black_body(2856.0);
        assert!(
            (a - DVec2::new(0.255_97, 0.349_53)).abs().max_element() < 1e-4,
            "{a}"
        );
        for kelvins in [1500.0, 2856.0, 5000.0, 10_000.0, 15_000.0] {
            // The light itself, from its chromaticity.
            let d65 = TO_XYZ * DVec3::ONE;
            let d65 = DVec2::new(4.0 * d65.x, 6.0 * d65.y) / d65.dot(DVec3::new(1.0, 15.0, 3.0));
            let shift = d65 - black_body(DAYLIGHT);
            let [u, v] = (black_body(kelvins) + shift).to_array();
            let (x, y) = (
                3.0 * u / (2.0 * u - 8.0 * v + 4.0),
                2.0 * v / (2.0 * u - 8.0 * v + 4.0),
            );
            let light = TO_XYZ.inverse() * DVec3::new(x / y, 1.0, (1.0 - x - y) / y);
            // Candlelight has next to no blue.
            let white = white_balance(kelvins) * light;
            assert!(
                (white - DVec3::ONE).abs().max_element() < 2e-3,
                "{kelvins}: {white}"
            );
            assert_eq!(light.x > light.z, kelvins < DAYLIGHT);
        }
    }
}
