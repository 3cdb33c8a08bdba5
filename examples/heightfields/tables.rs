//! The measured tables of the page.

use conemarch::command::bench::cone_rows::{GeneratorRow, TracerRow};
use serde::Deserialize;

use crate::distances::DistanceRow;
use crate::frames::FrameRow;
use crate::rows::{NodesRow, SizesRow, TimesRow};

/// A row of `bench cones`, of either kind.
#[derive(Deserialize)]
#[serde(untagged)]
pub enum ConesRow {
    /// A map of a field.
    Generator(GeneratorRow),
    /// A tracer over a view of a field.
    Tracer(TracerRow),
}

/// Size at which tracers are shown field by field, and nodes; and another at which all
/// maps are done in time, for the mean.
const SHOWN: u32 = 256;
pub const SMALL: u32 = 128;
/// Angles of view of `bench cones`, in degrees.
const VIEWS: [u32; 3] = [30, 60, 80];
/// Most nodes per place that a search of a rough field should take.
const MOST_NODES: f64 = 110.0;
/// Least times that exact maps should be made faster than by brute force, and most that
/// they may take of an improved one's time.
const OVER_BRUTE: f64 = 50.0;
const OVER_IMPROVED: f64 = 4.0;
/// Steps of the walk over those of the maxima that were expected on `fbm`, view by view,
/// and how far off they may be.
const WALKS: [f64; 3] = [0.65, 0.85, 1.05];
const OFF: f64 = 0.15;

fn generator_rows(rows: &[ConesRow]) -> Vec<&GeneratorRow> {
    let own = rows.iter().filter_map(|row| match row {
        ConesRow::Generator(row) => Some(row),
        ConesRow::Tracer(_) => None,
    });
    own.collect()
}

/// The tracers' rows at a size.
fn tracer_rows(rows: &[ConesRow], size: u32) -> Vec<&TracerRow> {
    let own = rows.iter().filter_map(|row| match row {
        ConesRow::Tracer(row) if row.size == [size; 2] => Some(row),
        _ => None,
    });
    own.collect()
}

/// Values without repetitions, in the order in which they come.
fn once<T: PartialEq>(all: impl Iterator<Item = T>) -> Vec<T> {
    let mut kept = Vec::new();
    for one in all {
        if !kept.contains(&one) {
            kept.push(one);
        }
    }
    kept
}

/// A share as per cent: 0 is none at all.
fn percent(share: f64) -> String {
    match 100.0 * share {
        0.0 => "0".into(),
        p if p < 0.01 => "< 0.01".into(),
        p if p < 10.0 => format!("{p:.2}"),
        p => format!("{p:.1}"),
    }
}

/// Texels: 0 is what rounding leaves.
fn texels(error: f64) -> String {
    if error < 1e-6 {
        "0".into()
    } else {
        format!("{error:.3}")
    }
}

/// Milliseconds: two digits at least.
fn ms(time: f64) -> String {
    if time < 10.0 {
        format!("{time:.1}")
    } else {
        format!("{time:.0}")
    }
}

fn joined(views: &[&TracerRow], show: impl Fn(&TracerRow) -> String) -> String {
    let all: Vec<String> = views.iter().map(|row| show(row)).collect();
    all.join(" / ")
}

/// Tracers in the mean of the fields at a size.
pub fn means(rows: &[ConesRow], size: u32) -> String {
    let rows = tracer_rows(rows, size);
    let pairs = once(rows.iter().map(|r| (r.tracer.as_str(), r.map.as_str())));
    let fields = once(rows.iter().map(|r| r.field.as_str()));
    let mut text = format!(
        "### In the mean of {}, {size} x {size}\n\n",
        fields.join(", ")
    );
    text += "| tracer | map | steps at 30 | at 60 | at 80 | skipped % | unconverged % |\n";
    text += "|:--|:--|--:|--:|--:|--:|--:|\n";
    for (tracer, map) in &pairs {
        let mean = |figure: fn(&TracerRow) -> f64| {
            VIEWS.map(|view| {
                let own = rows.iter().filter(|r| {
                    (r.tracer.as_str(), r.map.as_str(), r.view_deg) == (*tracer, *map, view)
                });
                let all: Vec<f64> = own.map(|r| figure(r)).collect();
                all.iter().sum::<f64>() / all.len().max(1) as f64
            })
        };
        // A map that was not done in time leaves its tracers without a row.
        let own = rows.iter().filter(|r| {
            (r.tracer.as_str(), r.map.as_str(), r.view_deg) == (*tracer, *map, VIEWS[0])
        });
        let note = match own.count() {
            n if n < fields.len() => format!(" ({n} of {})", fields.len()),
            _ => String::new(),
        };
        let [a, b, c] = mean(|r| r.steps_mean);
        let skipped = mean(|r| r.skipped).map(percent).join(" / ");
        let unconverged = mean(|r| r.unconverged).map(percent).join(" / ");
        text += &format!(
            "| {tracer} | {map}{note} | {a:.1} | {b:.1} | {c:.1} | {skipped} | {unconverged} |\n"
        );
    }
    text + "\n"
}

/// Tracers over the fields, first in the mean.
pub fn tracers(rows: &[ConesRow]) -> String {
    let mut text = means(rows, SMALL) + &means(rows, SHOWN);
    let rows = tracer_rows(rows, SHOWN);
    let pairs = once(rows.iter().map(|r| (r.tracer.as_str(), r.map.as_str())));
    let fields = once(rows.iter().map(|r| r.field.as_str()));
    for field in fields {
        text += &format!("\n### {field}, {SHOWN} x {SHOWN}\n\n");
        text += "| tracer | map | steps at 30, mean / p99 | at 60 | at 80 | skipped % | unconverged % | error, texels |\n";
        text += "|:--|:--|--:|--:|--:|--:|--:|--:|\n";
        for (tracer, map) in &pairs {
            let own = rows.iter().filter(|r| {
                (r.field.as_str(), r.tracer.as_str(), r.map.as_str()) == (field, *tracer, *map)
            });
            let views: Vec<&TracerRow> = own.copied().collect();
            if views.is_empty() {
                continue;
            }
            let steps: Vec<String> = views
                .iter()
                .map(|r| format!("{:.1} / {}", r.steps_mean, r.steps_p99))
                .collect();
            text += &format!(
                "| {tracer} | {map} | {} | {} | {} | {} |\n",
                steps.join(" | "),
                joined(&views, |r| percent(r.skipped)),
                joined(&views, |r| percent(r.unconverged)),
                joined(&views, |r| texels(r.error_texels)),
            );
        }
    }
    text
}

/// Generators over the fields, size by size.
pub fn generators(rows: &[ConesRow]) -> String {
    let rows = generator_rows(rows);
    let fields = once(rows.iter().map(|r| r.field.as_str()));
    let names = once(rows.iter().map(|r| r.generator.as_str()));
    let mut text = String::new();
    for size in once(rows.iter().map(|r| r.size)) {
        let [w, h] = size;
        text += &format!("### {w} x {h}\n\n| generator | {} |\n", fields.join(" | "));
        text += &format!("|:--|{}\n", "--:|".repeat(fields.len()));
        for name in &names {
            let cell = |field: &&str| {
                let own = rows.iter().find(|r| {
                    (r.size, r.field.as_str(), r.generator.as_str()) == (size, *field, *name)
                });
                own.map_or("n/a".into(), |r| generator(r))
            };
            let cells: Vec<String> = fields.iter().map(cell).collect();
            text += &format!("| {name} | {} |\n", cells.join(" | "));
        }
        text.push('\n');
    }
    text
}

/// Time, mean ratio, share of the exact mean, share of wider cones; as far as there are any.
fn generator(row: &GeneratorRow) -> String {
    let time = match (row.ms, row.estimate_ms) {
        (Some(own), _) => ms(own),
        (None, Some(estimate)) => format!("~{}", ms(estimate)),
        (None, None) => "n/a".into(),
    };
    let rest = [
        row.mean_ratio.map(|r| format!("{r:.4}")),
        row.of_exact.map(|r| format!("{r:.3}")),
        row.wider_than_exact.map(percent),
    ];
    let all = std::iter::once(time).chain(rest.into_iter().flatten());
    all.collect::<Vec<_>>().join(" / ")
}

/// Nodes per place: of `exact` by size, of the other searches at one size.
pub fn nodes(rows: &[NodesRow]) -> String {
    let fields = once(rows.iter().map(|r| r.field.as_str()));
    let sizes = once(rows.iter().map(|r| r.size));
    let cell = |generator: &str, field: &str, size: u32| {
        let own = rows
            .iter()
            .find(|r| (r.generator.as_str(), r.field.as_str(), r.size) == (generator, field, size));
        own.map_or("n/a".into(), |r| format!("{:.1} ({})", r.mean, r.worst))
    };
    let heads: Vec<String> = sizes.iter().map(|n| format!("{n} x {n}")).collect();
    let mut text = format!("| field | exact, {} |", heads.join(" | "));
    let others = once(rows.iter().map(|r| r.generator.as_str()));
    let others: Vec<&str> = others.into_iter().filter(|g| *g != "exact").collect();
    for other in &others {
        text += &format!(" {other}, {SHOWN} x {SHOWN} |");
    }
    text += &format!("\n|:--|{}\n", "--:|".repeat(sizes.len() + others.len()));
    for field in fields {
        let exact = sizes.iter().map(|size| cell("exact", field, *size));
        let rest = others.iter().map(|g| cell(g, field, SHOWN));
        let cells: Vec<String> = exact.chain(rest).collect();
        text += &format!("| {field} | {} |\n", cells.join(" | "));
    }
    text
}

fn time_of<'a>(rows: &'a [TimesRow], generator: &str) -> Option<&'a TimesRow> {
    rows.iter().find(|r| r.generator == generator)
}

/// The device's time of one generator over that of another.
fn over(rows: &[TimesRow], one: &str, other: &str) -> f64 {
    let [one, other] = [one, other].map(|g| time_of(rows, g).map_or(f64::NAN, |r| r.ms));
    one / other
}

/// Times of maps of one size.
pub fn times(rows: &[TimesRow]) -> String {
    let size = rows.first().map_or(0, |r| r.size);
    let mut text = format!("`fbm`, {size} x {size}:\n\n");
    text += "| generator | device, ms | of `exact` | dispatches alone, ms | settled on the CPU % | CPU in f64, ms |\n";
    text += "|:--|--:|--:|--:|--:|--:|\n";
    for row in rows {
        let tilde = |is: bool| if is { "~" } else { "" };
        let (own, cpu) = (tilde(row.estimated), tilde(row.cpu_estimated));
        text += &format!(
            "| {} | {own}{} | {own}{:.2} | {} | {} | {cpu}{} |\n",
            row.generator,
            ms(row.ms),
            over(rows, &row.generator, "exact"),
            // Of a map that was given up nobody knows how long they take.
            if row.estimated {
                "n/a".into()
            } else {
                ms(row.dispatches_ms)
            },
            percent(row.settled),
            ms(row.cpu_ms)
        );
    }
    text
}

/// The largest map, in a sentence each.
pub fn large(rows: &[TimesRow]) -> String {
    let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
    let one = |row: &TimesRow| {
        let peak = row.peak.map_or(String::new(), |bytes| {
            format!(" The process had at most {:.0} MiB of memory.", mib(bytes))
        });
        format!(
            "\n`{}` at {size} x {size}: {}{:.1} s on the device, {}{:.1} s on the CPU. The largest buffer that is bound has {:.1} MiB.{peak}\n",
            row.generator,
            if row.estimated { "about " } else { "" },
            row.ms / 1e3,
            if row.cpu_estimated { "about " } else { "" },
            row.cpu_ms / 1e3,
            mib(row.largest_binding),
            size = row.size,
        )
    };
    rows.iter().map(one).collect()
}

/// What was aimed at, and what was measured.
pub fn aims(cones: &[ConesRow], nodes: &[NodesRow], times: &[TimesRow]) -> String {
    let mut text = String::from("| aim | measured | |\n|:--|:--|:--|\n");
    let mut row = |aim: &str, measured: &str, reached: bool| {
        let word = if reached { "reached" } else { "**missed**" };
        text += &format!("| {aim} | {measured} | {word} |\n");
    };
    let rough = ["fbm", "ridges", "noise", "spikes"].map(|field| {
        let own = nodes
            .iter()
            .find(|r| (r.generator.as_str(), r.field.as_str(), r.size) == ("exact", field, SHOWN));
        (field, own.map_or(f64::NAN, |r| r.mean))
    });
    let told: Vec<String> = rough.iter().map(|(f, n)| format!("{f} {n:.1}")).collect();
    row(
        &format!("at most {MOST_NODES} nodes per texel of rough fields, {SHOWN} x {SHOWN}"),
        &told.join(", "),
        rough.iter().all(|(_, n)| *n <= MOST_NODES),
    );
    let size = times.first().map_or(0, |r| r.size);
    let cpu = |generator: &str| time_of(times, generator).map_or(f64::NAN, |r| r.cpu_ms);
    let brute = over(times, "brute", "exact");
    row(
        &format!(
            "`exact` at least {OVER_BRUTE} times as fast as brute force on one device, {size} x {size}"
        ),
        &format!(
            "{}{brute:.0} times on this device, {:.1} on the CPU",
            if time_of(times, "brute").is_some_and(|r| r.estimated) {
                "about "
            } else {
                ""
            },
            cpu("brute") / cpu("exact")
        ),
        brute >= OVER_BRUTE,
    );
    let improved = over(times, "exact", "improved");
    row(
        &format!("and at most {OVER_IMPROVED} times as long as `improved`"),
        &format!("{improved:.1} times"),
        improved <= OVER_IMPROVED,
    );
    let tracers = tracer_rows(cones, SHOWN);
    let steps = |field: &str, tracer: &str, view: u32| {
        let own = tracers
            .iter()
            .find(|r| (r.field.as_str(), r.tracer.as_str(), r.view_deg) == (field, tracer, view));
        own.map_or(f64::NAN, |r| r.steps_mean)
    };
    for field in once(tracers.iter().map(|r| r.field.as_str())) {
        let ratios = VIEWS.map(|view| steps(field, "walk", view) / steps(field, "max-mip", view));
        let [a, b, c] = ratios;
        row(
            &format!("`walk` takes no more steps than `max-mip` at 30 and 60 degrees: {field}"),
            &format!("{a:.2}, {b:.2} (and {c:.2} at 80) of its steps"),
            a <= 1.0 && b <= 1.0,
        );
        if field == "fbm" {
            let [x, y, z] = WALKS;
            row(
                &format!(
                    "within {:.0} % of {x}, {y}, {z} of its steps at 30, 60, 80 degrees: fbm",
                    100.0 * OFF
                ),
                &format!("{a:.2}, {b:.2}, {c:.2}"),
                ratios
                    .iter()
                    .zip(WALKS)
                    .all(|(own, aim)| (own / aim - 1.0).abs() <= OFF),
            );
        }
    }
    text
}

/// Whole frames by the map that is stepped with.
pub fn frames(rows: &[FrameRow]) -> String {
    let steps = once(rows.iter().map(|r| r.steps));
    let kinds = once(rows.iter().map(|r| (&r.paper, &r.tracer, &r.map)));
    let mut text = String::from("| in the paper | tracer | map |");
    for n in &steps {
        text += &format!(" {n} steps: ms | of the first | skipped % | unconverged % |");
    }
    text += &format!(
        "\n|:--|:--|:--|{}\n",
        "--:|--:|--:|--:|".repeat(steps.len())
    );
    for kind in kinds {
        text += &format!("| {} | {} | {} |", kind.0, kind.1, kind.2);
        for row in rows
            .iter()
            .filter(|r| (&r.paper, &r.tracer, &r.map) == kind)
        {
            text += &format!(
                " {} | {:.2} | {} | {} |",
                ms(row.ms),
                row.of_first,
                percent(row.skipped),
                percent(row.unconverged)
            );
        }
        text.push('\n');
    }
    text
}

/// Times of maps on the device, size by size.
pub fn sizes(rows: &[SizesRow]) -> String {
    let names = once(rows.iter().map(|r| r.generator.as_str()));
    let mut text = format!("| size | {} |\n", names.join(" | "));
    text += &format!("|:--|{}\n", "--:|".repeat(names.len()));
    for size in once(rows.iter().map(|r| r.size)) {
        let cell = |name: &&str| {
            let mut own = rows
                .iter()
                .filter(|r| r.size == size && r.generator == *name);
            own.next().map_or("n/a".into(), |r| {
                format!("{}{}", if r.estimated { "~" } else { "" }, ms(r.ms))
            })
        };
        let cells: Vec<String> = names.iter().map(cell).collect();
        text += &format!("| {size} x {size} | {} |\n", cells.join(" | "));
    }
    text
}

/// The walks for distant views beside the walk.
pub fn distances(rows: &[DistanceRow]) -> String {
    let mut text = String::from(
        "| samples | texels to a pixel | tracer | steps, rays alone | after cones | time of `walk`'s | skipped % | in one only % | apart, pixels: median | 95 % |\n|:--|--:|:--|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    for row in rows {
        let [half, most] = row.apart;
        text += &format!(
            "| {n} x {n} | {:.1} | {} | {:.1} | {:.1} | {:.2} | {} | {} | {half:.2} | {most:.2} |\n",
            row.texels,
            row.tracer,
            row.alone,
            row.after_cones,
            row.of_walk,
            percent(row.skipped),
            percent(row.in_one),
            n = row.samples,
        );
    }
    text
}
