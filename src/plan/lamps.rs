//! The lamps of a scene: keys of the section `[look]` for those after the first.

use glam::DVec3;

use super::look::Look;
use crate::base::key::{auto_number, auto_triple, number, triple};
use crate::settings;

/// The largest number of lamps.
pub const MOST_LAMPS: usize = 3;

settings! {
    /// The second and the third lamp.
    pub struct Lamps {
        lamp2: f64 = 0.0, number(0.0, 1e6), "strength of a second lamp, 0 for none; see lamp" => Program;
        lamp2_at: Option<DVec3> = None, auto_triple(-1e9, 1e9), "its position; auto is the eye";
        lamp2_color: DVec3 = DVec3::new(0.42, 0.66, 1.0), triple(0.0, 1.0), "its colour, sRGB";
        lamp2_size: f64 = 0.005, number(1e-4, 1.0), "its radius as a share of the distance from eye to target";
        lamp2_cone: Option<f64> = None, auto_number(1.0, 360.0), "full angle in degrees of the cone in which it shines; see lamp_cone";
        lamp2_toward: Option<DVec3> = None, auto_triple(-1e9, 1e9), "the point in the middle of its cone; see lamp_toward";
        lamp3: f64 = 0.0, number(0.0, 1e6), "strength of a third lamp, 0 for none; see lamp" => Program;
        lamp3_at: Option<DVec3> = None, auto_triple(-1e9, 1e9), "its position; auto is the eye";
        lamp3_color: DVec3 = DVec3::new(1.0, 0.40, 0.62), triple(0.0, 1.0), "its colour, sRGB";
        lamp3_size: f64 = 0.005, number(1e-4, 1.0), "its radius as a share of the distance from eye to target";
        lamp3_cone: Option<f64> = None, auto_number(1.0, 360.0), "full angle in degrees of the cone in which it shines; see lamp_cone";
        lamp3_toward: Option<DVec3> = None, auto_triple(-1e9, 1e9), "the point in the middle of its cone; see lamp_toward";
    }
}

/// One lamp of a look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LampSettings {
    /// Radiance of a white wall that faces it at the distance from eye to target.
    pub strength: f64,
    /// Its position, if not the eye.
    pub at: Option<DVec3>,
    /// Its colour, sRGB.
    pub color: DVec3,
    /// Its radius as a share of the distance from eye to target.
    pub size: f64,
    /// Full angle of its cone in degrees, if it has one.
    pub cone: Option<f64>,
    /// The point in the middle of the cone, if not the target.
    pub toward: Option<DVec3>,
}

impl Look {
    /// The lamps that shine, the first one first.
    pub fn lit_lamps(&self) -> impl Iterator<Item = LampSettings> {
        let more = &self.lamps;
        let all: [LampSettings; MOST_LAMPS] = [
            LampSettings {
                strength: self.lamp,
                at: self.lamp_at,
                color: self.lamp_color,
                size: self.lamp_size,
                cone: self.lamp_cone,
                toward: self.lamp_toward,
            },
            LampSettings {
                strength: more.lamp2,
                at: more.lamp2_at,
                color: more.lamp2_color,
                size: more.lamp2_size,
                cone: more.lamp2_cone,
                toward: more.lamp2_toward,
            },
            LampSettings {
                strength: more.lamp3,
                at: more.lamp3_at,
                color: more.lamp3_color,
                size: more.lamp3_size,
                cone: more.lamp3_cone,
                toward: more.lamp3_toward,
            },
        ];
        all.into_iter().filter(|lamp| lamp.strength > 0.0)
    }
}
