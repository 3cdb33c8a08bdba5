//! The channels of a map as panels.

use glam::DVec3;

use crate::command::conemap::describe::{figure, steepness};
use crate::command::conemap::sheet::{Bar, Panel};
use crate::heightfield::conemap::file::{Channel, MapFile};
use crate::heightfield::conemap::generate::slopes::slopes;
use crate::heightfield::heights::Heights;
use crate::picture::heat;

/// Ends of a scale of two signs: blue below, orange above (of one lightness).
const BELOW: DVec3 = DVec3::new(0.10, 0.32, 0.62);
const ABOVE: DVec3 = DVec3::new(0.75, 0.33, 0.05);
const EVEN: DVec3 = DVec3::splat(0.96);

/// The colour of a share of 0..=1 that is even at one half.
fn signed(share: f64) -> DVec3 {
    let x = 2.0 * share - 1.0;
    let end = if x < 0.0 { BELOW } else { ABOVE };
    EVEN.lerp(end, x.abs().min(1.0))
}

fn height_panel(size: [u32; 2], heights: &[f32]) -> Panel {
    let bar = Bar {
        color: DVec3::splat,
        marks: ["0".into(), "0.5".into(), "1".into()],
    };
    let color = |i: usize| DVec3::splat(f64::from(heights[i]));
    Panel::new("height", size, color, Some(bar))
}

/// Share of the ratios that the colours of a panel distinguish. The rest are as bright as
/// colours get; otherwise a few cones over peaks would leave no colours for all others.
const DISTINGUISHED: f64 = 0.99;

/// The cones of one channel as a heat map of the square root of their ratios, because most
/// are small.
fn ratio_panel(file: &MapFile, caption: &str, channel: usize) -> Panel {
    let (map, channels) = (&file.map, file.map.kind.channels());
    let mut sorted = map.ratios.clone();
    let at = (DISTINGUISHED * sorted.len().saturating_sub(1) as f64) as usize;
    let most = match sorted.is_empty() {
        true => 0.0,
        false => *sorted.select_nth_unstable_by(at, f64::total_cmp).1,
    };
    // No farther than the papers' channels hold.
    let high = most.min(file.label.scale()).max(1e-9);
    let color = |i: usize| {
        let ratio = map.ratios[i * channels + channel];
        heat((ratio / high).clamp(0.0, 1.0).sqrt())
    };
    let most = format!("{} texels +", figure(high));
    let bar = Bar {
        color: heat,
        marks: ["0".into(), figure(high / 4.0), most],
    };
    Panel::new(caption, map.size, color, Some(bar))
}

/// A channel that is even at one half, scaled to its farthest value.
fn signed_panel(size: [u32; 2], caption: &str, shares: &[f32]) -> Panel {
    let far = shares.iter().map(|s| (f64::from(*s) - 0.5).abs());
    let far = far.fold(0.0, f64::max).max(1e-9);
    let color = |i: usize| signed(0.5 + 0.5 * (f64::from(shares[i]) - 0.5) / far);
    let bar = Bar {
        color: signed,
        marks: [figure(-far), "0".into(), figure(far)],
    };
    Panel::new(caption, size, color, Some(bar))
}

/// A normal as it is stored, with the blue that follows from its two numbers.
fn normal_panel(size: [u32; 2], xs: &[f32], ys: &[f32]) -> Panel {
    let color = |i: usize| {
        let [nx, ny] = [xs[i], ys[i]].map(|n| 2.0 * f64::from(n) - 1.0);
        let nz = (1.0 - nx * nx - ny * ny).max(0.0).sqrt();
        DVec3::new(nx, ny, nz) * 0.5 + 0.5
    };
    Panel::new("normal", size, color, None)
}

/// The channels of a cone map.
pub fn map_panels(file: &MapFile) -> Vec<Panel> {
    let size = file.map.size;
    let heights = file.heights.iter().map(|h| height_panel(size, h));
    let mut panels: Vec<Panel> = heights.collect();
    let captions = match file.map.kind.channels() {
        1 => &["ratio"][..],
        _ => &["ratio +x", "ratio -x", "ratio +y", "ratio -y"],
    };
    for (channel, caption) in captions.iter().enumerate() {
        panels.push(ratio_panel(file, caption, channel));
    }
    let has_normals = file.format.layout.has(Channel::NormalX);
    match file.shading.as_slice() {
        [x, y] if has_normals => panels.push(normal_panel(size, &x.shares, &y.shares)),
        slopes => {
            panels.extend(slopes.iter().map(|s| signed_panel(size, s.name, &s.shares)));
        }
    }
    panels
}

/// Slope that the mean slope is shaded as: plastic, and not so steep that half of the
/// picture is black.
const SHADED: f64 = 0.5;

/// A height map, as it is and lit from the top left.
pub fn heights_panels(heights: &Heights) -> Vec<Panel> {
    let slopes = slopes(heights);
    let steep = slopes.iter().map(|slope| steepness(*slope)).sum::<f64>();
    let depth = SHADED * slopes.len() as f64 / steep.max(1e-9);
    let light = DVec3::new(-1.0, -1.0, 1.5).normalize();
    let lit = |i: usize| {
        let [x, y] = slopes[i].map(f64::from);
        let normal = DVec3::new(-x * depth, -y * depth, 1.0).normalize();
        DVec3::splat(0.06 + 0.94 * normal.dot(light).max(0.0))
    };
    vec![
        height_panel(heights.size(), heights.data()),
        Panel::new("lit from the top left", heights.size(), lit, None),
    ]
}
