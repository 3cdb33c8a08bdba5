// The stand-in of `rotation.wgsl` without a rotation.

const ROTATES = false;

fn rotate(v: real3) -> real3 {
    return v;
}

fn rotation_load() {}
