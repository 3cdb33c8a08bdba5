use conemarch::{gpu::device::*, pass::look::srgb, plan::*, render::*};
#[path = "scratch_plans.rs"]
mod plans;
use glam::DVec3;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let ads = Adapters::find();
    let (ad, _) = ads.choose(&Choice::Auto).unwrap().unwrap();
    let mut r = Renderer::new(Device::open(ad).unwrap());
    for name in &a[1..] {
        let plan = plans::plan(name);
        let f = r.render(&plan, Extras::default(), &mut |_| true).unwrap();
        println!(
            "{name} {:?} march {:.0} color {:.0}",
            f.census(),
            f.march_ms,
            f.passes.last().unwrap().wall_ms
        );
        let light = plan.light();
        let bytes: Vec<u8> = f
            .radiance
            .iter()
            .flat_map(|c| {
                let c = srgb(light.tone(DVec3::new(c[0] as f64, c[1] as f64, c[2] as f64)));
                [c.x, c.y, c.z].map(|x| (x * 255.0 + 0.5) as u8)
            })
            .collect();
        let file = std::fs::File::create(format!("/tmp/{name}.png")).unwrap();
        let mut e = png::Encoder::new(file, plan.size[0], plan.size[1]);
        e.set_color(png::ColorType::Rgb);
        e.write_header().unwrap().write_image_data(&bytes).unwrap();
    }
}
