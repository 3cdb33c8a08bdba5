//! The presets that are compiled in.

/// Makes the list of presets from the names of the files in `presets/`.
macro_rules! presets {
    ($($name:literal),* $(,)?) => {
        /// Name and text of every built-in preset, in alphabetical order.
        pub const BUILTIN: &[(&str, &str)] = &[
            $(($name, include_str!(concat!("../../presets/", $name, ".toml")))),*
        ];
    };
}

presets![
    "bench-far",
    "bench-graze",
    "bench-inside",
    "bench-outside",
    "bench-thin",
    "bricks",
    "mandelbox",
    "mandelbox-avenue",
    "mandelbox-canyon",
    "mandelbox-citadel",
    "mandelbox-clay",
    "mandelbox-corner",
    "mandelbox-ember",
    "mandelbox-forge",
    "mandelbox-gate",
    "mandelbox-globe",
    "mandelbox-gold",
    "mandelbox-grotto",
    "mandelbox-hall",
    "mandelbox-julia",
    "mandelbox-lantern",
    "mandelbox-lattice",
    "mandelbox-miniature",
    "mandelbox-plain",
    "mandelbox-reef",
    "mandelbox-shell",
    "mandelbox-shrine",
    "mandelbox-stage",
    "mandelbox-temple",
    "mandelbox-towers",
    "mandelbox-vault",
    "mandelbox-vortex",
    "map-kinds",
    "spikes",
    "stones",
    "terrain",
    "tiles-deep",
    "tiles-shallow",
    "valley-mist",
];

/// The text of a built-in preset.
pub fn builtin(name: &str) -> Option<&'static str> {
    let found = BUILTIN.iter().find(|(n, _)| *n == name);
    found.map(|(_, text)| *text)
}
