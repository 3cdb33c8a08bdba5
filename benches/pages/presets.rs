//! The page `docs/presets.md`, which explains every key. It is written from the lists that
//! presets are read by, so that it names exactly the keys that exist.

use std::fmt::Write as _;
use std::iter;

use conemarch::base::key::Key;
use conemarch::plan::Plan;
use conemarch::preset::SECTIONS;
use conemarch::scene::Scene;

/// The text above the tables.
const HEAD: &str = include_str!("presets.md");

/// The reference of all keys, section by section, as Markdown.
pub fn reference() -> String {
    let mut text = HEAD.to_string();
    for section in iter::once("").chain(SECTIONS) {
        for scene in Scene::all() {
            let (kind, formula) = (scene.kind(), scene.formula());
            let chosen = formula.map_or(String::new(), |f| format!(", `formula = \"{f}\"`"));
            let head = match section {
                "" => "Above all sections".into(),
                "scene" => format!("`[scene]` with `kind = \"{kind}\"`{chosen}"),
                _ => format!("`[{section}]`"),
            };
            let mut plan = Plan::new(scene);
            table(&mut text, &head, plan.keys(section).unwrap_or_default());
            if section != "scene" {
                // The same for every scene.
                break;
            }
        }
    }
    format!("{}\n", text.trim_end())
}

/// A heading, and a row for each key.
fn table(text: &mut String, head: &str, keys: Vec<Key<'_>>) {
    // Writing to a string cannot fail, here and below.
    let _ = writeln!(text, "## {head}\n");
    text.push_str("| key | what it is | what it takes | default |\n|---|---|---|---|\n");
    for key in keys {
        let (name, takes, default) = (key.name, key.slot.expects(), key.slot.get());
        let [help, takes] = [key.help, &takes].map(|cell| cell.replace('|', "\\|"));
        let _ = writeln!(text, "| `{name}` | {help} | {takes} | `{default}` |");
    }
    text.push('\n');
}
