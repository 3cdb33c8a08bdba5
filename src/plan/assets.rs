//! The files that a plan names, and the assets that serve it: those of its scene, and its sky.

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

    /// Gives the named files other names by their paths, unless these lead from the root. A file for
    /// which there is no name keeps its own.
    pub fn rename_files(&mut self, to: &dyn Fn(&Path) -> Option<String>) {
        let sky = &mut self.look.sky;
        let renamed = |name: &String, folder: &Path| match Path::new(name).is_absolute() {
            true => None,
            false => to(&folder.join(name)),
        };
        if let Some(name) = sky
            .path()
            .and_then(|_| renamed(&sky.sky_file, &sky.folder.0))
        {
            sky.sky_file = name;
        }
        let folder = self.scene.folder().to_path_buf();
        for name in self.scene.file_names() {
            if let Some(new) = renamed(name, &folder) {
                *name = new;
            }
        }
    }

    /// The named files, each with the key that names it.
    pub fn files(&self) -> Vec<(&'static str, PathBuf)> {
        let sky = self.look.sky.path().map(|path| ("look.sky_file", path));
        self.scene.files().into_iter().chain(sky).collect()
    }
}

/// What is asked for is read once, when it is asked for first, unless it was loaded before.
impl Assets {
    /// Reads the files that a plan names, and checks that they fit.
    ///
    /// # Errors
    /// The key of a file that cannot be read or does not fit.
    pub fn load(&self, plan: &Plan) -> Result<(), Fault> {
        plan.scene.load(self)?;
        self.sky(plan).map(|_| ())
    }

    /// The sky of the file that a plan names, if it names one.
    ///
    /// # Errors
    /// It cannot be read or does not fit.
    pub fn sky(&self, plan: &Plan) -> Result<Option<Arc<Sky>>, Fault> {
        let read = plan.look.sky.path().map(|path| self.sky_in(path));
        read.transpose()
            .map_err(|why| Fault::new("look.sky_file", why))
    }

    /// Whether a plan finds all that it needs loaded and made. It never waits for a thread that
    /// does it.
    pub fn serve(&self, plan: &Plan) -> bool {
        let sky = plan.look.sky.path();
        plan.scene.has_assets(self) && sky.is_none_or(|path| self.has_sky(&path))
    }

    /// The numbers in the files that a plan names. They decide a picture as the settings do.
    pub fn contents(&self, plan: &Plan) -> Vec<u8> {
        let mut all = plan.scene.contents(self);
        if let Ok(Some(sky)) = self.sky(plan) {
            all.extend(sky.texel_bytes());
        }
        all
    }
}
