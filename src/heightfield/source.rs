//! Where the heights of a preset come from: a pattern or a file, and how they are read.

use std::path::{Path, PathBuf};

use crate::base::key::{Fault, Key, switch, text, word};
use crate::heightfield::load::{LoadOptions, Loaded, PatternSpec, load};
use crate::keys;

/// The axes along which a height map wraps: its last sample is next to its first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// Neither.
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

    /// Whether x and y wrap.
    pub fn axes(self) -> [bool; 2] {
        match self {
            Self::None => [false, false],
            Self::X => [true, false],
            Self::Y => [false, true],
            Self::Both => [true, true],
        }
    }
}

/// The source of heights.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// A pattern, or the path of a file.
    pub field: String,
    /// The folder that a path is relative to.
    pub folder: PathBuf,
    /// Whether the numbers are depths.
    pub invert: bool,
    /// Whether the heights are stretched to the range from 0 to 1.
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
    /// The argument of [`load`]: the pattern, or the file's whole path.
    pub fn argument(&self) -> String {
        if PatternSpec::read(&self.field).is_some() {
            return self.field.clone();
        }
        let path = self.folder.join(Path::new(&self.field));
        path.to_string_lossy().into_owned()
    }

    /// Its keys in `[scene]`.
    pub fn keys(&mut self) -> Vec<Key<'_>> {
        keys![
            "field" = text(&mut self.field),
                "a pattern like fbm:512x512,seed=7,power=2.6, or a file of heights";
            "invert" = switch(&mut self.invert),
                "whether the numbers are depths";
            "normalize" = switch(&mut self.normalize),
                "whether to stretch the heights to the range from 0 to 1";
            "wrap" = word(&mut self.wrap, Wrap::WORDS),
                "axes along which the map repeats";
        ]
    }

    /// Loads the heights.
    ///
    /// # Errors
    /// There is no such pattern, or the file holds no heights.
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
