//! Arrays of numbers that stay the same from frame to frame: heights, cones, textures.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// What a variable of a program reads, made only when a device does not have it yet.
pub struct SceneArray {
    /// The WGSL variable.
    pub name: &'static str,
    /// What the bytes are made of. As long as it is the same value in memory, so are the bytes.
    pub origin: Arc<dyn Any + Send + Sync>,
    make: Box<dyn Fn() -> Vec<u8>>,
}

impl SceneArray {
    /// The array of a variable, made from a shared value.
    pub fn new<T: Any + Send + Sync>(
        name: &'static str,
        origin: &Arc<T>,
        bytes: fn(&T) -> Vec<u8>,
    ) -> Self {
        let held = origin.clone();
        Self {
            name,
            origin: origin.clone(),
            make: Box::new(move || bytes(&held)),
        }
    }

    /// Its bytes: numbers of 4 bytes.
    pub fn bytes(&self) -> Vec<u8> {
        (self.make)()
    }
}

impl fmt::Debug for SceneArray {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("SceneArray").field(&self.name).finish()
    }
}
