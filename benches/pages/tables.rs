//! The measured tables of `docs/heightfields.md`.

use conemarch::command::bench::cone_rows::{ConesRow, GeneratorRow, TracerRow};

use crate::distances::DistanceRow;
use crate::frames::FrameRow;
use crate::markdown::table;
use crate::rows::{NodesRow, SizesRow, TimesRow};

/// Size at which tracers and nodes are shown field by field.
const SHOWN: u32 = 256;
/// Size at which all maps are done in time, for the mean.
pub const SMALL: u32 = 128;
/// Angles of view of `bench cones`, in degrees.
const VIEWS: [u32; 3] = [30, 60, 80];
/// Most nodes per place that a search of a rough field should take.
const MOST_NODES: f64 = 110.0;
/// `exact` should be at least so many times as fast as brute force.
const OVER_BRUTE: f64 = 50.0;
/// `exact` should take at most so many times as long as `improved`.
const OVER_IMPROVED: f64 = 4.0;
/// Expected steps of the walk over those of the maxima on `fbm`, view by view.
const WALKS: [f64; 3] = [0.65, 0.85, 1.05];
/// Allowed deviation from these.
const OFF: f64 = 0.15;

/// The tracers' rows at a size.
fn tracer_rows(rows: &[ConesRow], size: u32) -> Vec<&TracerRow> {
    let own = rows.iter().filter_map(|row| match row {
        ConesRow::Tracer(row) if row.over.size == [size; 2] => Some(row),
        _ => None,
    });
    own.collect()
}

/// Every pair of tracer and map.
fn pairs<'a>(rows: &[&'a TracerRow]) -> Vec<(&'a str, &'a str)> {
    once(rows.iter().map(|r| (r.tracer.as_str(), r.map.as_str())))
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

/// Figures of several views in one cell.
fn joined(all: impl IntoIterator<Item = String>) -> String {
    all.into_iter().collect::<Vec<_>>().join(" / ")
}

/// Cells of a row.
fn cells(all: impl IntoIterator<Item = String>) -> String {
    all.into_iter().collect::<Vec<_>>().join(" | ")
}

/// A share in per cent. Only 0 itself is shown as 0.
fn percent(share: f64) -> String {
    match 100.0 * share {
        0.0 => "0".into(),
        p if p < 0.01 => "< 0.01".into(),
        p if p < 10.0 => format!("{p:.2}"),
        p => format!("{p:.1}"),
    }
}

/// Texels. What rounding leaves is shown as 0.
fn texels(error: f64) -> String {
    if error < 1e-6 {
        "0".into()
    } else {
        format!("{error:.3}")
    }
}

/// Milliseconds with at least two digits.
fn ms(time: f64) -> String {
    if time < 10.0 {
        format!("{time:.1}")
    } else {
        format!("{time:.0}")
    }
}

/// The mark of an estimate.
fn tilde(estimated: bool) -> &'static str {
    if estimated { "~" } else { "" }
}

/// Tracers in the mean of the fields at a size.
pub fn means(rows: &[ConesRow], size: u32) -> String {
    let rows = tracer_rows(rows, size);
    let fields = once(rows.iter().map(|r| r.over.field.as_str()));
    let body = pairs(&rows).into_iter().map(|(tracer, map)| {
        let of_view = |view| {
            let key = (tracer, map, view);
            rows.iter()
                .filter(move |r| (&*r.tracer, &*r.map, r.view_deg) == key)
        };
        let mean = |figure: fn(&TracerRow) -> f64| {
            VIEWS.map(|view| {
                let sum: f64 = of_view(view).map(|r| figure(r)).sum();
                sum / of_view(view).count().max(1) as f64
            })
        };
        // The tracers of a map that was not done in time have no rows.
        let note = match of_view(VIEWS[0]).count() {
            n if n < fields.len() => format!(" ({n} of {})", fields.len()),
            _ => String::new(),
        };
        let steps = cells(mean(|r| r.stats.steps_mean).map(|steps| format!("{steps:.1}")));
        let skipped = joined(mean(|r| r.stats.skipped).map(percent));
        let unconverged = joined(mean(|r| r.stats.unconverged).map(percent));
        format!("{tracer} | {map}{note} | {steps} | {skipped} | {unconverged}")
    });
    let head = "tracer | map | steps at 30 | at 60 | at 80 | skipped % | unconverged %";
    let (table, fields) = (table(head, "llr", body), fields.join(", "));
    format!("### In the mean of {fields}, {size} x {size}\n\n{table}\n")
}

/// Tracers, first in the mean of the fields, then field by field.
pub fn tracers(rows: &[ConesRow]) -> String {
    let mut text = means(rows, SMALL) + &means(rows, SHOWN);
    let rows = tracer_rows(rows, SHOWN);
    let head = "tracer | map | steps at 30, mean / p99 | at 60 | at 80 | skipped % | unconverged % | error, texels";
    for field in once(rows.iter().map(|r| r.over.field.as_str())) {
        let own: Vec<&TracerRow> = rows
            .iter()
            .copied()
            .filter(|r| r.over.field == field)
            .collect();
        let body = pairs(&own).into_iter().map(|(tracer, map)| {
            let is = |r: &&&TracerRow| (&*r.tracer, &*r.map) == (tracer, map);
            let of = |show: fn(&TracerRow) -> String| own.iter().filter(is).map(move |r| show(r));
            let steps = cells(of(|r| {
                format!("{:.1} / {}", r.stats.steps_mean, r.stats.steps_p99)
            }));
            let skipped = joined(of(|r| percent(r.stats.skipped)));
            let unconverged = joined(of(|r| percent(r.stats.unconverged)));
            let error = joined(of(|r| texels(r.stats.error_texels)));
            format!("{tracer} | {map} | {steps} | {skipped} | {unconverged} | {error}")
        });
        let table = table(head, "llr", body);
        text += &format!("\n### {field}, {SHOWN} x {SHOWN}\n\n{table}");
    }
    text
}

/// Generators over the fields, size by size.
pub fn generators(rows: &[ConesRow]) -> String {
    let own = rows.iter().filter_map(|row| match row {
        ConesRow::Generator(row) => Some(row),
        ConesRow::Tracer(_) => None,
    });
    let rows: Vec<&GeneratorRow> = own.collect();
    let fields = once(rows.iter().map(|r| r.over.field.as_str()));
    let names = once(rows.iter().map(|r| r.generator.as_str()));
    let head = format!("generator | {}", fields.join(" | "));
    let mut text = String::new();
    for size in once(rows.iter().map(|r| r.over.size)) {
        let body = names.iter().map(|name| {
            let figures = fields.iter().map(|field| {
                let key = (size, *field, *name);
                let mut all = rows.iter();
                let own = all.find(|r| (r.over.size, &*r.over.field, &*r.generator) == key);
                own.map_or("n/a".into(), |r| generator(r))
            });
            format!("{name} | {}", cells(figures))
        });
        let [w, h] = size;
        text += &format!("### {w} x {h}\n\n{}\n", table(&head, "lr", body));
    }
    text
}

/// Time, mean ratio, that over the exact mean, and the share of wider cones, as far as there
/// are any.
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
    joined(std::iter::once(time).chain(rest.into_iter().flatten()))
}

fn nodes_of<'a>(rows: &'a [NodesRow], key: (&str, &str, u32)) -> Option<&'a NodesRow> {
    rows.iter()
        .find(|r| (&*r.generator, &*r.field, r.size) == key)
}

/// Nodes per place: of `exact` by size, of the other searches at one size.
pub fn nodes(rows: &[NodesRow]) -> String {
    let mut columns = Vec::new();
    let mut head = String::from("field");
    for size in once(rows.iter().map(|r| r.size)) {
        let name = if columns.is_empty() { "exact, " } else { "" };
        head += &format!(" | {name}{size} x {size}");
        columns.push(("exact", size));
    }
    let searches = once(rows.iter().map(|r| r.generator.as_str()));
    for other in searches.into_iter().filter(|g| *g != "exact") {
        head += &format!(" | {other}, {SHOWN} x {SHOWN}");
        columns.push((other, SHOWN));
    }
    let fields = once(rows.iter().map(|r| r.field.as_str()));
    let body = fields.into_iter().map(|field| {
        let counts = columns.iter().map(|(generator, size)| {
            let own = nodes_of(rows, (*generator, field, *size));
            own.map_or("n/a".into(), |r| format!("{:.1} ({})", r.mean, r.worst))
        });
        format!("{field} | {}", cells(counts))
    });
    table(&head, "lr", body)
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
    let head = "generator | device, ms | of `exact` | dispatches alone, ms | settled on the CPU % | CPU in f64, ms";
    let body = rows.iter().map(|row| {
        // How long the dispatches of an abandoned map take is unknown.
        let dispatches = if row.estimated {
            "n/a".into()
        } else {
            ms(row.dispatches_ms)
        };
        format!(
            "{} | {own}{} | {own}{:.2} | {dispatches} | {} | {}{}",
            row.generator,
            ms(row.ms),
            over(rows, &row.generator, "exact"),
            percent(row.settled),
            tilde(row.cpu_estimated),
            ms(row.cpu_ms),
            own = tilde(row.estimated),
        )
    });
    format!("`fbm`, {size} x {size}:\n\n{}", table(head, "lr", body))
}

/// The largest map, in a sentence each.
pub fn large(rows: &[TimesRow]) -> String {
    let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
    let about = |estimated| if estimated { "about " } else { "" };
    let one = |row: &TimesRow| {
        let peak = row.peak.map_or(String::new(), |bytes| {
            format!(" The process used at most {:.0} MiB of memory.", mib(bytes))
        });
        format!(
            "\n`{}` takes {}{:.1} s on the device and {}{:.1} s on the CPU for {size} x {size} heights. Its largest buffer has {:.1} MiB.{peak}\n",
            row.generator,
            about(row.estimated),
            row.ms / 1e3,
            about(row.cpu_estimated),
            row.cpu_ms / 1e3,
            mib(row.largest_binding),
            size = row.size,
        )
    };
    rows.iter().map(one).collect()
}

/// Aims, and what was measured.
pub fn aims(cones: &[ConesRow], nodes: &[NodesRow], times: &[TimesRow]) -> String {
    let mut body = Vec::new();
    let mut aim = |aim: String, measured: String, reached: bool| {
        let word = if reached { "reached" } else { "**missed**" };
        body.push(format!("{aim} | {measured} | {word}"));
    };
    let rough = ["fbm", "ridges", "noise", "spikes"];
    let rough = rough.map(|field| {
        let own = nodes_of(nodes, ("exact", field, SHOWN));
        (field, own.map_or(f64::NAN, |r| r.mean))
    });
    aim(
        format!("at most {MOST_NODES} nodes per texel of rough fields, {SHOWN} x {SHOWN}"),
        rough.map(|(field, n)| format!("{field} {n:.1}")).join(", "),
        rough.iter().all(|(_, n)| *n <= MOST_NODES),
    );
    let size = times.first().map_or(0, |r| r.size);
    let cpu = |generator| time_of(times, generator).map_or(f64::NAN, |r| r.cpu_ms);
    let estimated = time_of(times, "brute").is_some_and(|r| r.estimated);
    let about = if estimated { "about " } else { "" };
    let (brute, on_cpu) = (over(times, "brute", "exact"), cpu("brute") / cpu("exact"));
    aim(
        format!(
            "`exact` at least {OVER_BRUTE} times as fast as brute force on one device, {size} x {size}"
        ),
        format!("{about}{brute:.0} times on this device, {on_cpu:.1} on the CPU"),
        brute >= OVER_BRUTE,
    );
    let improved = over(times, "exact", "improved");
    aim(
        format!("and at most {OVER_IMPROVED} times as long as `improved`"),
        format!("{improved:.1} times"),
        improved <= OVER_IMPROVED,
    );
    let tracers = tracer_rows(cones, SHOWN);
    for field in once(tracers.iter().map(|r| r.over.field.as_str())) {
        let ratios = VIEWS.map(|view| {
            let steps = |tracer| {
                let is = |r: &&&TracerRow| {
                    (&*r.over.field, &*r.tracer, r.view_deg) == (field, tracer, view)
                };
                tracers
                    .iter()
                    .find(is)
                    .map_or(f64::NAN, |r| r.stats.steps_mean)
            };
            steps("walk") / steps("max-mip")
        });
        let [a, b, c] = ratios;
        aim(
            format!("`walk` takes no more steps than `max-mip` at 30 and 60 degrees: {field}"),
            format!("{a:.2}, {b:.2} (and {c:.2} at 80) of its steps"),
            a <= 1.0 && b <= 1.0,
        );
        if field == "fbm" {
            let ([x, y, z], off) = (WALKS, 100.0 * OFF);
            let near = |(own, aim): (f64, f64)| (own / aim - 1.0).abs() <= OFF;
            aim(
                format!(
                    "within {off:.0} % of {x}, {y}, {z} of its steps at 30, 60, 80 degrees: fbm"
                ),
                format!("{a:.2}, {b:.2}, {c:.2}"),
                ratios.into_iter().zip(WALKS).all(near),
            );
        }
    }
    table("aim | measured | result", "l", body)
}

/// Whole frames by cone map.
pub fn frames(rows: &[FrameRow]) -> String {
    let mut head = String::from("in the paper | tracer | map");
    for n in once(rows.iter().map(|r| r.steps)) {
        head += &format!(" | {n} steps: ms | of the first | skipped % | unconverged %");
    }
    let kind = |r: &FrameRow| format!("{} | {} | {}", r.paper, r.tracer, r.map);
    let body = once(rows.iter().map(kind)).into_iter().map(|own| {
        let figures = rows.iter().filter(|r| kind(r) == own).map(|row| {
            let [skipped, unconverged] = [row.skipped, row.unconverged].map(percent);
            format!(
                "{} | {:.2} | {skipped} | {unconverged}",
                ms(row.ms),
                row.of_first
            )
        });
        format!("{own} | {}", cells(figures))
    });
    table(&head, "lllr", body)
}

/// Times of maps on the device, size by size.
pub fn sizes(rows: &[SizesRow]) -> String {
    let names = once(rows.iter().map(|r| r.generator.as_str()));
    let body = once(rows.iter().map(|r| r.size)).into_iter().map(|size| {
        let times = names.iter().map(|name| {
            let own = rows
                .iter()
                .find(|r| (r.size, &*r.generator) == (size, *name));
            own.map_or("n/a".into(), |r| {
                format!("{}{}", tilde(r.estimated), ms(r.ms))
            })
        });
        format!("{size} x {size} | {}", cells(times))
    });
    table(&format!("size | {}", names.join(" | ")), "lr", body)
}

/// The tracers for distant views beside the walk.
pub fn distances(rows: &[DistanceRow]) -> String {
    let head = "samples | texels to a pixel | tracer | steps, rays alone | after cones | time of `walk`'s | skipped % | in one only % | apart, pixels: median | 95 %";
    let body = rows.iter().map(|row| {
        format!(
            "{n} x {n} | {:.1} | {} | {:.1} | {:.1} | {:.2} | {} | {} | {:.2} | {:.2}",
            row.texels,
            row.tracer,
            row.alone,
            row.after_cones,
            row.of_walk,
            percent(row.skipped),
            percent(row.in_one),
            row.apart[0],
            row.apart[1],
            n = row.samples,
        )
    });
    table(head, "lrlr", body)
}
