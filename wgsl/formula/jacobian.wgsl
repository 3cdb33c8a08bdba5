// The derivative of a point of the orbit by the starting point, while all folds are linear:
// three columns, as there is a rotation.

struct Jacobian {
    x: real3,
    y: real3,
    z: real3,
}

fn jacobian_start() -> Jacobian {
    let one = real(1.0);
    let no = real(0.0);
    return Jacobian(real3(one, no, no), real3(no, one, no), real3(no, no, one));
}

/// After a fold, a rotation, a scale and the addition of the starting point. `mirror` is -1 for
/// coordinates that the fold mirrors, else 1.
fn jacobian_next(j: Jacobian, mirror: real3, scale: real) -> Jacobian {
    let start = jacobian_start();
    return Jacobian(
        scale * rotate(mirror * j.x) + start.x,
        scale * rotate(mirror * j.y) + start.y,
        scale * rotate(mirror * j.z) + start.z,
    );
}

/// An upper bound of the operator norm. The largest eigenvalue of a symmetric 3 x 3 matrix is at
/// most its mean plus sqrt(2/3) times the Frobenius norm of the matrix less the mean.
fn jacobian_norm(j: Jacobian) -> real {
    let squares = real3(dot(j.x, j.x), dot(j.y, j.y), dot(j.z, j.z));
    let products = real3(dot(j.x, j.y), dot(j.y, j.z), dot(j.z, j.x));
    let mean = (squares.x + squares.y + squares.z) / real(3.0);
    let off = squares - real3(mean);
    let square = dot(off, off) + real(2.0) * dot(products, products);
    return sqrt(mean + sqrt(real(2.0 / 3.0) * square));
}
