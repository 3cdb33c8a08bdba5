//! The page `docs/presets.md`, which explains every key. It is written from the lists that
//! presets are read by, so that it names exactly the keys that exist.

use std::fmt::Write as _;
use std::iter;

use crate::base::key::Key;
use crate::plan::Plan;
use crate::preset::document::SECTIONS;
use crate::scene::Scene;

/// The text above the tables.
const HEAD: &str = "# Presets

<!-- Written by `cargo bench --bench pages -- presets`; do not edit. -->

A preset is a TOML file that describes one picture: a scene, a camera, and how they are rendered.
This is a whole preset:

```toml
title = \"A Mandelbox\"

[scene]
kind = \"distance\"
formula = \"mandelbox\"
scale = -1.5

[camera]
eye = [4.2, -5.6, 3.3]
```

If its file is `box.toml`, `conemarch render box.toml` writes the picture `box.png`. Only
`scene.kind` is required, and `scene.formula` if the kind is \"distance\". The tables show the
defaults of all other keys. An unknown key or a wrong value is an error. The error names the file,
the line and a valid alternative.

`conemarch presets NAME` prints a built-in preset to start from. In `conemarch render PRESET`, each
`--set section.key=value` changes one value, for example `--set camera.fov=30`. Words, fields and
paths need no quotes there, for example `--set scene.field=fbm:64x64,seed=3`. A whole number may
stand for any number. A relative path starts at the folder of the preset, and for a
built-in preset at the current folder.

These are the terms of the tables. [method.md](method.md) explains them in full, and
[benchmarks.md](benchmarks.md) shows what the modes and the keys of `[march]` cost in time and in
error.

- A *distance estimate* is a function that estimates the distance from a point to the surface. A
  ray can move by it without crossing the surface. A *formula* computes it in *iterations*.
- A *cone* contains the rays of a block of pixels. *Cone passes* move cones forward first, for
  smaller and smaller blocks. Rays start where the last cones stopped.
- A *footprint* is half the width of a pixel, at the distance of the hit.
- The *bounds* are a region that contains the whole surface.
- A *heightfield* is a surface over a grid of heights, its *samples*. A *texel* is the distance
  between two samples. Four neighbouring samples are the corners of a *cell*.
- A *cone map* tells, for each place of a heightfield, how wide a cone that opens upwards there
  stays empty. A *generator* makes cone maps. A *tracer* finds where a ray hits a heightfield,
  mostly by means of a cone map. [heightfields.md](heightfields.md) explains all of them.
- A *slab* is a round plate between two parallel planes.

";

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::distance_settings::MOST_ITERATIONS;

    #[test]
    fn the_page_is_what_would_be_written() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/presets.md");
        let text = std::fs::read_to_string(page).expect("the page");
        assert!(
            text == reference(),
            "{page} is out of date; `cargo bench --bench pages -- presets` writes it"
        );
    }

    #[test]
    fn the_limit_of_automatic_iterations_is_told() {
        let help = format!("needs, up to {MOST_ITERATIONS} |");
        assert!(reference().contains(&help), "{help}");
    }
}
