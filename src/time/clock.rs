//! Length, frames and beats of a film: the section `[time]` of a preset.

use crate::base::key::{number, switch};
use crate::settings;

settings! {
    /// When the frames of a film are. Tracks and the length count in beats.
    pub struct Timing {
        length: f64 = 10.0, number(1e-3, 1e6), "length of the film in beats; at 60 beats per minute these are seconds";
        bpm: f64 = 60.0, number(1.0, 1e4), "beats per minute";
        fps: f64 = 30.0, number(0.1, 1e3), "frames per second";
        looping as "loop": bool = false, switch(), "whether the film begins again at its end";
    }
}

impl Timing {
    /// Seconds as beats.
    pub fn beats(&self, seconds: f64) -> f64 {
        seconds * self.bpm / 60.0
    }

    /// Frames in the film. Each starts within its length.
    pub fn frames(&self) -> u32 {
        let frames = self.length * 60.0 / self.bpm * self.fps;
        // A length of whole frames may be a rounding error longer.
        ((frames - 1e-6).ceil() as u32).max(1)
    }

    /// The beat at which a frame starts: the nearest number, so that it is that of a key which is
    /// written in a file.
    pub fn beat_of(&self, frame: u32) -> f64 {
        f64::from(frame) * self.bpm / (60.0 * self.fps)
    }

    /// A moment of play as one in the film: within its length, again and again if it loops. The end
    /// is a moment of its own, that of the last keys.
    pub fn within(&self, beat: f64) -> f64 {
        match self.looping && !(0.0..=self.length).contains(&beat) {
            true => beat.rem_euclid(self.length),
            false => beat.clamp(0.0, self.length),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_has_as_many_frames_as_start_within_its_length() {
        let timing = |length, bpm, fps| Timing {
            length,
            bpm,
            fps,
            ..Timing::default()
        };
        assert_eq!(timing(10.0, 60.0, 30.0).frames(), 300);
        // 16 beats of half a second.
        assert_eq!(timing(16.0, 120.0, 25.0).frames(), 200);
        assert_eq!(timing(1.01, 60.0, 10.0).frames(), 11);
        assert_eq!(timing(1e-3, 60.0, 0.1).frames(), 1);
        let film = timing(16.0, 120.0, 25.0);
        assert_eq!(film.beat_of(25), 2.0);
        let film = Timing {
            fps: 25.0,
            bpm: 60.0,
            ..film
        };
        assert_eq!([3, 6, 24].map(|n| film.beat_of(n)), [0.12, 0.24, 0.96]);
        assert!(film.beat_of(film.frames() - 1) < film.length);
    }

    #[test]
    fn a_loop_begins_again_and_other_films_stop() {
        let mut timing = Timing::default();
        assert_eq!(timing.within(13.0), 10.0);
        timing.looping = true;
        assert_eq!(timing.within(13.0), 3.0);
        assert_eq!(timing.within(-1.0), 9.0);
        assert_eq!(timing.within(10.0), 10.0);
    }
}
