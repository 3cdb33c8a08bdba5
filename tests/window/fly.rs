//! Keys, wheel and buttons move the camera, and the panel sets numbers.

use std::thread::sleep;
use std::time::Duration;

use conemarch::plan::Plan;
use conemarch::plan::camera::Camera;
use conemarch::preset;

use crate::desktop::{Desktop, Preview};
use crate::folder::Folder;

/// Saves the preset and reads it.
fn saved(view: &Preview<'_>, folder: &Folder) -> Plan {
    view.save(&folder.0.join("mandelbox-1.toml"))
}

#[test]
fn keys_wheel_and_clicks_fly() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let view = Preview::open(&desktop, &folder.0, "mandelbox --size 960x540");
    let first = preset::load("mandelbox", &[]).unwrap().plan.camera;
    let ahead = (first.target - first.eye).normalize();
    let right = ahead.cross(first.up).normalize();
    let ways = [
        ("w", ahead),
        ("Up", ahead),
        ("s", -ahead),
        ("d", right),
        ("Left", -right),
        ("e", right.cross(ahead)),
    ];
    // The way of a held key, and back again.
    let flown = |key: &str| {
        view.hold(key, 300);
        let camera = saved(&view, &folder).camera;
        view.key("ctrl+z");
        camera
    };
    for (key, way) in ways {
        let moved = flown(key);
        let step = moved.eye - first.eye;
        assert!(step.normalize().distance(way) < 1e-6, "{key}: {step}");
        assert!((moved.target - first.target).distance(step) < 1e-9);
    }
    for (key, side) in [("x", 1.0), ("z", -1.0)] {
        let rolled = flown(key);
        assert!(rolled.eye == first.eye && side * rolled.up.dot(right) > 0.1);
    }
    view.point(200, 300);
    view.xdotool("keydown ctrl sleep 0.1 click 4 sleep 0.1 keyup ctrl");
    let narrow = saved(&view, &folder).camera;
    assert!(narrow.fov < first.fov);
    // The preset's camera is that of its file.
    view.hold("w", 300);
    view.key("Home");
    assert_eq!(saved(&view, &folder).camera, narrow);
    // The flight, the way home, and each of two notches of the wheel.
    for _ in 0..4 {
        view.key("ctrl+z");
    }
    // What lies in the middle of the part that the panel leaves free.
    view.point(300, 270);
    view.xdotool("click --repeat 2 --delay 60 1");
    let focused = saved(&view, &folder).camera;
    assert!(focused.eye == first.eye && focused.target.distance(first.target) > 1.0);
    view.key("ctrl+z");
    assert_eq!(saved(&view, &folder).camera, first);
    // At any speed the surface stops a flight, and nothing is lost in it.
    view.point(200, 300);
    view.xdotool("click --repeat 50 --delay 5 4");
    view.hold("w", 1000);
    let stopped = saved(&view, &folder).camera;
    assert!(stopped.eye.dot(ahead) < 0.0, "{stopped:?}");
    view.close();
}

#[test]
fn a_left_drag_orbits_shift_is_faster_and_f11_fills_the_screen() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let view = Preview::open(&desktop, &folder.0, "mandelbox --size 960x540");
    let flown = |with: &str| {
        let before = saved(&view, &folder).camera.eye;
        view.xdotool(&format!("keydown {with}"));
        view.hold("s", 300);
        view.xdotool(&format!("keyup {with}"));
        let way = saved(&view, &folder).camera.eye - before;
        view.key("ctrl+z");
        way.length()
    };
    let [plain, fast] = ["F3", "shift"].map(flown);
    assert!(fast > 2.0 * plain, "{fast} and {plain}");
    // The eye goes round what lies in the middle of the window: the place that is ahead of all eyes at
    // one distance.
    let ahead = |camera: &Camera| (camera.target - camera.eye).normalize();
    let pivot = |before: &Camera, after: &Camera| {
        let turned = ahead(before) - ahead(after);
        let far = (after.eye - before.eye).dot(turned) / turned.length_squared();
        let [one, two] = [before, after].map(|camera| camera.eye + far * ahead(camera));
        assert!(
            far > 1.0 && one.distance(two) < 1e-3 * far,
            "{far} {one} {two}"
        );
        one
    };
    // A pointer that leaves the panel and drags at once is over the picture.
    view.point(700, 300);
    let before = saved(&view, &folder).camera;
    let poses = [0, 1].map(|_| {
        view.drag(1, [480, 270], [430, 250]);
        saved(&view, &folder).camera
    });
    let pivots = [pivot(&before, &poses[0]), pivot(&poses[0], &poses[1])];
    assert!(pivots[0].distance(pivots[1]) < 0.1, "{pivots:?}");
    view.key("F11");
    assert_eq!(view.at_rest().size, [1280, 800]);
    view.key("F11");
    assert_eq!(view.at_rest().size, [960, 540]);
    view.close();
}

#[test]
fn a_drag_stays_one_step_after_an_undo_in_its_middle() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let view = Preview::open(&desktop, &folder.0, "mandelbox --size 960x540");
    let first = preset::load("mandelbox", &[]).unwrap().plan.camera;
    view.point(200, 300);
    view.xdotool("mousedown 3");
    for x in [230, 260, 290, 320] {
        view.point(x, 300);
        sleep(Duration::from_millis(200));
        if x == 260 {
            view.key("ctrl+z");
        }
    }
    view.xdotool("mouseup 3");
    assert!(saved(&view, &folder).camera != first);
    view.key("ctrl+z");
    assert_eq!(saved(&view, &folder).camera, first);
    view.close();
}

#[test]
fn a_typed_number_and_a_dragged_color_are_one_step() {
    let (desktop, folder) = (Desktop::new(), Folder::new());
    let view = Preview::open(&desktop, &folder.0, "mandelbox --size 960x540");
    let first = preset::load("mandelbox", &[]).unwrap().plan;
    // The number beside the slider of `scene.scale`.
    let set = |number: &str| view.type_into([858, 94], number);
    // No Mandelbox has this scale, and no file could be opened with it.
    set("0.5");
    view.key("ctrl+s");
    sleep(Duration::from_millis(700));
    assert_eq!(folder.files(), ["cache"]);
    view.key("ctrl+z");
    set("2.35");
    let typed = saved(&view, &folder);
    assert!(preset::write(&typed).contains("scale = 2.35"));
    assert_eq!(typed.camera, first.camera);
    view.key("ctrl+z");
    assert_eq!(saved(&view, &folder).scene, first.scene);
    view.key("ctrl+y");
    // A save takes in what is still typed.
    view.click(858, 94);
    sleep(Duration::from_millis(500));
    view.key("ctrl+a");
    view.xdotool("type --delay 200 2.45");
    let typed = saved(&view, &folder);
    assert!(preset::write(&typed).contains("scale = 2.45"));
    // Its default is that of the preset.
    view.click(927, 94);
    assert_eq!(saved(&view, &folder).scene, first.scene);
    // The colour of the light opens a box of colours.
    let color = |plan: &Plan| plan.look.light_color;
    view.click(755, 416);
    sleep(Duration::from_millis(700));
    view.drag(1, [750, 250], [700, 300]);
    assert!(color(&saved(&view, &folder)) != color(&first));
    view.key("ctrl+z");
    assert_eq!(color(&saved(&view, &folder)), color(&first));
    view.close();
}
