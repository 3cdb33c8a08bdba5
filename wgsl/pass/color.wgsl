// The colour pass: the light of each hit (`quick.wgsl` or `path.wgsl`), fog and glow. Light is
// linear. Tone map and sRGB follow where it is shown (`tone.wgsl`) or written.

override COLOR_KEEPS_NORMALS: bool;
/// Whether the fourth number of a normal is the sum of the squared deviations of the samples'
/// luminance from their mean.
override COLOR_KEEPS_VARIANCE: bool;
/// The shares of red, green and blue in luminance (ITU-R BT.709).
const COLOR_LUMA = vec3<f32>(0.2126, 0.7152, 0.0722);
/// Whether pigments are linear colours.
override COLOR_IS_PIGMENT: bool;

/// The share of light that a surface sends back. `q` is relative to the eye.
fn albedo_of(surface: Surface, q: vec3<f32>) -> vec3<f32> {
    if COLOR_IS_PIGMENT {
        return surface.pigment;
    }
    return layers_albedo(q, surface.pigment);
}

/// The light of the surface itself. A linear colour is no trap.
fn emission_of(surface: Surface) -> vec3<f32> {
    return select(emission(surface.pigment), vec3<f32>(0.0), COLOR_IS_PIGMENT);
}

@compute @workgroup_size(64)
fn color(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    scene_load();
    view_load();
    look_load();
    queue_load();
    // Every pixel gets a colour, also the sky.
    let packed = queue_tile(group.xy, lane);
    if packed == QUEUE_NONE {
        return;
    }
    let cell = queue_cell(packed);
    let index = queue_index(cell);
    let ended = until_ended(index);
    if turn.stage.before == 0u {
        until_begin(index);
    }
    // The normal is that of the centre.
    if ended > 0.0 && turn.stage.lens.x >= 0.0 {
        return;
    }
    let ray = view_ray_from(turn.stage.origin + cell, turn.stage.place, turn.stage.lens);
    let s = cell_state(turn.stage.state + index);
    var c = vec3<f32>(0.0);
    var decided = 1.0;
    var n = vec3<f32>(0.0);
    // A pixel under a sky cell was never written: it is sky.
    let is_hit = s == STATE_HIT || s == STATE_UNCONVERGED;
    if is_hit {
        var hit = Hit(cell_front(index), 0u, vec2<f32>(0.0));
        if HIT_CARRIES_MARK {
            let mark = cell_mark(index);
            hit.id = mark.id;
            hit.uv = vec2<f32>(mark.u, mark.v);
        }
        // An unconverged ray is lit where it stopped, mostly close to a surface.
        let grain = footprint(ray, hit.t);
        let at = surroundings(ray, hit, shade_nearest(grain));
        n = at.surface.normal;
        if ended == 0.0 {
            let pixel = turn.stage.origin + cell;
            let shaded = shade(ray, ray.origin + hit.t * ray.axis, at, grain, pixel);
            let lit = shafts(fog(shaded.rgb, ray, hit.t), ray, hit.t, pixel);
            c = lit.rgb + glow(ray, hit.t);
            decided = min(shaded.w, lit.w);
        }
        if look.flag == 1u && (s == STATE_UNCONVERGED || (LIGHT_IS_FLAGGED && decided == 0.0)) {
            c = vec3<f32>(1.0, 0.0, 1.0);
        }
    } else if ended == 0.0 {
        let behind = sky(ray.axis);
        let lit = shafts(behind, ray, bounds_far(), turn.stage.origin + cell);
        c = background(lit.rgb + glow(ray, bounds_far()));
    }
    var note = background_note(decided, is_hit);
    let normal_at = turn.stage.cells.x * turn.stage.cells.y + index;
    var spread = 0.0;
    if turn.stage.before > 0u {
        let sum = cell_pixel(index);
        let counts = turn.stage.weight > 0.0 && ended == 0.0;
        if COLOR_KEEPS_VARIANCE {
            spread = cell_pixel(normal_at).a;
            if counts {
                // Welford 1962.
                let n = f32(turn.stage.before);
                let off = dot(COLOR_LUMA, c - sum.rgb / n);
                spread += off * off * n / (n + 1.0);
            }
        }
        c = sum.rgb + select(vec3<f32>(0.0), c, counts);
        note = background_join(sum.a, note, counts);
    }
    var scale = turn.stage.scale;
    if ended > 0.0 {
        scale = 1.0 / ended;
    }
    cell_store_pixel(index, vec4<f32>(c * scale, note));
    if COLOR_KEEPS_NORMALS {
        cell_store_pixel(normal_at, vec4<f32>(n, spread));
    }
}
