//! The command line that makes a picture of the window.

use std::path::{Path, PathBuf};

use crate::picture::Layer;
use crate::plan::Plan;
use crate::plan::stereo::Stereo;
use crate::preset::{self, Override, SECTIONS};

/// The command that renders a plan without tracks: the preset of a name as it is known to others,
/// and what differs from it.
///
/// # Errors
/// No command line makes this plan of the preset.
pub fn command(name: &str, plan: &Plan, layer: Layer) -> Result<String, String> {
    let mut now = plan.clone();
    // The window shows what is between the eyes.
    now.camera.stereo = Stereo::Off;
    let mut sets: Vec<String> = Vec::new();
    // What it makes so far, without what this window was started with.
    let made = |sets: &[String]| {
        let read: Result<Vec<_>, _> = sets.iter().map(|set| Override::read(set)).collect();
        let loaded = read.and_then(|read| preset::load(Path::new(name), &read));
        loaded.map_err(|e| e.to_string())
    };
    let mut known = made(&[])?.plan;
    let file = written(name, [&known, &now]);
    let kinds = |plan: &Plan| {
        [
            ("kind", Some(plan.scene.kind())),
            ("formula", plan.scene.formula()),
        ]
    };
    if kinds(&known) != kinds(&now) {
        // The other values of the preset's scene are dropped by these.
        let words = kinds(&now).into_iter();
        let words = words.filter_map(|(key, word)| Some(format!("scene.{key}={}", word?)));
        sets.extend(words);
        known.scene = now.scene.usual();
    }
    let others = |section: &&str| *section != "time";
    for section in SECTIONS.into_iter().filter(others) {
        let old = known.keys(section).unwrap_or_default();
        let new = now.keys(section).unwrap_or_default();
        for (old, new) in old.into_iter().zip(new) {
            let value = new.slot.get();
            // The size is that of the window.
            if value != old.slot.get() && new.name != "size" {
                sets.push(format!("{section}.{}={value}", new.name));
            }
        }
    }
    let makes = made(&sets)?.plan;
    let still = Plan {
        size: now.size,
        time: now.time.clone(),
        title: now.title.clone(),
        tracks: Vec::new(),
        ..makes
    };
    if still != now {
        return Err("no command line makes this picture".into());
    }
    let mut line = format!("conemarch render {}", quoted(name));
    for set in sets {
        line += &format!(" --set {}", quoted(&set));
    }
    if layer != Layer::Color {
        line += &format!(" --layer {}", layer.name());
    }
    let [width, height] = now.size;
    Ok(line + &format!(" --size {width}x{height} -o {file}"))
}

/// The file that the command writes: none that the preset or the picture reads.
fn written(name: &str, plans: [&Plan; 2]) -> String {
    let files = plans.into_iter().flat_map(Plan::files);
    let files = files.map(|(_, path)| path);
    let read: Vec<PathBuf> = files.chain([name.into()]).collect();
    let is_read = |file: &String| read.iter().any(|path| path.ends_with(file));
    let mut file = String::from("picture.png");
    let mut number = 1;
    while is_read(&file) {
        number += 1;
        file = format!("picture-{number}.png");
    }
    file
}

/// A word of a command as a shell takes it.
pub fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "_./=-,".contains(c);
    match text.chars().all(plain) {
        true => text.into(),
        false => format!("'{}'", text.replace('\'', "'\\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::stereo::Stereo;
    use crate::preset::BUILTIN;

    /// Every other plan can be made of a preset, whatever its formula and its kind.
    #[test]
    fn a_command_makes_the_plan_of_any_other_preset() {
        for (name, text) in BUILTIN {
            let mut plan = preset::read(text, name).expect("a preset");
            (plan.tracks, plan.camera.stereo) = (Vec::new(), Stereo::Pair);
            let line = command("mandelbox", &plan, Layer::Depth).expect(name);
            assert!(line.ends_with("-o picture.png") && line.contains("--layer depth"));
            assert!(!line.contains("stereo"), "{line}");
        }
        let plan = preset::load("mandelbox", &[]).expect("a preset").plan;
        let line = command("mandelbox", &plan, Layer::Color).expect("a command");
        assert_eq!(
            line,
            "conemarch render mandelbox --size 1280x720 -o picture.png"
        );
        let mut plan = plan;
        let files = ["a/picture.png", "a/picture.toml"].map(|name| written(name, [&plan; 2]));
        assert_eq!(files, ["picture-2.png", "picture.png"]);
        let before = plan.clone();
        let sky = toml::Value::from("a/picture.png");
        let mut keys = plan.keys("look").expect("a section");
        let key = keys.iter_mut().find(|key| key.name == "sky_file");
        key.expect("a key").slot.set(&sky).expect("a file");
        drop(keys);
        let files = ["a/picture-2.png", "a.toml"].map(|name| written(name, [&plan, &before]));
        assert_eq!(files, ["picture-3.png", "picture-2.png"]);
        let quotes = quoted("it's 1");
        assert_eq!(quotes, "'it'\\''s 1'");
    }
}
