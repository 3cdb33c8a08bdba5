//! Where the heights of a preset come from: a pattern or a file, and how they are read.

use std::path::PathBuf;

use crate::base::key::{Fault, Key, switch, text, word};
use crate::heightfield::conemap::generate::generator::ShareWatch;
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
    pub fn argument(&self) -> PathBuf {
        match PatternSpec::read(&self.field) {
            Some(_) => PathBuf::from(&self.field),
            None => self.folder.join(&self.field),
        }
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
    /// There is no such pattern, the file holds no heights, or `watch` returns `false`.
    pub fn load(&self, watch: ShareWatch<'_>) -> Result<Loaded, Fault> {
        let loaded = load(self.argument(), &self.options, watch);
        loaded.map_err(|e| Fault::new("scene.field", e.to_string()))
    }
}
