//! The tables of measurements.

use crate::command::bench::cone_rows::{GeneratorRow, SurfaceNote, TracerRow};
use crate::command::bench::row::Row;
use crate::command::bench::steps_row::StepsRow;
use crate::command::table::{Column, table};

/// Stands above the times of a device without timestamps.
const UNTIMED: &str = "The device has no timestamps: times are wall time.\n\n";

/// A number with so many digits after the point.
fn fixed(x: f64, digits: usize) -> String {
    format!("{x:.digits$}")
}

/// A share in percent with so many digits after the point.
fn percent(share: f64, digits: usize) -> String {
    fixed(100.0 * share, digits)
}

/// A line of warning, if there is a warning.
pub fn precision(warning: Option<&str>) -> String {
    warning.map_or(String::new(), |w| format!("Precision: {w}.\n\n"))
}

/// What stands above a table: its title, and what is wrong with its figures.
fn head(title: &str, [w, h]: [u32; 2], warning: Option<&str>, timed: bool) -> String {
    let clock = if timed { "" } else { UNTIMED };
    format!("\n### {title}, {w} x {h}\n\n{}{clock}", precision(warning))
}

/// The rows of one preset, compared with the first.
pub fn preset(rows: &[Row]) -> String {
    let Some(first) = rows.first() else {
        return String::new();
    };
    let timed = rows.iter().any(|r| r.gpu_ms.is_some());
    let text = head(&first.preset, first.size, first.precision.as_deref(), timed);
    let starts = |row: &Row| {
        let starts = row.report.start_violations.iter().map(u64::to_string);
        starts.collect::<Vec<_>>().join(" ")
    };
    text + &table(
        rows,
        &[
            ("setting", &Row::label),
            ("evaluations per pixel", &|r| fixed(work(r), 2)),
            ("fewer", &|r| fixed(work(first) / work(r), 2)),
            ("wall ms", &|r| fixed(r.wall_ms, 1)),
            ("faster", &|r| fixed(first.wall_ms / r.wall_ms, 2)),
            ("behind %", &|r| percent(r.report.behind, 4)),
            ("holes %", &|r| percent(r.report.holes, 4)),
            ("behind 8 %", &|r| percent(r.report.behind8, 4)),
            ("p99 footprints", &|r| fixed(r.report.depth_error.p99, 3)),
            ("unconverged %", &|r| percent(r.report.unconverged, 4)),
            ("before the set", &|r| {
                fixed(r.sharpness.before_set.median, 2)
            }),
            ("wrong of the set %", &|r| {
                percent(r.sharpness.wrong_of_set, 3)
            }),
            ("FLIP", &|r| fixed(r.flip, 4)),
            ("start violations, coarse to fine", &starts),
        ],
    )
}

/// The rows of a setting, preset by preset.
fn of<'a>(rows: &'a [Row], label: &str) -> Vec<&'a Row> {
    rows.iter().filter(|r| r.label() == label).collect()
}

/// The geometric mean of a figure's ratio, first over second.
fn ratio(first: &[&Row], second: &[&Row], figure: fn(&Row) -> f64) -> f64 {
    let pairs = first.iter().zip(second);
    let logs: f64 = pairs.map(|(a, b)| (figure(a) / figure(b)).ln()).sum();
    (logs / first.len().max(1) as f64).exp()
}

/// The arithmetic mean of a figure.
fn mean(rows: &[&Row], figure: fn(&Row) -> f64) -> f64 {
    rows.iter().map(|r| figure(r)).sum::<f64>() / rows.len().max(1) as f64
}

fn wrong(row: &Row) -> f64 {
    row.report.wrong()
}

fn work(row: &Row) -> f64 {
    row.evaluations_per_pixel
}

fn time(row: &Row) -> f64 {
    row.wall_ms
}

/// Means over the presets, of each setting against the rival and `ray`.
pub fn means(rows: &[Row]) -> String {
    let (rival, ray) = (of(rows, "rival"), of(rows, "ray"));
    let text = "
### Means over the presets

Ratios are geometric means. Shares are arithmetic means. A pixel is wrong if it is behind, a hole or
unconverged.

";
    let mut labels: Vec<String> = Vec::new();
    for row in rows {
        if !labels.contains(&row.label()) {
            labels.push(row.label());
        }
    }
    // A setting that does not fit every preset has no mean over them.
    labels.retain(|label| of(rows, label).len() == ray.len());
    let own = |label: &String| of(rows, label);
    let fewer = |than: &[&Row], l: &String| fixed(ratio(than, &own(l), work), 2);
    let faster = |than: &[&Row], l: &String| fixed(ratio(than, &own(l), time), 2);
    let columns: [Column<'_, String>; 7] = [
        ("setting", &String::clone),
        ("fewer evaluations than the rival", &|l| fewer(&rival, l)),
        ("than ray", &|l| fewer(&ray, l)),
        ("faster than the rival", &|l| faster(&rival, l)),
        ("than ray", &|l| faster(&ray, l)),
        ("wrong pixels %", &|l| percent(mean(&own(l), wrong), 4)),
        ("FLIP", &|l| fixed(mean(&own(l), |r| r.flip), 4)),
    ];
    text.to_string() + &table(&labels, &columns)
}

/// The rules of the list of what beats `safe`.
const BEATS: &str = "
### What beats `safe`

These settings take at most 0.95 of the time of `safe`, and are wrong on fewer pixels. A pixel is
wrong if it is behind, a hole or unconverged. Settings with another `detail` are left out, because
their truth is another picture.

";

/// Settings that are both at least 5 % faster than `safe` and wrong on fewer pixels, preset
/// by preset.
pub fn better_than_safe(rows: &[Row]) -> String {
    let mut text = String::new();
    for safe in of(rows, "safe") {
        let own = rows.iter().filter(|r| r.preset == safe.preset);
        for row in own.filter(|r| r.is_comparable()) {
            if row.wall_ms <= 0.95 * safe.wall_ms && wrong(row) < wrong(safe) {
                text += &format!(
                    "- {}: `{}`, {:.2} of the time, wrong on {:.4} % instead of {:.4} %\n",
                    row.preset,
                    row.label(),
                    row.wall_ms / safe.wall_ms,
                    100.0 * wrong(row),
                    100.0 * wrong(safe),
                );
            }
        }
    }
    if text.is_empty() {
        text += "None.\n";
    }
    BEATS.to_string() + &text
}

/// The gain in percent that the slides claim for each of their budgets.
const CLAIMS: [(&str, u32); 3] = [
    ("slides-even", 30),
    ("slides-deep", 50),
    ("slides-fast", 100),
];

/// The claims of the slides beside what was measured.
pub fn slides(rows: &[Row]) -> String {
    let ray = of(rows, "ray");
    let text = "
### The claims of the 2012 slides

The slides have three budgets of steps. For each of them they claim a gain in speed over rays
without cones. The table compares the claimed gain with the measured one, and the wrong pixels with
those of `safe`.

";
    let own = |(name, _): &(&str, u32)| of(rows, name);
    let share = |figure: fn(&Row) -> f64| move |claim: &_| percent(mean(&own(claim), figure), 3);
    let starts = |claim: &_| {
        let all = own(claim).into_iter();
        let last = all.filter_map(|r| r.report.start_violations.last());
        last.sum::<u64>().to_string()
    };
    let gain = |claim: &_| percent(ratio(&ray, &own(claim), time) - 1.0, 0);
    let fewer = |claim: &_| fixed(ratio(&ray, &own(claim), work), 2);
    let of_safe = |_: &_| percent(mean(&of(rows, "safe"), wrong), 3);
    let columns: [Column<'_, (&str, u32)>; 9] = [
        ("budget", &|(name, _)| (*name).to_string()),
        ("claimed gain %", &|(_, claim)| claim.to_string()),
        ("measured gain %", &gain),
        ("fewer evaluations", &fewer),
        ("behind %", &share(|r| r.report.behind)),
        ("holes %", &share(|r| r.report.holes)),
        ("unconverged %", &share(|r| r.report.unconverged)),
        ("pixels whose cell starts behind the surface", &starts),
        ("behind, holes and unconverged of `safe` %", &of_safe),
    ];
    text.to_string() + &table(&CLAIMS, &columns)
}

/// The levels of one preset and mode.
pub fn levels(rows: &[StepsRow]) -> String {
    let Some(first) = rows.first() else {
        return String::new();
    };
    // The whole column has one clock.
    let timed = rows.iter().all(|r| r.gpu_ms.is_some());
    let title = format!("{}, {}", first.preset, first.mode);
    let text = head(&title, first.size, first.precision.as_deref(), timed);
    let clock = if timed { "gpu ms" } else { "wall ms" };
    let ms = |r: &StepsRow| fixed(r.gpu_ms.filter(|_| timed).unwrap_or(r.wall_ms), 2);
    text + &table(
        rows,
        &[
            ("pass", &|r| r.pass.clone()),
            ("cells", &|r| r.cells.to_string()),
            ("evaluations", &|r| r.evaluations.to_string()),
            ("iterations", &|r| r.iterations.to_string()),
            ("p50", &|r| r.p50.to_string()),
            ("p90", &|r| r.p90.to_string()),
            ("p99", &|r| r.p99.to_string()),
            ("max", &|r| r.max.to_string()),
            ("sky %", &|r| percent(r.sky, 2)),
            ("unconverged %", &|r| percent(r.unconverged, 4)),
            ("waste 8 x 1", &|r| fixed(r.waste_8x1, 2)),
            ("waste 8 x 4", &|r| fixed(r.waste_8x4, 2)),
            (clock, &ms),
        ],
    )
}

/// The cone maps of one field.
pub fn generators(rows: &[GeneratorRow]) -> String {
    let number = |value: Option<f64>| value.map_or("n/a".into(), |v| fixed(v, 4));
    let ms = |row: &GeneratorRow| match (row.ms, row.estimate_ms) {
        (Some(ms), _) => fixed(ms, 2),
        (None, Some(ms)) => format!("n/a, about {ms:.0}"),
        (None, None) => "n/a".into(),
    };
    let wider = |row: &GeneratorRow| number(row.wider_than_exact.map(|share| 100.0 * share));
    let columns: [Column<'_, GeneratorRow>; 5] = [
        ("generator", &|r| r.generator.clone()),
        ("ms", &ms),
        ("mean ratio", &|r| number(r.mean_ratio)),
        ("of exact", &|r| number(r.of_exact)),
        ("wider than exact %", &wider),
    ];
    rows.first().map_or(String::new(), |r| {
        of_field("Maps of", &r.over) + &table(rows, &columns)
    })
}

/// The tracers of one field.
pub fn tracers(rows: &[TracerRow]) -> String {
    let columns: [Column<'_, TracerRow>; 8] = [
        ("view", &|r| r.view_deg.to_string()),
        ("tracer", &|r| r.tracer.clone()),
        ("map", &|r| r.map.clone()),
        ("steps, mean", &|r| fixed(r.stats.steps_mean, 2)),
        ("p99", &|r| r.stats.steps_p99.to_string()),
        ("skipped %", &|r| percent(r.stats.skipped, 3)),
        ("unconverged %", &|r| percent(r.stats.unconverged, 3)),
        ("error, texels", &|r| {
            format!("{:.2e}", r.stats.error_texels)
        }),
    ];
    rows.first().map_or(String::new(), |r| {
        of_field("Tracers over", &r.over) + &table(rows, &columns)
    })
}

/// The title of a table of a field.
fn of_field(what: &str, over: &SurfaceNote) -> String {
    let ([w, h], surface) = (over.size, &over.surface);
    format!("\n### {what} {}, {w} x {h}, {surface}\n\n", over.field)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::compare::Report;

    /// A row of some mode, setting, time and wrong pixels.
    fn row(mode: &str, set: &str, wall_ms: f64, behind: f64, unconverged: f64) -> Row {
        Row {
            preset: "p".into(),
            mode: mode.into(),
            parameters: serde_json::from_str(&format!("{{{set}}}")).expect("a setting"),
            size: [100, 100],
            wall_ms,
            report: Report {
                behind,
                unconverged,
                ..Report::default()
            },
            ..Row::default()
        }
    }

    #[test]
    fn what_beats_safe_asks_for_its_picture_and_finds_its_pixels() {
        let safe = row("safe", "", 100.0, 0.01, 0.0);
        let listed = |other: Row| {
            let text = better_than_safe(&[safe.clone(), other]);
            assert!(text.starts_with(BEATS));
            !text.ends_with("None.\n")
        };
        assert!(listed(row("safe", r#""shell":0.1"#, 90.0, 0.009, 0.0)));
        // Slower, more wrong, given up, or another picture.
        assert!(!listed(row("safe", r#""shell":0.1"#, 96.0, 0.009, 0.0)));
        assert!(!listed(row("safe", r#""shell":0.1"#, 90.0, 0.011, 0.0)));
        assert!(!listed(row("safe", r#""steps":16"#, 90.0, 0.001, 0.01)));
        assert!(!listed(row("safe", r#""detail":2.0"#, 90.0, 0.001, 0.0)));
    }

    #[test]
    fn a_column_of_times_has_one_clock_and_says_which() {
        let step = |gpu_ms: Option<f64>, precision: Option<String>| StepsRow {
            gpu_ms,
            wall_ms: 77.0,
            precision,
            ..StepsRow::default()
        };
        let timed = levels(&[step(Some(5.0), None), step(Some(6.0), None)]);
        assert!(timed.contains("| gpu ms |") && timed.contains("|   5.00 |"));
        assert!(!timed.contains("wall") && !timed.contains("Precision"));
        let partly = levels(&[step(Some(5.0), None), step(None, None)]);
        assert!(partly.contains("| wall ms |") && partly.contains(UNTIMED));
        assert_eq!(partly.matches("|   77.00 |").count(), 2);
        let marked = levels(&[step(None, Some("too near".into()))]);
        assert!(marked.contains("Precision: too near.\n"));
        // Errors are measured beside wall time on every device.
        let mut error = row("safe", "", 77.0, 0.0, 0.0);
        let untimed = preset(std::slice::from_ref(&error));
        assert!(untimed.contains("| wall ms |") && untimed.contains(UNTIMED));
        error.gpu_ms = Some(5.0);
        error.precision = Some("too near".into());
        let timed = preset(&[error]);
        assert!(timed.contains("| wall ms |") && !timed.contains(UNTIMED));
        assert!(timed.contains("Precision: too near.\n"));
    }
}
