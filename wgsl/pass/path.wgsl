// Light by paths: rays to a point of the sun and of lamps, and a ray in a direction that the material
// chooses, from surface to surface. The mean over the samples tends to the true light (Kajiya, The
// rendering equation, 1986).

/// One of many paths says little of its pixel.
const LIGHT_IS_FLAGGED = false;

/// Bounces after which a path may end by chance.
const PATH_SURE = 2u;

/// What a ray between surfaces met, and its walk.
struct Sight {
    state: u32,
    hit: Hit,
}

/// Follows a ray for `reach` from a point whose opening is known. The path has so many steps left.
fn path_sight(ray: Beam, reach: f32, opened: Opening, left: ptr<function, u32>) -> Sight {
    var walk = begin_opened(ray, reach, opened);
    var s = STATE_UNCONVERGED;
    let most = min(look.shadow_steps, *left);
    let done = min(steps_opened(walk), most);
    *left -= done;
    for (var i = done; i < most; i++) {
        *left -= 1u;
        let now = walk_step(ray, &walk);
        if now != STATE_MOVING {
            s = now;
            break;
        }
    }
    return Sight(s, walk_hit(ray, walk));
}

/// The first purpose of the random numbers of a sky that is sampled. Each bounce has two. Those of
/// shafts are before it.
const PATH_SKY = 130u;

/// Rays find what is near a hit by themselves.
fn shade_nearest(grain: f32) -> f32 {
    return 0.0;
}

/// Radiance that leaves a hit towards the eye, and 0 if a ray reached its step limit, else 1. `q` is
/// the hit relative to the eye, `grain` half a pixel's width there, also for later hits.
fn shade(ray: Beam, q: vec3<f32>, seen: Surroundings, grain: f32, pixel: vec2<u32>) -> vec4<f32> {
    let seed = random_seed(pixel);
    let lift = shadow_lift(grain);
    // Without bounces, light of the sky is stopped by near surfaces only.
    let far = 2.0 * bounds_far();
    let reach = select(far, look.occlusion_reach, look.bounces == 0u);
    var light = vec3<f32>(0.0);
    var through = vec3<f32>(1.0);
    var at = seen.surface;
    var point = q;
    var axis = ray.axis;
    var decided = 1.0;
    var left = look.path_steps;
    for (var bounce = 0u; bounce <= look.bounces; bounce++) {
        let frame = material_frame(at.normal);
        let v = material_view(-axis * frame);
        let material = material_at(min(albedo_of(at, point), vec3<f32>(1.0)), v);
        let start = point + lift * at.normal;
        // The rays of a surface begin with the same step. The CPU repeats it: the bits are the same.
        let opened = opening(start, grain);
        light += through * emission_of(at);
        for (var nth = 0u; nth <= lamp_count(); nth++) {
            var lamp = Lamp(look.light, far, look.softness);
            var strength = look.key * look.light_color;
            if nth > 0u {
                lamp = lamp_from(nth - 1u, start);
                strength = lamp_light(nth - 1u, lamp);
            }
            if all(strength == vec3<f32>(0.0)) {
                continue;
            }
            let pair = random_pair(seed, turn.stage.before, aim_purpose(bounce, nth));
            let toward = aim(lamp, pair);
            let l = toward * frame;
            if l.z <= 0.0 {
                continue;
            }
            let sight = path_sight(Beam(start, toward, 0.0, 0.0, grain, 0.0), lamp.far, opened, &left);
            if sight.state == STATE_SKY {
                light += through * material_reflects(material, v, l, 0.0).rgb * (PI * strength);
            }
            decided = select(decided, 0.0, sight.state == STATE_UNCONVERGED);
        }
        if SKY_IS_SAMPLED {
            let place = random_pair(seed, turn.stage.before, PATH_SKY + 2u * bounce);
            let within = random_pair(seed, turn.stage.before, PATH_SKY + 2u * bounce + 1u);
            let sampled = sky_toward(place, within);
            let l = sampled.xyz * frame;
            if l.z > 0.0 {
                let ray = Beam(start, sampled.xyz, 0.0, 0.0, grain, 0.0);
                let sight = path_sight(ray, reach, opened, &left);
                if sight.state == STATE_SKY {
                    // The balance heuristic (Veach 1997): both rays may find the same light.
                    let reflected = material_reflects(material, v, l, 0.0);
                    let joint = reflected.rgb / (sampled.w + reflected.w);
                    light += through * joint * sky_light(sampled.xyz);
                }
                decided = select(decided, 0.0, sight.state == STATE_UNCONVERGED);
            }
        }
        let choice = random_pair(seed, turn.stage.before, 4u * bounce + 2u);
        let pair = random_pair(seed, turn.stage.before, 4u * bounce + 3u);
        let l = material_scatter(material, v, pair, choice.x);
        if l.z <= 0.0 {
            break;
        }
        let reflected = material_reflects(material, v, l, 0.0);
        through *= reflected.rgb / max(reflected.w, 1e-20);
        if bounce >= PATH_SURE {
            let stays = clamp(max(through.r, max(through.g, through.b)), 0.05, 1.0);
            if choice.y >= stays {
                break;
            }
            through /= stays;
        }
        let next = Beam(start, frame * l, 0.0, 0.0, grain, 0.0);
        let sight = path_sight(next, reach, opened, &left);
        if sight.state == STATE_SKY {
            var share = 1.0;
            if SKY_IS_SAMPLED {
                share = reflected.w / max(reflected.w + sky_density(next.axis), 1e-20);
            }
            light += through * (share * sky_light(next.axis));
            break;
        }
        if sight.state == STATE_UNCONVERGED {
            decided = 0.0;
            break;
        }
        if bounce == look.bounces {
            break;
        }
        at = surface(next, sight.hit);
        point = next.origin + sight.hit.t * next.axis;
        axis = next.axis;
    }
    return vec4<f32>(light, decided);
}
