//! The moment of the film that is shown.

use crate::plan::Plan;
use crate::plan::film::{POSE, field, numbers_of};
use crate::time::track::{Track, TrackKey};

/// Two keys nearer than this are one, in beats.
const SAME: f64 = 1e-6;

/// A key on the timeline.
#[derive(Clone, Debug, PartialEq)]
pub struct TimelineKey {
    /// The setting of its track, as `section.key`.
    pub of: String,
    /// Its time in beats.
    pub time: f64,
}

impl TimelineKey {
    /// Its track, and its index there; `None` if it is gone.
    fn find<'a>(&self, plan: &'a mut Plan) -> Option<(&'a mut Track, usize)> {
        let track = plan.tracks.iter_mut().find(|track| track.of == self.of)?;
        let index = track.keys.iter().position(|key| key.time == self.time)?;
        Some((track, index))
    }
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
    pub chosen: Option<TimelineKey>,
    /// Whether the drag under way is to copy that key.
    pub copies: bool,
}

impl Play {
    /// Goes on by some seconds. Time is never dropped.
    pub fn advance(&mut self, plan: &Plan, seconds: f64) {
        let [from, to] = self.range.unwrap_or([0.0, plan.time.length]);
        let beat = self.beat + plan.time.beats(seconds);
        let to = to.min(plan.time.length);
        let loops = self.range.is_some() || plan.time.looping;
        self.beat = match loops {
            true => from + (beat - from).rem_euclid((to - from).max(SAME)),
            false => beat.min(to),
        };
        self.playing &= loops || self.beat < to;
    }

    /// Goes to another frame, so many later.
    pub fn step(&mut self, plan: &Plan, frames: i32) {
        let each = plan.time.beat_of(1);
        let at = self.beat / each;
        let frame = match (at - at.round()).abs() < SAME {
            true => at.round(),
            // Between two frames, the next one is less than a frame away.
            false if frames > 0 => at.floor(),
            false => at.ceil(),
        };
        let frame = (frame + f64::from(frames)).max(0.0);
        self.beat = plan.time.beat_of(frame as u32).min(plan.time.length);
        self.playing = false;
    }

    /// Stays within a film of so many beats.
    pub fn fit(&mut self, length: f64) {
        self.beat = self.beat.min(length);
        let ends = self.range.map(|[from, to]| [from, to.min(length)]);
        self.range = ends.filter(|[from, to]| from < to);
    }
}

/// The beat of the last key; 0 without keys.
pub fn last_key(plan: &Plan) -> f64 {
    let keys = plan.tracks.iter().flat_map(|track| &track.keys);
    keys.map(|key| key.time).fold(0.0, f64::max)
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
    let Some(value) = numbers(plan, of) else {
        return false;
    };
    let mut key = TrackKey {
        time: beat,
        value,
        between: None,
    };
    // A new track of the camera goes on as the camera does.
    let of_camera = |track: &&Track| POSE.contains(&track.of.as_str());
    let camera = plan.tracks.iter().find(of_camera);
    let between = camera.filter(|_| POSE.contains(&of)).map(|t| t.between);
    match plan.tracks.iter_mut().find(|track| track.of == of) {
        Some(track) => {
            let at = track.keys.partition_point(|key| key.time < beat - SAME);
            match track.keys.get_mut(at) {
                Some(old) if (old.time - beat).abs() <= SAME => old.value = key.value,
                _ => {
                    let before = at.checked_sub(1).map(|i| &track.keys[i]);
                    key.between = before.and_then(|key| key.between);
                    track.keys.insert(at, key);
                }
            }
        }
        None => plan.tracks.push(Track {
            of: of.into(),
            between: between.unwrap_or_default(),
            keys: vec![key],
        }),
    }
    true
}

/// The present value of a setting in numbers.
fn numbers(plan: &Plan, of: &str) -> Option<Vec<f64>> {
    plan.value(of).as_ref().and_then(numbers_of)
}

/// Whether a setting has the value that its track says. A track's value of a count is rounded.
fn is_tracked(plan: &Plan, track: &Track, beat: f64) -> bool {
    let mut tracked = plan.clone();
    let set = tracked.set_numbers(&track.of, &track.at(beat));
    set.is_ok() && numbers(plan, &track.of) == numbers(&tracked, &track.of)
}

/// Sets a key of the present view: of the camera, and of every other track whose setting was
/// changed.
pub fn set_view(plan: &mut Plan, beat: f64) {
    let others = plan
        .tracks
        .iter()
        .filter(|track| !POSE.contains(&track.of.as_str()) && !is_tracked(plan, track, beat));
    let others = others.map(|track| track.of.clone());
    let all = POSE.into_iter().map(String::from).chain(others);
    for of in all.collect::<Vec<_>>() {
        set_key(plan, &of, beat);
    }
}

/// Sets a key to the present value of its setting; a key of the camera to the present view.
/// Returns whether the key is still there.
pub fn overwrite(plan: &mut Plan, place: &TimelineKey) -> bool {
    if place.find(plan).is_none() {
        return false;
    }
    match POSE.contains(&place.of.as_str()) {
        true => POSE.into_iter().all(|of| set_key(plan, of, place.time)),
        false => set_key(plan, &place.of, place.time),
    }
}

/// Moves a key in time, or a copy of it. Keys of one track never share a time, so a key may stop
/// beside another. Returns its new place.
pub fn retime(plan: &mut Plan, place: &TimelineKey, to: f64, copy: bool) -> TimelineKey {
    let to = to.clamp(0.0, plan.time.length);
    let Some((track, index)) = place.find(plan) else {
        return place.clone();
    };
    let others = track.keys.iter().enumerate();
    let taken = others
        .filter(|(i, _)| copy || *i != index)
        .any(|(_, other)| (other.time - to).abs() <= SAME);
    if taken {
        return place.clone();
    }
    let key = match copy {
        true => track.keys[index].clone(),
        false => track.keys.remove(index),
    };
    let at = track.keys.partition_point(|key| key.time < to);
    track.keys.insert(at, TrackKey { time: to, ..key });
    TimelineKey {
        time: to,
        ..place.clone()
    }
}

/// Takes a key away, and a track that has no more.
pub fn remove(plan: &mut Plan, place: &TimelineKey) {
    if let Some((track, index)) = place.find(plan) {
        track.keys.remove(index);
        plan.tracks.retain(|track| !track.keys.is_empty());
    }
}

/// Whether all settings with a track have the values of a moment of the film.
pub fn shows_film(plan: &Plan, beat: f64) -> bool {
    let moment = plan.at(beat);
    !plan.tracks.is_empty()
        && moment.is_ok_and(|moment| {
            Plan {
                tracks: plan.tracks.clone(),
                ..moment
            } == *plan
        })
}

/// Whether what has a track is as in a file, so that no other view than the film's was left.
pub fn has_still_of(plan: &Plan, saved: &Plan) -> bool {
    let is_same = |track: &Track| numbers(plan, &track.of) == numbers(saved, &track.of);
    plan.tracks.iter().all(is_same)
}

/// The plan to save. While a moment of its film is shown, what has tracks keeps the values of the
/// file, so that the still stays the one that it was. Another view is saved as it is.
pub fn with_still(plan: &Plan, saved: &Plan, beat: f64) -> Plan {
    let mut still = plan.clone();
    if !shows_film(plan, beat) {
        return still;
    }
    let is_pose = |track: &&Track| POSE.contains(&track.of.as_str());
    for track in plan.tracks.iter().filter(|track| !is_pose(track)) {
        if let Some(own) = numbers(saved, &track.of) {
            // What the file has fits.
            let _ = still.set_numbers(&track.of, &own);
        }
    }
    let mut own = still.camera.clone();
    for track in plan.tracks.iter().filter(is_pose) {
        *field(&mut own, &track.of) = *field(&mut saved.camera.clone(), &track.of);
    }
    if own.check().is_ok() {
        still.camera = own;
    }
    still
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::time::track::Between;
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
        // From between two frames, to the next on either side.
        for (frames, beat) in [(-1, 13.0 / 15.0), (1, 14.0 / 15.0)] {
            play.beat = 13.4 / 15.0;
            play.step(&plan, frames);
            assert!((play.beat - beat).abs() < 1e-12, "{play:?}");
        }
    }

    #[test]
    fn a_moment_stays_within_a_shorter_film() {
        let mut play = Play {
            beat: 5.5,
            range: Some([2.0, 6.0]),
            ..Play::default()
        };
        play.fit(4.0);
        assert_eq!((play.beat, play.range), (4.0, Some([2.0, 4.0])));
        play.fit(1.0);
        assert_eq!((play.beat, play.range), (1.0, None));
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
        let place = |of: &str, time| TimelineKey {
            of: of.into(),
            time,
        };
        let moved = retime(&mut plan, &place("camera.eye", 4.0), 2.0, false);
        assert_eq!((moved.time, plan.tracks[0].keys.len()), (2.0, 2));
        assert_eq!(plan.tracks[0].keys[1].time, 2.0);
        // Not onto another key.
        assert_eq!(retime(&mut plan, &moved, 0.0, false), moved);
        let copy = retime(&mut plan, &place("camera.eye", 0.0), 3.0, true);
        assert_eq!((copy.time, plan.tracks[0].keys.len()), (3.0, 3));
        // Other tracks keep their keys, and a key that is gone is told.
        plan.camera.eye = DVec3::new(7.0, 7.0, 7.0);
        plan.camera.fov = 12.0;
        assert!(overwrite(&mut plan, &copy));
        assert_eq!(plan.tracks[0].keys[2].value, [7.0; 3]);
        assert_eq!(plan.track("camera.fov").map(|t| t.keys.len()), Some(1));
        assert!(!overwrite(&mut plan, &place("camera.eye", 9.0)));
        remove(&mut plan, &place("camera.fov", 4.0));
        assert!(plan.track("camera.fov").is_none());
        assert!(plan.check().is_ok());
    }

    #[test]
    fn a_key_of_the_view_leaves_tracks_that_were_not_touched() {
        let mut plan = plan();
        plan.tracks = vec![Track {
            of: "march.steps".into(),
            between: Between::Linear,
            keys: [(0.0, 100.0), (3.0, 200.0)]
                .map(|(time, value)| TrackKey {
                    time,
                    value: vec![value],
                    between: None,
                })
                .into(),
        }];
        // 133.3 steps are 133.
        assert_eq!(pose_at(&mut plan, 1.0), None);
        set_view(&mut plan, 1.0);
        assert_eq!(plan.tracks[0].keys.len(), 2);
        let (key, value) = ("march.steps", [150.0]);
        assert_eq!(plan.set_numbers(key, &value), Ok(()));
        set_view(&mut plan, 1.0);
        assert_eq!(plan.tracks[0].keys[1].value, value);
    }

    #[test]
    fn a_key_of_what_is_shown_keeps_the_way() {
        let mut plan = plan();
        let key = |time: f64, between| TrackKey {
            time,
            value: vec![0.0, -9.0, 1.0],
            between,
        };
        plan.tracks = vec![Track {
            of: POSE[0].into(),
            between: Between::Linear,
            keys: vec![key(0.0, Some(Between::Step)), key(6.0, None)],
        }];
        set_view(&mut plan, 2.0);
        // The eye is still held.
        assert_eq!(plan.tracks[0].keys[1].between, Some(Between::Step));
        let ways: Vec<_> = plan.tracks.iter().map(|track| track.between).collect();
        assert_eq!(ways, [Between::Linear; 3]);
        assert!(set_key(&mut plan, "camera.fov", 2.0));
        let own = plan.track("camera.fov").map(|track| track.between);
        assert_eq!(own, Some(Between::default()));
    }

    #[test]
    fn another_moment_does_not_change_the_still() {
        let mut plan = plan();
        let saved = plan.clone();
        set_view(&mut plan, 0.0);
        plan.camera.eye.x = 5.0;
        set_view(&mut plan, 4.0);
        assert_eq!(pose_at(&mut plan, 3.0), None);
        let kept = with_still(&plan, &saved, 3.0);
        assert_eq!((&kept.camera, &kept.tracks), (&saved.camera, &plan.tracks));
        assert!(has_still_of(&kept, &saved) && !has_still_of(&plan, &saved));
        assert!(shows_film(&plan, 3.0) && !shows_film(&plan, 2.0));
        // Another view is a new still, with all that it shows.
        plan.camera.eye.x = 6.0;
        plan.camera.fov += 5.0;
        assert!(set_key(&mut plan, "camera.fov", 3.0));
        assert_eq!(with_still(&plan, &saved, 3.0), plan);
        assert_eq!(pose_at(&mut plan, 3.0), None);
        assert_eq!(with_still(&plan, &saved, 3.0).camera, saved.camera);
        plan.tracks.retain(|track| track.of != "camera.fov");
        // A target without a track belongs to every moment.
        plan.tracks.retain(|track| track.of == "camera.eye");
        plan.camera.target.z = 2.0;
        assert_eq!(pose_at(&mut plan, 3.0), None);
        let kept = with_still(&plan, &saved, 3.0);
        assert_eq!(kept.camera.eye, saved.camera.eye);
        assert_eq!(kept.at(3.0), plan.at(3.0));
    }
}
