//! Checks before the work begins that a picture fits into memory.

use std::fs;
use std::path::Path;

use anyhow::{Result, anyhow};
use indicatif::BinaryBytes;

use crate::gpu::adapters::Choice;
use crate::heightfield::assets::Preparation;
use crate::plan::Plan;
use crate::scene::Assets;

/// Assumed if the system does not tell.
const UNKNOWN: u64 = 16 << 30;

/// What a render takes beside its pixels: the program, the driver and compiled shaders. On software
/// Vulkan a picture of 64 x 36 takes 102 to 122 MiB in all.
const FIXED: u64 = 128 << 20;

/// What a driver maps beside it, for stacks and heaps of its threads. It fills little of that, so only
/// a limit of the address space counts it. With less, software Vulkan fails.
const MAPPED: u64 = 1 << 30;

/// Bytes that are available now for pixels and maps, with a driver or without.
fn available(has_driver: bool) -> u64 {
    let mapped = if has_driver { MAPPED } else { 0 };
    free(mapped, &|file| fs::read_to_string(file).ok()).saturating_sub(FIXED)
}

/// Bytes that are free: the least of what the system, the control groups of the process, and its
/// address space leave, of which so many bytes are `mapped` by others. `read` reads a file.
fn free(mapped: u64, read: &dyn Fn(&Path) -> Option<String>) -> u64 {
    let of = |file: &str, name: &str| line(name, &read(Path::new(file))?);
    let system = of("/proc/meminfo", "MemAvailable:").unwrap_or(UNKNOWN);
    let limits = read(Path::new("/proc/self/limits")).unwrap_or_default();
    let most = number("Max address space", &limits);
    let taken = of("/proc/self/status", "VmSize:").unwrap_or(0);
    let space = most.map(|most| most.saturating_sub(taken + mapped));
    let groups = read(Path::new("/proc/self/cgroup")).unwrap_or_default();
    let groups = groups.lines().filter_map(|group| left_by(group, read));
    groups.chain(space).fold(system, u64::min)
}

/// Bytes that a control group of the process and those above it leave, of a line like
/// `0::/user/job`, or `4:memory:/job` of version 1. Files that are kept in memory go when others
/// need it.
fn left_by(group: &str, read: &dyn Fn(&Path) -> Option<String>) -> Option<u64> {
    let mut parts = group.splitn(3, ':').skip(1);
    let (controllers, path) = (parts.next()?, parts.next()?);
    let (root, most, used, files) = match controllers {
        "" => ("", "memory.max", "memory.current", "inactive_file"),
        _ if controllers.split(',').any(|c| c == "memory") => (
            "memory",
            "memory.limit_in_bytes",
            "memory.usage_in_bytes",
            "total_inactive_file",
        ),
        _ => return None,
    };
    let left = |group: &Path| {
        let folder = Path::new("/sys/fs/cgroup").join(root);
        let folder = folder.join(group.strip_prefix("/").unwrap_or(group));
        let value = |file| -> Option<u64> { read(&folder.join(file))?.trim().parse().ok() };
        let stat = read(&folder.join("memory.stat")).unwrap_or_default();
        let files = number(files, &stat).unwrap_or(0);
        let used = value(used).unwrap_or(0).saturating_sub(files);
        Some(value(most)?.saturating_sub(used))
    };
    Path::new(path).ancestors().filter_map(left).min()
}

/// The first number behind a name in a list of the system.
fn number(name: &str, text: &str) -> Option<u64> {
    let line = text.lines().find_map(|l| l.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Bytes of memory that the process has, if the system tells.
pub fn used() -> Option<u64> {
    line("VmRSS:", &fs::read_to_string("/proc/self/status").ok()?)
}

/// A number of KiB in a list of the system, in bytes.
fn line(name: &str, text: &str) -> Option<u64> {
    let line = text.lines().find_map(|l| l.strip_prefix(name))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kib.checked_mul(1024)
}

/// Checks that a render fits into memory: the pixels of its window, and the cone maps that it needs.
///
/// # Errors
/// It does not fit.
pub fn check(plan: &Plan, bytes_per_pixel: u64, assets: &Assets, who: &Choice) -> Result<()> {
    let available = available(*who != Choice::Cpu);
    let lacking = match plan.window {
        Some(window) => lacking_part("a part", window.size, bytes_per_pixel, available, FINER),
        None => lacking(plan.size, bytes_per_pixel, available),
    };
    fits(lacking.or_else(|| lacking_for(plan, assets, available)))
}

/// What helps if a part of a picture does not fit.
pub const FINER: &str = "render parts of a finer --tile";

/// Checks that what has so many pixels fits into memory.
///
/// # Errors
/// It does not fit. The error says what helps.
pub fn check_pixels(what: &str, size: [u32; 2], bytes_per_pixel: u64, helps: &str) -> Result<()> {
    fits(lacking_part(
        what,
        size,
        bytes_per_pixel,
        available(false),
        helps,
    ))
}

/// Checks that making a cone map with so many ratios fits into memory.
///
/// # Errors
/// It does not fit.
pub fn check_map(ratios: u64, who: &Choice) -> Result<()> {
    fits(lacking_maps(ratios, available(*who != Choice::Cpu)))
}

fn fits(lacking: Option<String>) -> Result<()> {
    lacking.map_or(Ok(()), |why| Err(anyhow!(why)))
}

/// Share of the available memory that an advised size may take: other programs may take some
/// before it is tried.
const ADVISED: f64 = 0.9;

/// A sentence if a picture does not fit, with a size of the same shape that does.
fn lacking([w, h]: [u32; 2], bytes_per_pixel: u64, available: u64) -> Option<String> {
    let pixels = u64::from(w) * u64::from(h);
    let needed = pixels * bytes_per_pixel;
    if needed <= available {
        return None;
    }
    let there_is = there_is(needed, available);
    let fitting = (ADVISED * available as f64 / bytes_per_pixel as f64) as u64;
    let advice = if fitting == 0 {
        "free some memory, or raise the limits of the process".into()
    } else {
        let shrink = (fitting as f64 / pixels as f64).sqrt();
        let side = |n: u32, most: u64| ((f64::from(n) * shrink) as u64).clamp(1, most);
        // A side of one pixel cannot shrink further: the other one does.
        let width = side(w, fitting);
        format!("--size {width}x{} would fit", side(h, fitting / width))
    };
    Some(format!("a picture of {w}x{h} {there_is}; {advice}"))
}

/// A sentence if what has so many pixels does not fit, with what helps.
fn lacking_part(
    what: &str,
    [w, h]: [u32; 2],
    bytes_per_pixel: u64,
    available: u64,
    helps: &str,
) -> Option<String> {
    let needed = u64::from(w) * u64::from(h) * bytes_per_pixel;
    (needed > available).then(|| {
        let there_is = there_is(needed, available);
        format!("{what} of {w}x{h} pixels {there_is}; free some, or {helps}")
    })
}

fn there_is(needed: u64, available: u64) -> String {
    format!(
        "needs about {} of memory, and {} are available",
        BinaryBytes(needed),
        BinaryBytes(available)
    )
}

/// Most memory that making a cone map takes at once for each ratio: heights, maxima, the
/// ratios, and the file encoded and read back; measured and rounded up.
const BYTES_PER_RATIO: u64 = 64;

/// A sentence if cone maps with so many ratios do not fit.
fn lacking_maps(ratios: u64, available: u64) -> Option<String> {
    let needed = ratios.saturating_mul(BYTES_PER_RATIO);
    (needed > available).then(|| {
        format!(
            "making cone maps with {ratios} ratios {}; scale the heights down, or crop them",
            there_is(needed, available)
        )
    })
}

/// A sentence if the cone maps that a plan needs do not fit.
fn lacking_for(plan: &Plan, assets: &Assets, available: u64) -> Option<String> {
    let ratios = |made: &Preparation| {
        let places: u64 = made.places.map(u64::from).iter().product();
        places * made.generator.channels() as u64
    };
    let made = plan.scene.preparations(assets);
    lacking_maps(made.iter().map(ratios).sum(), available)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::arguments::size;
    use crate::heightfield::settings::HeightfieldSettings;
    use crate::heightfield::tracer::TracerKind;

    #[test]
    fn an_advised_size_fits_and_is_read_as_a_size() {
        assert_eq!(lacking([100, 100], 60, 600_000), None);
        let why = lacking([65_536, 65_536], 60, 1 << 30).unwrap_or_default();
        assert!(why.contains("240.00 GiB of memory, and 1.00 GiB"), "{why}");
        for asked in [[65_536, 65_536], [65_536, 1], [2, 65_536], [9, 9]] {
            for available in [60, 67, 600, 1201, 131_072, 1 << 20] {
                let Some(why) = lacking(asked, 60, available) else {
                    continue;
                };
                let advised = why.split("--size ").nth(1);
                match advised.and_then(|rest| size(rest.split(' ').next()?).ok()) {
                    Some(advised) => assert_eq!(lacking(advised, 60, available), None),
                    None => assert!(available < 67 && why.ends_with("the limits of the process")),
                }
            }
        }
    }

    #[test]
    fn numbers_of_the_system_are_in_kib() {
        let text = "MemTotal:  9 kB\nMemAvailable:     2048 kB\n";
        assert_eq!(line("MemAvailable:", text), Some(2 << 20));
        assert_eq!(line("MemAvailable:", "nothing"), None);
    }

    #[test]
    fn the_least_of_all_limits_counts() {
        let mib = |n: u64| (n << 20).to_string();
        let left = |mapped: u64, more: &[(&str, String)]| {
            let mut files = vec![(
                "/proc/meminfo".to_string(),
                "MemAvailable: 9437184 kB".into(),
            )];
            files.extend(more.iter().map(|(f, text)| (f.to_string(), text.clone())));
            free(mapped, &move |path| {
                let file = files.iter().find(|(file, _)| Path::new(file) == path);
                file.map(|(_, text)| text.clone())
            }) >> 20
        };
        let files = |more: &[(&str, String)]| left(0, more);
        assert_eq!(files(&[]), 9216);
        let space = format!("Max address space  {}  unlimited  bytes\n", mib(1000));
        let limits = ("/proc/self/limits", space);
        let status = ("/proc/self/status", "VmSize:  102400 kB\n".into());
        let space = [limits, status];
        assert_eq!(files(&space), 900);
        assert_eq!(left(300 << 20, &space), 600);
        assert_eq!(left(MAPPED, &space), 0);
        // A job within a user's group, which is smaller, and holds files.
        let own = ("/proc/self/cgroup", "0::/user/job\n".to_string());
        let job = ("/sys/fs/cgroup/user/job/memory.max", "max".into());
        let most = ("/sys/fs/cgroup/user/memory.max", mib(500));
        let used = ("/sys/fs/cgroup/user/memory.current", mib(300));
        let stat = format!("anon 5\ninactive_file {}\n", mib(200));
        let stat = ("/sys/fs/cgroup/user/memory.stat", stat);
        assert_eq!(files(&[own, job, most, used, stat]), 400);
        let own = ("/proc/self/cgroup", "5:cpu:/a\n4:memory:/a\n".to_string());
        let most = ("/sys/fs/cgroup/memory/a/memory.limit_in_bytes", mib(70));
        assert_eq!(files(&[own, most]), 70);
    }

    #[test]
    fn maps_are_weighed_by_their_ratios_before_heights_are_made() {
        let mut shape = HeightfieldSettings::default();
        shape.source.field = "fbm:8192x8192".into();
        shape.source.options.wrap = [true; 2];
        shape.tracer_settings.tracer = Some(TracerKind::Quad);
        let lacking = |shape: &HeightfieldSettings, available| {
            let plan = Plan::new(shape.clone());
            lacking_for(&plan, &Assets::default(), available)
        };
        let needed = 8192 * 8192 * 4 * BYTES_PER_RATIO;
        assert_eq!(lacking(&shape, needed), None);
        let why = lacking(&shape, needed - 1).unwrap_or_default();
        assert!(why.contains("16.00 GiB of memory, and 16.00 GiB"), "{why}");
        shape.tracer_settings.tracer = Some(TracerKind::MaxMip);
        assert_eq!(lacking(&shape, 0), None);
    }
}
