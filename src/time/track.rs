//! The values of one setting over time.
//!
//! The ways between two keys are those of trackers that demos are made with: hold the value, go
//! straight, start and end slowly, or start slowly.

use crate::base::named::named_enum;

named_enum! {
    /// How a value goes from one key to the next.
    #[derive(Default)]
    pub enum Between: fn(f64) -> f64 {
        /// It holds the first value.
        Step = "step" => |_| 0.0,
        /// In a straight line.
        Linear = "linear" => |u| u,
        /// Slowly at both ends; a camera goes on a smooth curve instead.
        #[default]
        Smooth = "smooth" => |u| u * u * (3.0 - 2.0 * u),
        /// Slowly at the first end.
        Ramp = "ramp" => |u| u * u,
    }
}

impl Between {
    /// The share of the way at a share of the time, both from 0 to 1.
    pub fn share(self, u: f64) -> f64 {
        self.facts()(u)
    }
}

/// A value at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackKey {
    /// In beats from the start.
    pub time: f64,
    /// One number, or the three of a point or a colour.
    pub value: Vec<f64>,
    /// How the value goes on from here, if it is not as the track says.
    pub between: Option<Between>,
}

/// The values of one setting over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// The setting, as `section.key`.
    pub of: String,
    /// How values go from key to key.
    pub between: Between,
    /// In the order of time. There is at least one.
    pub keys: Vec<TrackKey>,
}

impl Track {
    /// The last key at or before a time; the first key before all of them.
    pub fn index_at(&self, time: f64) -> usize {
        let later = self.keys.partition_point(|key| key.time <= time);
        later.saturating_sub(1)
    }

    /// How the value goes on from a key.
    pub fn between_at(&self, index: usize) -> Between {
        let own = self.keys.get(index).and_then(|key| key.between);
        own.unwrap_or(self.between)
    }

    /// The value at a time. Before the first key and after the last one it is theirs.
    pub fn at(&self, time: f64) -> Vec<f64> {
        let index = self.index_at(time);
        let key = &self.keys[index];
        let Some(next) = self.keys.get(index + 1) else {
            return key.value.clone();
        };
        let u = ((time - key.time) / (next.time - key.time)).clamp(0.0, 1.0);
        let u = self.between_at(index).share(u);
        let pairs = key.value.iter().zip(&next.value);
        // Exact at both ends.
        pairs.map(|(a, b)| a * (1.0 - u) + b * u).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_go_from_key_to_key_as_they_are_told() {
        let key = |time: f64, value: f64, between| TrackKey {
            time,
            value: vec![value, -value],
            between,
        };
        let track = Track {
            of: "camera.fov".into(),
            between: Between::Linear,
            keys: vec![
                key(1.0, 10.0, None),
                key(3.0, 20.0, Some(Between::Step)),
                key(4.0, 0.0, Some(Between::Smooth)),
                key(6.0, 8.0, Some(Between::Ramp)),
                key(8.0, 16.0, None),
            ],
        };
        let expected = [
            (0.0, 10.0),
            (1.0, 10.0),
            (2.0, 15.0),
            (3.0, 20.0),
            (3.9, 20.0),
            (4.0, 0.0),
            (4.5, 1.25),
            (5.0, 4.0),
            (7.0, 10.0),
            (8.0, 16.0),
            (99.0, 16.0),
        ];
        for (time, value) in expected {
            assert_eq!(track.at(time), [value, -value], "at {time}");
        }
    }
}
