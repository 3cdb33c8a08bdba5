//! Assets: what a plan needs beside its numbers.

use std::path::PathBuf;
use std::sync::Arc;

use crate::base::one_value_cache::{OneValueCache, is_last, last_or_new, snapshot};
use crate::heightfield::assets::Assets as HeightfieldAssets;
use crate::scene::sky::Sky;

/// Loaded heights, made cone maps, and read textures and skies. Clones share what is kept.
#[derive(Clone, Debug, Default)]
pub struct Assets {
    /// Those of heightfields.
    pub heightfield: HeightfieldAssets,
    skies: OneValueCache<PathBuf, Sky>,
}

impl Assets {
    /// What is there now. What others make and drop does not change it. What others are making is
    /// left out, unless this may wait for them.
    #[must_use]
    pub fn snapshot(&self, may_wait: bool) -> Self {
        Self {
            heightfield: self.heightfield.snapshot(may_wait),
            skies: snapshot(&self.skies, may_wait),
        }
    }

    /// The sky in a file.
    ///
    /// # Errors
    /// As [`Sky::read`].
    pub fn sky_in(&self, path: PathBuf) -> Result<Arc<Sky>, String> {
        last_or_new(&self.skies, path, |path| Sky::read(path))
    }

    /// Whether the sky in a file is read. It never waits for a thread that reads it.
    pub fn has_sky(&self, path: &PathBuf) -> bool {
        is_last(&self.skies, path)
    }
}
