//! The rules of the source tree: imports point downward, twins share a path, files are short.
//!
//! Each rule is a function from a path and a text to violations, so that it can be tried on
//! an example. A test collects the violations of all files before it fails.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test may panic, and is read by its name"
)]

mod common {
    pub mod files;
}

use std::path::Path;

use common::files::files_below;

/// The rooms of `src/`, lowest first. Rooms on the same line do not import each other.
const FLOORS: [&[&str]; 9] = [
    &["base"],
    &["formula", "heightfield"],
    &["scene"],
    &["plan"],
    &["preset", "pass"],
    &["picture"],
    &["gpu", "cpu"],
    &["measure"],
    &["command"],
];
/// The most lines of a source file.
const MOST_LINES: usize = 420;

fn floor(room: &str) -> Option<usize> {
    FLOORS.iter().position(|rooms| rooms.contains(&room))
}

/// Asserts that a rule finds nothing in the sources.
fn assert_kept(rule: fn(&str, &str) -> Vec<String>) {
    let files = files_below("src").into_iter();
    let found: Vec<String> = files.flat_map(|(path, text)| rule(&path, &text)).collect();
    assert!(found.is_empty(), "violations:\n{}", found.join("\n"));
}

/// The code of a file: without comments and without its test module, which stands last.
fn code(text: &str) -> String {
    let product = text.split("#[cfg(test)]").next().unwrap();
    let lines = product.lines().map(|line| line.split("//").next().unwrap());
    lines.collect::<Vec<_>>().join("\n")
}

/// The first name of each path in a list such as `base::view, pass::{self, look}}; ...`,
/// up to the brace that closes it; or the one name that the text starts with.
fn first_names(text: &str) -> Vec<String> {
    let name = |part: &str| -> String {
        let word = part.trim_start().chars();
        word.take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect()
    };
    let Some(list) = text.strip_prefix('{') else {
        return vec![name(text)];
    };
    let (mut depth, mut parts) = (0_i32, vec![String::new()]);
    for c in list.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        match c {
            _ if depth < 0 => break,
            ',' if depth == 0 => parts.push(String::new()),
            _ => parts.last_mut().unwrap().push(c),
        }
    }
    parts
        .iter()
        .map(|part| name(part))
        .filter(|n| !n.is_empty())
        .collect()
}

/// Paths of a file in `src/ROOM/` that name a room which is not below its own.
fn upward_paths(path: &str, text: &str) -> Vec<String> {
    let inner = path.strip_prefix("src/").unwrap();
    let Some((room, rest)) = inner.split_once('/') else {
        return Vec::new(); // `lib.rs` and `main.rs` stand above all rooms.
    };
    let Some(own) = floor(room) else {
        return vec![format!("{path}: the room `{room}` has no floor")];
    };
    // As many `super::` as there are modules around the file lead to the root.
    let modules = 1 + rest
        .replace("mod.rs", "")
        .split('/')
        .filter(|p| !p.is_empty())
        .count();
    let text = code(text).replace(&"super::".repeat(modules), "crate::");
    let named = text.split("crate::").skip(1).flat_map(first_names);
    let mut upward: Vec<String> = named
        .filter(|name| name != room && floor(name).is_some_and(|other| other >= own))
        .map(|name| format!("{path}: `{room}` must not name `{name}`"))
        .collect();
    upward.sort();
    upward.dedup();
    upward
}

/// A Rust file that has a twin names the WGSL file at its own path, and that file exists.
fn broken_twins(path: &str, text: &str) -> Vec<String> {
    let inner = path
        .strip_prefix("src/")
        .unwrap()
        .strip_suffix(".rs")
        .unwrap();
    let own = format!("wgsl/{inner}.wgsl");
    let docs: Vec<&str> = text
        .lines()
        .map_while(|line| line.strip_prefix("//!"))
        .collect();
    let docs = docs.join("");
    let says = docs.contains("Twin: `wgsl/") || docs.contains(&own);
    let exists = Path::new(env!("CARGO_MANIFEST_DIR")).join(&own).exists();
    match (says && docs.contains(&own), exists) {
        (false, true) => vec![format!("{path}: its docs do not name its twin {own}")],
        (true, false) => vec![format!("{path}: its twin {own} does not exist")],
        (false, false) if says => vec![format!("{path}: its twin has another path")],
        _ => Vec::new(),
    }
}

fn too_long(path: &str, text: &str) -> Vec<String> {
    let lines = text.lines().count();
    let long = lines > MOST_LINES;
    long.then(|| format!("{path}: {lines} lines, at most {MOST_LINES}"))
        .into_iter()
        .collect()
}

#[test]
fn imports_point_downward() {
    assert_kept(upward_paths);
}

#[test]
fn twins_share_a_path() {
    assert_kept(broken_twins);
}

#[test]
fn no_file_is_too_long() {
    assert_kept(too_long);
}

#[test]
fn upward_paths_are_found_in_every_form() {
    let of = |text: &str| {
        let found = upward_paths("src/scene/distance.rs", text);
        let rooms = found
            .iter()
            .map(|f| f.rsplit('`').nth(1).unwrap().to_string());
        rooms.collect::<Vec<String>>()
    };
    for downward in [
        "use crate::base::view::View;\nuse crate::{formula::Formula, scene::Solid, wgsl};",
        "use super::Solid;\n// as crate::plan does\n/// See [`crate::gpu`].",
        "fn f() {}\n#[cfg(test)]\nmod tests { use crate::plan::Plan; }",
    ] {
        assert_eq!(of(downward), [""; 0], "{downward}");
    }
    for upward in [
        "use crate::plan::Plan;",
        "use crate::{base::{self, view}, plan};",
        "use crate::{\n    base::view,\n    plan::{camera, look},\n};",
        "fn f(plan: &crate::plan::Plan) {}",
        "use super::super::plan::Plan;",
    ] {
        assert_eq!(of(upward), ["plan"], "{upward}");
    }
    assert_eq!(
        of("use crate::{plan::Plan, gpu};\nuse crate::gpu::device;"),
        ["gpu", "plan"]
    );
    // A neighbour on the same floor is not below.
    assert_eq!(
        upward_paths("src/cpu/mod.rs", "use super::gpu::render;").len(),
        1
    );
    assert_eq!(upward_paths("src/attic/mod.rs", "").len(), 1);
    assert_eq!(
        upward_paths("src/lib.rs", "use crate::command::line;"),
        [""; 0]
    );
}

#[test]
fn broken_twins_and_long_files_are_found() {
    let kept = "//! Rays. Twin: `wgsl/pass/trace.wgsl`.";
    assert_eq!(broken_twins("src/pass/trace.rs", kept), [""; 0]);
    for (path, docs) in [
        ("src/pass/trace.rs", "//! Rays."),
        (
            "src/pass/trace.rs",
            "//! Rays. Twin: `wgsl/pass/march.wgsl`.",
        ),
        (
            "src/pass/rays.rs",
            "//! Rays. Twin: `wgsl/pass/trace.wgsl`.",
        ),
        ("src/pass/rays.rs", "//! Rays. Twin: `wgsl/pass/rays.wgsl`."),
    ] {
        assert_eq!(broken_twins(path, docs).len(), 1, "{path}: {docs}");
    }
    assert_eq!(too_long("src/a.rs", &"\n".repeat(MOST_LINES)), [""; 0]);
    assert_eq!(too_long("src/a.rs", &"\n".repeat(MOST_LINES + 1)).len(), 1);
}
