// Traps of a formula without orbits: those of the place itself.

fn orbit_traps(p: real3, most: u32) -> array<f32, 7> {
    var all = traps_start();
    traps_add(&all, vec3<f32>(p), 1.0);
    return traps_numbers(all, 1.0);
}
