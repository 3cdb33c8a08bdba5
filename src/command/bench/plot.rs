//! Time against error, and against sharpness, as an SVG: two panels for each preset, with
//! logarithmic axes.
//!
//! Each mode has a colour; settings that change one key of a mode are small dots of its
//! colour. The line joins the settings that no other beats in both time and error: the Pareto front.
//!
//! Drawn by hand: the logarithmic axes of `plotters` have no ticks within a decade, where most
//! measurements lie, and its dots have no tooltips.

use crate::command::bench::row::Row;

/// Width and height of a panel.
pub const PANEL: [f64; 2] = [460.0, 330.0];
/// Left, top, right and bottom of the axes within a panel.
const MARGIN: [f64; 4] = [58.0, 34.0, 18.0, 44.0];
const LEGEND: f64 = 58.0;
/// Modes and their colours (Okabe and Ito's, which colour-blind people can tell apart).
const COLORS: [(&str, &str); 10] = [
    ("rival", "#000000"),
    ("old rival", "#f0e442"),
    ("safe", "#0072b2"),
    ("proven", "#009e73"),
    ("ray", "#666666"),
    ("ray-relaxed", "#bbbbbb"),
    ("calibrated", "#56b4e9"),
    ("slides-even", "#e69f00"),
    ("slides-deep", "#d55e00"),
    ("slides-fast", "#cc79a7"),
];

/// The colour of the line that joins the best.
const LINE: &str = "#8c564b";

/// What is drawn over the time.
struct Measure {
    what: &'static str,
    of: fn(&Row) -> Option<f64>,
    unit: &'static str,
    /// Whether the Pareto front is drawn, and named.
    has_front: bool,
}

const MEASURES: [Measure; 2] = [
    Measure {
        what: "wrong pixels, %",
        of: |row| Some(shown(row)),
        unit: "%",
        has_front: true,
    },
    Measure {
        what: "sharpness: median distance before the set, footprints",
        // A logarithmic axis has no place for a surface behind the set.
        of: |row| Some(row.sharpness.before_set.median).filter(|median| *median > 0.0),
        unit: "footprints",
        has_front: false,
    },
];

/// The begin of a picture of a size.
pub fn head(w: f64, h: f64) -> String {
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" viewBox="0 0 {w} {h}" font-family="sans-serif" font-size="11" fill="#333">
<rect width="{w}" height="{h}" fill="#fff"/>"##
    )
}

/// The picture of all rows.
pub fn draw(rows: &[Row]) -> String {
    let presets: Vec<&[Row]> = rows.chunk_by(|a, b| a.preset == b.preset).collect();
    let lines = presets.len().max(1);
    let (w, h) = (
        MEASURES.len() as f64 * PANEL[0],
        lines as f64 * PANEL[1] + LEGEND,
    );
    let mut svg = vec![head(w, h)];
    for (line, own) in presets.into_iter().enumerate() {
        for (column, measure) in MEASURES.iter().enumerate() {
            let at = [column as f64 * PANEL[0], line as f64 * PANEL[1]];
            panel(&mut svg, own, measure, at);
        }
    }
    legend(&mut svg, h - LEGEND + 18.0);
    svg.push("</svg>\n".into());
    svg.join("\n")
}

/// Rows that no other row beats in both time and wrong pixels, sorted by time.
pub fn front<'a>(rows: &[&'a Row]) -> Vec<&'a Row> {
    let mut sorted: Vec<&Row> = rows.iter().copied().filter(|r| r.is_comparable()).collect();
    sorted.sort_by(|a, b| {
        let time = a.wall_ms.total_cmp(&b.wall_ms);
        time.then(a.report.wrong().total_cmp(&b.report.wrong()))
    });
    let mut best: Vec<&Row> = Vec::new();
    for row in sorted {
        let beats = |best: &&Row| row.report.wrong() < best.report.wrong();
        if best.last().is_none_or(beats) {
            best.push(row);
        }
    }
    best
}

/// A logarithmic axis over some values, from `at` over `length`.
pub struct Axis {
    low: f64,
    high: f64,
    /// Where it begins.
    pub at: f64,
    /// How far it goes on; negative upwards.
    pub length: f64,
}

impl Axis {
    /// An axis with some room beyond the values.
    pub fn new(values: impl Iterator<Item = f64>, at: f64, length: f64) -> Self {
        // Without values any range will do.
        let values: Vec<f64> = values.collect();
        let low = values.iter().copied().reduce(f64::min).unwrap_or(1.0);
        let high = values.iter().copied().reduce(f64::max).unwrap_or(1.0);
        Self {
            low: low / 1.25,
            high: high * 1.25,
            at,
            length,
        }
    }

    /// Where a value is.
    pub fn place(&self, v: f64) -> f64 {
        let share = (v.max(self.low) / self.low).ln() / (self.high / self.low).ln();
        self.at + share * self.length
    }

    /// The coarsest choice of round numbers that still makes four ticks.
    fn ticks(&self) -> Vec<f64> {
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let choices: [&[f64]; 4] = [
            &[1.0],
            &[1.0, 2.0, 5.0],
            &[1.0, 2.0, 3.0, 5.0, 7.0],
            &[1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
        ];
        let of = |round: &[f64]| -> Vec<f64> {
            let powers = decades.clone().map(|e| 10_f64.powi(e));
            let all = powers.flat_map(|power| round.iter().map(move |m| m * power));
            all.filter(|t| (self.low..=self.high).contains(t)).collect()
        };
        let made = choices.map(of);
        let enough = made.iter().find(|ticks| ticks.len() >= 4);
        enough.unwrap_or(&made[3]).clone()
    }
}

/// A tick's number without the rounding error of its power of ten.
fn rounded(t: f64) -> String {
    match t {
        t if t >= 1e6 => format!("{:.0} M", 1e-6 * t),
        t if t >= 1e4 => format!("{:.0} k", 1e-3 * t),
        t => ((t * 1e6).round() / 1e6).to_string(),
    }
}

/// Wrong pixels in percent. None at all is drawn as half a pixel: the axis is logarithmic.
fn shown(row: &Row) -> f64 {
    let pixels = f64::from(row.size[0]) * f64::from(row.size[1]);
    100.0 * row.report.wrong().max(0.5 / pixels)
}

/// The axes over and beside the corner at which they begin, with a title and what they show.
pub fn axes(svg: &mut Vec<String>, [x, y]: [&Axis; 2], title: &str, [across, up]: [&str; 2]) {
    let (x0, y1, w, h) = (x.at, y.at, x.length, -y.length);
    let y0 = y1 - h;
    let above = y0 - 12.0;
    svg.push(format!(
        r##"<text x="{x0}" y="{above:.1}" font-size="13" font-weight="bold">{title}</text>"##
    ));
    for t in x.ticks() {
        let (at, below, label) = (x.place(t), y1 + 14.0, rounded(t));
        svg.push(format!(
            r##"<path d="M{at:.1} {y0:.1}v{h:.1}" stroke="#eee"/><text x="{at:.1}" y="{below:.1}" text-anchor="middle">{label}</text>"##
        ));
    }
    for t in y.ticks() {
        let (at, beside, base, label) = (y.place(t), x0 - 5.0, y.place(t) + 4.0, rounded(t));
        svg.push(format!(
            r##"<path d="M{x0:.1} {at:.1}h{w:.1}" stroke="#eee"/><text x="{beside:.1}" y="{base:.1}" text-anchor="end">{label}</text>"##
        ));
    }
    let (middle, below) = (x0 + 0.5 * w, y1 + 32.0);
    let (beside, height) = (x0 - 44.0, y0 + 0.5 * h);
    svg.push(format!(
        r##"<rect x="{x0}" y="{y0}" width="{w}" height="{h}" fill="none" stroke="#999"/>
<text x="{middle:.1}" y="{below:.1}" text-anchor="middle">{across}</text><text transform="translate({beside:.1} {height:.1}) rotate(-90)" text-anchor="middle">{up}</text>"##
    ));
}

/// The axes of a panel whose upper left corner is at a place.
pub fn axes_at(
    [left, top]: [f64; 2],
    across: impl Iterator<Item = f64>,
    up: impl Iterator<Item = f64>,
) -> [Axis; 2] {
    let [w, h] = [
        PANEL[0] - MARGIN[0] - MARGIN[2],
        PANEL[1] - MARGIN[1] - MARGIN[3],
    ];
    [
        Axis::new(across, left + MARGIN[0], w),
        // Downwards is better.
        Axis::new(up, top + MARGIN[1] + h, -h),
    ]
}

/// A line through points.
pub fn line(svg: &mut Vec<String>, points: impl Iterator<Item = [f64; 2]>, color: &str) {
    let points = points.map(|[x, y]| format!("{x:.1},{y:.1}"));
    let points = points.collect::<Vec<_>>().join(" ");
    svg.push(format!(
        r##"<polyline points="{points}" fill="none" stroke="{color}" stroke-width="1.5"/>"##
    ));
}

fn panel(svg: &mut Vec<String>, rows: &[Row], measure: &Measure, at: [f64; 2]) {
    let preset = rows.first().map_or("", |r| &r.preset);
    let rows: Vec<(&Row, f64)> = rows
        .iter()
        .filter(|row| row.is_comparable() || !measure.has_front)
        .filter_map(|row| Some((row, (measure.of)(row)?)))
        .collect();
    let times = rows.iter().map(|(row, _)| row.wall_ms);
    let [x, y] = axes_at(at, times, rows.iter().map(|(_, value)| *value));
    let labels = ["march and trace, ms", measure.what];
    axes(svg, [&x, &y], preset, labels);
    let dots: Vec<[f64; 2]> = rows
        .iter()
        .map(|(row, value)| [x.place(row.wall_ms), y.place(*value)])
        .collect();
    let all: Vec<&Row> = rows.iter().map(|(row, _)| *row).collect();
    let best = front(&all);
    if measure.has_front {
        let place = |row: &&Row| [x.place(row.wall_ms), y.place(shown(row))];
        line(svg, best.iter().map(place), LINE);
    }
    for ((row, value), [x, y]) in rows.iter().zip(&dots) {
        let (radius, stroke) = match row.baseline {
            true => (5.0, "#fff"),
            false => (2.6, "none"),
        };
        let (color, label) = (color(row.name()), row.label());
        let (ms, unit) = (row.wall_ms, measure.unit);
        svg.push(format!(
            r##"<circle cx="{x:.1}" cy="{y:.1}" r="{radius}" fill="{color}" stroke="{stroke}"><title>{label}: {ms:.1} ms, {value:.4} {unit}</title></circle>"##
        ));
    }
    if measure.has_front {
        names(svg, &best, &dots, &x, &y);
    }
}

/// Places for a name beside its dot: right or left; level, above or below.
const BESIDE: [[f64; 2]; 6] = [
    [6.0, 3.0],
    [-6.0, 3.0],
    [5.0, -6.0],
    [-5.0, -6.0],
    [5.0, 12.0],
    [-5.0, 12.0],
];

/// Writes the names of the sweeps on the front, the least wrong first, unless they would
/// cover each other or a dot. A dot also tells its name to a pointer.
fn names(svg: &mut Vec<String>, best: &[&Row], dots: &[[f64; 2]], x: &Axis, y: &Axis) {
    let around = |[x, y]: &[f64; 2]| [x - 3.0, y - 3.0, x + 3.0, y + 3.0];
    let mut taken: Vec<[f64; 4]> = dots.iter().map(around).collect();
    let [left, right] = [x.at, x.at + x.length];
    for row in best.iter().rev().filter(|r| !r.baseline) {
        let (cx, cy) = (x.place(row.wall_ms), y.place(shown(row)));
        let label = row.label().replace(", ", " ");
        let width = 4.8 * label.len() as f64;
        let room = BESIDE.iter().find_map(|[dx, dy]| {
            let start = if *dx > 0.0 { cx + dx } else { cx + dx - width };
            let shape = [start, cy + dy - 7.0, start + width, cy + dy + 2.0];
            let apart = |t: &[f64; 4]| {
                shape[0] > t[2] || shape[2] < t[0] || shape[1] > t[3] || shape[3] < t[1]
            };
            let fits = start > left && start + width < right && taken.iter().all(apart);
            fits.then_some((shape, start, cy + dy))
        });
        if let Some((shape, start, base)) = room {
            taken.push(shape);
            svg.push(format!(
                r##"<text x="{start:.1}" y="{base:.1}" font-size="9" fill="#666">{label}</text>"##
            ));
        }
    }
}

fn color(mode: &str) -> &'static str {
    let found = COLORS.iter().find(|(name, _)| *name == mode);
    found.map_or("#8c564b", |(_, color)| color)
}

fn legend(svg: &mut Vec<String>, y: f64) {
    let (mut x, middle, below) = (20.0, y - 4.0, y + 20.0);
    for (name, color) in COLORS {
        let beside = x + 9.0;
        svg.push(format!(
            r##"<circle cx="{x}" cy="{middle:.1}" r="5" fill="{color}"/><text x="{beside:.1}" y="{y}">{name}</text>"##
        ));
        x += 30.0 + 6.5 * name.len() as f64;
    }
    svg.push(format!(
        r##"<text x="20" y="{below:.1}">Small dots: one key of the mode changed. Brown line: no other setting is both faster and less wrong. A pixel is wrong if it is behind, a hole or unconverged.</text>"##
    ));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::compare::Report;

    fn row(wall_ms: f64, behind: f64) -> Row {
        Row {
            preset: "p".into(),
            size: [100, 100],
            wall_ms,
            report: Report {
                behind,
                ..Report::default()
            },
            ..Row::default()
        }
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let figures = [(3.0, 0.1), (1.0, 0.5), (2.0, 0.6), (4.0, 0.1), (5.0, 0.0)];
        let rows = figures.map(|(ms, behind)| row(ms, behind));
        let all: Vec<&Row> = rows.iter().collect();
        let times: Vec<f64> = front(&all).iter().map(|r| r.wall_ms).collect();
        assert_eq!(times, [1.0, 3.0, 5.0]);
    }

    #[test]
    fn a_plot_is_whole_with_few_rows_and_with_none() {
        let both = [row(1.0, 0.0), row(20.0, 0.3)];
        for rows in [&both[..0], &both[..1], &both] {
            let svg = draw(rows);
            assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
            assert_eq!(svg.matches("<circle").count(), rows.len() + COLORS.len());
        }
    }
}
