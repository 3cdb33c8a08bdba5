//! A sky in a file: keys of the section `[look]`.

use std::path::PathBuf;

use crate::base::key::{Key, number, text};
use crate::settings;

/// The value of `sky_file` for none.
const NO_SKY: &str = "none";

/// The folder that names of files are relative to. Presets do not hold it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Folder(pub PathBuf);

impl Folder {
    /// It has none.
    pub fn keys(&mut self) -> Vec<Key<'_>> {
        Vec::new()
    }
}

settings! {
    /// A sky in a file.
    pub struct SkySettings {
        sky_file: String = NO_SKY.into(), text(),
            "a Radiance HDR or OpenEXR of the whole sky in equirectangular form, twice as wide as high, in place of sky_high, sky_low and ground; \"none\" for none" => Assets;
        sky_turn: f64 = 0.0, number(-36e3, 36e3),
            "angle in degrees by which the sky of the file is turned about the camera's up axis, to the left; at 0 its middle is toward +y";
        sky_strength: f64 = 1.0, number(0.0, 1e6),
            "factor of the light in the file; surfaces get it times fill";
        /// Where the file is.
        ..folder: Folder;
    }
}

impl SkySettings {
    /// The path of the file, if there is one.
    pub fn path(&self) -> Option<PathBuf> {
        (self.sky_file != NO_SKY).then(|| self.folder.0.join(&self.sky_file))
    }

    /// The settings without a file.
    pub fn without(&self) -> Self {
        Self {
            sky_file: NO_SKY.into(),
            ..self.clone()
        }
    }
}
