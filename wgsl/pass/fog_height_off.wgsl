// The stand-in of `fog_height.wgsl`: fog is as dense everywhere.

fn fog_depth(ray: Beam, t: f32) -> f32 {
    return look.fog * t;
}
