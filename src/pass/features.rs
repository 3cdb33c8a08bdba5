//! The parts of a look that can be absent.
//!
//! A feature has a twin pair, `NAME.rs` and `wgsl/pass/NAME.wgsl`, a stand-in
//! `wgsl/pass/NAME_off.wgsl` with the same functions, and one predicate that both executors
//! read. Where it is off, the GPU joins the stand-in, and the function of the CPU returns at
//! once.

use crate::base::shader::Module;
use crate::plan::look::{LightMode, Look};
use crate::wgsl;

/// Makes the enum of all features from one list: name, module, stand-in, `by` the keys of `[look]`
/// that switch it, `with` the feature that must be on too, `in` the only mode that has it, predicate.
/// A module that leaves the colour as it is while the feature's number is zero is neutral.
macro_rules! features {
    ($($(#[$doc:meta])* $name:ident: $on:expr, $off:expr,
        by [$($key:literal),+] $(with $needed:ident)? $(in $mode:ident)?, $is_on:expr);* $(;)?) => {
        /// A feature of a look that can be absent.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum LookFeature { $($(#[$doc])* $name),* }

        impl LookFeature {
            /// All features.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// Whether a look has the feature.
            pub fn is_on(self, look: &Look) -> bool {
                let is_on: fn(&Look) -> bool = match self { $(Self::$name => $is_on),* };
                self.mode().is_none_or(|mode| mode == look.mode) && is_on(look)
            }

            /// Its module, or the stand-in.
            pub fn module(self, on: bool) -> Module {
                match (self, on) {
                    $((Self::$name, true) => $on,
                    (Self::$name, false) => $off),*
                }
            }

            /// Its own keys in `[look]`: it is off if each is 0 or `false`.
            pub fn keys(self) -> &'static [&'static str] {
                match self { $(Self::$name => &[$($key),+]),* }
            }

            /// The feature without which it shows nothing.
            pub fn needs(self) -> Option<Self> {
                match self { $(Self::$name => [$(Some(Self::$needed),)? None][0]),* }
            }

            /// The only mode that has it.
            pub fn mode(self) -> Option<LightMode> {
                match self { $(Self::$name => [$(Some(LightMode::$mode),)? None][0]),* }
            }
        }
    };
}

features![
    /// Shadows of the key light. In mode path, rays find them by themselves.
    Shadow: wgsl!("pass/shadow.wgsl"), wgsl!("pass/shadow_off.wgsl"),
        by ["shadow"] in Quick, |look| look.shadow;
    /// Ambient occlusion. In mode path, rays find hollows by themselves.
    Occlusion: wgsl!("pass/occlusion.wgsl").neutral(), wgsl!("pass/occlusion_off.wgsl"),
        by ["occlusion"] in Quick, |look| look.occlusion > 0.0;
    /// Light of lamps.
    Lamp: wgsl!("pass/lamp.wgsl").neutral(), wgsl!("pass/lamp_off.wgsl"),
        by ["lamp", "lamp2", "lamp3"], |look| look.lit_lamps().next().is_some();
    /// Light of the surface itself.
    Emission: wgsl!("pass/emission.wgsl").neutral(), wgsl!("pass/emission_off.wgsl"),
        by ["emission"], |look| look.emission > 0.0;
    /// Exponential fog.
    Fog: wgsl!("pass/fog.wgsl").neutral(), wgsl!("pass/fog_off.wgsl"),
        by ["fog"], |look| look.fog > 0.0;
    /// Fog that thins out with the height.
    FogHeight: wgsl!("pass/fog_height.wgsl").neutral(), wgsl!("pass/fog_height_off.wgsl"),
        by ["fog_height"] with Fog, |look| look.fog_height > 0.0;
    /// Light of the air near the surface.
    Glow: wgsl!("pass/glow.wgsl").neutral(), wgsl!("pass/glow_off.wgsl"),
        by ["glow"], |look| look.glow > 0.0;
    /// Light of the sun that fog scatters.
    Shafts: wgsl!("pass/shafts.wgsl").neutral(), wgsl!("pass/shafts_off.wgsl"),
        by ["shafts"] with Fog, |look| look.fog > 0.0 && look.shafts > 0.0;
];

/// The sky: that of a file, or two colours.
pub fn sky(look: &Look) -> Module {
    match look.sky.path() {
        Some(_) => wgsl!("pass/sky_file.wgsl"),
        None => wgsl!("pass/sky.wgsl"),
    }
}

/// The modules of a look: how light is found, and its features.
pub fn modules(look: &Look) -> Vec<Module> {
    // What only mode quick has is called by `quick.wgsl` alone.
    let is_called =
        |f: &&LookFeature| f.mode() != Some(LightMode::Quick) || look.mode == LightMode::Quick;
    let features = LookFeature::ALL.iter().filter(is_called);
    let mut all: Vec<Module> = features.map(|f| f.module(f.is_on(look))).collect();
    all.extend([
        wgsl!("pass/material.wgsl"),
        wgsl!("base/random.wgsl"),
        wgsl!("pass/aim.wgsl"),
    ]);
    match look.mode {
        // The loop alone would take time to compile where there is no lamp.
        LightMode::Quick => all.extend([
            match LookFeature::Lamp.is_on(look) {
                true => wgsl!("pass/quick_lamps.wgsl").neutral(),
                false => wgsl!("pass/quick_lamps_off.wgsl"),
            },
            wgsl!("pass/quick.wgsl"),
        ]),
        LightMode::Path => all.push(wgsl!("pass/path.wgsl")),
    }
    all
}
