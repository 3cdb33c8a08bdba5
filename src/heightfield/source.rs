//! Where a preset's heights come from: a field or a file, and how it is read.

use std::path::{Path, PathBuf};

use crate::base::key::{Fault, Key, Switch, Text, Word};
use crate::heightfield::load::{LoadOptions, Loaded, PatternSpec, load};

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
    /// A field in one word, or a file's path.
    pub field: String,
    /// The folder that a path is relative to.
    pub folder: PathBuf,
    /// Whether the numbers are depths.
    pub invert: bool,
    /// Whether the lowest becomes 0 and the highest 1.
    pub normalize: bool,
    /// Which axes wrap.
    pub wrap: Wrap,
}

impl Default for Source {
    fn default() -> Self {
        Self {
            field: "fbm".into(),
            folder: PathBuf::new(),
            invert: false,
            normalize: false,
            wrap: Wrap::None,
        }
    }
}

impl Source {
    /// What [`load`] is asked for: the field's word, or the file's path.
    pub fn argument(&self) -> String {
        if PatternSpec::read(&self.field).is_some() {
            return self.field.clone();
        }
        let path = self.folder.join(Path::new(&self.field));
        path.to_string_lossy().into_owned()
    }

    /// The keys that it reads in `[scene]`.
    pub fn keys(&mut self) -> Vec<Key<'_>> {
        vec![
            Key::new(
                "field",
                Text(&mut self.field),
                "a field like fbm:512x512,seed=7,power=2.6, or a file of heights",
            ),
            Key::new(
                "invert",
                Switch(&mut self.invert),
                "whether the numbers are depths",
            ),
            Key::new(
                "normalize",
                Switch(&mut self.normalize),
                "whether the lowest becomes 0 and the highest 1",
            ),
            Key::new(
                "wrap",
                Word(&mut self.wrap, Wrap::WORDS),
                "axes that come round to their start",
            ),
        ]
    }

    /// The heights.
    ///
    /// # Errors
    /// What it names is none, or holds no heights.
    pub fn load(&self) -> Result<Loaded, Fault> {
        let options = LoadOptions {
            wrap: self.wrap.axes(),
            invert: self.invert,
            normalize: self.normalize,
            size: None,
        };
        load(self.argument(), &options).map_err(|e| Fault::new("scene.field", e.to_string()))
    }
}
