//! The timeline shows the frames of the film, and playing follows the clock.

use std::thread::sleep;
use std::time::{Duration, Instant};

use conemarch::preset;

use crate::desktop::{Desktop, Preview, Shot};
use crate::folder::Folder;
use crate::{FILM, SIZE, picture};

#[test]
fn the_timeline_shows_the_frames_of_the_film() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    folder.write("film.toml", FILM);
    folder.done("animate film.toml -o f-%02d.png --frames 0..7");
    folder.done("animate film.toml -o f-%02d.png --frames 19..19");
    let view = Preview::open(&desktop, &folder.0, &format!("film.toml {SIZE}"));
    view.key("Tab");
    view.key("t");
    let shows = |frame: u32| {
        let wanted = picture(&folder, &format!("f-{frame:02}.png"));
        view.wait_for(&format!("frame {frame}"), |shot| *shot == wanted);
    };
    shows(0);
    // What is flown before another moment is a step, and so is what is flown after it.
    view.xdotool("keydown d sleep 0.4 key period sleep 0.4 keyup d");
    view.at_rest();
    view.key("ctrl+z");
    view.key("ctrl+z");
    assert!(view.at_rest() != picture(&folder, "f-01.png"));
    view.key("ctrl+z");
    shows(1);
    view.key("comma");
    shows(0);
    for _ in 0..7 {
        view.key("period");
    }
    shows(7);
    view.key("comma");
    shows(6);
    // To the end, and it stops there.
    view.key("space");
    folder.done(&format!("render film.toml {SIZE} --at 2 -o end.png"));
    let end = picture(&folder, "end.png");
    view.wait_for("the end of the film", |shot| *shot == end);
    // A key of another view at the end.
    view.hold("d", 300);
    let flown = view.at_rest();
    view.key("k");
    // It shows the timeline.
    view.key("t");
    let saved = view.save(&folder.0.join("film.toml"));
    assert_eq!(saved.tracks.len(), 3);
    assert!(saved.tracks[0].keys[1].value != [17.0, 10.0, 12.0]);
    // The still of the file stays.
    assert_eq!(saved.camera.eye.to_array(), [12.0, -14.0, 3.0]);
    // A step back takes the key away, and another one the flight. Both come back.
    let shows_flown = || view.wait_for("the view of the flight", |shot| *shot == flown);
    view.key("ctrl+z");
    shows_flown();
    view.key("ctrl+z");
    view.wait_for("the end of the film again", |shot| *shot == end);
    view.key("ctrl+shift+z");
    shows_flown();
    view.key("ctrl+shift+z");
    // Under another playhead they go back to the moment there, not to that of the steps.
    folder.done("animate film.toml -o g-%02d.png --frames 19..19");
    let keyed = picture(&folder, "g-19.png");
    view.key("comma");
    view.wait_for("a frame before the key", |shot| *shot == keyed);
    // The view of the flight stays a step.
    view.key("ctrl+z");
    view.key("ctrl+z");
    shows_flown();
    view.key("ctrl+z");
    shows(19);
    // An undo stops the film, which would go on from there.
    view.key("Home");
    let home = view.at_rest();
    view.key("comma");
    view.key("space");
    sleep(Duration::from_millis(500));
    view.key("ctrl+z");
    view.wait_for("the view before the film went on", |shot| *shot == home);
    view.close();
}

#[test]
fn a_key_lies_in_a_film_that_became_shorter_again() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let still = FILM.split("[[track]]").next().unwrap();
    folder.write("film.toml", still);
    let view = Preview::open(&desktop, &folder.0, &format!("film.toml {SIZE}"));
    folder.write("film.toml", still.replace("length = 2", "length = 20"));
    sleep(Duration::from_millis(1500));
    for _ in 0..30 {
        view.key("period");
    }
    view.key("ctrl+z");
    view.key("k");
    let saved = view.save(&folder.0.join("film.toml"));
    assert_eq!(saved.time.length, 2.0);
    let times = saved.tracks.iter().flat_map(|track| &track.keys);
    let times: Vec<f64> = times.map(|key| key.time).collect();
    assert!(
        !times.is_empty() && times.iter().all(|time| *time == 2.0),
        "{times:?}"
    );
    view.close();
}

#[test]
fn playing_drops_pictures_and_never_time() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    // No machine that these tests run on shows so many pictures.
    let film = FILM.replace("length = 2\nfps = 10", "length = 60\nfps = 1000");
    folder.write("film.toml", film);
    let view = Preview::open(&desktop, &folder.0, "film.toml --size 960x540");
    let mut played = 0.0;
    for _ in 0..8 {
        let began = Instant::now();
        view.key("space");
        sleep(Duration::from_millis(600));
        view.key("space");
        played += began.elapsed().as_secs_f64();
        // Long enough to rest.
        sleep(Duration::from_millis(900));
    }
    view.key("k");
    let saved = view.save(&folder.0.join("film.toml"));
    let times = saved.tracks[1].keys.iter().map(|key| key.time);
    let shown = times.fold(0.0, f64::max);
    assert!((shown - played).abs() < 0.6, "{shown} of {played} s");
    view.close();
}

#[test]
fn keys_are_dragged_and_copied_and_a_part_is_played_again() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let film = FILM.replace("length = 2\n", "length = 10\n");
    let film = film.replace("[2, [17", "[5, [17");
    folder.write("film.toml", film);
    let view = Preview::open(&desktop, &folder.0, "film.toml --size 960x540");
    view.key("Tab");
    view.at_rest();
    // A ruler of 20 pixels with the handles at its foot, over a row of 18 for the only track.
    let x = |beat: u32| 118 + beat * 822 / 10;
    let (handles, row) = (513, 529);
    let keys = || {
        sleep(Duration::from_millis(300));
        let plan = view.save(&folder.0.join("film.toml"));
        let times = plan.tracks[0].keys.iter().map(|key| key.time.round());
        times.collect::<Vec<_>>()
    };
    view.drag(1, [x(5), row], [x(7), row]);
    assert_eq!(keys(), [0.0, 7.0]);
    view.xdotool("keydown alt");
    view.drag(1, [x(7), row], [x(3), row]);
    view.xdotool("keyup alt");
    assert_eq!(keys(), [0.0, 3.0, 7.0]);
    view.key("ctrl+z");
    assert_eq!(keys(), [0.0, 7.0]);
    view.key("ctrl+z");
    assert_eq!(keys(), [0.0, 5.0]);
    // The chosen key is gone, and nothing is left for it. What is told is below these rows.
    let above = |shot: &Shot| shot.rgb[..3 * 960 * 440].to_vec();
    view.hold("d", 300);
    view.at_rest();
    let flown = above(&view.at_rest());
    view.key("Delete");
    view.at_rest();
    view.wait_for("the view of the flight", |shot| above(shot) == flown);
    view.key("ctrl+z");
    assert_eq!(keys(), [0.0, 5.0]);
    // The last key is copied too, on a way that begins beyond the end.
    view.drag(1, [x(5), row], [x(10), row]);
    view.xdotool("keydown alt");
    view.point(x(10), row);
    view.xdotool("mousedown 1");
    for to in [x(10) + 12, x(9), x(8)] {
        sleep(Duration::from_millis(300));
        view.point(to, row);
    }
    sleep(Duration::from_millis(300));
    view.xdotool("mouseup 1 keyup alt");
    assert_eq!(keys(), [0.0, 8.0, 10.0]);
    view.key("ctrl+z");
    view.key("ctrl+z");
    assert_eq!(keys(), [0.0, 5.0]);
    // The chosen key gets another view, and is taken away.
    let eye = || {
        assert_eq!(keys(), [0.0, 5.0]);
        let plan = preset::load(folder.0.join("film.toml"), &[]).unwrap().plan;
        plan.tracks[0].keys[1].value.clone()
    };
    let before = eye();
    view.click(x(5), row);
    view.hold("d", 300);
    // A click on the key under the playhead leaves the view of the flight.
    view.at_rest();
    let flown = above(&view.at_rest());
    view.click(x(5), row);
    view.at_rest();
    view.wait_for("the view of the flight", |shot| above(shot) == flown);
    view.key("ctrl+k");
    assert!(eye() != before);
    view.key("Delete");
    assert_eq!(keys(), [0.0]);
    for _ in 0..3 {
        view.key("ctrl+z");
    }
    assert_eq!(eye(), before);
    // Two handles, and the playhead at 7: the part from 4 to 5 is played again and again.
    view.drag(1, [x(10), handles], [x(5), handles]);
    view.drag(1, [x(0), handles], [x(4), handles]);
    view.key("space");
    sleep(Duration::from_millis(1300));
    view.key("space");
    view.key("k");
    let all = keys();
    assert!(
        all.iter().all(|beat| [0.0, 4.0, 5.0].contains(beat)),
        "{all:?}"
    );
    view.close();
}
