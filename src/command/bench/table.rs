//! The tables of measurements.

use crate::command::bench::cone_rows::{GeneratorRow, TracerRow};
use crate::command::bench::row::Row;
use crate::command::bench::steps_row::StepsRow;
use crate::command::table::markdown;

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

/// The rows of one preset, compared with the first.
pub fn preset(rows: &[Row]) -> String {
    let Some(first) = rows.first() else {
        return String::new();
    };
    let [w, h] = first.size;
    let mut text = format!("\n### {}, {w} x {h}\n\n", first.preset);
    text += &precision(first.precision.as_deref());
    if rows.iter().all(|r| r.gpu_ms.is_none()) {
        text += UNTIMED;
    }
    let heads = [
        "setting",
        "evaluations per pixel",
        "fewer",
        "wall ms",
        "faster",
        "behind %",
        "holes %",
        "behind 8 %",
        "p99 footprints",
        "unconverged %",
        "FLIP",
        "start violations, coarse to fine",
    ];
    let cells = rows.iter().map(|row| {
        let starts: Vec<String> = row.start_violations.iter().map(u64::to_string).collect();
        [
            row.label(),
            fixed(row.evaluations_per_pixel, 2),
            fixed(first.evaluations_per_pixel / row.evaluations_per_pixel, 2),
            fixed(row.wall_ms, 1),
            fixed(first.wall_ms / row.wall_ms, 2),
            percent(row.behind, 4),
            percent(row.holes, 4),
            percent(row.behind8, 4),
            fixed(row.depth_error.p99, 3),
            percent(row.unconverged, 4),
            fixed(row.flip, 4),
            starts.join(" "),
        ]
    });
    text + &markdown(heads, &cells.collect::<Vec<_>>())
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

/// Means over the presets, of each setting against `ray` and `ray-relaxed`.
pub fn means(rows: &[Row]) -> String {
    let (ray, relaxed) = (of(rows, "ray"), of(rows, "ray-relaxed"));
    let text = String::from(
        "\n### Means over the presets\n\nRatios are geometric means, shares arithmetic ones. Wrong pixels are those behind, holes and\nunconverged ones.\n\n",
    );
    let mut labels: Vec<String> = Vec::new();
    for row in rows {
        if !labels.contains(&row.label()) {
            labels.push(row.label());
        }
    }
    let heads = [
        "setting",
        "fewer evaluations than ray",
        "than ray-relaxed",
        "faster than ray",
        "than ray-relaxed",
        "wrong pixels %",
        "FLIP",
    ];
    let mut cells = Vec::new();
    for label in labels {
        let own = of(rows, &label);
        // A setting that does not fit every preset has no mean over them.
        if own.len() != ray.len() {
            continue;
        }
        let work = |r: &Row| r.evaluations_per_pixel;
        let time = |r: &Row| r.wall_ms;
        cells.push([
            label,
            fixed(ratio(&ray, &own, work), 2),
            fixed(ratio(&relaxed, &own, work), 2),
            fixed(ratio(&ray, &own, time), 2),
            fixed(ratio(&relaxed, &own, time), 2),
            percent(mean(&own, Row::wrong), 4),
            fixed(mean(&own, |r| r.flip), 4),
        ]);
    }
    text + &markdown(heads, &cells)
}

/// What is listed as better than `safe`, and what is not.
const BEATS: &str = "
### What beats `safe`

Settings with at most 0.95 of its time and fewer wrong pixels. Settings of `detail` ask for
another picture, which has another truth, and are left out. Unconverged pixels count as wrong
beside those behind and lost: a setting that gives up on a pixel does not beat one that finds
it.

";

/// Settings that are both at least 5 % faster than `safe` and wrong on fewer pixels, preset
/// by preset, by the rules that its head states.
pub fn better_than_safe(rows: &[Row]) -> String {
    let mut text = String::from(BEATS);
    let mut found = 0;
    for safe in of(rows, "safe") {
        let own = rows.iter().filter(|r| r.preset == safe.preset);
        let same = own.filter(|r| !r.parameters.contains_key("detail"));
        for row in same {
            if row.wall_ms <= 0.95 * safe.wall_ms && row.wrong() < safe.wrong() {
                found += 1;
                text += &format!(
                    "- {}: `{}`, {:.2} of the time, wrong on {:.4} % instead of {:.4} %\n",
                    row.preset,
                    row.label(),
                    row.wall_ms / safe.wall_ms,
                    100.0 * row.wrong(),
                    100.0 * safe.wrong(),
                );
            }
        }
    }
    if found == 0 {
        text += "None.\n";
    }
    text
}

/// What the slides say that each of their budgets gains.
const CLAIMS: [(&str, u32); 3] = [
    ("slides-even", 30),
    ("slides-deep", 50),
    ("slides-fast", 100),
];

/// The slides' claims beside what was measured.
pub fn slides(rows: &[Row]) -> String {
    let (ray, safe) = (of(rows, "ray"), of(rows, "safe"));
    let text = "
### The claims of the 2012 slides

Speed gained over plain rays, and what it costs: pixels behind or lost, against those of the
exact step.

";
    let heads = [
        "budget",
        "claimed gain %",
        "measured gain %",
        "fewer evaluations",
        "behind %",
        "holes %",
        "unconverged %",
        "cells' pixels started behind",
        "behind, holes and unconverged of `safe` %",
    ];
    let cells = CLAIMS.map(|(name, claim)| {
        let own = of(rows, name);
        let starts: u64 = own.iter().flat_map(|r| r.start_violations.last()).sum();
        [
            name.into(),
            claim.to_string(),
            percent(ratio(&ray, &own, |r| r.wall_ms) - 1.0, 0),
            fixed(ratio(&ray, &own, |r| r.evaluations_per_pixel), 2),
            percent(mean(&own, |r| r.behind), 3),
            percent(mean(&own, |r| r.holes), 3),
            percent(mean(&own, |r| r.unconverged), 3),
            starts.to_string(),
            percent(mean(&safe, Row::wrong), 3),
        ]
    });
    text.to_string() + &markdown(heads, &cells)
}

/// The levels of one preset and mode.
pub fn levels(rows: &[StepsRow]) -> String {
    let Some(first) = rows.first() else {
        return String::new();
    };
    let [w, h] = first.size;
    let mut text = format!("\n### {}, {}, {w} x {h}\n\n", first.preset, first.mode);
    text += &precision(first.precision.as_deref());
    // The whole column has one clock.
    let timed = rows.iter().all(|r| r.gpu_ms.is_some());
    if !timed {
        text += UNTIMED;
    }
    let heads = [
        "pass",
        "cells",
        "evaluations",
        "iterations",
        "p50",
        "p90",
        "p99",
        "max",
        "sky %",
        "unconverged %",
        "waste 8 x 4",
        "waste 8 x 8",
        if timed { "gpu ms" } else { "wall ms" },
    ];
    let cells = rows.iter().map(|row| {
        [
            row.pass.clone(),
            row.cells.to_string(),
            row.evaluations.to_string(),
            row.iterations.to_string(),
            row.p50.to_string(),
            row.p90.to_string(),
            row.p99.to_string(),
            row.max.to_string(),
            percent(row.sky, 2),
            percent(row.unconverged, 4),
            fixed(row.waste_8x4, 2),
            fixed(row.waste_8x8, 2),
            fixed(row.gpu_ms.filter(|_| timed).unwrap_or(row.wall_ms), 2),
        ]
    });
    text + &markdown(heads, &cells.collect::<Vec<_>>())
}

/// The cone maps of one field.
pub fn generators(rows: &[GeneratorRow]) -> String {
    let Some(first) = rows.first() else {
        return String::new();
    };
    let [w, h] = first.size;
    let head = format!(
        "\n### Maps of {}, {w} x {h}, {}\n\n",
        first.field, first.surface
    );
    let heads = [
        "generator",
        "ms",
        "mean ratio",
        "of exact",
        "wider than exact %",
    ];
    let cells = rows.iter().map(|row| {
        let number = |value: Option<f64>| value.map_or("n/a".into(), |v| fixed(v, 4));
        let ms = match (row.ms, row.estimate_ms) {
            (Some(ms), _) => fixed(ms, 2),
            (None, Some(ms)) => format!("n/a, about {ms:.0}"),
            (None, None) => "n/a".into(),
        };
        [
            row.generator.clone(),
            ms,
            number(row.mean_ratio),
            number(row.of_exact),
            number(row.wider_than_exact.map(|share| 100.0 * share)),
        ]
    });
    head + &markdown(heads, &cells.collect::<Vec<_>>())
}

/// The tracers of one field.
pub fn tracers(rows: &[TracerRow]) -> String {
    let Some(first) = rows.first() else {
        return String::new();
    };
    let [w, h] = first.size;
    let head = format!(
        "\n### Tracers over {}, {w} x {h}, {}\n\n",
        first.field, first.surface
    );
    let heads = [
        "view",
        "tracer",
        "map",
        "steps, mean",
        "p99",
        "skipped %",
        "unconverged %",
        "error, texels",
    ];
    let cells = rows.iter().map(|row| {
        [
            row.view_deg.to_string(),
            row.tracer.clone(),
            row.map.clone(),
            fixed(row.steps_mean, 2),
            row.steps_p99.to_string(),
            percent(row.skipped, 3),
            percent(row.unconverged, 3),
            format!("{:.2e}", row.error_texels),
        ]
    });
    head + &markdown(heads, &cells.collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of `safe` but for its mode, a setting, its time and its wrong pixels.
    fn row(mode: &str, set: &str, wall_ms: f64, behind: f64, unconverged: f64) -> Row {
        let text = format!(
            r#"{{"preset":"p","mode":"{mode}","parameters":{{{set}}},"baseline":false,"size":[100,100],"device":"d","wall_ms":{wall_ms},"gpu_ms":null,"evaluations_per_pixel":1,"iterations_per_pixel":1,"depth_error":{{"median":0,"p95":0,"p99":0,"max":0}},"behind":{behind},"front":0,"behind8":0,"front8":0,"holes":0,"false_hits":0,"start_violations":[],"unconverged":{unconverged},"flip":0,"truth":{{"stride":0.1,"moved":0}},"precision":null}}"#
        );
        serde_json::from_str(&text).expect("a row")
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
            preset: "p".into(),
            mode: "safe".into(),
            pass: "trace".into(),
            size: [9, 9],
            device: "d".into(),
            cells: 81,
            visited: 81,
            evaluations: 81,
            iterations: 81,
            p50: 1,
            p90: 1,
            p99: 1,
            max: 1,
            sky: 0.0,
            unconverged: 0.0,
            waste_8x4: 1.0,
            waste_8x8: 1.0,
            histogram: Vec::new(),
            gpu_ms,
            wall_ms: 77.0,
            precision,
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
