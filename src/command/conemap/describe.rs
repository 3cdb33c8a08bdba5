//! What is in a map, as text for a terminal: a few lines, then a histogram.

use std::fmt::Write as _;

use rayon::slice::ParallelSliceMut;

use crate::heightfield::conemap::WIDEST;
use crate::heightfield::conemap::file::{Channel, MapFile, RatioScale, Slopes};
use crate::heightfield::conemap::generate::generator::{Generator, Quality};
use crate::heightfield::conemap::generate::slopes::slopes;
use crate::heightfield::heights::wrap_name;
use crate::heightfield::load::Loaded;

/// Longest bar of a histogram.
const BAR: f64 = 40.0;
/// A bar ends with an eighth of a character.
const EIGHTHS: [&str; 8] = ["", "▏", "▎", "▍", "▌", "▋", "▊", "▉"];

/// Numbers in order, for quantiles.
struct Sorted(Vec<f64>);

impl Sorted {
    fn new(values: impl Iterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.collect();
        values.par_sort_unstable_by(f64::total_cmp);
        Self(values)
    }

    fn at(&self, share: f64) -> f64 {
        let last = self.0.len().saturating_sub(1);
        let found = self.0.get((share * last as f64) as usize);
        found.copied().unwrap_or(0.0)
    }

    /// How many are not above 0.
    fn zeros(&self) -> usize {
        self.0.partition_point(|v| *v <= 0.0)
    }

    /// How many are under a bound.
    fn count_under(&self, bound: f64) -> usize {
        self.0.partition_point(|v| *v < bound)
    }
}

/// A number with about three figures.
pub(crate) fn figure(x: f64) -> String {
    let text = match x.abs() {
        0.0 => return "0".into(),
        a if a >= 1000.0 => return format!("{x:.0}"),
        a if a >= 100.0 => format!("{x:.1}"),
        a if a >= 1.0 => format!("{x:.2}"),
        a if a >= 1e-3 => format!("{x:.4}"),
        _ => return format!("{x:.1e}"),
    };
    text.trim_end_matches('0').trim_end_matches('.').into()
}

/// A share with one decimal, which is 0 only if nothing is there.
fn percent(count: usize, all: usize) -> String {
    let share = 100.0 * count as f64 / all.max(1) as f64;
    match count {
        0 => "0 %".into(),
        _ if share < 0.05 => "<0.1 %".into(),
        _ => format!("{share:.1} %"),
    }
}

/// A report: a name, rows of what is known, and a histogram with its title.
fn report(
    name: &str,
    rows: &[(&str, String)],
    title: &str,
    bars: &[(String, usize)],
    all: usize,
) -> String {
    let mut text = format!("{name}\n");
    for (name, what) in rows {
        let _ = writeln!(text, "  {name:<9} {what}");
    }
    let _ = writeln!(text, "\n  {title}");
    let longest = bars.iter().map(|(_, n)| *n).max().unwrap_or(0).max(1);
    let width = bars.iter().map(|(name, _)| name.chars().count()).max();
    let width = width.unwrap_or(0);
    for (name, n) in bars {
        let eighths = (BAR * 8.0 * *n as f64 / longest as f64).round() as usize;
        // Whatever is there has a visible bar.
        let eighths = eighths.max(usize::from(*n > 0));
        let bar = "█".repeat(eighths / 8) + EIGHTHS[eighths % 8];
        let line = format!("  {name:>width$}  {:>7}  {bar}", percent(*n, all));
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// Describes a cone map.
pub fn describe_map(name: &str, file: &MapFile) -> String {
    let (map, label, scale) = (&file.map, &file.label, file.label.scale());
    let ([w, h], [sw, sh]) = (map.size, label.samples);
    let (word, promise) = (map.kind.name(), map.kind.facts().promise);
    let mut heights = format!("{sw} x {sh} samples, wrap {}", wrap_name(map.wrap));
    if map.kind.over_cells() {
        let (surface, offset) = (label.patches.surface(), figure(map.offset));
        heights += &format!(", {surface}, offset {offset} texels");
    }
    if let Some(digest) = &label.digest {
        heights += &format!(", SHA-256 {digest:.12}...");
    }
    let ratios = Sorted::new(map.ratios.iter().copied());
    let (all, mean) = (ratios.0.len(), file.mean_share());
    let [low, median, high] = [0.0, 0.5, 1.0].map(|share| figure(ratios.at(share)));
    let [mean, texels, widest] = [mean, mean * scale, scale].map(figure);
    let means = format!(
        "mean {mean} of the width ({texels} texels), wider cones counted as the width; median {median} texels"
    );
    let zeros = percent(ratios.zeros(), all);
    let wide = percent(all - ratios.count_under(scale), all);
    let range = format!("from {low} to {high}; {zeros} are 0, {wide} are {widest} or wider");
    let rows = [
        ("cone map", format!("{w} x {h}, kind {word}: {promise}")),
        ("file", format_of(file)),
        ("heights", heights),
        ("made by", maker(label.generator.as_deref())),
        ("ratios", means),
        ("", range),
    ];
    let bars = octaves(&ratios, scale);
    report(name, &rows, "ratios in texels", &bars, all)
}

/// What made a map, with a warning if its cones may be too wide.
fn maker(label: Option<&str>) -> String {
    let Some(by) = label else {
        return "another program; it may have rounded cones up, to too wide ones".into();
    };
    let generator = by.split(',').next().and_then(Generator::named);
    match generator.map(|g| g.facts().quality) {
        Some(Quality::Flawed(flaw)) => format!("{by}: some cones are too wide, {flaw}"),
        _ => by.into(),
    }
}

fn format_of(file: &MapFile) -> String {
    let (format, scale) = (&file.format, figure(file.label.scale()));
    let layout = format.layout.name();
    if format.layout.is_exr() {
        return format!("EXR, 32-bit floats, 1 means {scale} texels");
    }
    let slopes = match format.slopes {
        Slopes::Half if format.layout.has(Channel::SlopeX) => "half slopes, ",
        _ => "",
    };
    let ratios = match format.ratio {
        RatioScale::Sqrt => "as square roots",
        RatioScale::Linear => "linear",
    };
    format!(
        "PNG, layout {layout}, {} bit, {slopes}ratios {ratios}, 1 means {scale} texels",
        format.bits as u8
    )
}

/// Rise per texel where it is steepest.
pub(crate) fn steepness(slope: [f32; 2]) -> f64 {
    let [x, y] = slope.map(f64::from);
    x.hypot(y)
}

/// How many ratios are between doubling bounds, up to the scale or the widest.
fn octaves(ratios: &Sorted, scale: f64) -> Vec<(String, usize)> {
    let all = ratios.0.len();
    let zero = ratios.zeros();
    // More rows at the low end would only be long.
    let top = (scale.log2().ceil() as i32).max(0);
    let low = (top - 12).max(-3);
    let mut bounds: Vec<f64> = (low..=top).map(f64::from).map(f64::exp2).collect();
    if ratios.at(1.0) > 2.0 * scale {
        let more = [4.0 * bounds[bounds.len() - 1], WIDEST];
        bounds.extend(more.into_iter().filter(|b| *b > scale));
        bounds.sort_by(f64::total_cmp);
        bounds.dedup();
    }
    let (least, most) = (short(bounds[0]), short(bounds[bounds.len() - 1]));
    let between = bounds.windows(2);
    let between = between.map(|pair| format!("{} to {}", short(pair[0]), short(pair[1])));
    let names = ["0".to_string(), format!("under {least}")].into_iter();
    let names = names.chain(between).chain([format!("{most} and wider")]);
    let under = bounds.iter().map(|b| ratios.count_under(*b).max(zero));
    let counts: Vec<usize> = [0, zero].into_iter().chain(under).chain([all]).collect();
    let counts = counts.windows(2).map(|pair| pair[1] - pair[0]);
    let rows: Vec<(String, usize)> = names.zip(counts).collect();
    // Empty rows at both ends are left out.
    let full = |r: &(String, usize)| r.1 > 0;
    let first = rows.iter().position(full).unwrap_or(0);
    let end = rows.iter().rposition(full).map_or(rows.len(), |i| i + 1);
    rows[first..end].to_vec()
}

fn short(x: f64) -> String {
    match x {
        x if x >= 1.0 => format!("{x:.0}"),
        x => format!("1/{:.0}", 1.0 / x),
    }
}

/// Describes a height map.
pub fn describe_heights(name: &str, loaded: &Loaded) -> String {
    let heights = &loaded.heights;
    let ([w, h], wrap) = (heights.size(), wrap_name(heights.wrap()));
    let data = heights.data();
    let all = data.len();
    let range = data.iter().fold([f32::INFINITY, 0.0], |[low, high], z| {
        [z.min(low), z.max(high)]
    });
    let mut halves = data.to_vec();
    let (_, median, _) = halves.select_nth_unstable_by((all - 1) / 2, f32::total_cmp);
    let [low, high, median] = [range[0], range[1], *median].map(|z| figure(z.into()));
    let mean = |sum: f64| figure(sum / all as f64);
    let slopes = slopes(heights).into_iter().map(steepness);
    let (sum, steepest) = slopes.fold((0.0, 0.0), |(sum, most): (f64, f64), s| {
        (sum + s, most.max(s))
    });
    let (mean_slope, steepest) = (mean(sum), figure(steepest));
    let mean = mean(data.iter().map(|z| f64::from(*z)).sum());
    let samples = format!("{w} x {h} samples, wrap {wrap}, {}", loaded.form);
    let range = format!("from {low} to {high}, mean {mean}, median {median}");
    let slopes = format!("mean {mean_slope} of the height per texel, steepest {steepest}");
    let rows = [("heights", samples), ("", range), ("slopes", slopes)];
    let bounds: [f64; 10] = std::array::from_fn(|i| i as f64 / 10.0);
    let mut counts = [0; 10];
    for z in data {
        let under = bounds.iter().take_while(|b| f64::from(*z) >= **b);
        counts[under.count().max(1) - 1] += 1;
    }
    let bars = counts.into_iter().zip(bounds);
    let bars = bars.map(|(n, from)| (format!("{from:.1} to {:.1}", from + 0.1), n));
    let bars: Vec<_> = bars.collect();
    report(name, &rows, "heights", &bars, all)
}
