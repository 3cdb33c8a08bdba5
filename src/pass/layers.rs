//! The albedo of a hit by traps: a palette over a number of the orbit, and further layers over
//! it. Twins: `wgsl/pass/layers.wgsl`, `layers_off.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec4};

use crate::base::shader::Module;
use crate::pass::look::{Light, colors, phase};
use crate::plan::layers::{Blend, Layers, Trap};
use crate::plan::look::{Look, MOST_STOPS};
use crate::scene::{AnySolid, Solid};
use crate::wgsl;

/// A layer as WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LayerUniform {
    /// Factor on the trap's number.
    pub scale: f32,
    /// What is added to it.
    pub offset: f32,
    /// The layer's share of the colour.
    pub weight: f32,
    /// The position of the trap in [`Trap::ALL`].
    pub trap: u32,
    /// The position of the blend in [`Blend::ALL`].
    pub blend: u32,
    /// Number of colours.
    pub stops: u32,
    /// Unused.
    pub pad: [u32; 2],
    /// Colours in the space of the palette.
    pub palette: [Vec4; MOST_STOPS],
}

/// All layers.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LayersUniform {
    /// The first has the palette of the look.
    pub layer: [LayerUniform; 3],
}

/// One layer.
struct Layer<'a> {
    trap: Trap,
    palette: &'a [DVec3],
    scale: f64,
    offset: f64,
    blend: Blend,
    weight: f64,
}

/// The layers of a look, the first one first.
fn all(look: &Look) -> [Layer<'_>; 3] {
    let all = &look.layers;
    [
        Layer {
            trap: all.trap,
            palette: &look.palette,
            scale: all.trap_scale,
            offset: all.trap_offset,
            blend: Blend::Mix,
            weight: 1.0,
        },
        Layer {
            trap: all.layer2_trap,
            palette: &all.layer2_palette,
            scale: all.layer2_scale,
            offset: all.layer2_offset,
            blend: all.layer2_blend,
            weight: all.layer2_weight,
        },
        Layer {
            trap: all.layer3_trap,
            palette: &all.layer3_palette,
            scale: all.layer3_scale,
            offset: all.layer3_offset,
            blend: all.layer3_blend,
            weight: all.layer3_weight,
        },
    ]
}

/// The modules of the albedo of a scene.
pub fn modules(layers: &Layers, solid: &AnySolid) -> Vec<Module> {
    let traps = solid.twin().trap_modules();
    if !layers.are_on() || traps.is_empty() {
        return vec![wgsl!("pass/layers_off.wgsl")];
    }
    [traps, vec![wgsl!("pass/layers.wgsl")]].concat()
}

/// The values of the WGSL struct.
pub fn uniform(light: &Light) -> LayersUniform {
    let one = |layer: Layer<'_>| LayerUniform {
        scale: layer.scale as f32,
        offset: layer.offset as f32,
        weight: layer.weight as f32,
        trap: layer.trap as u32,
        blend: layer.blend as u32,
        stops: layer.palette.len() as u32,
        pad: [0; 2],
        palette: colors(layer.palette),
    };
    LayersUniform {
        layer: all(&light.look).map(one),
    }
}

/// The albedo of a hit at q, relative to the eye.
pub fn albedo<S: Solid>(solid: &S, light: &Light, q: DVec3, pigment: DVec3) -> DVec3 {
    let traps = match light.look.layers.are_on() {
        true => solid.traps(q),
        false => None,
    };
    let Some(numbers) = traps else {
        return light.pigment_color(pigment);
    };
    let [first, second, third] = all(&light.look);
    let at = |layer: &Layer<'_>| {
        let number = (layer.trap as usize).checked_sub(1).map(|i| numbers[i]);
        number.map(|x| layer.scale * x + layer.offset)
    };
    let mut c = match at(&first) {
        Some(x) => light.palette_at(x),
        None => light.pigment_color(pigment),
    };
    for layer in [second, third] {
        let Some(x) = at(&layer) else { continue };
        let own = light.color_at(layer.palette, phase(x));
        let laid = match layer.blend {
            Blend::Mix => own,
            Blend::Multiply => c * own,
            Blend::Screen => 1.0 - (1.0 - c) * (1.0 - own),
        };
        c = c.lerp(laid, layer.weight);
    }
    c
}
