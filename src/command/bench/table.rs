//! Rows as tables that are Markdown and read well on a terminal.

use crate::command::bench::cone_rows::{GeneratorRow, TracerRow};
use crate::command::bench::row::Row;
use crate::command::bench::steps_row::StepsRow;

/// Said above times of a device that does not tell its own.
const UNTIMED: &str = "The device has no timestamps: times are wall time.\n\n";

/// A line of warning where there is one.
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
    text += "| setting                              | evaluations per pixel | fewer | wall ms | faster | behind % | holes % | behind 8 % | p99 footprints | unconverged % |   FLIP | start violations, coarse to fine |\n";
    text += "|:-------------------------------------|----:|----:|----:|----:|----:|----:|----:|----:|----:|----:|:----|\n";
    for row in rows {
        let starts: Vec<String> = row.start_violations.iter().map(u64::to_string).collect();
        text += &format!(
            "| {:<36} | {:6.2} | {:5.2} | {:7.1} | {:5.2} | {:.4} | {:.4} | {:.4} | {:8.3} | {:.4} | {:.4} | {} |\n",
            row.label(),
            row.evaluations_per_pixel,
            first.evaluations_per_pixel / row.evaluations_per_pixel,
            row.wall_ms,
            first.wall_ms / row.wall_ms,
            100.0 * row.behind,
            100.0 * row.holes,
            100.0 * row.behind8,
            row.depth_error.p99,
            100.0 * row.unconverged,
            row.flip,
            starts.join(" "),
        );
    }
    text
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
    let mut text = String::from(
        "\n### Means over the presets\n\nRatios are geometric means, shares arithmetic ones. Wrong pixels are those behind, holes and\nunconverged ones.\n\n",
    );
    text += "| setting                              | fewer evaluations than ray | than ray-relaxed | faster than ray | than ray-relaxed | wrong pixels % |   FLIP |\n";
    text += "|:-------------------------------------|----:|----:|----:|----:|----:|----:|\n";
    let mut labels: Vec<String> = Vec::new();
    for row in rows {
        if !labels.contains(&row.label()) {
            labels.push(row.label());
        }
    }
    for label in labels {
        let own = of(rows, &label);
        // A setting that does not fit every preset has no mean over them.
        if own.len() != ray.len() {
            continue;
        }
        let work = |r: &Row| r.evaluations_per_pixel;
        let time = |r: &Row| r.wall_ms;
        text += &format!(
            "| {label:<36} | {:5.2} | {:5.2} | {:5.2} | {:5.2} | {:.4} | {:.4} |\n",
            ratio(&ray, &own, work),
            ratio(&relaxed, &own, work),
            ratio(&ray, &own, time),
            ratio(&relaxed, &own, time),
            100.0 * mean(&own, Row::wrong),
            mean(&own, |r| r.flip),
        );
    }
    text
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
    let mut text = String::from(
        "\n### The claims of the 2012 slides\n\nSpeed gained over plain rays, and what it costs: pixels behind or lost, against those of the\nexact step.\n\n",
    );
    text += "| budget      | claimed gain % | measured gain % | fewer evaluations | behind % | holes % | unconverged % | cells' pixels started behind | behind, holes and unconverged of `safe` % |\n";
    text += "|:------------|----:|----:|----:|----:|----:|----:|----:|----:|\n";
    for (name, claim) in CLAIMS {
        let own = of(rows, name);
        let starts: u64 = own.iter().flat_map(|r| r.start_violations.last()).sum();
        text += &format!(
            "| {name:<11} | {claim} | {:.0} | {:.2} | {:.3} | {:.3} | {:.3} | {starts} | {:.3} |\n",
            100.0 * (ratio(&ray, &own, |r| r.wall_ms) - 1.0),
            ratio(&ray, &own, |r| r.evaluations_per_pixel),
            100.0 * mean(&own, |r| r.behind),
            100.0 * mean(&own, |r| r.holes),
            100.0 * mean(&own, |r| r.unconverged),
            100.0 * mean(&safe, Row::wrong),
        );
    }
    text
}

/// The levels of one preset and mode.
pub fn levels(rows: &[StepsRow]) -> String {
    let Some(first) = rows.first() else {
        return String::new();
    };
    let [w, h] = first.size;
    let mut text = format!("\n### {}, {}, {w} x {h}\n\n", first.preset, first.mode);
    text += &precision(first.precision.as_deref());
    // One clock for the whole column.
    let timed = rows.iter().all(|r| r.gpu_ms.is_some());
    if !timed {
        text += UNTIMED;
    }
    let clock = if timed { " gpu ms" } else { "wall ms" };
    text += &format!(
        "| pass       |   cells | evaluations | iterations | p50 | p90 | p99 |  max |  sky % | unconverged % | waste 8 x 4 | waste 8 x 8 | {clock} |\n"
    );
    text +=
        "|:-----------|----:|----:|----:|----:|----:|----:|----:|----:|----:|----:|----:|----:|\n";
    for row in rows {
        text += &format!(
            "| {:<10} | {:7} | {:11} | {:10} | {:3} | {:3} | {:3} | {:4} | {:6.2} | {:8.4} | {:5.2} | {:5.2} | {:7.2} |\n",
            row.pass,
            row.cells,
            row.evaluations,
            row.iterations,
            row.p50,
            row.p90,
            row.p99,
            row.max,
            100.0 * row.sky,
            100.0 * row.unconverged,
            row.waste_8x4,
            row.waste_8x8,
            row.gpu_ms.filter(|_| timed).unwrap_or(row.wall_ms),
        );
    }
    text
}

/// The cone maps of one field.
pub fn generators(rows: &[GeneratorRow]) -> String {
    let Some(first) = rows.first() else {
        return String::new();
    };
    let [w, h] = first.size;
    let mut text = format!(
        "\n### Maps of {}, {w} x {h}, {}\n\n",
        first.field, first.surface
    );
    text += "| generator      |       ms | mean ratio | of exact | wider than exact % |\n";
    text += "|:---------------|----:|----:|----:|----:|\n";
    for row in rows {
        let number = |value: Option<f64>| value.map_or("n/a".into(), |v| format!("{v:.4}"));
        let ms = match (row.ms, row.estimate_ms) {
            (Some(ms), _) => format!("{ms:.2}"),
            (None, Some(ms)) => format!("n/a, about {ms:.0}"),
            (None, None) => "n/a".into(),
        };
        text += &format!(
            "| {:<14} | {ms:>8} | {:>10} | {:>8} | {:>8} |\n",
            row.generator,
            number(row.mean_ratio),
            number(row.of_exact),
            number(row.wider_than_exact.map(|share| 100.0 * share)),
        );
    }
    text
}

/// The tracers of one field.
pub fn tracers(rows: &[TracerRow]) -> String {
    let Some(first) = rows.first() else {
        return String::new();
    };
    let [w, h] = first.size;
    let mut text = format!(
        "\n### Tracers over {}, {w} x {h}, {}\n\n",
        first.field, first.surface
    );
    text += "| view | tracer        | map            | steps, mean | p99 | skipped % | unconverged % | error, texels |\n";
    text += "|----:|:--------------|:---------------|----:|----:|----:|----:|----:|\n";
    for row in rows {
        text += &format!(
            "| {:4} | {:<13} | {:<14} | {:7.2} | {:4} | {:7.3} | {:7.3} | {:.2e} |\n",
            row.view_deg,
            row.tracer,
            row.map,
            row.steps_mean,
            row.steps_p99,
            100.0 * row.skipped,
            100.0 * row.unconverged,
            row.error_texels,
        );
    }
    text
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
        assert!(timed.contains("|  gpu ms |") && timed.contains("|    5.00 |"));
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
