//! Rows as tables that are Markdown and read well on a terminal.

use super::cone_rows::{GeneratorRow, TracerRow};
use super::row::Row;
use super::steps::StepsRow;

/// The rows of one preset, compared with the first.
pub fn preset(rows: &[Row]) -> String {
    let Some(first) = rows.first() else {
        return String::new();
    };
    let [w, h] = first.size;
    let mut text = format!("\n### {}, {w} x {h}\n\n", first.preset);
    if let Some(warning) = &first.precision {
        text += &format!("Precision: {warning}.\n\n");
    }
    text += "| setting                              | evaluations per pixel | fewer |      ms | faster | behind % | holes % | behind 8 % | p99 footprints | unconverged % |   FLIP | start violations, coarse to fine |\n";
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

/// Settings that are both at least 5 % faster than `safe` and wrong on fewer pixels, preset
/// by preset. Settings of the hit rule ask for another picture and are left out.
pub fn better_than_safe(rows: &[Row]) -> String {
    let mut text = String::from(
        "\n### What beats `safe`\n\nSettings with at most 0.95 of its time and fewer wrong pixels.\n\n",
    );
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
    text += "| pass       |   cells | evaluations | iterations | p50 | p90 | p99 |  max |  sky % | unconverged % | waste 8 x 4 | waste 8 x 8 |      ms |\n";
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
            row.gpu_ms.unwrap_or(row.wall_ms),
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
    let mut text = format!("\n### Maps of {}, {w} x {h}\n\n", first.field);
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
    let mut text = format!("\n### Tracers over {}, {w} x {h}\n\n", first.field);
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
