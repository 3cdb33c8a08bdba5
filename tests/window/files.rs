//! Files that change or are broken, and work that no file has yet.

use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use conemarch::preset;

use crate::desktop::{Desktop, Preview, Shot};
use crate::folder::Folder;
use crate::{FILM, SIZE, picture};

#[test]
fn a_still_and_unsaved_work_outlive_the_window() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    folder.write("film.toml", FILM);
    let view = Preview::open(&desktop, &folder.0, &format!("film.toml {SIZE}"));
    view.at_rest();
    view.key("F12");
    for _ in 0..100 {
        if folder.files().contains(&"film-1.png".to_string()) {
            break;
        }
        sleep(Duration::from_millis(100));
    }
    folder.done("render film.toml --at 0 -o a.png");
    assert_eq!(
        folder.files(),
        ["a.png", "cache", "film-1.png", "film.toml"]
    );
    assert!(picture(&folder, "film-1.png") == picture(&folder, "a.png"));
    view.hold("w", 400);
    sleep(Duration::from_millis(2500));
    // A crash.
    drop(view);
    let kept = std::fs::read_dir(folder.0.join("cache/conemarch")).unwrap();
    let kept = kept.map(|file| file.unwrap().path());
    // The lock of the window is left over.
    let kept: Vec<_> = kept
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    assert_eq!(kept.len(), 1, "{kept:?}");
    let before = preset::load(folder.0.join("film.toml"), &[]).unwrap().plan;
    let plan = preset::load(&kept[0], &[]).unwrap().plan;
    assert!(plan.camera != before.camera && plan.scene == before.scene);
}

#[test]
fn a_still_is_finished_though_the_window_is_busy_hidden_or_closed() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let large = FILM.replace("[320, 180]", "[2560, 1440]");
    folder.write("film.toml", large.replace("fps", "loop = true\nfps"));
    let view = Preview::open(&desktop, &folder.0, &format!("film.toml {SIZE}"));
    let has = |name: &str| {
        let began = Instant::now();
        while !folder.files().contains(&name.to_string()) {
            assert!(began.elapsed() < Duration::from_secs(60), "no {name}");
            sleep(Duration::from_millis(100));
        }
    };
    view.at_rest();
    view.key("F12");
    view.hide(true);
    has("film-1.png");
    view.hide(false);
    // The film loops, and goes on.
    view.key("F12");
    view.key("space");
    has("film-2.png");
    let shot = view.shot();
    view.wait_for("the film", |later| Some(later) != shot.as_ref());
    view.key("space");
    view.key("F12");
    view.close();
    has("film-3.png");
    folder.done("render film.toml --at 0 -o a.png");
    for name in ["film-1.png", "film-2.png"] {
        assert!(picture(&folder, name) == picture(&folder, "a.png"));
    }
}

/// The first rows of a picture.
fn upper(shot: &Shot, rows: usize) -> &[u8] {
    &shot.rgb[..rows * 3 * shot.size[0] as usize]
}

#[test]
fn what_is_wrong_with_a_file_is_told_over_the_last_good_picture() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    folder.write("film.toml", FILM);
    let view = Preview::open(&desktop, &folder.0, "film.toml --size 640x360");
    view.key("Tab");
    view.key("t");
    folder.done("render film.toml --size 640x360 --at 0 -o a.png");
    let good = picture(&folder, "a.png");
    let is_good = |shot: &Shot| *shot == good;
    let is_told = |shot: &Shot| *shot != good && upper(shot, 240) == upper(&good, 240);
    view.wait_for("the good picture", is_good);
    let heights = "[scene]\nkind = 'heightfield'\nfield = 'none.png'\n";
    for (what, wrong) in [
        ("broken text", FILM.replace("[time]", "[time")),
        (
            "a track of no key",
            FILM.replace("\"camera.eye\"", "\"camera.eyes\""),
        ),
        ("a key beyond the end", FILM.replace("[2, [", "[2.5, [")),
        ("heights that are gone", heights.into()),
    ] {
        sleep(Duration::from_millis(20));
        folder.write("film.toml", wrong);
        view.wait_for(what, is_told);
        sleep(Duration::from_millis(20));
        folder.write("film.toml", FILM);
        view.wait_for("the mended film", is_good);
    }
    // What is told for a while does not take the place of an error that lasts.
    folder.write("film.toml", heights);
    view.wait_for("an error", is_told);
    view.key("ctrl+c");
    sleep(Duration::from_secs(7));
    assert!(view.shot().is_some_and(|shot| is_told(&shot)));
    folder.write("film.toml", FILM);
    view.wait_for("the mended film", is_good);
    // The same file goes and comes back.
    let [file, aside] = ["film.toml", "aside.toml"].map(|name| folder.0.join(name));
    std::fs::rename(&file, &aside).unwrap();
    view.wait_for("that the film is gone", is_told);
    std::fs::rename(&aside, &file).unwrap();
    view.wait_for("the film that is back", is_good);
    view.close();
}

/// What `--set` has set stays over a file that another program writes, and what was undone is no
/// unsaved work.
#[test]
fn a_file_that_is_read_again_keeps_what_was_set_over_it() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    folder.write("film.toml", FILM);
    let view = Preview::open(
        &desktop,
        &folder.0,
        &format!("film.toml {SIZE} --set look.key=3"),
    );
    view.at_rest();
    folder.write("film.toml", format!("{FILM}\n[march]\ndetail = 0.9\n"));
    sleep(Duration::from_millis(1000));
    view.hold("w", 300);
    sleep(Duration::from_millis(2000));
    let kept = || {
        let all = std::fs::read_dir(folder.0.join("cache/conemarch")).unwrap();
        let all = all.map(|file| file.unwrap().path());
        all.filter(|path| path.extension().is_some_and(|e| e == "toml"))
            .collect::<Vec<_>>()
    };
    let plan = preset::load(&kept()[0], &[]).unwrap().plan;
    assert_eq!((plan.look.key, plan.march.detail), (3.0, 0.9));
    view.key("ctrl+z");
    sleep(Duration::from_millis(2000));
    assert_eq!(kept().len(), 0);
}

#[test]
fn work_that_cannot_be_kept_is_not_dropped_at_once() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    // No folder can be made there.
    folder.write("cache", "");
    let mut view = Preview::open(&desktop, &folder.0, &format!("mandelbox {SIZE}"));
    view.hold("w", 400);
    view.at_rest();
    let stays = |view: &mut Preview| {
        view.key("ctrl+q");
        sleep(Duration::from_millis(1500));
        assert!(view.is_open());
    };
    stays(&mut view);
    // It is kept as soon as it can be.
    std::fs::remove_file(folder.0.join("cache")).unwrap();
    sleep(Duration::from_millis(3500));
    let file = folder.0.join("cache/conemarch/unsaved-mandelbox.toml");
    assert!(file.exists());
    view.hold("a", 200);
    std::fs::remove_dir_all(folder.0.join("cache")).unwrap();
    folder.write("cache", "");
    sleep(Duration::from_millis(2500));
    stays(&mut view);
    // What was said holds no longer once the work is saved.
    view.key("ctrl+s");
    view.hold("w", 200);
    stays(&mut view);
    view.close();
}

#[test]
fn another_preset_keeps_unsaved_work_and_none_is_lost() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let kept = || {
        let files = std::fs::read_dir(folder.0.join("cache/conemarch"));
        let names = files.map(|all| all.map(|f| f.unwrap().file_name().into_string().unwrap()));
        let names = names
            .into_iter()
            .flatten()
            .filter(|name| name.ends_with(".toml"));
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    };
    let view = Preview::open(&desktop, &folder.0, "mandelbox --size 960x540");
    let first = view.at_rest();
    view.hold("w", 400);
    let flown = view.at_rest();
    // The list of presets, and in it `bench-far` and `mandelbox`.
    let choose = |row: u32| {
        view.click(700, 16);
        sleep(Duration::from_millis(700));
        view.click(680, 43 + 23 * row);
    };
    choose(0);
    view.at_rest();
    assert_eq!(kept(), ["unsaved-mandelbox.toml"]);
    let left = |shot: &Shot| {
        let rows = shot.rgb.chunks_exact(3 * 960).skip(140).take(340);
        rows.flat_map(|row| &row[..3 * 600])
            .copied()
            .collect::<Vec<_>>()
    };
    // It is offered over the preset as it is.
    choose(6);
    let same = |shot: &Shot, wanted: &Shot| left(shot) == left(wanted);
    view.wait_for("the preset again", |shot| same(shot, &first));
    // Whoever goes on without an answer loses neither the old nor the new work.
    view.hold("d", 300);
    sleep(Duration::from_millis(2500));
    assert_eq!(
        kept(),
        ["unsaved-mandelbox-1.toml", "unsaved-mandelbox.toml"]
    );
    // Restore.
    view.click(RESTORE[0], RESTORE[1]);
    view.wait_for("the work again", |shot| same(shot, &flown));
    // What was done before the answer is there too, by an undo and at the next start.
    view.key("ctrl+z");
    view.wait_for("the work before the answer", |shot| {
        !same(shot, &flown) && !same(shot, &first)
    });
    view.key("ctrl+y");
    view.wait_for("the work again", |shot| same(shot, &flown));
    assert_eq!(
        kept(),
        ["unsaved-mandelbox-1.toml", "unsaved-mandelbox.toml"]
    );
    // What is undone is no work, however soon the window is closed. What was restored stays.
    view.key("ctrl+z");
    view.key("ctrl+z");
    view.close();
    assert_eq!(kept(), ["unsaved-mandelbox.toml"]);
}

#[test]
fn a_film_that_is_restored_shows_its_moment() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    // The still of the file is none of the film's moments.
    folder.write("film.toml", FILM);
    let view = Preview::open(&desktop, &folder.0, "film.toml --size 960x540");
    let first = view.at_rest();
    // A key of what is shown is a change of the film.
    view.key("period");
    view.key("k");
    sleep(Duration::from_millis(2500));
    drop(view);
    let view = Preview::open(&desktop, &folder.0, "film.toml --size 960x540");
    view.at_rest();
    view.click(RESTORE[0], RESTORE[1]);
    let left = |shot: &Shot| {
        let rows = shot.rgb.chunks_exact(3 * 960).skip(140).take(240);
        rows.flat_map(|row| &row[..3 * 600])
            .copied()
            .collect::<Vec<_>>()
    };
    view.wait_for("the first moment", |shot| left(shot) == left(&first));
    folder.done("render film.toml --size 960x540 -o still.png");
    assert!(left(&picture(&folder, "still.png")) != left(&first));
    view.close();
}

/// The button that takes unsaved work, in a window of 960 x 540.
const RESTORE: [u32; 2] = [346, 89];

/// Copies a folder and the folders in it.
fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let to = to.join(entry.file_name());
        match entry.path().is_dir() {
            true => copy(&entry.path(), &to),
            false => _ = std::fs::copy(entry.path(), to).unwrap(),
        }
    }
}

#[test]
fn shaders_are_read_again_and_a_paused_film_stays_paused() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("wgsl");
    copy(&own, &folder.0.join("wgsl"));
    folder.write("film.toml", FILM);
    let line = "film.toml --size 640x360 --wgsl wgsl";
    let view = Preview::open(&desktop, &folder.0, line);
    view.key("Tab");
    view.key("t");
    for _ in 0..3 {
        view.key("period");
    }
    folder.done("animate film.toml --set image.size=[640,360] -o f-%02d.png --frames 2..3");
    let [before, good] = ["f-02.png", "f-03.png"].map(|name| picture(&folder, name));
    let is_good = |shot: &Shot| *shot == good;
    view.wait_for("a frame of the film", is_good);
    let edit = |file: &str, from: &str, to: &str| {
        sleep(Duration::from_millis(20));
        let text = std::fs::read_to_string(own.join(file)).unwrap();
        assert!(text.contains(from), "{file} has no `{from}`");
        folder.write(&format!("wgsl/{file}"), text.replace(from, to));
    };
    let (tone, store) = ("pass/tone.wgsl", "(bytes) / 255.0");
    // Without red, and the notice is gone.
    edit(tone, store, "(bytes) / 255.0 * vec3<f32>(0.0, 1.0, 1.0)");
    let [blue_before, blue] = [before, good.clone()].map(|mut shot| {
        shot.rgb.chunks_exact_mut(3).for_each(|p| p[0] = 0);
        shot
    });
    view.wait_for("the other shader", |shot| *shot == blue);
    // An error lies over pictures by the last shader that worked.
    edit(tone, store, "(nothing) / 255.0");
    for (key, blue) in [
        (None, &blue),
        (Some("comma"), &blue_before),
        (Some("period"), &blue),
    ] {
        key.into_iter().for_each(|key| view.key(key));
        view.wait_for("what is wrong", |shot| {
            *shot != *blue && upper(shot, 240) == upper(blue, 240)
        });
    }
    edit(tone, store, store);
    view.wait_for("the mended shader", is_good);
    // A loop without an end leaves a window that answers. Of the loops that a driver cuts off, pixels
    // are wrong.
    let (trace, steps) = ("pass/trace.wgsl", "let last = queue_steps();");
    let endless = "var x = ray.k; for (var j = 0u; j < 4000000000u; j++) { x = fract(x * 1.7 + 0.31); } if x > 2.0 { return; }";
    edit(trace, steps, &format!("{steps} {endless}"));
    view.wait_for("that the shader is read", |shot| !is_good(shot));
    view.key("Tab");
    view.wait_for("the panel", |shot| {
        let right = shot.rgb.chunks_exact(3 * 640).take(300);
        right.fold(0, |n, row| {
            n + row[3 * 320..].iter().filter(|x| **x < 40).count()
        }) > 50_000
    });
    view.key("Tab");
    edit(trace, steps, steps);
    view.wait_for("the shader without the loop", is_good);
    view.close();
}
