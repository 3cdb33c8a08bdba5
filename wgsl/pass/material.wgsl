// How a surface reflects light: a diffuse base under a coat of tiny mirrors (GGX, with Smith's
// correlated shadowing and Schlick's Fresnel term). Light that goes from mirror to mirror is given
// back (Turquin, Practical multiple scattering compensation for microfacet models, 2019), and
// the base gets what the coat lets through. So only the albedo absorbs light.
//
// Vectors are in the frame of the surface, whose normal is z.

const MATERIAL_LAST = 63.0;
const PI = 3.14159265;

/// A point of a surface seen from a direction.
struct Material {
    /// Albedo of the base.
    base: vec3<f32>,
    /// What a mirror reflects along its normal, and at grazing angles, with what goes from mirror to
    /// mirror.
    mirror: vec3<f32>,
    grazing: vec3<f32>,
    /// The share of light from all sides that the coat sends towards the direction.
    coat: vec3<f32>,
    /// The share of the next rays that mirrors choose.
    chosen: f32,
}

fn material_share(z: f32) -> vec2<f32> {
    let at = sqrt(clamp(z, 0.0, 1.0)) * MATERIAL_LAST;
    let i = u32(min(at, MATERIAL_LAST - 1.0));
    let one = look_parameters.material.shares[i / 2u];
    let two = look_parameters.material.shares[(i + 1u) / 2u];
    let low = select(one.xy, one.zw, (i & 1u) == 1u);
    let high = select(two.zw, two.xy, (i & 1u) == 1u);
    return mix(low, high, at - f32(i));
}

/// What mirrors reflect along their normal and at grazing angles, given the first.
fn material_coat(specular: vec3<f32>, all: f32) -> mat2x3<f32> {
    let again = 1.0 + specular * ((1.0 - all) / all);
    // Without a coat there is nothing at grazing angles either.
    let grazing = min(1.0, 50.0 * max(specular.x, max(specular.y, specular.z)));
    return mat2x3<f32>(specular * again, grazing * again);
}

/// A direction to the eye in the frame of a surface. Its z is at least 1e-3, as the normal of a rough
/// surface may face away from the eye.
fn material_view(v: vec3<f32>) -> vec3<f32> {
    return normalize(vec3<f32>(v.xy, max(v.z, 1e-3)));
}

fn material_at(albedo: vec3<f32>, v: vec3<f32>) -> Material {
    let metal = look_parameters.material.metal;
    let share = material_share(v.z);
    let paint = material_coat(vec3<f32>(look_parameters.material.specular), share.x + share.y);
    let bare = material_coat(albedo, share.x + share.y);
    let base = (1.0 - metal) * albedo * max(vec3<f32>(1.0) - paint * share, vec3<f32>(0.0));
    let mirror = mix(paint[0], bare[0], metal);
    let grazing = mix(paint[1], bare[1], metal);
    let coat = mirror * share.x + grazing * share.y;
    let weights = vec2<f32>(dot(coat, vec3<f32>(1.0)), dot(base, vec3<f32>(1.0)));
    let chosen = weights.x / max(weights.x + weights.y, 1e-20);
    return Material(base, mirror, grazing, coat, chosen);
}

/// The share of light from a direction that leaves towards `v`, times the cosine: the reflectance
/// times `l.z`. The fourth number is the density of the directions of `material_scatter`. Light of a
/// disc, `radius` the tangent of its angular radius, comes from its centre, and mirrors are rougher by
/// that. Then the density is of no use.
fn material_reflects(material: Material, v: vec3<f32>, l: vec3<f32>, radius: f32) -> vec4<f32> {
    let diffuse = l.z / PI;
    if material.chosen == 0.0 {
        return vec4<f32>(material.base * diffuse, diffuse);
    }
    let h = normalize(v + l);
    let alpha = look_parameters.material.alpha;
    let aa = min(alpha * alpha + 0.25 * radius * radius, 1.0);
    // 1 - h.z^2 would cancel.
    let spread = aa * h.z * h.z + dot(h.xy, h.xy);
    let density = aa / (PI * spread * spread);
    let sv = sqrt(v.z * v.z * (1.0 - aa) + aa);
    let sl = sqrt(l.z * l.z * (1.0 - aa) + aa);
    let seen = 0.5 / (l.z * sv + v.z * sl);
    let grazing = pow(clamp(1.0 - dot(v, h), 0.0, 1.0), 5.0);
    let fresnel = mix(material.mirror, material.grazing, grazing);
    let coat = fresnel * (density * seen * l.z);
    let mirrored = density * 0.5 / (v.z + sv);
    return vec4<f32>(
        material.base * diffuse + coat,
        mix(diffuse, mirrored, material.chosen),
    );
}

fn material_turn(turns: f32) -> vec2<f32> {
    return vec2<f32>(cos(2.0 * PI * turns), sin(2.0 * PI * turns));
}

/// The normal of a mirror that is seen from `v` (Dupuy and Benyoub, Sampling visible GGX normals with
/// spherical caps, 2023).
fn material_mirror(v: vec3<f32>, pair: vec2<f32>) -> vec3<f32> {
    let alpha = look_parameters.material.alpha;
    let s = normalize(vec3<f32>(alpha * v.xy, v.z));
    let z = (1.0 - pair.y) * (1.0 + s.z) - s.z;
    let cap = vec3<f32>(sqrt(clamp(1.0 - z * z, 0.0, 1.0)) * material_turn(pair.x), z);
    let h = cap + s;
    return normalize(vec3<f32>(alpha * h.xy, h.z));
}

/// A direction in which light may come that leaves towards `v`, and below 0 along z for none. `pair`
/// and `choice` are from 0 to 1.
fn material_scatter(material: Material, v: vec3<f32>, pair: vec2<f32>, choice: f32) -> vec3<f32> {
    if choice < material.chosen {
        return reflect(-v, material_mirror(v, pair));
    }
    return vec3<f32>(sqrt(pair.y) * material_turn(pair.x), sqrt(1.0 - pair.y));
}

/// Two unit vectors across a unit normal (Duff et al., Building an orthonormal basis, revisited,
/// 2017), and the normal.
fn material_frame(n: vec3<f32>) -> mat3x3<f32> {
    let sign = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    let x = vec3<f32>(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    let y = vec3<f32>(b, sign + n.y * n.y * a, -n.y);
    return mat3x3<f32>(x, y, n);
}
