//! Traps that colour a fractal, and layers of colour over them: keys of the section `[look]`.

use glam::DVec3;

use super::look::MOST_STOPS;
use crate::base::key::{number, triples, word};
use crate::base::named::named_enum;
use crate::settings;

named_enum! {
    /// What an orbit is measured by, to pick a colour.
    pub enum Trap {
        /// The formula's own numbers, which also shade the colours; for a further layer none.
        Auto = "auto",
        /// How near it comes to the origin.
        Point = "point",
        /// How near it comes to the z axis.
        Line = "line",
        /// How near it comes to the plane z = 0.
        Plane = "plane",
        /// How near it comes to a sphere about the origin.
        Sphere = "sphere",
        /// How near it comes to any of the axes.
        Cross = "cross",
        /// How many iterations it takes to escape, without steps.
        Iterations = "iterations",
        /// How often it is folded.
        Folds = "folds",
    }
}

/// The traps of further layers.
const OVER: &[(&str, Trap)] = &[
    ("none", Trap::Auto),
    ("point", Trap::Point),
    ("line", Trap::Line),
    ("plane", Trap::Plane),
    ("sphere", Trap::Sphere),
    ("cross", Trap::Cross),
    ("iterations", Trap::Iterations),
    ("folds", Trap::Folds),
];

named_enum! {
    /// How a layer is laid over the colour below.
    pub enum Blend {
        /// In its place.
        Mix = "mix",
        /// As a filter: the product of the two.
        Multiply = "multiply",
        /// As light: the product of what the two lack of white.
        Screen = "screen",
    }
}

/// The default colours of a further layer, sRGB.
fn colors() -> Vec<DVec3> {
    vec![DVec3::new(0.10, 0.12, 0.20), DVec3::new(0.95, 0.85, 0.65)]
}

settings! {
    /// Traps and layers.
    pub struct Layers {
        trap: Trap = Trap::Auto, word(&Trap::WORDS), "what picks the colour of a fractal, and only auto for other scenes: auto is the formula's own mixture; or how near the orbit comes to a point, line, plane, sphere or cross, how many iterations it takes to escape, or how often it is folded" => Program;
        trap_scale: f64 = 1.0, number(-1000.0, 1000.0), "factor on the number of the trap, which is 0 at the shape and below 1, or grows by 0.1 with each iteration or fold";
        trap_offset: f64 = 0.0, number(-1000.0, 1000.0), "number that is added to the trap's after the scale";
        layer2_trap: Trap = Trap::Auto, word(OVER), "the trap of a second layer of colour over the first" => Program;
        layer2_palette: Vec<DVec3> = colors(), triples(MOST_STOPS, 0.0, 1.0), "colours of the second layer, sRGB";
        layer2_scale: f64 = 1.0, number(-1000.0, 1000.0), "factor on the number of its trap";
        layer2_offset: f64 = 0.0, number(-1000.0, 1000.0), "number that is added to the trap's after the scale";
        layer2_blend: Blend = Blend::Mix, word(&Blend::WORDS), "how it is laid over the first";
        layer2_weight: f64 = 0.5, number(0.0, 1.0), "its share of the colour";
        layer3_trap: Trap = Trap::Auto, word(OVER), "the trap of a third layer of colour over the others" => Program;
        layer3_palette: Vec<DVec3> = colors(), triples(MOST_STOPS, 0.0, 1.0), "colours of the third layer, sRGB";
        layer3_scale: f64 = 1.0, number(-1000.0, 1000.0), "factor on the number of its trap";
        layer3_offset: f64 = 0.0, number(-1000.0, 1000.0), "number that is added to the trap's after the scale";
        layer3_blend: Blend = Blend::Mix, word(&Blend::WORDS), "how it is laid over the others";
        layer3_weight: f64 = 0.5, number(0.0, 1.0), "its share of the colour";
    }
}

impl Layers {
    /// Whether a trap is asked for.
    pub fn are_on(&self) -> bool {
        self.first_on().is_some()
    }

    /// The first key that asks for a trap.
    pub fn first_on(&self) -> Option<&'static str> {
        let traps = [self.trap, self.layer2_trap, self.layer3_trap].into_iter();
        let keys = ["look.trap", "look.layer2_trap", "look.layer3_trap"];
        let mut on = traps.zip(keys).filter(|(trap, _)| *trap != Trap::Auto);
        on.next().map(|(_, key)| key)
    }
}
