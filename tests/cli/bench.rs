//! The measurements: fields, files and figures.

use std::collections::BTreeSet;

use conemarch::heightfield::conemap::generate::Generator;
use conemarch::heightfield::tracer::{Accuracy, TracerKind};
use serde_json::Value;

use crate::folder::{Folder, holds, output, said, text};
use crate::tools::{json, names, number};

/// Runs a measurement that takes no time, with a cache in the folder. Returns what it
/// printed and what it said on standard error.
fn bench(folder: &Folder, args: &str) -> (String, String) {
    let args = match args.starts_with("cones") {
        true => format!("bench {args}"),
        false => format!("bench {args} --device cpu --size 40x24"),
    };
    let mut command = folder.command(&args);
    let output = output(command.env("XDG_CACHE_HOME", folder.0.join("cache")));
    assert_eq!(output.status.code(), Some(0), "{args}: {}", said(&output));
    (text(&output), said(&output))
}

fn rows(folder: &Folder, name: &str) -> Vec<Value> {
    json(&folder.bytes(name)).as_array().expect("rows").clone()
}

fn word<'a>(row: &'a Value, field: &str) -> &'a str {
    row[field].as_str().expect(field)
}

/// The names of a CSV file, and the first cell of each row. Rows of unequal length are an
/// error of the reader.
fn csv_of(bytes: &[u8]) -> (Vec<String>, Vec<String>) {
    let mut csv = csv::Reader::from_reader(bytes);
    let header = csv.headers().unwrap().iter().map(str::to_string).collect();
    let first = csv.records().map(|row| row.unwrap()[0].to_string());
    (header, first.collect())
}

/// Writes a built-in preset with cones, which such small pictures have only if they are asked for,
/// and a thick shell, with which no pixel of them is a hole.
fn with_cones(folder: &Folder, name: &str) {
    let preset = text(&folder.done(&format!("presets {name}")));
    let lines = preset
        .lines()
        .filter(|line| !line.starts_with("coarsest") && !line.starts_with("shell"));
    let preset: String = lines.map(|line| format!("{line}\n")).collect();
    let preset = match preset.contains("[march]") {
        true => preset.replace("[march]", "[march]\ncoarsest = 16\nshell = 0.45"),
        false => preset + "\n[march]\ncoarsest = 16\nshell = 0.45\n",
    };
    folder.write(&format!("{name}.toml"), preset);
}

#[test]
fn error_rows_files_and_the_cache() {
    // The fields that the contract of the command line names, in its order.
    const FIELDS: &str = "preset mode parameters baseline size device wall_ms gpu_ms evaluations_per_pixel iterations_per_pixel depth_error behind front behind8 front8 holes false_hits start_violations unconverged flip before_set wrong_of_set starts_beyond_set";
    let folder = Folder::new();
    with_cones(&folder, "bench-far");
    with_cones(&folder, "mandelbox");
    let args = "error bench-far.toml mandelbox.toml --json a.json --csv a.csv --plot a.svg";
    let (table, told) = bench(&folder, args);
    assert!(!told.contains("kept from before"), "{told}");
    let titles = ["### bench-far, 40 x 24", "### mandelbox, 40 x 24"];
    holds(&table, &titles);
    holds(&table, &["| slides-fast", "FLIP"]);
    let first = rows(&folder, "a.json");
    let modes: Vec<&str> = first.iter().map(|r| word(r, "mode")).collect();
    let of_one = "ray-relaxed safe proven ray ray-relaxed calibrated slides-even slides-deep slides-fast ray-relaxed";
    assert_eq!(modes.join(" "), format!("{of_one} {of_one}"));
    for row in &first {
        assert!(names(row).join(" ").starts_with(FIELDS), "{row}");
        assert_eq!(row["baseline"], true);
        assert_eq!(names(&row["depth_error"]), ["median", "p95", "p99", "max"]);
        let levels = row["start_violations"].as_array().unwrap().len();
        let marched = !word(row, "mode").starts_with("ray");
        assert_eq!(levels, if marched { 4 } else { 0 });
    }
    // The same executor renders the truth: what is not exact differs from it.
    let safe = &first[1];
    assert_eq!(first[0]["parameters"]["clip"], "on");
    assert_eq!(first[9]["parameters"]["estimate"], "scalar");
    holds(&table, &["| rival ", "| old rival "]);
    let before = &safe["before_set"];
    assert!(
        number(before, "median") > 0.0 && number(before, "p95") < 5.0,
        "{before}"
    );
    assert_eq!(safe["holes"], 0.0);
    assert!(number(&safe["depth_error"], "median") < 1.0);
    assert!(number(&first[6], "behind") > number(safe, "behind"));
    let (header, records) = csv_of(&folder.bytes("a.csv"));
    assert_eq!(header[0], "preset");
    assert!(header.iter().any(|h| h == "depth_error_p99"));
    assert_eq!(records.len(), first.len());
    let plot = String::from_utf8(folder.bytes("a.svg")).expect("text");
    holds(&plot, &[">bench-far<", ">mandelbox<"]);

    // Again: the truth of either estimate is kept, and everything but time is the same.
    let (_, told) = bench(&folder, args);
    assert_eq!(told.matches("kept from before").count(), 4, "{told}");
    let timeless = |mut rows: Vec<Value>| {
        for row in &mut rows {
            row.as_object_mut().unwrap().remove("wall_ms");
        }
        rows
    };
    assert_eq!(timeless(first), timeless(rows(&folder, "a.json")));
    // A preset of the same name that asks for something else has a truth of its own.
    let preset = text(&folder.done("presets bench-far")).replace("-14", "-13");
    folder.write("bench-far.toml", preset);
    let (_, told) = bench(&folder, "error bench-far.toml");
    assert!(!told.contains("kept from before"), "{told}");
}

#[test]
fn sweeps_follow_the_baselines() {
    let folder = Folder::new();
    bench(&folder, "error bench-thin --sweep --json s.json");
    let all = rows(&folder, "s.json");
    let base = all.iter().filter(|r| r["baseline"] == true).count();
    assert!(all[..base].iter().all(|r| r["baseline"] == true));
    for key in "coarsest shell fudge steps relaxation detail".split(' ') {
        let swept = all[base..].iter();
        let swept = swept.filter(|r| !r["parameters"][key].is_null());
        assert!(swept.count() >= 2, "{key}");
    }
    // Sixteen steps do not take every ray to the surface, and none of them is a hit.
    let few = all.iter().find(|r| r["parameters"]["steps"] == 16).unwrap();
    assert!(number(few, "unconverged") > 0.0);
}

#[test]
fn steps_are_counted_and_drawn() {
    let folder = Folder::new();
    with_cones(&folder, "bench-thin");
    let args = "steps bench-thin.toml --mode safe --json s.json --csv s.csv --heat h";
    let (table, _) = bench(&folder, args);
    assert!(table.contains("| march 1/16"), "{table}");
    let all = rows(&folder, "s.json");
    let passes: Vec<&str> = all.iter().map(|r| word(r, "pass")).collect();
    let promised = ["march 1/16", "march 1/8", "march 1/4", "march 1/2", "trace"];
    assert_eq!(passes, promised);
    for row in &all {
        let histogram = row["histogram"].as_array().unwrap().iter();
        let sum: u64 = histogram.filter_map(Value::as_u64).sum();
        assert_eq!(sum, row["cells"]);
        let quantiles = ["p50", "p90", "p99", "max"].map(|q| number(row, q));
        assert!(quantiles.is_sorted(), "{row}");
        assert!(number(row, "waste_8x4") >= number(row, "waste_8x1"));
    }
    assert_eq!(all[4]["cells"], 40 * 24);
    assert_eq!(csv_of(&folder.bytes("s.csv")).1.len(), all.len());
    // The sums are those of a counted render.
    let render = "render bench-thin.toml --device cpu --size 40x24 -o x.png --layer steps";
    folder.done(&format!("{render} --stats x.json"));
    let stats = json(&folder.bytes("x.json"));
    for (row, pass) in all.iter().zip(stats["passes"].as_array().unwrap()) {
        assert_eq!(row["evaluations"], pass["evaluations"]);
        assert_eq!(row["iterations"], pass["iterations"]);
    }
    // The heat map is a picture that carries its preset.
    folder.done("render h/bench-thin-safe.png --explain");
}

#[test]
fn calibration_proposes_a_preset_that_keeps_its_budget() {
    let folder = Folder::new();
    with_cones(&folder, "bench-far");
    let args = "calibrate bench-far.toml --rays 500 --budget 0.02 --json c.json";
    let (table, _) = bench(&folder, args);
    assert!(table.contains("mode = \"calibrated\""), "{table}");
    let row = &rows(&folder, "c.json")[0];
    assert_eq!(row["within"], true);
    assert!(number(row, "lost") <= 0.02);
    assert_eq!(row["fudge"].as_array().unwrap().len(), 4);
    assert!(number(row, "evaluations_per_pixel") < number(row, "safe_evaluations_per_pixel"));
    // What it prints can be put into the preset.
    let lines = table.lines().filter_map(|l| l.strip_prefix("    "));
    let march: Vec<&str> = lines.skip_while(|l| *l != "[march]").collect();
    let preset = text(&folder.done("presets bench-far"));
    folder.write("mine.toml", format!("{preset}\n{}\n", march.join("\n")));
    folder.done("render mine.toml --explain");
}

#[test]
fn cones_are_measured_map_by_map_and_view_by_view() {
    let folder = Folder::new();
    let args = "cones checker noise --size 24x16 --json a.json --csv a.csv";
    let (table, _) = bench(&folder, args);
    holds(&table, &["### Maps of checker, 24 x 16, bilinear"]);
    holds(&table, &["### Tracers over noise, 24 x 16, bilinear"]);
    let all = rows(&folder, "a.json");
    let (maps, traces): (Vec<_>, Vec<_>) = all.iter().partition(|r| !r["generator"].is_null());
    assert_eq!(maps.len(), 2 * (Generator::ALL.len() + 1));
    let measured: BTreeSet<_> = traces.iter().map(|row| word(row, "tracer")).collect();
    let tracers = TracerKind::ALL.into_iter();
    let tracers = tracers.filter(|kind| kind.facts().accuracy != Accuracy::Pixel);
    assert_eq!(measured, tracers.map(TracerKind::name).collect());
    let of_map =
        "field size surface generator device ms mean_ratio of_exact wider_than_exact estimate_ms";
    assert_eq!(names(maps[0]).join(" "), of_map);
    let of_trace = "field size surface view_deg tracer map steps_mean steps_p99 skipped unconverged error_texels";
    assert_eq!(names(traces[0]).join(" "), of_trace);
    for row in maps {
        assert!(number(row, "ms") > 0.0);
        // Branch and bound is brute force; the quick maps are narrower, and never wider.
        match word(row, "generator") {
            "brute" | "exact" => {
                assert_eq!([&row["of_exact"], &row["wider_than_exact"]], [&1.0, &0.0]);
            }
            "naive" | "improved" => {
                assert!(number(row, "of_exact") <= 1.0);
                assert_eq!(row["wider_than_exact"], 0.0);
            }
            "max-mip" => assert!(row["mean_ratio"].is_null()),
            _ => {}
        }
    }
    let exact = ["walk", "walk-relaxed", "max-mip"];
    let mut missed = 0.0;
    for row in traces {
        if exact.contains(&word(row, "tracer")) {
            assert_eq!(row["skipped"], 0.0, "{row}");
            assert_eq!(row["unconverged"], 0.0, "{row}");
        }
        missed += number(row, "skipped");
    }
    assert!(missed > 0.0);
    let (header, records) = csv_of(&folder.bytes("a.csv"));
    assert_eq!((header[0].as_str(), header.len()), ("field", 10 + 8));
    assert_eq!(records.len(), all.len());
}

#[test]
fn boxes_are_measured_as_boxes() {
    let folder = Folder::new();
    let (table, _) = bench(&folder, "cones spikes --boxes --size 32x32 --json a.json");
    holds(&table, &["### Tracers over spikes, 32 x 32, boxes"]);
    let all = rows(&folder, "a.json");
    assert!(all.iter().all(|row| row["surface"] == "boxes"));
    let skipped = |name: &str| -> f64 {
        let own = all.iter().filter(|row| row["tracer"] == name);
        own.map(|row| number(row, "skipped")).sum()
    };
    for exact in ["walk", "walk-relaxed", "max-mip"] {
        assert_eq!(skipped(exact), 0.0, "{exact}");
    }
    // Cones of samples know nothing of walls between them.
    assert!(skipped("secant") > 0.1, "{}", skipped("secant"));
}

/// Whatever is sent to standard output stands there alone, and the tables on stderr.
#[test]
fn rows_and_pictures_go_to_standard_output() {
    let folder = Folder::new();
    for more in ["error", "steps", "calibrate --rays 100"] {
        let (out, told) = bench(&folder, &format!("{more} bench-far --json -"));
        assert!(!json(out.as_bytes()).as_array().unwrap().is_empty());
        assert!(told.contains("### bench-far"), "{more}: {told}");
        let (out, told) = bench(&folder, &format!("{more} bench-far --csv -"));
        let (header, first) = csv_of(out.as_bytes());
        assert_eq!(header[0], "preset", "{out}");
        assert!(first.iter().all(|cell| cell == "bench-far"));
        assert!(told.contains("### bench-far"), "{more}: {told}");
    }
    let (out, told) = bench(&folder, "error bench-far --plot - --json a.json");
    let whole = out.starts_with("<svg") && out.ends_with("</svg>\n");
    assert!(whole, "{out}");
    assert!(told.contains("### What beats"), "{told}");
    // Where nothing else is printed, tables are.
    let (out, told) = bench(&folder, "steps bench-far --json b.json");
    let moved = out.contains("### bench-far") && !told.contains("###");
    assert!(moved, "{told}");
    assert_eq!(folder.files(), ["a.json", "b.json", "cache"]);
}

/// The CPU executor tells no device time, and every table says what its times are.
#[test]
fn times_without_timestamps_are_called_wall_time() {
    let folder = Folder::new();
    for verb in ["error", "steps"] {
        let (table, told) = bench(&folder, &format!("{verb} bench-far"));
        holds(&table, &["| wall ms |", "times are wall time"]);
        holds(&told, &["times are wall time"]);
    }
    let (table, _) = bench(&folder, "calibrate bench-far --rays 100");
    let words: Vec<&str> = table.split_whitespace().collect();
    holds(&words.join(" "), &[" ms of wall time"]);
}
