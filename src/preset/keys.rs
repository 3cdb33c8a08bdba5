//! The list of all keys, for who completes or explains them.

use crate::plan::Plan;
use crate::preset::document::SECTIONS;
use crate::preset::read::kinds;
use crate::scene::Scene;

/// Every `section.key` that `--set` takes, with its help and the words that it takes, if it does.
pub fn keys() -> Vec<(String, &'static str, Vec<String>)> {
    let scenes = Scene::all();
    let formulas = scenes.iter().filter_map(|scene| scene.formula());
    let first = [
        ("title", "a name of the picture, for people", vec![]),
        ("scene.kind", "what kind of scene it is", kinds()),
        (
            "scene.formula",
            "the formula of a distance scene",
            formulas.collect(),
        ),
    ];
    let text = |words: Vec<&str>| words.into_iter().map(String::from).collect();
    let mut all = Vec::from(first.map(|(path, help, words)| (path.to_string(), help, text(words))));
    for section in SECTIONS {
        for mut plan in Scene::all().into_iter().map(Plan::new) {
            for key in plan.keys(section).unwrap_or_default() {
                let path = format!("{section}.{}", key.name);
                if all.iter().all(|(known, ..)| *known != path) {
                    all.push((path, key.help, words(&key.slot.expects())));
                }
            }
        }
    }
    all
}

/// The words in quotes that a key expects, or those of a switch.
pub(super) fn words(expects: &str) -> Vec<String> {
    match expects {
        "true or false" => vec!["true".into(), "false".into()],
        _ => expects
            .split('"')
            .skip(1)
            .step_by(2)
            .map(String::from)
            .collect(),
    }
}
