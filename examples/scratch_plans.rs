use conemarch::formula::mandelbox::Mandelbox;
use conemarch::{formula::*, plan::*};
use glam::DVec3;
pub fn plan(name: &str) -> Plan {
    let (e, t, s) = match name {
        "far" => ((0., 0., -14.), (0., 0., 0.), 2.0),
        "outside" => ((4., 2.5, -6.), (0., 0., 0.), -1.5),
        "inside" => ((1., 0.4, -3.5), (0.2, 0.1, 0.), -1.5),
        "graze" => ((6.5, 6.4, -7.5), (0., 5.5, 0.), 2.0),
        "thin" => ((3., 3., -9.), (0., 0., 0.), 3.0),
        _ => {
            return Plan::new(Subject::Distance {
                shape: Shape::Mandelbox(Mandelbox::default()),
                iterations: None,
            });
        }
    };
    let mut p = Plan::new(Subject::Distance {
        shape: Shape::Mandelbox(Mandelbox {
            scale: s,
            ..Default::default()
        }),
        iterations: None,
    });
    p.camera.eye = DVec3::new(e.0, e.1, e.2);
    p.camera.target = DVec3::new(t.0, t.1, t.2);
    p.camera.up = DVec3::Y;
    p.camera.fov = 48.5;
    p.size = [640, 360];
    p
}
#[allow(dead_code)]
fn main() {}
