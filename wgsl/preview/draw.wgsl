// Draws a picture and the panel to the window.
//
// A picture of the same view and size is copied pixel by pixel, so that the window has the bytes
// of the file. Any other is turned to the view of the window: the rays of both start at the eye,
// so a linear map of (x, y, 1) leads from a pixel of the one to a pixel of the other.

struct ScreenParameters {
    /// From a pixel of the window to one of the picture, as columns.
    to_picture: mat3x3<f32>,
    /// Width and height of the picture.
    size: vec2<f32>,
    /// 1 to copy pixel by pixel.
    exact: u32,
    pad: u32,
}

@group(0) @binding(0) var<uniform> screen_parameters: ScreenParameters;
@group(0) @binding(1) var source: texture_2d<f32>;
@group(0) @binding(2) var smooth_sampler: sampler;

/// A triangle that covers the window.
@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(vec2<u32>(index & 1u, index >> 1u));
    return vec4<f32>(4.0 * corner - 1.0, 0.0, 1.0);
}

@fragment
fn show_picture(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    if screen_parameters.exact == 1u {
        return textureLoad(source, vec2<i32>(at.xy), 0);
    }
    let p = screen_parameters.to_picture * vec3<f32>(at.xy, 1.0);
    // What was behind the eye has no colour yet.
    if p.z <= 0.0 {
        return vec4<f32>(0.5, 0.5, 0.5, 1.0);
    }
    let place = p.xy / p.z / screen_parameters.size;
    return textureSampleLevel(source, smooth_sampler, place, 0.0);
}

@fragment
fn show_panel(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return textureLoad(source, vec2<i32>(at.xy), 0);
}
