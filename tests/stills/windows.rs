//! A window of an image is a part of the picture, bit for bit.

use conemarch::picture::frame::Frame;
use conemarch::picture::{BitDepth, Layer, Shades};
use conemarch::plan::look::LightMode;
use conemarch::plan::pyramid::Block;
use conemarch::plan::{Background, Plan, WINDOW_STEP};

use super::common::plans::{preset, sized};
use super::work::bits;
use crate::adapter::{EVERYTHING, on_cpu, render};

/// A part of a frame.
fn cropped(frame: &Frame, window: Block) -> Frame {
    fn cut<T: Copy>(layer: &[T], width: u32, origin: [u32; 2], size: [u32; 2]) -> Vec<T> {
        let rows = layer.chunks(width as usize);
        let rows = rows.skip(origin[1] as usize).take(size[1] as usize);
        let columns = |row: &[T]| row[origin[0] as usize..][..size[0] as usize].to_vec();
        rows.flat_map(columns).collect()
    }
    let mut part = frame.clone();
    let (width, Block { origin, size }) = (frame.size[0], window);
    (part.size, part.origin) = (size, origin);
    part.radiance = cut(&frame.radiance, width, origin, size);
    if !frame.alpha.is_empty() {
        part.alpha = cut(&frame.alpha, width, origin, size);
    }
    if !frame.variance.is_empty() {
        part.variance = cut(&frame.variance, width, origin, size);
    }
    part.depth = cut(&frame.depth, width, origin, size);
    part.state = cut(&frame.state, width, origin, size);
    part.normal = cut(&frame.normal, width, origin, size);
    part.work = cut(&frame.work, width, origin, size);
    for level in &mut part.levels {
        let (columns, first) = (level.cells[0], origin.map(|o| o / level.divisor));
        level.cells = size.map(|n| n.div_ceil(level.divisor));
        level.front = cut(&level.front, columns, first, level.cells);
        level.state = cut(&level.state, columns, first, level.cells);
        level.work = cut(&level.work, columns, first, level.cells);
    }
    part
}

#[test]
fn a_window_is_a_part_of_the_picture_bit_for_bit() {
    let size = [150, 139];
    let lens = [
        "image.size=[150, 139]",
        "image.samples=3",
        "camera.aperture=0.02",
    ];
    let mut wide = sized("mandelbox", size);
    (wide.march.coarsest, wide.samples) = (Some(WINDOW_STEP), 2);
    let mut followed = sized("mandelbox-lantern", size);
    (followed.look.mode, followed.look.bounces) = (LightMode::Path, 1);
    let mut clear = wide.clone();
    clear.background = Background::Transparent;
    let plans = [
        clear,
        wide,
        preset("mandelbox-miniature", &lens),
        sized("terrain", size),
        followed,
    ];
    let windows = [
        ([0, 64], [150, 64]),
        ([0, 128], [150, 11]),
        ([64, 0], [86, 139]),
        ([64, 64], [64, 64]),
    ];
    for plan in &plans {
        let executors: [fn(&Plan) -> Frame; 2] = [
            |plan| render(plan, EVERYTHING),
            |plan| on_cpu(plan, EVERYTHING),
        ];
        for executor in executors {
            let whole = executor(plan);
            for (origin, size) in windows {
                let mut part = plan.clone();
                part.window = Some(Block { origin, size });
                let (found, expected) = (executor(&part), cropped(&whole, Block { origin, size }));
                assert_eq!((found.size, found.origin), (size, origin));
                assert_eq!(bits(&found), bits(&expected), "{}: {origin:?}", plan.title);
                assert_eq!(
                    found.positions(&plan.picture_rays()),
                    expected.positions(&plan.picture_rays())
                );
                let shown =
                    |frame: &Frame, layer| Shades::new(layer, frame, plan).rows(BitDepth::Eight);
                for layer in Layer::ALL
                    .into_iter()
                    .filter(|layer| layer.facts().is_local)
                {
                    assert_eq!(shown(&found, layer), shown(&expected, layer), "{layer:?}");
                }
            }
        }
    }
}

/// Dithering goes by the place in the whole image: the rows of the parts are those of the picture.
#[test]
fn the_rows_of_bands_are_those_of_the_picture() {
    let plan = sized("mandelbox", [100, 150]);
    let whole = on_cpu(&plan, conemarch::plan::Extras::default());
    for depth in [BitDepth::Eight, BitDepth::Sixteen] {
        let rows = |frame: &Frame| Shades::new(Layer::Color, frame, &plan).rows(depth);
        let bands = [(0, 64), (64, 64), (128, 22)].map(|(first, rows)| Block {
            origin: [0, first],
            size: [100, rows],
        });
        let parts: Vec<u8> = bands
            .iter()
            .flat_map(|b| rows(&cropped(&whole, *b)))
            .collect();
        assert_eq!(parts, rows(&whole));
    }
}
