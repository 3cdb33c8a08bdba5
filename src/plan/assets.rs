//! The files and assets of a plan: those of its scene, and its sky.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Plan;
use crate::base::key::Fault;
use crate::scene::Assets;
use crate::scene::sky::Sky;

impl Plan {
    /// Sets the folder that names of files are relative to.
    pub fn set_folder(&mut self, folder: &Path) {
        self.scene.set_folder(folder);
        self.look.sky.folder.0 = folder.to_path_buf();
    }

    /// The named files, each with the key that names it.
    pub fn files(&self) -> Vec<(&'static str, PathBuf)> {
        let sky = self.look.sky.path().map(|path| ("look.sky_file", path));
        self.scene.files().into_iter().chain(sky).collect()
    }

    /// Reads the named files and checks that they fit.
    ///
    /// # Errors
    /// The key of a file that cannot be read or does not fit.
    pub fn load(&self, assets: &Assets) -> Result<(), Fault> {
        self.scene.load(assets)?;
        self.sky(assets).map(|_| ())
    }

    /// The sky of the file, if one is named.
    ///
    /// # Errors
    /// It cannot be read or does not fit.
    pub fn sky(&self, assets: &Assets) -> Result<Option<Arc<Sky>>, Fault> {
        let read = self.look.sky.path().map(|path| assets.sky(path));
        read.transpose()
            .map_err(|why| Fault::new("look.sky_file", why))
    }

    /// Whether all assets are loaded and made. It never waits for a thread that does it.
    pub fn has_assets(&self, assets: &Assets) -> bool {
        let sky = self.look.sky.path();
        self.scene.has_assets(assets) && sky.is_none_or(|path| assets.has_sky(&path))
    }

    /// The numbers in the named files. They decide a picture as the settings do.
    pub fn contents(&self, assets: &Assets) -> Vec<u8> {
        let mut all = self.scene.contents(assets);
        if let Ok(Some(sky)) = self.sky(assets) {
            all.extend(sky.texel_bytes());
        }
        all
    }
}
