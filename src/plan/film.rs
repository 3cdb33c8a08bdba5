//! A plan at a moment of its film.
//!
//! The tracks of `camera.eye`, `camera.target` and `camera.up` are the path of one camera
//! ([`crate::time::pose`]). Every other track sets one number, point or colour.

use glam::DVec3;
use toml::Value;

use super::{Plan, camera::Camera};
use crate::base::key::{Fault, Key, Kind};
use crate::time::clock::Timing;
use crate::time::pose::Pose;
use crate::time::track::{Between, Track, TrackKey};

/// The settings that make a pose.
pub const POSE: [&str; 3] = ["camera.eye", "camera.target", "camera.up"];

/// The numbers of a value, if a track can hold it.
pub fn numbers_of(value: &Value) -> Option<Vec<f64>> {
    let number = |v: &Value| v.as_float().or(v.as_integer().map(|n| n as f64));
    match value {
        Value::Array(three) if three.len() == 3 => three.iter().map(number).collect(),
        one => Some(vec![number(one)?]),
    }
}

/// Numbers of a track as a value of a kind; `None` if the kind cannot be tracked.
fn value_of(kind: &Kind, numbers: &[f64]) -> Option<Value> {
    match (kind, numbers) {
        (Kind::Auto(kind), _) => value_of(kind, numbers),
        (Kind::Count(_), [n]) => Some(Value::Integer(n.round() as i64)),
        (Kind::Number(_), [x]) => Some(Value::Float(*x)),
        (Kind::Triple(_), [_, _, _]) => Some(numbers.to_vec().into()),
        _ => None,
    }
}

/// The part of a camera that a track of [`POSE`] sets.
pub fn field<'a>(camera: &'a mut Camera, of: &str) -> &'a mut DVec3 {
    match of {
        "camera.eye" => &mut camera.eye,
        "camera.target" => &mut camera.target,
        _ => &mut camera.up,
    }
}

/// The tracks that hold their value from the beat `of` on, as they are at the beat `at`.
#[derive(Clone, Copy, Debug)]
struct Hold {
    of: f64,
    at: f64,
}

/// Sets what a track of [`POSE`] says of a time.
fn set(camera: &mut Camera, track: &Track, time: f64) {
    if let [x, y, z] = track.at(time)[..] {
        *field(camera, &track.of) = [x, y, z].into();
    }
}

impl Plan {
    /// The value of `section.key`, if there is such a key.
    pub fn value(&self, path: &str) -> Option<Value> {
        let mut plan = self.clone();
        plan.with_key(path, |key| key.slot.get())
    }

    /// Sets `section.key` to numbers.
    ///
    /// # Errors
    /// There is no such key, no track can set it, or the value does not fit.
    pub fn set_numbers(&mut self, path: &str, numbers: &[f64]) -> Result<(), String> {
        let set = self.with_key(path, |key| {
            let value = value_of(&key.slot.kind(), numbers).ok_or_else(|| match numbers {
                [_] => "this key takes no number".to_string(),
                _ => "this key takes no three numbers".into(),
            })?;
            key.slot
                .set(&value)
                .map_err(|expects| format!("must be {expects}"))
        });
        set.unwrap_or_else(|| Err("the plan has no such key".into()))
    }

    fn with_key<T>(&mut self, path: &str, use_it: impl FnOnce(&mut Key<'_>) -> T) -> Option<T> {
        let (section, name) = path.split_once('.')?;
        let mut keys = self.keys(section)?;
        keys.iter_mut().find(|key| key.name == name).map(use_it)
    }

    /// The track of a setting.
    pub fn track(&self, of: &str) -> Option<&Track> {
        self.tracks.iter().find(|track| track.of == of)
    }

    /// The plan at a beat of its film, as a still without tracks.
    ///
    /// # Errors
    /// Values between two keys do not fit, alone or together.
    pub fn at(&self, beat: f64) -> Result<Self, Fault> {
        let beat = self.time.within(beat);
        let mut still = Self {
            tracks: Vec::new(),
            ..self.clone()
        };
        for track in &self.tracks {
            let value = track.at(beat);
            let set = still.set_numbers(&track.of, &value);
            set.map_err(|why| Fault::new(&track.of, format!("{value:?} at beat {beat}: {why}")))?;
        }
        if let Some(pose) = self.pose_at(beat) {
            // What has no track stays: all poses share it.
            let up = self.own_up(beat).unwrap_or(pose.up());
            let parts = [pose.eye, pose.target(), up];
            for (of, part) in POSE.into_iter().zip(parts) {
                if self.track(of).is_some() {
                    *field(&mut still.camera, of) = part;
                }
            }
            self.hold(&mut still.camera, Hold { of: beat, at: beat });
        }
        still.check().map(|()| still)
    }

    /// The pose of the camera on its path; `None` without tracks of it.
    fn pose_at(&self, beat: f64) -> Option<Pose> {
        let own = || POSE.iter().filter_map(|of| self.track(of));
        let mut times: Vec<f64> = own()
            .flat_map(|track| track.keys.iter().map(|key| key.time))
            .collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let [first, .., last] = times[..] else {
            return None;
        };
        let beat = beat.clamp(first, last);
        if beat == last {
            // Nothing is held there any more.
            return Some(self.key_pose(last, &[]));
        }
        let index = times.partition_point(|time| *time <= beat) - 1;
        let [from, to] = [times[index], times[index + 1]];
        let u = (beat - from) / (to - from);
        // What is held does not move on before its next key.
        let held = Hold { of: from, at: from };
        let pose = |index: usize| self.key_pose(times[index], &[held]);
        let [here, there] = [pose(index), pose(index + 1)];
        Some(match self.way_from(from) {
            Between::Smooth => {
                let around = self.around(&times, index);
                let [before, after] = around.map(|(time, i, cut)| {
                    let cut = Hold {
                        of: times[cut[0]],
                        at: times[cut[1]],
                    };
                    (time, self.key_pose(times[i], &[cut, held]))
                });
                Pose::on_spline([before, (from, here), (to, there), after], beat)
            }
            between => here.toward(&there, between.share(u)),
        })
    }

    /// How the camera goes on from a time. A track that holds its value, has not begun or is over
    /// says nothing of that.
    fn way_from(&self, time: f64) -> Between {
        let own = POSE.iter().filter_map(|of| self.track(of));
        let moving = own.filter_map(|track| {
            let index = track.index_at(time);
            let moves = track.keys[index].time <= time && index + 1 < track.keys.len();
            moves.then(|| track.between_at(index))
        });
        let way = moving.max_by_key(|between| match between {
            Between::Step => 0,
            Between::Smooth => 2,
            _ => 1,
        });
        way.unwrap_or(Between::Linear)
    }

    /// What the track of `camera.up` says of a beat at one of its keys, or between two that say the
    /// same; there, a level camera stays level. The way of the pose would roll it.
    fn own_up(&self, beat: f64) -> Option<DVec3> {
        let track = self.track("camera.up")?;
        let index = track.index_at(beat);
        let key = &track.keys[index];
        let next = track.keys.get(index + 1);
        let stays = beat <= key.time || next.is_none_or(|next| next.value == key.value);
        let [x, y, z] = key.value[..] else {
            return None;
        };
        stays.then(|| DVec3::new(x, y, z))
    }

    /// The keys before and after the two from `index` on: their times, their indices, and the two
    /// keys of the way to them. A film that loops through the same pose goes on around its end. At the
    /// ends of other films the first or the last pose stands twice. So does what a cut leads to or
    /// from: it does not bend the way on the other side.
    fn around(&self, times: &[f64], index: usize) -> [(f64, usize, [usize; 2]); 2] {
        let Timing {
            length, looping, ..
        } = self.time;
        let last = times.len() - 1;
        let closed = looping
            && last > 1
            && times[last] - times[0] == length
            && self.key_pose(times[0], &[]) == self.key_pose(times[last], &[]);
        let step = times[index + 1] - times[index];
        let before = match index.checked_sub(1) {
            Some(i) => (times[i], i, [i, index]),
            None if closed => (times[last - 1] - length, last - 1, [last - 1, last]),
            None => (times[0] - step, 0, [0, 0]),
        };
        let after = match index + 2 {
            i if i <= last => (times[i], i, [i - 1; 2]),
            _ if closed => (times[1] + length, 1, [0, 0]),
            _ => (times[last] + step, last, [last, last]),
        };
        [before, after]
    }

    /// The pose at a key of one of the camera's tracks. A track without a key there goes the way
    /// between its own keys as a camera does, so that a key of another track does not bend it. One
    /// that holds its value is as `held` says.
    fn key_pose(&self, time: f64, held: &[Hold]) -> Pose {
        let mut camera = self.key_camera(time);
        for track in POSE.iter().filter_map(|of| self.track(of)) {
            let index = track.index_at(time);
            let key = &track.keys[index];
            let Some(next) = track.keys.get(index + 1).filter(|_| key.time < time) else {
                continue;
            };
            if track.of == "camera.up" && self.own_up(time).is_some() {
                continue;
            }
            let pose = |time: f64| {
                let camera = self.key_camera(time);
                Pose::new(camera.eye, camera.target, camera.up)
            };
            let share = (time - key.time) / (next.time - key.time);
            let share = match track.between_at(index) {
                Between::Smooth => share,
                between => between.share(share),
            };
            let there = pose(key.time).toward(&pose(next.time), share);
            *field(&mut camera, &track.of) = match track.of.as_str() {
                "camera.eye" => there.eye,
                "camera.target" => there.target(),
                _ => there.up(),
            };
        }
        for hold in held {
            self.hold(&mut camera, *hold);
        }
        Pose::new(camera.eye, camera.target, camera.up)
    }

    /// The camera by its tracks alone, each on its own.
    fn key_camera(&self, time: f64) -> Camera {
        let mut camera = self.camera.clone();
        for track in POSE.iter().filter_map(|of| self.track(of)) {
            set(&mut camera, track, time);
        }
        camera
    }

    /// Sets what tracks that hold their value from a time on say of another.
    fn hold(&self, camera: &mut Camera, Hold { of, at }: Hold) {
        let own = POSE.iter().filter_map(|of| self.track(of));
        for track in own.filter(|t| t.between_at(t.index_at(of)) == Between::Step) {
            set(camera, track, at);
        }
    }

    /// Checks the tracks: their keys exist, and their values fit.
    pub(super) fn check_tracks(&self) -> Result<(), Fault> {
        let mut seen: Vec<&str> = Vec::new();
        for track in &self.tracks {
            let fault = |why: String| Fault::new(format!("track.{}", track.of), why);
            let unless = |fits: bool, why: &str| match fits {
                true => Ok(()),
                false => Err(fault(why.into())),
            };
            unless(
                !seen.contains(&track.of.as_str()),
                "a second track of this key; put all its values into one",
            )?;
            seen.push(&track.of);
            unless(
                !track.of.starts_with("time.") && !track.of.starts_with("image."),
                "time and image stay the same in a film; leave this track out",
            )?;
            unless(
                !track.keys.is_empty(),
                "a track needs one value at least, like [0, 40]",
            )?;
            let ascend = track.keys.windows(2).all(|two| two[0].time < two[1].time);
            unless(ascend, "the times must ascend")?;
            for TrackKey { time, value, .. } in &track.keys {
                if !(0.0..=self.time.length).contains(time) {
                    let length = self.time.length;
                    return Err(fault(format!(
                        "the time {time} is not within 0 and time.length, {length}; move the key, or make the film longer"
                    )));
                }
                let mut at = self.clone();
                at.set_numbers(&track.of, value)
                    .map_err(|why| fault(format!("{value:?}: {why}")))?;
                if POSE.contains(&track.of.as_str()) {
                    let checked = self.key_camera(*time).check();
                    checked.map_err(|wrong| fault(format!("at beat {time}: {}", wrong.why)))?;
                }
            }
        }
        Ok(())
    }
}
