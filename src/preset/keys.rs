//! The list of all keys, for who completes or explains them.

use crate::plan::Plan;
use crate::preset::document::SECTIONS;
use crate::scene::Scene;

/// Every `section.key` that `--set` takes, with its help.
pub fn keys() -> Vec<(String, &'static str)> {
    let first = [
        ("title", "a name of the picture, for people"),
        ("scene.kind", "what kind of scene it is"),
        ("scene.formula", "the formula of a distance scene"),
    ];
    let mut all = first.map(|(path, help)| (path.to_string(), help)).to_vec();
    for section in SECTIONS {
        for mut plan in Scene::all().into_iter().map(Plan::new) {
            for key in plan.keys(section).unwrap_or_default() {
                let path = format!("{section}.{}", key.name);
                if all.iter().all(|(known, _)| *known != path) {
                    all.push((path, key.help));
                }
            }
        }
    }
    all
}
