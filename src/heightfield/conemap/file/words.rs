//! Kinds of maps and wrapping in words, as labels, options and sentences use them.

use crate::heightfield::conemap::MapKind;

/// Kinds with the words that stand for them, and what they promise.
const KINDS: [(MapKind, &str, &str); 5] = [
    (
        MapKind::Samples,
        "samples",
        "apex on a sample, no other sample inside",
    ),
    (
        MapKind::Quad,
        "quad",
        "apex on a sample, one cone for each of four sides",
    ),
    (
        MapKind::Relaxed,
        "relaxed",
        "apex on a sample, a ray inside should cross the surface once",
    ),
    (
        MapKind::Walk,
        "walk",
        "apex over a cell, proven for the surface between the samples",
    ),
    (
        MapKind::WalkRelaxed,
        "walk-relaxed",
        "apex over a cell, proven for rays that go down",
    ),
];

fn row(kind: MapKind) -> (MapKind, &'static str, &'static str) {
    let found = KINDS.into_iter().find(|(k, _, _)| *k == kind);
    found.expect("every kind has its row")
}

/// The word for a kind.
pub fn kind_word(kind: MapKind) -> &'static str {
    row(kind).1
}

/// What the cones of a kind promise, in words.
pub fn promise(kind: MapKind) -> &'static str {
    row(kind).2
}

/// The kind that a word stands for.
pub fn kind_named(word: &str) -> Option<MapKind> {
    let found = KINDS.into_iter().find(|(_, w, _)| *w == word);
    found.map(|(kind, _, _)| kind)
}

/// `none`, `x`, `y` or `xy`.
pub fn wrap_word(wrap: [bool; 2]) -> &'static str {
    match wrap {
        [false, false] => "none",
        [true, false] => "x",
        [false, true] => "y",
        [true, true] => "xy",
    }
}

/// What `none`, `x`, `y` or `xy` means.
pub(crate) fn wrap_named(word: &str) -> Option<[bool; 2]> {
    let all = [[false, false], [true, false], [false, true], [true, true]];
    all.into_iter().find(|wrap| wrap_word(*wrap) == word)
}

/// Ratios in a place of a map.
pub(crate) fn ratios_per_place(kind: MapKind) -> usize {
    if kind == MapKind::Quad { 4 } else { 1 }
}

/// Whether the places of a map are cells.
pub fn is_walk(kind: MapKind) -> bool {
    matches!(kind, MapKind::Walk | MapKind::WalkRelaxed)
}
