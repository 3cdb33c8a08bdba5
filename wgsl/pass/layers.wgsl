// The albedo of a hit by traps: a palette over a number of the orbit, and further layers over it.

struct LayerUniform {
    scale: f32,
    offset: f32,
    /// Its share of the colour.
    weight: f32,
    /// 0 for none, else 1 more than the position of the trap among the numbers of an orbit.
    trap: u32,
    /// 0 to mix, 1 to multiply, 2 to screen.
    blend: u32,
    stops: u32,
    pad: vec2<u32>,
    palette: array<vec4<f32>, 16>,
}

/// The first layer has the palette of the look.
struct LayersUniform {
    layer: array<LayerUniform, 3>,
}

@group(1) @binding(4) var<storage, read> layers_parameters: LayersUniform;

/// A layer's colour at x.
fn layer_color(layer: u32, x: f32) -> vec3<f32> {
    let stops = layers_parameters.layer[layer].stops;
    let phase = abs(x - 2.0 * round(0.5 * x));
    let at = clamp(phase, 0.0, 1.0) * f32(stops - 1u);
    let i = min(u32(at), stops - 1u);
    let j = min(i + 1u, stops - 1u);
    let f = at - f32(i);
    let one = layers_parameters.layer[layer].palette[i].rgb;
    let two = layers_parameters.layer[layer].palette[j].rgb;
    return palette_linear(mix(one, two, f * f * (3.0 - 2.0 * f)));
}

/// The albedo of a hit at q, relative to the eye.
fn layers_albedo(q: vec3<f32>, pigment: vec3<f32>) -> vec3<f32> {
    var numbers = orbit_traps(scene_point(q), distance_scene.iterations);
    var c = vec3<f32>(0.0);
    for (var i = 0u; i < 3u; i++) {
        let trap = layers_parameters.layer[i].trap;
        if i == 0u && trap == 0u {
            c = pigment_color(pigment);
        }
        if trap == 0u {
            continue;
        }
        let number = numbers[trap - 1u];
        let x = layers_parameters.layer[i].scale * number + layers_parameters.layer[i].offset;
        if i == 0u {
            c = palette_at(x);
            continue;
        }
        let own = layer_color(i, x);
        var laid = own;
        if layers_parameters.layer[i].blend == 1u {
            laid = c * own;
        } else if layers_parameters.layer[i].blend == 2u {
            laid = 1.0 - (1.0 - c) * (1.0 - own);
        }
        c = mix(c, laid, layers_parameters.layer[i].weight);
    }
    return c;
}
