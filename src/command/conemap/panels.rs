//! The channels of a map as panels.

use glam::DVec3;

use crate::command::conemap::canvas::{Bar, Canvas, Panel};
use crate::command::conemap::describe::steepness;
use crate::heightfield::conemap::file::{Layout, MapFile};
use crate::heightfield::conemap::generate::slopes::slopes;
use crate::heightfield::heights::Heights;
use crate::picture::heat;

/// Ends of a scale of two signs: blue under, orange over (of one lightness).
const UNDER: DVec3 = DVec3::new(0.10, 0.32, 0.62);
const OVER: DVec3 = DVec3::new(0.75, 0.33, 0.05);
const EVEN: DVec3 = DVec3::splat(0.96);

fn signed(x: f64) -> DVec3 {
    let end = if x < 0.0 { UNDER } else { OVER };
    EVEN.lerp(end, x.abs().min(1.0))
}

/// A number on a bar: about three figures.
fn mark(x: f64) -> String {
    match x.abs() {
        a if a >= 99.95 || x.fract() == 0.0 => format!("{x:.0}"),
        a if a >= 0.995 => format!("{x:.1}"),
        a if a >= 0.01 => format!("{x:.3}"),
        _ => format!("{x:.5}"),
    }
}

fn height_panel(size: [u32; 2], heights: &[f32]) -> Panel<'_> {
    let width = size[0];
    Panel {
        caption: "height".into(),
        size,
        color: Box::new(move |x, y| DVec3::splat(f64::from(heights[(y * width + x) as usize]))),
        bar: Some(Bar {
            color: Box::new(DVec3::splat),
            marks: ["0".into(), "0.5".into(), "1".into()],
        }),
    }
}

/// Share of the ratios that the colours of a panel tell apart. The rest are as bright as
/// colours get: a few cones over peaks would else leave no colours for all others.
const TOLD_APART: f64 = 0.99;

/// Ratios in a heat map of their square root, since most are small. `step` of them
/// belong to each place, and one counts.
fn ratio_panel<'a>(file: &'a MapFile, caption: &str, which: usize, step: usize) -> Panel<'a> {
    let map = &file.map;
    let width = map.size[0];
    let mut sorted = map.ratios.clone();
    let at = (TOLD_APART * sorted.len().saturating_sub(1) as f64) as usize;
    let most = match sorted.is_empty() {
        true => 0.0,
        false => *sorted.select_nth_unstable_by(at, f64::total_cmp).1,
    };
    // No farther than the papers' channels hold.
    let high = most.min(file.label.scale).max(1e-9);
    Panel {
        caption: caption.into(),
        size: map.size,
        color: Box::new(move |x, y| {
            let ratio = map.ratios[(y * width + x) as usize * step + which];
            heat((ratio / high).clamp(0.0, 1.0).sqrt())
        }),
        bar: Some(Bar {
            color: Box::new(heat),
            marks: [
                "0".into(),
                mark(high / 4.0),
                format!("{} texels +", mark(high)),
            ],
        }),
    }
}

/// A channel that is even at one half, with its farthest value as its scale.
fn signed_panel<'a>(size: [u32; 2], caption: &str, shares: &'a [f32]) -> Panel<'a> {
    let width = size[0];
    let far = shares.iter().map(|s| (f64::from(*s) - 0.5).abs());
    let far = far.fold(0.0, f64::max).max(1e-9);
    Panel {
        caption: caption.into(),
        size,
        color: Box::new(move |x, y| {
            let share = f64::from(shares[(y * width + x) as usize]);
            signed((share - 0.5) / far)
        }),
        bar: Some(Bar {
            color: Box::new(|x| signed(2.0 * x - 1.0)),
            marks: [mark(-far), "0".into(), mark(far)],
        }),
    }
}

/// The channels of a cone map.
pub fn map_panels(file: &MapFile) -> Canvas {
    let size = file.map.size;
    let mut panels = Vec::new();
    if let Some(heights) = &file.heights {
        panels.push(height_panel(size, heights));
    }
    let places = size[0] as usize * size[1] as usize;
    if file.map.ratios.len() == places {
        panels.push(ratio_panel(file, "ratio", 0, 1));
    } else {
        for (i, side) in ["+x", "-x", "+y", "-y"].iter().enumerate() {
            panels.push(ratio_panel(file, &format!("ratio {side}"), i, 4));
        }
    }
    match (file.form.layout, file.extra.as_slice()) {
        (Layout::HeightSurface, [x, y]) => panels.push(normal_panel(size, &x.shares, &y.shares)),
        (_, extra) => {
            for channel in extra {
                panels.push(signed_panel(size, channel.name, &channel.shares));
            }
        }
    }
    Canvas::of(&panels)
}

/// A normal as it is stored, with the blue that its two numbers leave.
fn normal_panel<'a>(size: [u32; 2], xs: &'a [f32], ys: &'a [f32]) -> Panel<'a> {
    let width = size[0];
    Panel {
        caption: "normal".into(),
        size,
        color: Box::new(move |x, y| {
            let i = (y * width + x) as usize;
            let [nx, ny] = [xs[i], ys[i]].map(|n| 2.0 * f64::from(n) - 1.0);
            let nz = (1.0 - nx * nx - ny * ny).max(0.0).sqrt();
            DVec3::new(nx, ny, nz) * 0.5 + 0.5
        }),
        bar: None,
    }
}

/// Slope that the mean slope is shaded as: plastic, and not so steep that half of the
/// picture is black.
const SHADED: f64 = 0.5;

/// A height map, as it is and lit from the top left.
pub fn heights_panels(heights: &Heights) -> Canvas {
    let size = heights.size();
    let width = size[0];
    let slopes = slopes(heights);
    let steep = slopes.iter().map(|slope| steepness(*slope)).sum::<f64>();
    let depth = SHADED * slopes.len() as f64 / steep.max(1e-9);
    let light = DVec3::new(-1.0, -1.0, 1.5).normalize();
    let lit = |slope: [f32; 2]| {
        let [x, y] = slope.map(f64::from);
        let normal = DVec3::new(-x * depth, -y * depth, 1.0).normalize();
        0.06 + 0.94 * normal.dot(light).max(0.0)
    };
    let lit: Vec<f64> = slopes.into_iter().map(lit).collect();
    let shaded = Panel {
        caption: "lit from the top left".into(),
        size,
        color: Box::new(move |x, y| DVec3::splat(lit[(y * width + x) as usize])),
        bar: None,
    };
    Canvas::of(&[height_panel(size, heights.data()), shaded])
}
