// Estimates of the Mandelbox with one growth factor for all directions (docs/method.md, 3).

override SCALAR_CLASSIC: bool;

/// w stays below this, as its product with the next factor could overflow. The estimate is
/// zero in f32 before this limit.
const SCALAR_MOST_W = 1e30;

fn estimate(p: real3, most: u32) -> real {
    let c = fold_constant(p);
    let gain = select(real(1.0), real(0.0), FOLDS_JULIA);
    let bail2 = real(folds.bail2);
    var z = p;
    var w = real(1.0);
    var z2 = dot(z, z);
    var n = 0u;
    while n < most && z2 <= bail2 {
        let f = fold(z);
        z = fold_next(f, c);
        w = min(fold_growth(f) * w + gain, real(SCALAR_MOST_W));
        z2 = dot(z, z);
        n += 1u;
    }
    count_evaluation();
    count_iterations(n);
    if SCALAR_CLASSIC {
        return (sqrt(z2) - real(folds.classic_offset)) / w - real(folds.classic_skin);
    }
    let tail = select(real(folds.tail), real(0.0), FOLDS_JULIA);
    return (sqrt(z2) - fold_k(c)) / (w + tail);
}
