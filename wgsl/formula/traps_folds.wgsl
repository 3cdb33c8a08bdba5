// Traps of an orbit of box folds and ball folds.

fn orbit_traps(p: real3, most: u32) -> array<f32, 7> {
    let c = fold_constant(p);
    let limit = real3(real(folds.fold_limit));
    var all = traps_start();
    var z = p;
    var n = 0u;
    while n < most && dot(z, z) <= real(folds.bail2) {
        let f = fold(z);
        // Later iterations only add noise to distances.
        if n < 10u {
            traps_add(&all, vec3<f32>(f.b), folds.fixed_radius);
        }
        let over = vec3<u32>(abs(z) > limit);
        all.folds += over.x + over.y + over.z + select(0u, 1u, f.square < real(folds.fixed2));
        z = fold_next(f, c);
        n += 1u;
    }
    // An orbit that is far past its end has ended earlier.
    let square = f32(dot(z, z)) / folds.bail2;
    let past = 0.5 * log(max(square, 1.0)) / log(abs(folds.scale));
    all.iterations = f32(n) - min(past, 1.0);
    return traps_numbers(all, folds.fold_limit);
}
