//! The preview in a real window: what it shows at rest is what the other commands write.
//!
//! - `desktop`: an X server with the window in it
//! - `fly`: the camera and the panel; `rest`: pictures, layers and pixels; `film`: the timeline
//! - `files`: presets and shaders that change, and unsaved work
//! - `harm`: sizes and events of all kinds, and no display; `loss`: a lost device
#![cfg(all(target_os = "linux", feature = "preview"))]
#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "tests are read by their names, and one that panics has failed"
)]

mod desktop;
mod files;
mod film;
mod fly;
#[path = "../common/folder.rs"]
#[allow(dead_code, reason = "other files use the rest")]
mod folder;
mod harm;
mod loss;
#[path = "../common/random.rs"]
#[allow(dead_code, reason = "other files use the rest")]
mod random;
mod rest;

use desktop::Shot;
use folder::Folder;

/// A picture in a file.
fn picture(folder: &Folder, name: &str) -> Shot {
    let decoded = image::open(folder.0.join(name)).unwrap().into_rgb8();
    Shot {
        size: [decoded.width(), decoded.height()],
        rgb: decoded.into_raw(),
    }
}

const SIZE: &str = "--size 320x180";

/// A film whose first moment is not its still.
const FILM: &str = r#"
[scene]
kind = "distance"
formula = "mandelbox"
[camera]
eye = [12, -14, 3]
[image]
size = [320, 180]
samples = 1
[time]
length = 2
fps = 10
[[track]]
key = "camera.eye"
keys = [[0, [10, -17, 12]], [2, [17, 10, 12]]]
"#;
