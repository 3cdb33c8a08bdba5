//! What shaders leave out to be quick, against shaders that leave nothing out.

use std::sync::Arc;

use conemarch::base::shader::Sources;
use conemarch::measure::flip::flip;
use conemarch::plan::Extras;
use conemarch::preset::BUILTIN;
use conemarch::scene::Assets;

use super::common::plans::sized;
use super::shown;
use crate::adapter;

/// The mean FLIP difference that haste may make.
const HASTE: f64 = 0.01;

/// A text of a shader file in which a part is replaced.
pub fn replaced(text: &str, part: &str, by: &str) -> String {
    assert_eq!(text.matches(part).count(), 1, "{part}");
    text.replace(part, by)
}

/// Shader files whose estimates are computed one by one, whose rays from a point share nothing,
/// and whose searches for free room go on to the end.
fn unhurried(path: &str) -> Option<String> {
    const ONE_BY_ONE: &str = include_str!("../../wgsl/formula/four_plain.wgsl");
    const DISTANCE: &str = include_str!("../../wgsl/scene/distance.wgsl");
    const HEIGHTFIELD: &str = include_str!("../../wgsl/scene/heightfield.wgsl");
    match path {
        "wgsl/formula/four_folds.wgsl" => Some(ONE_BY_ONE.to_string()),
        "wgsl/scene/distance.wgsl" => Some(replaced(
            DISTANCE,
            "    if walk.t == 0.0 && walk.end >= 0.0 && opened.walk.radius > 0.0 {",
            "    if false {",
        )),
        "wgsl/scene/heightfield.wgsl" => Some(replaced(
            HEIGHTFIELD,
            "    return mix(empty_radius(p, rest), gap,",
            "    return mix(empty_radius(p, 1e30), gap,",
        )),
        _ => None,
    }
}

/// Heightfields whose search for free room, that of [`unhurried`], finds none.
fn without_room(path: &str) -> Option<String> {
    let text = unhurried(path)?;
    (path == "wgsl/scene/heightfield.wgsl")
        .then(|| replaced(&text, "mix(empty_radius(p, 1e30), gap,", "mix(0.0, gap,"))
}

#[test]
fn what_shaders_leave_out_is_not_seen_on_any_preset() {
    let mut differ = Vec::new();
    for (name, _) in BUILTIN {
        let plan = sized(name, [240, 135]);
        let mut renderer = adapter::open();
        let [quick, slow] = [None, Some(Arc::new(unhurried) as Sources)].map(|sources| {
            renderer.sources = sources;
            let assets = Assets::default();
            let frame = renderer.render(&plan, &assets, Extras::default(), &mut |_| true);
            shown(&plan, &frame.unwrap())
        });
        let apart = flip(plan.size, &slow, &quick);
        println!("{name}: {apart:.5}");
        assert!(apart <= HASTE, "{name}: {apart}");
        if apart > 0.0 {
            differ.push(*name);
        }
    }
    // Fractals change by roundings, so no picture is compared with itself.
    assert!(differ.contains(&"mandelbox"), "{differ:?}");
    assert!(differ.contains(&"bench-thin"), "{differ:?}");
    // Heightfields lose nothing. This one is compared with itself if their shaders stay as they are.
    let plan = sized("stones", [240, 135]);
    let mut renderer = adapter::open();
    let [seeing, blind] = [None, Some(Arc::new(without_room) as Sources)].map(|sources| {
        renderer.sources = sources;
        let frame = renderer.render(&plan, &Assets::default(), Extras::default(), &mut |_| true);
        shown(&plan, &frame.unwrap())
    });
    assert!(flip(plan.size, &blind, &seeing) > HASTE);
}
