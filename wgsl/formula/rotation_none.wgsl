// The stand-in of `rotation.wgsl` where nothing is rotated.

fn rotate(v: real3) -> real3 {
    return v;
}

fn rotation_load() {}
