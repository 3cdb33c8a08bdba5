//! Whether a picture fits into memory, asked before it is begun.

use std::fs;

use crate::heightfield::assets::Preparation;
use crate::plan::Plan;
use crate::scene::Assets;

/// Assumed where the system does not tell.
const UNKNOWN: u64 = 16 << 30;

/// Bytes that could be had now: what the system says is available, within the limit
/// of the control group, where there is one.
pub fn available() -> u64 {
    let free = fs::read_to_string("/proc/meminfo")
        .ok()
        .and_then(|text| meminfo(&text));
    let group = |file: &str| {
        let text = fs::read_to_string(format!("/sys/fs/cgroup/{file}")).ok()?;
        text.trim().parse::<u64>().ok()
    };
    let rest = group("memory.max").map(|most| {
        let used = group("memory.current").unwrap_or(0);
        most.saturating_sub(used)
    });
    free.unwrap_or(UNKNOWN).min(rest.unwrap_or(u64::MAX))
}

/// `MemAvailable` in bytes.
fn meminfo(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kib.checked_mul(1024)
}

/// A sentence where a picture does not fit, with a size of the same shape that does.
pub fn lacking([w, h]: [u32; 2], bytes_per_pixel: u64, available: u64) -> Option<String> {
    let needed = u64::from(w) * u64::from(h) * bytes_per_pixel;
    if needed <= available {
        return None;
    }
    let shrink = (available as f64 / needed as f64).sqrt();
    let fit = |n: u32| ((f64::from(n) * shrink) as u32).max(1);
    Some(format!(
        "a picture of {w}x{h} needs about {needed} bytes of memory, and {available} are available; --size {}x{} would fit",
        fit(w),
        fit(h)
    ))
}

/// Most memory that making a cone map takes at once, for each ratio: heights, maxima, the
/// ratios, and the file encoded and read back, measured and rounded up.
const BYTES_PER_RATIO: u64 = 64;

/// A sentence where cone maps with so many ratios do not fit.
pub fn lacking_maps(ratios: u64, available: u64) -> Option<String> {
    let needed = ratios.saturating_mul(BYTES_PER_RATIO);
    (needed > available).then(|| {
        format!(
            "cone maps with {ratios} ratios need about {needed} bytes of memory, and {available} are available; scale the heights down, or cut them"
        )
    })
}

/// A sentence where what a plan prepares does not fit.
pub fn lacking_for(plan: &Plan, assets: &Assets, available: u64) -> Option<String> {
    let ratios = |made: &Preparation| {
        let places: u64 = made.places.map(u64::from).iter().product();
        places * made.generator.channels() as u64
    };
    lacking_maps(
        plan.scene.preparations(assets).iter().map(ratios).sum(),
        available,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heightfield::settings::{HeightfieldSettings, Wrap};
    use crate::heightfield::tracer::TracerKind;

    #[test]
    fn a_size_that_is_offered_fits() {
        assert_eq!(lacking([100, 100], 60, 600_000), None);
        let why = lacking([65_536, 65_536], 60, 1 << 30).unwrap_or_default();
        assert!(why.contains("257698037760 bytes"), "{why}");
        let offered = why.rsplit("--size ").next().unwrap_or_default();
        let offered = offered.split(' ').next().unwrap_or_default();
        let size = crate::command::size::read(offered);
        assert!(size.is_ok_and(|s| lacking(s, 60, 1 << 30).is_none()));
    }

    #[test]
    fn meminfo_is_read_in_kib() {
        let text = "MemTotal:  9 kB\nMemAvailable:     2048 kB\n";
        assert_eq!(meminfo(text), Some(2 << 20));
        assert_eq!(meminfo("nothing"), None);
    }

    #[test]
    fn maps_are_weighed_by_their_ratios_before_heights_are_made() {
        let mut shape = HeightfieldSettings::default();
        shape.source.field = "fbm:8192x8192".into();
        shape.source.wrap = Wrap::Both;
        shape.tracing.tracer = TracerKind::Quad;
        let lacking = |shape: &HeightfieldSettings, available| {
            let plan = Plan::new(shape.clone());
            lacking_for(&plan, &Assets::default(), available)
        };
        let needed = 8192 * 8192 * 4 * BYTES_PER_RATIO;
        assert_eq!(lacking(&shape, needed), None);
        let why = lacking(&shape, needed - 1).unwrap_or_default();
        assert!(why.contains(&format!("{needed} bytes of memory")), "{why}");
        shape.tracing.tracer = TracerKind::MaxMip;
        assert_eq!(lacking(&shape, 0), None);
    }
}
