//! Where the heights of a preset come from: a pattern or a file, and how they are read.

use std::path::{Path, PathBuf};

use crate::base::key::{Fault, Key, switch, text, word};
use crate::heightfield::heights::WRAPS;
use crate::heightfield::load::{LoadOptions, Loaded, PatternSpec, load};
use crate::keys;

/// The source of heights.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// A pattern, or the path of a file.
    pub field: String,
    /// The folder that a path is relative to.
    pub folder: PathBuf,
    /// How it is read.
    pub options: LoadOptions,
}

impl Default for Source {
    fn default() -> Self {
        Self {
            field: "fbm".into(),
            folder: PathBuf::new(),
            options: LoadOptions::default(),
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

    /// Samples along each axis; `None` for a file.
    pub fn pattern_size(&self) -> Option<[u32; 2]> {
        Some(PatternSpec::read(&self.field)?.ok()?.size)
    }

    /// Its keys in `[scene]`.
    pub fn keys(&mut self) -> Vec<Key<'_>> {
        keys![
            "field" = text(&mut self.field),
                "a built-in pattern like fbm:512x512,seed=7,power=2.6, or the file of a height map" => Assets;
            "invert" = switch(&mut self.options.invert),
                "whether the numbers of the map are depths instead of heights" => Assets;
            "normalize" = switch(&mut self.options.normalize),
                "whether to stretch the heights to the range from 0 to 1" => Assets;
            "wrap" = word(&mut self.options.wrap, &WRAPS),
                "axes along which the map repeats" => Assets;
        ]
    }

    /// Loads the heights.
    ///
    /// # Errors
    /// There is no such pattern, or the file holds no heights.
    pub fn load(&self) -> Result<Loaded, Fault> {
        load(self.argument(), &self.options).map_err(|e| Fault::new("scene.field", e.to_string()))
    }
}
