//! What cone marching promises, on fields that are known in closed form: no cell starts
//! behind a surface that one of its rays meets, at any image size and field of view; how
//! the work is cut never changes a bit; every limit that is reached is a state; and no
//! pass knows what it marches.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test fails by panicking, and has no readers of its interface"
)]

mod adapter;
#[allow(dead_code, reason = "other crates use the rest")]
mod common {
    pub mod exact;
    pub mod overclaims;
    pub mod plans;
    pub mod solved;
}

use adapter::{
    COUNTED, DEPTHS, EVERYTHING, HIT, LEVELS, NO_ADAPTER, SKY, UNCONVERGED, on_cpu, render,
    render_cut,
};
use common::exact::first_hit;
use common::overclaims::{brought_near, overclaims};
use common::plans::{camera, compared, preset, sized};
use common::solved::{balls, cameras, rays, slab, solids, solved};
use conemarch::base::outcome::Counts;
use conemarch::base::projection::Projection;
use conemarch::base::view::footprint;
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::Device;
use conemarch::gpu::render::{Cutting, Renderer};
use conemarch::picture::frame::Frame;
use conemarch::plan::camera::Camera;
use conemarch::plan::march::Mode;
use conemarch::plan::{Extras, Plan};
use conemarch::scene::{Assets, Scene};
use glam::DVec3;
use wgpu::DeviceType;

/// Asserts that no cell of a render claims too much; says how near they bring rays.
fn assert_sound(plan: &Plan, what: &str) -> f64 {
    let (reference, t) = solved(plan);
    let frame = render(plan, LEVELS);
    let divisors: Vec<u32> = frame.levels.iter().map(|l| l.divisor).collect();
    assert_eq!(divisors, [32, 16, 8, 4, 2]);
    assert_eq!(overclaims(&frame, plan.camera.eye, &t), [], "{what}");
    let report = compared(&frame, &reference, plan);
    assert_eq!(report.start_violations, [0; 5], "{what}");
    // On a field of slope 1 neither can a ray pass what it meets.
    assert_eq!((report.holes, report.behind), (0.0, 0.0), "{what}");
    assert_eq!(frame.census()[2], 0, "{what}");
    brought_near(&frame, &t)
}

#[test]
fn no_cell_starts_behind_a_surface_at_any_small_size_and_angle() {
    let sizes = [[1, 1], [33, 17], [1, 400], [200, 1]];
    for (n, camera) in cameras().iter().enumerate() {
        for fov in [1.0, 48.5, 90.0, 170.0] {
            let camera = Camera {
                fov,
                ..camera.clone()
            };
            for size in sizes {
                for rod in [0.05, 1e-3] {
                    let what = format!("camera {n}, fov {fov}, {size:?}, rod {rod}");
                    assert_sound(&balls(rod, &camera, size), &what);
                }
                let what = format!("slab, camera {n}, fov {fov}, {size:?}");
                assert_sound(&slab(&camera, size), &what);
            }
        }
    }
}

#[test]
fn no_cell_starts_behind_a_surface_in_large_images() {
    let [far, near, close, inside, axis] = cameras();
    // Nor do cells keep to the truth by claiming next to nothing.
    let near = [
        assert_sound(&balls(0.05, &far, [1366, 768]), "far"),
        assert_sound(&balls(1e-3, &near, [1600, 1050]), "near"),
        assert_sound(&balls(1e-3, &inside, [1366, 768]), "inside"),
        assert_sound(&slab(&axis, [1366, 768]), "slab"),
    ];
    assert!(near.iter().all(|share| *share > 0.9), "{near:?}");
    let wide = Camera {
        fov: 170.0,
        ..close
    };
    assert_sound(&balls(0.05, &wide, [1366, 768]), "wide and close");
}

#[test]
fn no_cell_starts_behind_a_surface_in_any_projection() {
    for (word, projection) in &Projection::WORDS[1..] {
        let mut most = 0.0_f64;
        for (n, camera) in cameras().iter().enumerate() {
            for fov in [1.0, 48.5, 170.0, 360.0] {
                if fov > projection.widest() {
                    continue;
                }
                let camera = Camera {
                    fov,
                    projection: *projection,
                    ..camera.clone()
                };
                for size in [[1, 1], [33, 17], [1, 400], [400, 200]] {
                    let what = format!("{word}, camera {n}, fov {fov}, {size:?}");
                    let near = assert_sound(&balls(0.05, &camera, size), &what);
                    most = most.max(near);
                    assert_sound(&slab(&camera, size), &format!("slab, {what}"));
                }
            }
        }
        // Nor do cells keep to the truth by claiming next to nothing.
        assert!(most > 0.9, "{word}: {most}");
    }
}

/// The image planes of two eyes are shifted, and those that show the top of a tower.
#[test]
fn no_cell_starts_behind_a_surface_in_a_shifted_image() {
    let mut most = 0.0_f64;
    for (n, camera) in cameras().iter().enumerate() {
        for (fov, shift, rise) in [(48.5, 0.04, 0.0), (90.0, -0.7, 0.4), (20.0, 5.0, -5.0)] {
            let camera = Camera {
                fov,
                shift,
                rise,
                ..camera.clone()
            };
            for size in [[33, 17], [1, 400], [400, 200]] {
                let what = format!("camera {n}, fov {fov}, shift {shift}, {size:?}");
                most = most.max(assert_sound(&balls(0.05, &camera, size), &what));
                assert_sound(&slab(&camera, size), &format!("slab, {what}"));
            }
        }
    }
    assert!(most > 0.9, "{most}");
}

/// The disc of a slab has its radius in a view from above by parallel rays.
#[test]
fn parallel_rays_keep_sizes() {
    let above = Camera {
        projection: Projection::Orthographic,
        up: DVec3::Y,
        ..camera([0.0, 0.0, 30.0], [0.0, 0.0, 0.0])
    };
    let mut plan = slab(&above, [400, 300]);
    plan.scene = common::plans::scene("kind = 'slab'\nnormal = [0, 0, 1]\nhalf = 0.5\nradius = 6");
    for frame in [render(&plan, LEVELS), on_cpu(&plan, LEVELS)] {
        let pixel = 2.0 * 30.0 * (0.5 * plan.camera.fov.to_radians()).tan() / 300.0;
        let area = frame.census()[1] as f64 * pixel * pixel;
        assert!(
            (area / (36.0 * std::f64::consts::PI) - 1.0).abs() < 2e-3,
            "{area}"
        );
        let flat = |t: &f32| t.is_infinite() || (*t - 29.5).abs() < 1e-4;
        assert!(frame.depth.iter().all(flat));
    }
}

/// The rule of the 2012 slides leaves gaps, and both counts must find them: they can.
#[test]
fn the_rule_of_the_slides_is_caught() {
    let camera = &cameras()[3];
    for mut plan in [balls(1e-3, camera, [160, 90]), slab(camera, [160, 90])] {
        plan.march.mode = Mode::SlidesDeep;
        let (reference, t) = solved(&plan);
        let frame = render(&plan, LEVELS);
        assert!(overclaims(&frame, plan.camera.eye, &t).len() > 100);
        let report = compared(&frame, &reference, &plan);
        let found: u64 = report.start_violations.iter().sum();
        assert!(found > 100, "{:?}", report.start_violations);
        assert!(report.behind > 0.001, "{}", report.behind);
    }
}

/// A built-in plan by another projection.
fn projected(name: &str, size: [u32; 2], projection: Projection) -> Plan {
    let mut plan = sized(name, size);
    plan.camera.projection = projection;
    plan
}

/// Every number of a frame but times, as bits.
fn bits(frame: &Frame) -> Vec<u32> {
    let mut all = Vec::new();
    let mut add = |numbers: &[f32], states: &[u8], work: &[Counts]| {
        all.extend(numbers.iter().map(|x| x.to_bits()));
        all.extend(states.iter().map(|s| u32::from(*s)));
        all.extend(work.iter().flat_map(|w| [w.evaluations, w.iterations]));
    };
    add(&frame.depth, &frame.state, &frame.work);
    add(frame.radiance.as_flattened(), &[], &[]);
    add(frame.normal.as_flattened(), &[], &[]);
    for level in &frame.levels {
        add(&level.front, &level.state, &level.work);
    }
    all
}

#[test]
fn blocks_and_chunks_never_change_a_bit() {
    let size = [333, 217];
    let plans = [
        sized("bench-outside", size),
        balls(1e-3, &cameras()[3], size),
        slab(&cameras()[1], size),
        projected("bench-outside", size, Projection::Orthographic),
        projected("bench-inside", size, Projection::Fisheye),
        projected("bench-inside", size, Projection::Equirectangular),
    ];
    for mut plan in plans {
        // A limit that some rays reach, for their state must not depend on the cut, and
        // one that takes all rays over many dispatches.
        for (coarsest, steps) in [(16, 7), (32, 300)] {
            plan.march.coarsest = Some(coarsest);
            plan.march.steps = Some(steps);
            let frame = render(&plan, EVERYTHING);
            let limited = steps == 7 && !matches!(plan.scene, Scene::Slab(_));
            assert_eq!(frame.census()[2] > 0, limited);
            let whole = bits(&frame);
            for (block, chunk) in [(64, 4), (96, 4), (1024, 1), (1024, 3), (1024, 256), (96, 3)] {
                let cut = bits(&render_cut(&plan, EVERYTHING, Cutting { block, chunk }));
                // Not assert_eq: it would print a million numbers.
                assert!(
                    whole == cut,
                    "1/{coarsest}, blocks of {block}, chunks of {chunk}"
                );
            }
            // Anything that matters does change bits.
            let mut other = plan.clone();
            other.camera.eye.x += 1e-4;
            assert!(whole != bits(&render(&other, EVERYTHING)));
        }
    }
}

#[test]
fn levels_halve_and_children_of_the_sky_do_nothing() {
    let mut far = sized("bench-far", [333, 217]);
    far.camera.eye *= 2.0;
    let (size, camera) = ([333, 217], &cameras()[0]);
    for mut plan in [far, balls(0.05, camera, size), slab(camera, size)] {
        plan.march.coarsest = Some(32);
        let frame = render(&plan, COUNTED);
        assert_eq!(frame.levels.len(), 5);
        let (mut idle, mut busy) = (0, 0);
        for (n, parent) in frame.levels.iter().enumerate() {
            let fine = frame.levels.get(n + 1);
            let (cells, work) = fine.map_or((plan.size, &frame.work), |l| (l.cells, &l.work));
            assert_eq!(parent.divisor, 32 >> n);
            assert_eq!(cells.map(|c| c.div_ceil(2)), parent.cells);
            for (i, work) in work.iter().enumerate() {
                let (x, y) = (i % cells[0] as usize, i / cells[0] as usize);
                let above = (y / 2) * parent.cells[0] as usize + x / 2;
                if parent.state[above] != SKY {
                    busy += u32::from(work.evaluations > 0);
                    continue;
                }
                assert_eq!(*work, Counts::default());
                idle += 1;
                assert_eq!(fine.map_or(frame.state[i], |l| l.state[i]), SKY);
            }
        }
        // Both kinds of cells were there to be looked at.
        assert!(idle > 1000 && busy > 1000, "{idle} idle, {busy} busy");
    }
}

/// Images whose edges cut cells lose no pixel there: the last row and column are those
/// that the other executor renders, and that the equations give.
#[test]
fn cells_cut_by_the_image_are_complete() {
    // Straight down on the slab through so narrow a lens that it fills every image.
    let down = Camera {
        fov: 1.0,
        ..camera([0.3, 0.2, 3.0], [0.0, 0.1, 0.0])
    };
    for size in [[1366, 768], [1600, 1050], [33, 17], [200, 1], [1, 1]] {
        for plan in [slab(&down, size), balls(0.05, &cameras()[2], size)] {
            let frame = render(&plan, LEVELS);
            let other = on_cpu(&plan, LEVELS);
            let ([w, h], solids) = (size, solids(&plan).unwrap());
            let mut differ = 0;
            for (i, ray) in rays(&plan).enumerate() {
                let last_column = i as u32 % w == w - 1;
                if !last_column && i as u32 / w < h - 1 {
                    continue;
                }
                if let Scene::Slab(_) = plan.scene {
                    assert_eq!(frame.state[i], HIT);
                    let t = first_hit(&solids, plan.camera.eye, ray.axis);
                    assert!((f64::from(frame.depth[i]) / t - 1.0).abs() < 1e-5);
                }
                let apart = f64::from(frame.depth[i] - other.depth[i]).abs();
                let near = apart < 2.0 * ray.grain * f64::from(frame.depth[i]);
                let alike = frame.state[i] == other.state[i];
                differ += u32::from(!alike || frame.state[i] == HIT && !near);
            }
            // f32 and f64 may part where a ray grazes an edge: few of hundreds.
            assert!(differ <= (w + h) / 200, "{size:?}: {differ} pixels differ");
            assert_eq!(frame.census()[2], 0);
        }
    }
}

#[test]
fn a_limit_that_is_reached_is_a_state_and_shown_only_on_request() {
    let mut plan = sized("bench-far", [96, 54]);
    plan.march.mode = Mode::Ray;
    plan.march.steps = Some(1);
    let frame = render(&plan, Extras::default());
    // The first sample is taken at the eye, far from everything.
    let [sky, hit, unconverged] = frame.census();
    assert_eq!((hit, sky + unconverged), (0, 96 * 54));
    assert!(unconverged > 1000);
    let limited = |f: &Frame, i: usize| f.state[i] == UNCONVERGED;
    for i in 0..frame.state.len() {
        assert_eq!(frame.depth[i].is_finite(), limited(&frame, i));
        assert_ne!(frame.radiance[i], [1.0, 0.0, 1.0]);
    }
    // Started at the bounds, which this surface touches, first samples do hit.
    plan.march.clip = Some(true);
    plan.look.flag_unconverged = true;
    for steps in [1, 2, 3] {
        plan.march.steps = Some(steps);
        let frame = render(&plan, Extras::default());
        let other = on_cpu(&plan, Extras::default());
        assert!(frame.census()[1] > 100 && frame.census()[2] > 20);
        let report = compared(&frame, &other, &plan);
        // Of 5184 rays, those that end within a rounding of the threshold.
        assert!(report.mask < 1e-3, "{}", report.mask);
        for f in [&frame, &other] {
            for i in 0..f.state.len() {
                assert_eq!(f.radiance[i] == [1.0, 0.0, 1.0], limited(f, i));
            }
        }
    }
    // With steps enough there are none.
    plan.march.steps = Some(256);
    assert_eq!(render(&plan, LEVELS).census()[2], 0);
}

#[test]
fn passes_figures_and_fudge_are_what_the_plan_says() {
    let mut plan = sized("bench-outside", [160, 90]);
    let names = |f: &Frame| f.passes.iter().map(|p| p.pass.name()).collect::<Vec<_>>();
    let marched = render(&plan, COUNTED);
    assert_eq!(
        names(&marched),
        ["march 1/16", "march 1/8", "march 1/4", "march 1/2", "trace"]
    );
    let layers = marched.levels.iter().map(|l| &l.work);
    for (pass, work) in marched.passes.iter().zip(layers.chain([&marched.work])) {
        let sum = |f: fn(&Counts) -> u32| work.iter().map(|w| u64::from(f(w))).sum::<u64>();
        assert_eq!(pass.cells, work.len() as u64);
        assert_eq!(pass.evaluations, Some(sum(|w| w.evaluations)));
        assert_eq!(pass.iterations, Some(sum(|w| w.iterations)));
        assert!(sum(|w| w.evaluations) > 0);
    }
    let uncounted = render(&plan, LEVELS);
    let mut figures = uncounted.passes.iter();
    assert!(figures.all(|p| p.evaluations.is_none() && p.iterations.is_none()));
    assert!(uncounted.work.is_empty() && uncounted.work_per_pixel().is_none());
    // Full cones take no factor. In the mode that does, one stands for all that follow.
    let fronts = |mode, fudge: &[f64]| {
        let mut plan = plan.clone();
        plan.march.mode = mode;
        plan.march.fudge = fudge.to_vec();
        bits(&render(&plan, LEVELS))
    };
    let full = fronts(Mode::Safe, &plan.march.fudge);
    assert!(full == fronts(Mode::Safe, &[0.6]));
    let short = fronts(Mode::Calibrated, &[0.6]);
    assert!(short != full);
    assert!(short == fronts(Mode::Calibrated, &[0.6; 4]));
    assert!(short != fronts(Mode::Calibrated, &[0.6, 1.0]));
    plan.march.mode = Mode::Ray;
    let alone = render(&plan, EVERYTHING);
    assert_eq!(names(&alone), ["trace", "color"]);
    assert!(alone.levels.is_empty());
}

/// A scene without any estimate goes through the same passes, on both executors.
#[test]
fn passes_do_not_know_what_they_march() {
    let size = [333, 217];
    for camera in &cameras()[..4] {
        let plan = slab(camera, size);
        assert_eq!(
            plan.passes(LEVELS),
            balls(0.05, camera, size).passes(LEVELS)
        );
        let (reference, t) = solved(&plan);
        // An f32 solution is off by some roundings of the eye's coordinates, up to 20,
        // times the slope at which a ray meets the planes.
        for (frame, allowed) in [(render(&plan, LEVELS), 1e-4), (on_cpu(&plan, LEVELS), 1e-6)] {
            let mut differ = 0;
            for (i, &t) in t.iter().enumerate() {
                differ += u32::from(frame.state[i] != reference.state[i]);
                if t.is_finite() && frame.state[i] == HIT {
                    let off = (f64::from(frame.depth[i]) - t).abs() / t;
                    assert!(off < allowed, "{off:e} at pixel {i}");
                }
            }
            // Only pixels whose ray touches the rim within a rounding.
            assert!(differ <= 2, "{differ} pixels differ");
        }
    }
}

/// Rays after cones and rays alone take other steps, and find the place where the field meets the
/// threshold.
#[test]
fn a_hit_depends_little_on_the_steps_of_its_ray() {
    for name in ["mandelbox-gate", "mandelbox-canyon", "mandelbox-julia"] {
        let ways = [
            [
                "image.size=[320, 180]",
                "march.coarsest=16",
                "march.shell=0.2",
            ],
            [
                "image.size=[320, 180]",
                "march.coarsest=1",
                "march.shell=0.05",
            ],
        ];
        let plans = ways.map(|way| preset(name, &way));
        let [cones, alone] = plans.each_ref().map(|plan| render(plan, DEPTHS));
        let detail = plans[0].march.detail;
        let view = plans[0].view();
        let mut apart = Vec::new();
        for (i, (a, b)) in cones.depth.iter().zip(&alone.depth).enumerate() {
            if cones.state[i] == HIT && alone.state[i] == HIT {
                let pixel = [i as u32 % 320, i as u32 / 320];
                let width = footprint(&view.view_ray(pixel), f64::from(*a));
                apart.push(f64::from((a - b).abs()) / (detail * width));
            }
        }
        apart.sort_by(f64::total_cmp);
        let median = apart[apart.len() / 2];
        println!("{name}: {median:.3} thresholds");
        assert!(median < 0.05, "{name}: {median}");
    }
}

#[test]
fn cones_are_left_out_where_they_cost_more_than_they_save() {
    let levels = |name: &str, settings: &[&str]| {
        let mut settings = settings.to_vec();
        settings.push("march.coarsest=auto");
        let (plan, assets) = (preset(name, &settings), Assets::default());
        plan.scene.outline(&plan.viewpoint(), &assets).unwrap();
        plan.resolved(Extras::default(), &assets).levels().len()
    };
    for (name, small, large) in [
        ("bench-far", 0, 0),
        ("bench-inside", 0, 0),
        ("bench-thin", 0, 4),
        ("bench-graze", 0, 0),
        ("mandelbox-gate", 0, 4),
        ("mandelbox-hall", 4, 4),
        ("mandelbox-lantern", 0, 0),
        ("mandelbox-shell", 0, 4),
        ("bricks", 0, 0),
        ("spikes", 4, 4),
        ("stones", 4, 4),
        ("terrain", 4, 4),
        ("valley-mist", 4, 4),
    ] {
        let own = "image.reference=auto";
        assert_eq!(
            levels(name, &[own, "image.size=[640, 360]"]),
            small,
            "{name}"
        );
        assert_eq!(
            levels(name, &[own, "image.size=[1280, 720]"]),
            large,
            "{name}"
        );
    }
    // In mode proven rays go by balls as cones do, and cones cost less beside them.
    let proven = [
        "march.mode=proven",
        "image.reference=auto",
        "image.size=[640, 360]",
    ];
    assert_eq!(levels("mandelbox-stage", &proven), 4);
    // The cones of many samples are marched once.
    let mut plan = preset(
        "mandelbox-stage",
        &["image.reference=auto", "march.coarsest=auto"],
    );
    plan.size = [640, 360];
    for (samples, cones) in [(1, 0), (16, 4)] {
        plan.samples = samples;
        let resolved = plan.resolved(Extras::default(), &Assets::default());
        assert_eq!(resolved.levels().len(), cones, "{samples} samples");
    }
    for size in ["image.size=[640, 360]", "image.size=[1280, 720]"] {
        // In a small picture of heights few rays share a cone.
        assert_eq!(levels("terrain", &["image.size=[160, 90]"]), 0);
        // A mode that is about cones keeps them.
        assert_eq!(levels("bench-far", &[size, "march.mode=proven"]), 0);
        assert_eq!(levels("bench-far", &[size, "march.mode=calibrated"]), 4);
    }
    // What is asked for stays.
    let plan = preset("bench-far", &["march.coarsest=8"]);
    assert_eq!(
        plan.resolved(Extras::default(), &Assets::default())
            .levels()
            .len(),
        3
    );
    // Both executors leave them out, also where heights must be made to know.
    for (name, size) in [
        ("bench-far", "image.size=[40, 24]"),
        ("bricks", "image.size=[400, 300]"),
    ] {
        let plan = preset(name, &["march.coarsest=auto", size]);
        for frame in [render(&plan, LEVELS), on_cpu(&plan, LEVELS)] {
            let marched = frame.passes.iter().filter(|p| p.pass.marches()).count();
            assert_eq!((frame.levels.len(), marched), (0, 1), "{name}");
        }
    }
}

/// The device only says that it is one.
#[test]
fn a_discrete_gpu_has_cones_only_if_asked() {
    let adapters = Adapters::find();
    let (adapter, _) = adapters.choose(&Choice::Auto).unwrap().expect(NO_ADAPTER);
    let mut device = Device::open(adapter).unwrap();
    device.info.device_type = DeviceType::DiscreteGpu;
    let mut renderer = Renderer::new(device);
    let mut marched = |name: &str, settings: &str, extras: Extras| {
        let plan = preset(name, &["image.size=[400, 300]", settings]);
        let frame = renderer.render(&plan, &Assets::default(), extras, &mut |_| true);
        let frame = frame.unwrap();
        frame.passes.iter().filter(|p| p.pass.marches()).count()
    };
    for name in ["mandelbox-gate", "terrain"] {
        assert_eq!(marched(name, "march.coarsest=auto", DEPTHS), 1, "{name}");
        assert_eq!(marched(name, "march.coarsest=auto", LEVELS), 1, "{name}");
        let reuse = Extras {
            reuse: true,
            ..DEPTHS
        };
        assert_eq!(marched(name, "march.coarsest=auto", reuse), 1, "{name}");
        assert_eq!(marched(name, "march.coarsest=16", DEPTHS), 5, "{name}");
    }
}
