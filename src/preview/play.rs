//! The moment of the film that is shown.

use crate::plan::Plan;
use crate::plan::film::{POSE, numbers_of};
use crate::time::track::{Track, TrackKey};

/// Two keys nearer than this are one, in beats.
const SAME: f64 = 1e-6;

/// A key on the timeline: its track and its place in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The track.
    pub track: usize,
    /// The key.
    pub key: usize,
}

/// The moment of the film that is shown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Play {
    /// In beats.
    pub beat: f64,
    /// Whether time goes on.
    pub playing: bool,
    /// The part that is played again and again; `None` for all of the film.
    pub range: Option<[f64; 2]>,
    /// The chosen key.
    pub chosen: Option<Place>,
}

impl Play {
    /// Goes on by some seconds. Time is never dropped.
    pub fn advance(&mut self, plan: &Plan, seconds: f64) {
        let [from, to] = self.range.unwrap_or([0.0, plan.time.length]);
        let beat = self.beat + plan.time.beats(seconds);
        self.beat = match self.range.is_some() || plan.time.looping {
            true => from + (beat - from).rem_euclid((to - from).max(SAME)),
            false => beat.min(to),
        };
        self.playing &= self.beat < to;
    }

    /// Goes to another frame, so many later.
    pub fn step(&mut self, plan: &Plan, frames: i32) {
        let each = plan.time.beat_of(1);
        let frame = (self.beat / each).round() + f64::from(frames);
        self.beat = (frame * each).clamp(0.0, plan.time.length);
        self.playing = false;
    }
}

/// Sets what tracks say of a beat as the values of a plan. Returns what does not fit.
pub fn pose_at(plan: &mut Plan, beat: f64) -> Option<String> {
    if plan.tracks.is_empty() {
        return None;
    }
    match plan.at(beat) {
        Ok(still) => {
            let tracks = std::mem::take(&mut plan.tracks);
            *plan = Plan { tracks, ..still };
            None
        }
        Err(fault) => Some(format!("{}: {}", fault.key, fault.why)),
    }
}

/// Sets a key of a setting at a beat to its present value, in a new track if it has none. Returns
/// whether the setting can have one.
pub fn set_key(plan: &mut Plan, of: &str, beat: f64) -> bool {
    let Some(value) = plan.value(of).as_ref().and_then(numbers_of) else {
        return false;
    };
    let key = TrackKey {
        time: beat,
        value,
        between: None,
    };
    match plan.tracks.iter_mut().find(|track| track.of == of) {
        Some(track) => {
            let at = track.keys.partition_point(|key| key.time < beat - SAME);
            match track.keys.get_mut(at) {
                Some(old) if (old.time - beat).abs() <= SAME => old.value = key.value,
                _ => track.keys.insert(at, key),
            }
        }
        None => plan.tracks.push(Track {
            of: of.into(),
            between: Default::default(),
            keys: vec![key],
        }),
    }
    true
}

/// Sets a key of the present view: of the camera, and of every other track whose setting was
/// changed.
pub fn set_view(plan: &mut Plan, beat: f64) {
    let changed = |track: &&Track| {
        let now = plan.value(&track.of).as_ref().and_then(numbers_of);
        now.is_some_and(|now| now != track.at(beat))
    };
    let others: Vec<String> = plan
        .tracks
        .iter()
        .filter(changed)
        .map(|t| t.of.clone())
        .collect();
    let all = POSE.into_iter().map(String::from).chain(others);
    for of in all.collect::<Vec<_>>() {
        set_key(plan, &of, beat);
    }
}

/// Sets the chosen key to the present value of its setting; a key of the camera to the present
/// view.
pub fn overwrite(plan: &mut Plan, place: Place) {
    let Some(track) = plan.tracks.get(place.track) else {
        return;
    };
    let Some(time) = track.keys.get(place.key).map(|key| key.time) else {
        return;
    };
    match POSE.contains(&track.of.as_str()) {
        true => set_view(plan, time),
        false => _ = set_key(plan, &track.of.clone(), time),
    }
}

/// Moves a key in time, or a copy of it. Keys of one track never share a time, so a key may stop
/// beside another. Returns its new place.
pub fn retime(plan: &mut Plan, place: Place, to: f64, copy: bool) -> Place {
    let to = to.clamp(0.0, plan.time.length);
    let Some(track) = plan.tracks.get_mut(place.track) else {
        return place;
    };
    let Some(key) = track.keys.get(place.key).cloned() else {
        return place;
    };
    let others = track.keys.iter().enumerate();
    let taken = others
        .filter(|(i, _)| copy || *i != place.key)
        .any(|(_, other)| (other.time - to).abs() <= SAME);
    if taken {
        return place;
    }
    if !copy {
        track.keys.remove(place.key);
    }
    let at = track.keys.partition_point(|key| key.time < to);
    track.keys.insert(at, TrackKey { time: to, ..key });
    Place { key: at, ..place }
}

/// Takes a key away, and a track that has no more.
pub fn remove(plan: &mut Plan, place: Place) {
    let Some(track) = plan.tracks.get_mut(place.track) else {
        return;
    };
    if place.key < track.keys.len() {
        track.keys.remove(place.key);
    }
    if track.keys.is_empty() {
        plan.tracks.remove(place.track);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use glam::DVec3;

    fn plan() -> Plan {
        let mut plan = Plan::new(Scene::all().into_iter().next().expect("a scene"));
        plan.camera.eye = DVec3::new(0.0, -9.0, 1.0);
        plan
    }

    #[test]
    fn time_goes_on_and_never_drops() {
        let mut plan = plan();
        plan.time.bpm = 120.0;
        let mut play = Play {
            playing: true,
            ..Play::default()
        };
        play.advance(&plan, 1.5);
        assert_eq!(play.beat, 3.0);
        play.advance(&plan, 100.0);
        assert!(play.beat == 10.0 && !play.playing);
        play.range = Some([2.0, 4.0]);
        play.advance(&plan, 0.25);
        assert!((2.0..4.0).contains(&play.beat), "{play:?}");
        plan.time.looping = true;
        play.range = None;
        play.beat = 9.0;
        play.advance(&plan, 1.0);
        assert_eq!(play.beat, 1.0);
        play.step(&plan, -1);
        assert!((play.beat - 14.0 / 15.0).abs() < 1e-12, "{play:?}");
    }

    #[test]
    fn keys_are_set_moved_copied_and_taken_away() {
        let mut plan = plan();
        set_view(&mut plan, 0.0);
        assert_eq!(plan.tracks.len(), 3);
        plan.camera.eye.x = 5.0;
        set_view(&mut plan, 4.0);
        assert!(set_key(&mut plan, "camera.fov", 4.0));
        assert!(!set_key(&mut plan, "march.mode", 4.0));
        assert!(plan.check().is_ok());
        // What the tracks say is the present view at its time.
        let eye = plan.camera.eye;
        plan.camera.eye = DVec3::ONE;
        assert_eq!(pose_at(&mut plan, 4.0), None);
        assert!(plan.camera.eye.distance(eye) < 1e-12);
        let place = Place { track: 0, key: 1 };
        let moved = retime(&mut plan, place, 2.0, false);
        assert_eq!((moved.key, plan.tracks[0].keys.len()), (1, 2));
        assert_eq!(plan.tracks[0].keys[1].time, 2.0);
        // Not onto another key.
        assert_eq!(retime(&mut plan, moved, 0.0, false), moved);
        let copy = retime(&mut plan, Place { track: 0, key: 0 }, 3.0, true);
        assert_eq!((copy.key, plan.tracks[0].keys.len()), (2, 3));
        plan.camera.eye = DVec3::new(7.0, 7.0, 7.0);
        overwrite(&mut plan, copy);
        assert_eq!(plan.tracks[0].keys[2].value, [7.0; 3]);
        remove(&mut plan, Place { track: 3, key: 0 });
        assert!(plan.track("camera.fov").is_none());
        assert!(plan.check().is_ok());
    }
}
