//! The measurements of the command line: fields, files, figures and bad input. Presets are
//! tiny and measured by the CPU executor, so that no adapter is needed.

#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use serde_json::Value;

#[allow(dead_code, reason = "other files use the rest")]
mod common {
    pub mod folder;
}
use common::folder::{Folder, said, text};

/// Arguments of a measurement that takes no time.
fn tiny<'a>(verb: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut args = vec!["bench", verb, "--device", "cpu", "--size", "40x24"];
    args.extend(more);
    args
}

/// Runs what must succeed, with a cache in the folder.
fn bench(folder: &Folder, args: &[&str]) -> (String, String) {
    let mut command = folder.command(args);
    let output = command
        .env("XDG_CACHE_HOME", folder.0.join("cache"))
        .output();
    let output = output.expect("the program starts");
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", said(&output));
    (text(&output), said(&output))
}

fn rows(folder: &Folder, name: &str) -> Vec<Value> {
    let all: Value = serde_json::from_slice(&folder.bytes(name)).expect("JSON");
    all.as_array().expect("rows").clone()
}

fn names(row: &Value) -> Vec<String> {
    row.as_object().expect("a row").keys().cloned().collect()
}

/// The fields that the contract of the command line names, in its order.
const ERROR_FIELDS: [&str; 20] = [
    "preset",
    "mode",
    "parameters",
    "baseline",
    "size",
    "device",
    "wall_ms",
    "gpu_ms",
    "evaluations_per_pixel",
    "iterations_per_pixel",
    "depth_error",
    "behind",
    "front",
    "behind8",
    "front8",
    "holes",
    "false_hits",
    "start_violations",
    "unconverged",
    "flip",
];

#[test]
fn error_rows_files_and_the_cache() {
    let folder = Folder::new();
    let args = tiny(
        "error",
        &[
            "bench-far",
            "mandelbox",
            "--json",
            "a.json",
            "--csv",
            "a.csv",
            "--plot",
            "a.svg",
        ],
    );
    let (table, told) = bench(&folder, &args);
    assert!(!told.contains("kept from before"), "{told}");
    for word in [
        "### bench-far, 40 x 24",
        "### mandelbox, 40 x 24",
        "| slides-fast",
        "FLIP",
    ] {
        assert!(table.contains(word), "`{word}` not in {table}");
    }
    let first = rows(&folder, "a.json");
    let modes: Vec<&str> = first.iter().filter_map(|r| r["mode"].as_str()).collect();
    let of_one = [
        "ray",
        "ray-relaxed",
        "safe",
        "calibrated",
        "slides-even",
        "slides-deep",
        "slides-fast",
    ];
    assert_eq!(modes, [of_one, of_one].concat());
    for row in &first {
        assert_eq!(names(row)[..ERROR_FIELDS.len()], ERROR_FIELDS);
        assert_eq!(row["baseline"], true);
        let parts = ["median", "p95", "p99", "max"];
        assert_eq!(names(&row["depth_error"]), parts);
        let levels = if row["mode"].as_str().unwrap().starts_with("ray") {
            0
        } else {
            4
        };
        assert_eq!(row["start_violations"].as_array().unwrap().len(), levels);
    }
    // The same executor renders the truth: what is not exact differs from it.
    let safe = &first[2];
    assert_eq!(safe["holes"], 0.0);
    assert!(safe["depth_error"]["median"].as_f64().unwrap() < 1.0);
    assert!(first[6]["behind"].as_f64().unwrap() > safe["behind"].as_f64().unwrap());
    let bytes = folder.bytes("a.csv");
    let mut csv = csv::Reader::from_reader(&bytes[..]);
    let header = csv.headers().unwrap().clone();
    assert_eq!(header.get(0), Some("preset"));
    assert!(header.iter().any(|h| h == "depth_error_p99"));
    assert_eq!(csv.records().map(Result::unwrap).count(), first.len());
    let plot = String::from_utf8(folder.bytes("a.svg")).expect("text");
    assert!(plot.contains(">bench-far<") && plot.contains(">mandelbox<"));

    // Again: the truth is kept, and everything but time is the same.
    let (_, told) = bench(&folder, &args);
    assert_eq!(told.matches("kept from before").count(), 2, "{told}");
    let timeless = |rows: Vec<Value>| -> Vec<Value> {
        let without = |mut row: Value| {
            let fields = row.as_object_mut().unwrap();
            fields.remove("wall_ms");
            row
        };
        rows.into_iter().map(without).collect()
    };
    assert_eq!(timeless(first.clone()), timeless(rows(&folder, "a.json")));
    // A preset of the same name that asks for something else has a truth of its own.
    let preset = text(&folder.done(&["presets", "bench-far"])).replace("-14", "-13");
    folder.write("bench-far.toml", preset);
    let (_, told) = bench(&folder, &tiny("error", &["bench-far.toml"]));
    assert!(!told.contains("kept from before"), "{told}");
}

#[test]
fn sweeps_follow_the_baselines() {
    let folder = Folder::new();
    bench(
        &folder,
        &tiny("error", &["bench-thin", "--sweep", "--json", "s.json"]),
    );
    let all = rows(&folder, "s.json");
    let base = all.iter().filter(|r| r["baseline"] == true).count();
    assert!(all[..base].iter().all(|r| r["baseline"] == true));
    let swept = |key: &str| {
        all[base..]
            .iter()
            .filter(|r| !r["parameters"][key].is_null())
            .count()
    };
    for key in [
        "coarsest",
        "shell",
        "fudge",
        "steps",
        "relaxation",
        "detail",
    ] {
        assert!(swept(key) >= 2, "{key}");
    }
    // Sixteen steps do not take every ray to the surface, and none of them is a hit.
    let few = all.iter().find(|r| r["parameters"]["steps"] == 16).unwrap();
    assert!(few["unconverged"].as_f64().unwrap() > 0.0);
}

#[test]
fn steps_are_counted_and_drawn() {
    let folder = Folder::new();
    let args = [
        "bench-thin",
        "--mode",
        "safe",
        "--json",
        "s.json",
        "--csv",
        "s.csv",
        "--heat",
        "h",
    ];
    let (table, _) = bench(&folder, &tiny("steps", &args));
    assert!(table.contains("| march 1/16"), "{table}");
    let all = rows(&folder, "s.json");
    let passes: Vec<&str> = all.iter().filter_map(|r| r["pass"].as_str()).collect();
    assert_eq!(
        passes,
        ["march 1/16", "march 1/8", "march 1/4", "march 1/2", "trace"]
    );
    for row in &all {
        let of = |name: &str| row[name].as_u64().unwrap();
        let histogram: u64 = row["histogram"]
            .as_array()
            .unwrap()
            .iter()
            .filter_map(Value::as_u64)
            .sum();
        assert_eq!(histogram, of("cells"));
        assert!(of("p50") <= of("p90") && of("p90") <= of("p99") && of("p99") <= of("max"));
        assert!(row["waste_8x8"].as_f64().unwrap() >= row["waste_8x4"].as_f64().unwrap());
    }
    assert_eq!(all[4]["cells"], 40 * 24);
    // The sums are those of a counted render.
    folder.done(&[
        "render",
        "bench-thin",
        "--device",
        "cpu",
        "--size",
        "40x24",
        "-o",
        "x.png",
        "--layer",
        "steps",
        "--stats",
        "x.json",
    ]);
    let stats: Value = serde_json::from_slice(&folder.bytes("x.json")).unwrap();
    for (row, pass) in all.iter().zip(stats["passes"].as_array().unwrap()) {
        assert_eq!(row["evaluations"], pass["evaluations"]);
        assert_eq!(row["iterations"], pass["iterations"]);
    }
    // The heat map is a picture that carries its preset.
    folder.done(&["render", "h/bench-thin-safe.png", "--explain"]);
}

#[test]
fn calibration_proposes_a_preset_that_keeps_its_budget() {
    let folder = Folder::new();
    let args = [
        "bench-far",
        "--rays",
        "500",
        "--budget",
        "0.02",
        "--json",
        "c.json",
    ];
    let (table, _) = bench(&folder, &tiny("calibrate", &args));
    assert!(table.contains("mode = \"calibrated\""), "{table}");
    let row = &rows(&folder, "c.json")[0];
    assert_eq!(row["within"], true);
    assert!(row["lost"].as_f64().unwrap() <= 0.02);
    assert_eq!(row["fudge"].as_array().unwrap().len(), 4);
    let less = row["evaluations_per_pixel"].as_f64().unwrap();
    assert!(less < row["safe_evaluations_per_pixel"].as_f64().unwrap());
    // What it prints can be put into the preset.
    let lines = table.lines().filter_map(|l| l.strip_prefix("    "));
    let march: Vec<&str> = lines.skip_while(|l| *l != "[march]").collect();
    let preset = text(&folder.done(&["presets", "bench-far"]));
    let mine = format!("{preset}\n{}\n", march.join("\n"));
    folder.write("mine.toml", mine);
    folder.done(&["render", "mine.toml", "--explain"]);
}

#[test]
fn cones_are_measured_map_by_map_and_view_by_view() {
    let folder = Folder::new();
    let args = [
        "bench", "cones", "checker", "noise", "--size", "24x16", "--json", "a.json", "--csv",
        "a.csv",
    ];
    let (table, _) = bench(&folder, &args);
    for word in [
        "### Maps of checker, 24 x 16, bilinear",
        "### Tracers over noise, 24 x 16, bilinear",
    ] {
        assert!(table.contains(word), "`{word}` not in {table}");
    }
    let all = rows(&folder, "a.json");
    let (maps, traces): (Vec<_>, Vec<_>) = all.iter().partition(|r| !r["generator"].is_null());
    assert_eq!((maps.len(), traces.len()), (2 * 11, 2 * 3 * 16));
    let wanted = [
        "field",
        "size",
        "surface",
        "generator",
        "device",
        "ms",
        "mean_ratio",
        "of_exact",
        "wider_than_exact",
        "estimate_ms",
    ];
    assert_eq!(names(maps[0]), wanted);
    let wanted = [
        "field",
        "size",
        "surface",
        "view_deg",
        "tracer",
        "map",
        "steps_mean",
        "steps_p99",
        "skipped",
        "unconverged",
        "error_texels",
    ];
    assert_eq!(names(traces[0]), wanted);
    for row in maps {
        assert!(row["ms"].as_f64().unwrap() > 0.0);
        // Branch and bound is brute force; the quick maps are narrower, and never wider.
        match row["generator"].as_str().unwrap() {
            "brute" | "exact" => {
                assert_eq!(
                    (&row["of_exact"], &row["wider_than_exact"]),
                    (&1.0.into(), &0.0.into())
                );
            }
            "naive" | "improved" => {
                assert!(row["of_exact"].as_f64().unwrap() <= 1.0);
                assert_eq!(row["wider_than_exact"], 0.0);
            }
            "max-mip" => assert!(row["mean_ratio"].is_null()),
            _ => {}
        }
    }
    let exact = ["walk", "walk-relaxed", "max-mip"];
    let mut missed = 0.0;
    for row in traces {
        let skipped = row["skipped"].as_f64().unwrap();
        if exact.contains(&row["tracer"].as_str().unwrap()) {
            assert_eq!((skipped, &row["unconverged"]), (0.0, &0.0.into()), "{row}");
        }
        missed += skipped;
    }
    assert!(missed > 0.0);
    // The reader refuses rows of unequal length.
    let bytes = folder.bytes("a.csv");
    let mut csv = csv::Reader::from_reader(&bytes[..]);
    let header = csv.headers().unwrap().clone();
    assert_eq!(header.iter().next(), Some("field"));
    assert_eq!(header.len(), 10 + 8);
    assert_eq!(csv.records().map(Result::unwrap).count(), all.len());
    for (more, words) in [
        (&["fbn"][..], &["fbn", "fbm, ridges"][..]),
        (&["fbm", "--size", "9999x9"], &["9999"]),
    ] {
        let args: Vec<&str> = ["bench", "cones"]
            .into_iter()
            .chain(more.to_vec())
            .collect();
        folder.fails(&args, 2, words);
    }
}

#[test]
fn bad_input_is_one_sentence() {
    let folder = Folder::new();
    for verb in ["error", "steps", "calibrate"] {
        let huge = ["bench", verb, "bench-far", "--size", "65536x65536"];
        folder.fails(&huge, 1, &["bench-far", "bytes of memory", "would fit"]);
    }
    folder.write("file", "of nothing");
    std::fs::create_dir(folder.0.join("a")).expect("a folder");
    let preset = text(&folder.done(&["presets", "bench-far"]));
    folder.write("a/bench-far.toml", preset);
    let cases: &[(&str, &[&str], i32, &[&str])] = &[
        ("error", &["bench-fat"], 2, &["bench-fat", "bench-far"]),
        ("error", &["no.toml"], 1, &["no.toml"]),
        ("error", &["bench-far", "--json", "no/a.json"], 1, &["no"]),
        ("error", &["bench-far", "--plot", "no/a.svg"], 1, &["no"]),
        (
            "steps",
            &["bench-far", "--mode", "fast"],
            2,
            &["fast", "safe", "slides-even"],
        ),
        ("steps", &["bench-far", "--csv", "no/a.csv"], 1, &["no"]),
        (
            "error",
            &["bench-far", "--plot", "x.png"],
            2,
            &["x.png", ".svg"],
        ),
        (
            "error",
            &["bench-far", "--plot", "svg"],
            2,
            &["`svg`", ".svg"],
        ),
        (
            "error",
            &["bench-far", "--json", "a", "--csv", "./a"],
            2,
            &["--json and --csv", "`./a`"],
        ),
        (
            "error",
            &["bench-far", "--csv", "-", "--plot", "-"],
            2,
            &["--csv and --plot", "`-`"],
        ),
        (
            "steps",
            &["bench-far", "a/bench-far.toml", "--heat", "h"],
            2,
            &["two", "`bench-far`"],
        ),
        // A folder that was made goes again with what fails after it.
        (
            "steps",
            &["bench-far", "--heat", "h/i", "--json", "no/a.json"],
            1,
            &["no/a.json"],
        ),
        ("steps", &["bench-far", "--heat", "file"], 1, &["file"]),
        ("calibrate", &["bench-far", "--budget", "2"], 2, &["0.5"]),
        ("calibrate", &["bench-far", "--budget", "nan"], 2, &["0.5"]),
        ("calibrate", &["bench-far", "--rays", "0"], 2, &["100"]),
    ];
    for (verb, more, code, words) in cases {
        folder.fails(&tiny(verb, more), *code, words);
    }
    folder.fails(
        &["bench", "error", "bench-far", "--device", "nothing"],
        1,
        &["nothing", "cpu"],
    );
    folder.fails(&["bench", "errors"], 2, &["errors"]);
}

/// Whatever is sent to standard output stands there alone, and the tables on stderr.
#[test]
fn rows_and_pictures_go_to_standard_output() {
    let folder = Folder::new();
    let json = |text: &str| serde_json::from_str::<Vec<Value>>(text).expect("JSON alone");
    for verb in ["error", "steps", "calibrate"] {
        let more: &[&str] = match verb {
            "calibrate" => &["bench-far", "--rays", "100", "--json", "-"],
            _ => &["bench-far", "--json", "-"],
        };
        let (out, told) = bench(&folder, &tiny(verb, more));
        assert!(!json(&out).is_empty());
        assert!(told.contains("### bench-far"), "{verb}: {told}");
        let more = &[&more[..more.len() - 2], &["--csv", "-"]].concat();
        let (out, told) = bench(&folder, &tiny(verb, more));
        let mut csv = csv::Reader::from_reader(out.as_bytes());
        assert_eq!(csv.headers().unwrap().get(0), Some("preset"), "{out}");
        assert!(
            csv.records()
                .all(|r| r.unwrap().get(0) == Some("bench-far"))
        );
        assert!(told.contains("### bench-far"), "{verb}: {told}");
    }
    let (out, told) = bench(
        &folder,
        &tiny("error", &["bench-far", "--plot", "-", "--json", "a.json"]),
    );
    assert!(
        out.starts_with("<svg") && out.ends_with("</svg>\n"),
        "{out}"
    );
    assert!(told.contains("### What beats"), "{told}");
    // Where nothing else is printed, tables are.
    let (out, told) = bench(&folder, &tiny("steps", &["bench-far", "--json", "b.json"]));
    assert!(
        out.contains("### bench-far") && !told.contains("###"),
        "{told}"
    );
    assert_eq!(folder.files(), ["a.json", "b.json", "cache"]);
}

/// The CPU executor tells no device time, and every table says what its times are.
#[test]
fn times_without_timestamps_are_called_wall_time() {
    let folder = Folder::new();
    for verb in ["error", "steps"] {
        let (table, told) = bench(&folder, &tiny(verb, &["bench-far"]));
        assert!(table.contains("| wall ms |"), "{table}");
        assert!(table.contains("times are wall time"), "{table}");
        assert!(told.contains("times are wall time"), "{told}");
    }
    let (table, _) = bench(&folder, &tiny("calibrate", &["bench-far", "--rays", "100"]));
    let words: Vec<&str> = table.split_whitespace().collect();
    assert!(words.join(" ").contains(" ms of wall time"), "{table}");
}

#[test]
fn boxes_are_measured_as_boxes() {
    let folder = Folder::new();
    let args = [
        "bench", "cones", "spikes", "--boxes", "--size", "32x32", "--json", "a.json",
    ];
    let (table, _) = bench(&folder, &args);
    assert!(
        table.contains("### Tracers over spikes, 32 x 32, boxes"),
        "{table}"
    );
    let all = rows(&folder, "a.json");
    assert!(all.iter().all(|row| row["surface"] == "boxes"));
    let skipped = |name: &str| -> f64 {
        let own = all.iter().filter(|row| row["tracer"] == name);
        own.map(|row| row["skipped"].as_f64().unwrap()).sum()
    };
    for exact in ["walk", "walk-relaxed", "max-mip"] {
        assert_eq!(skipped(exact), 0.0, "{exact}");
    }
    // Cones of samples know nothing of walls between them.
    assert!(skipped("secant") > 0.1, "{}", skipped("secant"));
}
