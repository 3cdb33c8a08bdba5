//! A heightfield as a preset says it: heights, where they lie in the world, and how they are
//! traced.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::field::Field;
use super::heights::{Heights, MOST_SAMPLES, Patches};
use super::kept::Kept;
use super::placed::Placed;
use crate::key::{Count, Counts, Fault, Key, Number, Switch, Text, Triple, Word};

/// Which axes of a height map come round to their start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// Neither: the map ends at its borders.
    #[default]
    None,
    /// x alone.
    X,
    /// y alone.
    Y,
    /// Both.
    Both,
}

impl Wrap {
    /// The words of presets and the command line.
    pub const WORDS: &[(&str, Self)] = &[
        ("none", Self::None),
        ("x", Self::X),
        ("y", Self::Y),
        ("xy", Self::Both),
    ];

    /// For x and y.
    pub fn axes(self) -> [bool; 2] {
        match self {
            Self::None => [false, false],
            Self::X => [true, false],
            Self::Y => [false, true],
            Self::Both => [true, true],
        }
    }
}

/// What heights are made from.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// A field's name, or a file's path.
    pub field: String,
    /// The folder that a path is relative to.
    pub folder: PathBuf,
    /// Samples of a named field.
    pub samples: [u32; 2],
    /// Seed of a named field.
    pub seed: u32,
    /// Exponent of a named field.
    pub power: f64,
    /// Whether the numbers are depths.
    pub invert: bool,
    /// Which axes wrap.
    pub wrap: Wrap,
}

/// A heightfield: heights, their place in the world, and how they are traced.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightfieldShape {
    /// What its heights are made from.
    pub source: Source,
    /// What lies between the samples.
    pub patches: Patches,
    /// How often the map is repeated along wrapping axes.
    pub tiles: [u32; 2],
    /// Length of the longer side of the block, all tiles together.
    pub width: f64,
    /// Length of the whole height.
    pub depth: f64,
    /// The middle of the base.
    pub centre: DVec3,
    /// Degrees about x, then y, then z.
    pub turn: DVec3,
    kept: Kept<Source, Heights>,
}

impl Default for HeightfieldShape {
    fn default() -> Self {
        Self {
            source: Source {
                field: "fbm".into(),
                folder: PathBuf::new(),
                samples: [256, 256],
                seed: 1,
                power: 2.6,
                invert: false,
                wrap: Wrap::None,
            },
            patches: Patches::Bilinear,
            tiles: [1, 1],
            width: 8.0,
            depth: 1.0,
            centre: DVec3::ZERO,
            turn: DVec3::ZERO,
            kept: Kept::default(),
        }
    }
}

impl HeightfieldShape {
    /// The keys that a relief reads in `[scene]`.
    pub fn keys(&mut self) -> Vec<Key<'_>> {
        let source = &mut self.source;
        vec![
            Key::new(
                "field",
                Text(&mut source.field),
                "a field's name (fbm, ridges, spikes, checker, sine, noise), or a file of heights",
            ),
            Key::new(
                "samples",
                Counts(&mut source.samples, 1, MOST_SAMPLES),
                "samples of a named field",
            ),
            Key::new(
                "seed",
                Count(&mut source.seed, 0, u32::MAX),
                "seed of a named field",
            ),
            Key::new(
                "power",
                Number(&mut source.power, 0.0, 6.0),
                "how fast the waves of fbm and ridges fall: 2.6 rough, 4 smooth",
            ),
            Key::new(
                "invert",
                Switch(&mut source.invert),
                "whether the file's numbers are depths",
            ),
            Key::new(
                "wrap",
                Word(&mut source.wrap, Wrap::WORDS),
                "axes that come round to their start",
            ),
            Key::new(
                "surface",
                Word(
                    &mut self.patches,
                    &[("bilinear", Patches::Bilinear), ("boxes", Patches::Boxes)],
                ),
                "what lies between the samples",
            ),
            Key::new(
                "tiles",
                Counts(&mut self.tiles, 1, 256),
                "how often the map is repeated along x and y",
            ),
            Key::new(
                "width",
                Number(&mut self.width, 1e-6, 1e6),
                "length of the block's longer side",
            ),
            Key::new(
                "depth",
                Number(&mut self.depth, 1e-6, 1e6),
                "length of the whole height",
            ),
            Key::new(
                "centre",
                Triple(&mut self.centre, -1e6, 1e6),
                "the middle of the block's base",
            ),
            Key::new(
                "turn",
                Triple(&mut self.turn, -360.0, 360.0),
                "degrees that the block is turned by about x, then y, then z",
            ),
        ]
    }

    /// Whether heights and repetitions fit together. A file of heights is read.
    pub fn check(&self) -> Result<(), Fault> {
        for (axis, name) in [(0, "x"), (1, "y")] {
            if self.tiles[axis] > 1 && !self.source.wrap.axes()[axis] {
                return Err(Fault::new(
                    "scene.tiles",
                    format!(
                        "the map is repeated along {name}, where it does not wrap; wrap = \"xy\" would do"
                    ),
                ));
            }
        }
        if Field::named(&self.source.field).is_none() {
            self.heights()?;
        }
        Ok(())
    }

    /// The heights: made once, then kept while their source stays.
    pub fn heights(&self) -> Result<Arc<Heights>, Fault> {
        self.kept
            .get(self.source.clone(), |source| source.heights())
    }

    /// Where the block stands, once its heights are known.
    pub fn placed(&self, heights: &Heights) -> Placed {
        let cells = heights.cells(self.patches);
        let sides = DVec2::new(
            f64::from(cells[0] * self.tiles[0]),
            f64::from(cells[1] * self.tiles[1]),
        );
        Placed::new(sides, self.width, self.depth, self.centre, self.turn)
    }
}

impl Source {
    /// The file that heights are read from; none for a named field.
    pub fn file(&self) -> Option<PathBuf> {
        let named = Field::named(&self.field).is_some();
        (!named).then(|| self.folder.join(Path::new(&self.field)))
    }
}
