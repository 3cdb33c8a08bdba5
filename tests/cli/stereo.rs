//! Stereo pairs: two views in one picture.

use conemarch::base::projection::Projection;
use conemarch::plan::stereo::Stereo;
use conemarch::preset::{BUILTIN, load};

use crate::folder::{Folder, said};
use crate::images::pixels;
use crate::pictures::{exr_layer, values};

/// Eyes half a unit beside the middle, exactly; light at the eye, which must stay there; alpha,
/// variance and counts, so that there is every layer.
const SCENE: &str = "--device cpu --samples 2 --stats s.json --set camera.eye=[0,-16,0] \
    --set camera.target=[0,0,0] --set camera.fov=40 --set look.lamp=2 --set image.background=transparent --set look.shadow=false";
const PAIR: &str = "--size 24x14 --set camera.eyes=0.0625 --set camera.stereo";

/// The command of one eye as a picture of its own.
fn one(side: f64) -> String {
    let shift = -side * 0.03125 / (2.0 * 20_f64.to_radians().tan());
    format!(
        "{SCENE} --size 12x14 --set camera.eye=[{0},-16,0] --set camera.target=[{0},0,0] \
         --set camera.shift={shift} --set look.lamp_at=[0,-16,0] --set look.lamp_toward=[0,0,0] \
         --set look.shadow=false",
        0.5 * side
    )
}

/// Both halves of every channel, in bits.
fn halves(folder: &Folder, name: &str) -> [Vec<(String, Vec<u32>)>; 2] {
    let layer = exr_layer(&folder.0.join(name));
    let names = layer.channel_data.list.iter().map(|c| c.name.to_string());
    let names: Vec<String> = names.collect();
    [0, 1].map(|half| {
        let cut = |name: &String| {
            let rows = values(&layer, name);
            let own = rows.chunks(12).skip(half).step_by(2).flatten();
            (name.clone(), own.map(|x| x.to_bits()).collect())
        };
        names.iter().map(cut).collect()
    })
}

/// Every channel of a picture of one view, in bits.
fn all(folder: &Folder, name: &str) -> Vec<(String, Vec<u32>)> {
    let layer = exr_layer(&folder.0.join(name));
    let names = layer.channel_data.list.iter().map(|c| c.name.to_string());
    let bits = |name: String| {
        let bits = values(&layer, &name).iter().map(|x| x.to_bits()).collect();
        (name, bits)
    };
    names.map(bits).collect()
}

#[test]
fn each_half_of_a_pair_is_the_picture_of_its_eye() {
    let folder = Folder::new();
    for (name, side) in [("left", -1.0), ("right", 1.0)] {
        folder.done(&format!("render mandelbox {} -o {name}.exr", one(side)));
    }
    let [left, right] = ["left.exr", "right.exr"].map(|name| all(&folder, name));
    assert_ne!(left, right);
    let names: Vec<&str> = left.iter().map(|channel| channel.0.as_str()).collect();
    for name in ["A", "Z", "position.X", "variance.Y", "steps.Y"] {
        assert!(names.contains(&name), "{name}: {names:?}");
    }
    for word in ["pair", "cross"] {
        folder.done(&format!("render mandelbox {SCENE} {PAIR}={word} -o a.exr"));
        let mut found = halves(&folder, "a.exr");
        if word == "cross" {
            found.reverse();
        }
        for (found, wanted) in found.iter().zip([&left, &right]) {
            for (found, wanted) in found.iter().zip(wanted) {
                assert_eq!(found, wanted, "{word}");
            }
        }
    }
    let stats = crate::tools::json(&folder.bytes("s.json"));
    assert_eq!(stats["size"], serde_json::json!([24, 14]));
    assert_eq!(stats["passes"][0]["cells"], 24 * 14);
}

#[test]
fn files_films_and_bands_have_both_views() {
    let folder = Folder::new();
    let pair = "--device cpu --set camera.stereo=pair";
    let line = format!("render mandelbox {pair} --size 90x140");
    folder.done(&format!("{line} -o a.png"));
    folder.done(&format!("{line} -o b.png --resume"));
    assert!(folder.bytes("a.png") == folder.bytes("b.png"));
    for name in ["c.jpg", "c.webp"] {
        folder.done(&format!("render mandelbox {pair} --size 24x14 -o {name}"));
        let size = image::load_from_memory(&folder.bytes(name)).expect(name);
        assert_eq!([size.width(), size.height()], [24, 14]);
    }
    for layer in ["depth", "normal", "position", "steps", "state"] {
        folder.done(&format!(
            "render mandelbox {pair} --size 24x14 -o d.png --layer {layer}"
        ));
    }
    // A film, and one of its frames as a still.
    folder.write(
        "f.toml",
        "[scene]\nkind = \"slab\"\n[camera]\nstereo = \"pair\"\n[image]\nsize = [24, 14]\n\
         [time]\nlength = 1\nfps = 2\n[[track]]\nkey = \"camera.eyes\"\nkeys = [[0, 0.1], [1, 0.3]]\n",
    );
    folder.done("animate f.toml --device cpu -o f%d.png");
    folder.done("render f.toml --device cpu --at 0.5 -o still.png");
    assert!(folder.bytes("f1.png") == folder.bytes("still.png"));
    assert_ne!(
        pixels(folder.bytes("f0.png")).1,
        pixels(folder.bytes("f1.png")).1
    );
    let explained = folder.done(&format!("{line} --explain -o x.png"));
    assert!(crate::folder::text(&explained).contains("two views side by side"));
    assert!(!said(&explained).contains("error"));
}

#[test]
fn the_eyes_of_every_preset_are_plans_that_fit() {
    for (name, _) in BUILTIN {
        let mut plan = load(name, &[]).unwrap().plan;
        plan.camera.stereo = Stereo::Pair;
        let is_flat = plan.camera.projection == Projection::Perspective;
        assert_eq!(plan.check().is_ok(), is_flat, "{name}");
        for eye in plan.eyes().into_iter().flatten().filter(|_| is_flat) {
            assert_eq!(eye.check(), Ok(()), "{name}");
            assert_eq!(eye.eyes(), None, "{name}");
        }
    }
}
