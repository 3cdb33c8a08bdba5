//! The views in which modes are compared.

/// Presets of Mandelboxes.
pub const VIEWS: [&str; 6] = [
    "bench-far",
    "bench-graze",
    "bench-inside",
    "bench-outside",
    "bench-thin",
    "mandelbox-gate",
];
