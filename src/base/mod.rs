//! What all other rooms stand on: the keys of settings, WGSL modules, rays and cones.

pub mod cone;
pub mod key;
pub mod named;
pub mod shader;
pub mod srgb;
pub mod units;
pub mod view;
pub mod work;
