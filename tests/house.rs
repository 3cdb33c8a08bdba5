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

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use common::files::files_below;

/// The rooms of `src/`, lowest first. Rooms on the same line do not import each other.
const FLOORS: [&[&str]; 10] = [
    &["base", "raster"],
    &["formula", "heightfield", "time"],
    &["scene"],
    &["plan"],
    &["preset", "pass"],
    &["picture"],
    &["gpu", "cpu"],
    &["measure"],
    &["preview"],
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

/// The first names of the paths in a text such as `{base::view, pass::{self, look}}; ...`, or
/// the one name that the text starts with.
fn first_names(text: &str) -> Vec<String> {
    let mut depth = 0;
    let mut outer = String::new();
    for c in text.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        match depth {
            0 => break,
            1 => outer.push(c),
            _ => {}
        }
    }
    // Without braces nothing was kept.
    let paths = outer
        .strip_prefix('{')
        .map_or(vec![text], |list| list.split(',').collect());
    let name = |path: &str| {
        let end = path.find(|c: char| !c.is_alphanumeric() && c != '_');
        path[..end.unwrap_or(path.len())].to_string()
    };
    paths.into_iter().map(|path| name(path.trim())).collect()
}

/// Paths of a file in `src/ROOM/` that name a room which is not below its own.
fn upward_paths(path: &str, text: &str) -> Vec<String> {
    let parts: Vec<&str> = path
        .split(['/', '.'])
        .filter(|p| !["mod", "rs"].contains(p))
        .collect();
    let ["src", room, ..] = parts[..] else {
        panic!("{path} is not in src");
    };
    if ["lib", "main"].contains(&room) {
        return Vec::new();
    }
    let Some(own) = floor(room) else {
        return vec![format!("{path}: the room `{room}` has no floor")];
    };
    // As many `super::` as there are modules around the file lead to the root.
    let text = code(text).replace(&"super::".repeat(parts.len() - 1), "crate::");
    let names: BTreeSet<String> = text
        .split("crate::")
        .skip(1)
        .flat_map(first_names)
        .collect();
    let upward = |name: &String| name != room && floor(name).is_some_and(|other| other >= own);
    let upward = names.into_iter().filter(upward);
    upward
        .map(|name| format!("{path}: `{room}` must not name `{name}`"))
        .collect()
}

/// The name that a line of WGSL defines for all modules.
fn defined_name(line: &str) -> Option<&str> {
    // After its attributes.
    let line = line
        .rsplit_once(") ")
        .filter(|_| line.starts_with('@'))
        .map_or(line, |l| l.1);
    let (kind, rest) = line.split_once([' ', '<'])?;
    let rest = rest
        .split_once("> ")
        .filter(|_| kind == "var")
        .map_or(rest, |r| r.1);
    let is_kind = ["fn", "struct", "const", "override", "alias", "var"].contains(&kind);
    is_kind.then(|| rest.split(|c: char| !is_word(c)).next())?
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The words of a WGSL text that are neither fields nor local variables.
fn used_names(text: &str) -> BTreeSet<&str> {
    let (mut used, mut locals) = (BTreeSet::new(), BTreeSet::new());
    let mut rest = text;
    while let Some(start) = rest.find(is_word) {
        let before = text[..text.len() - rest.len() + start].trim_end();
        let word = rest[start..].split(|c: char| !is_word(c)).next().unwrap();
        rest = &rest[start + word.len()..];
        if before.ends_with('.') {
            continue;
        }
        let is_new = before.ends_with("let") || before.ends_with("var");
        match is_new || rest.trim_start().starts_with(':') {
            true => locals.insert(word),
            false => used.insert(word),
        };
    }
    used.difference(&locals).copied().collect()
}

/// Names in the WGSL files of a room that only rooms define which are not below it.
fn upward_names(files: &[(String, String)]) -> Vec<String> {
    let room = |path: &str| path.split('/').nth(1).unwrap().to_string();
    let texts: Vec<_> = files
        .iter()
        .map(|(path, text)| (path, room(path), code(text)))
        .collect();
    let mut definers: BTreeMap<&str, BTreeSet<&String>> = BTreeMap::new();
    for (_, room, text) in &texts {
        for name in text.lines().filter_map(defined_name) {
            definers.entry(name).or_default().insert(room);
        }
    }
    let mut found = Vec::new();
    for (path, own, text) in &texts {
        let is_below = |other: &&String| *other == own || floor(other) < floor(own);
        let is_upward = |name: &&str| {
            let rooms = definers.get(name);
            rooms.is_some_and(|rooms| !rooms.iter().any(is_below))
        };
        let names = used_names(text).into_iter().filter(is_upward);
        found.extend(names.map(|name| format!("{path}: {name}")));
    }
    found
}

#[test]
fn shaders_name_only_what_is_below() {
    let files = [
        (
            "wgsl/base/a.wgsl",
            "var<private> a: u32 = 0u;\nfn b(p: u32) {}\nconst P = 1u;",
        ),
        (
            "wgsl/scene/b.wgsl",
            "@group(0) @binding(1) var<storage, read> s: u32;\nstruct T { x: f32 }\nfn d() {}",
        ),
        (
            "wgsl/formula/c.wgsl",
            "fn c(d: u32) { b(a); e(d.s); }\nfn f() -> T { return s; }",
        ),
        (
            "wgsl/formula/d.wgsl",
            "// d\nfn e(x: u32) {\n    let s = x;\n    d(s);\n}",
        ),
    ];
    let files = files.map(|(path, text)| (path.to_string(), text.to_string()));
    let found = [
        "wgsl/formula/c.wgsl: T",
        "wgsl/formula/c.wgsl: s",
        "wgsl/formula/d.wgsl: d",
    ];
    assert_eq!(upward_names(&files), found);
    let found = upward_names(&files_below("wgsl"));
    assert!(found.is_empty(), "violations:\n{}", found.join("\n"));
}

/// The item that `#[cfg(feature = "cli")]` stands before, and what is left of a text without it.
fn without_next_item(text: &str) -> (&str, &str) {
    let mut depth = 0;
    let end = text.char_indices().find(|(i, c)| {
        depth += i32::from("{([".contains(*c)) - i32::from("})]".contains(*c));
        // A field ends with a comma, and a function's head may contain one.
        let ends = ";}".contains(*c) || *c == ',' && !text[..*i].contains("fn ");
        depth == 0 && ends
    });
    text.split_at(end.map_or(text.len(), |(i, _)| i + 1))
}

/// A text without what only the feature `cli` compiles, and the modules that are left out.
fn core(text: &str) -> (String, Vec<String>) {
    // The window needs the command line.
    let text = text.replace("feature = \"preview\"", "feature = \"cli\"");
    let (mut rest, mut kept, mut modules) = (&*text, String::new(), Vec::new());
    while let Some((before, after)) = rest.split_once("#[cfg(feature = \"cli\")]") {
        kept += before;
        let (item, left) = without_next_item(after);
        let name = item.split("mod ").nth(1);
        modules.extend(name.map(|name| name.trim_end_matches(';').to_string()));
        rest = left;
    }
    (kept + rest, modules)
}

/// What a browser lacks, or forbids.
const NOT_IN_CORE: [&str; 16] = [
    "fs::",
    "File::open",
    "File::create",
    "OpenOptions",
    "canonicalize",
    "SystemTime",
    "process::",
    "thread::",
    "Instant",
    "env::",
    "block_on",
    "pollster",
    ".recv_timeout(",
    "PollType::Wait",
    "rayon",
    ".metadata()",
];

#[test]
fn without_the_command_line_nothing_reads_files_waits_or_starts_threads() {
    let files: Vec<(String, String)> = files_below("src").into_iter().collect();
    let mut left_out = vec!["src/main".to_string()];
    for (path, text) in &files {
        let folder = path
            .trim_end_matches(".rs")
            .trim_end_matches("mod")
            .trim_end_matches("lib");
        let modules = core(&code(text)).1;
        left_out.extend(
            modules
                .iter()
                .map(|name| format!("{}/{name}", folder.trim_end_matches('/'))),
        );
    }
    let is_core = |path: &str| {
        let inside = |left: &String| {
            path.strip_prefix(&**left)
                .is_some_and(|p| p.starts_with(['/', '.']))
        };
        !left_out.iter().any(inside)
    };
    let found = |(path, text): &(String, String)| {
        let text = core(&code(text)).0;
        let words = NOT_IN_CORE.iter().filter(|word| text.contains(**word));
        words
            .map(|word| format!("{path}: {word}"))
            .collect::<Vec<_>>()
    };
    let core_files: Vec<_> = files.iter().filter(|(path, _)| is_core(path)).collect();
    let found: Vec<String> = core_files.iter().flat_map(|file| found(file)).collect();
    assert!(found.is_empty(), "the core uses:\n{}", found.join("\n"));
    // Enough of them are read, and each word is used elsewhere.
    assert!(core_files.len() > 100 && left_out.len() > 8, "{left_out:?}");
    for word in NOT_IN_CORE {
        assert!(files.iter().any(|(_, text)| text.contains(word)), "{word}");
    }
}

/// Modules of a folder that its page does not name.
fn unnamed_modules(path: &str, text: &str) -> Vec<String> {
    let page: String = text
        .lines()
        .filter(|line| line.starts_with("//!"))
        .collect();
    let code = code(text);
    let modules = code.lines().filter_map(|line| {
        let declared = line.strip_suffix(';')?;
        let words: Vec<&str> = declared.split(' ').collect();
        (words.len() <= 3).then_some(())?;
        let [.., "mod", name] = words[..] else {
            return None;
        };
        Some(name.to_string())
    });
    let is_named = |name: &str| {
        ["`", "mod@"]
            .iter()
            .any(|sign| page.contains(&format!("{sign}{name}`")))
    };
    let missing = modules.filter(|name| path.ends_with("/mod.rs") && !is_named(name));
    missing
        .map(|name| format!("{path}: its page does not name `{name}`"))
        .collect()
}

#[test]
fn the_page_of_a_folder_names_what_is_in_it() {
    let room = "//! - [`a`], [`mod@b`]\npub mod a;\nmod b;\npub(crate) mod c;\nfn d() {}\n";
    let found = ["src/r/mod.rs: its page does not name `c`"];
    assert_eq!(unnamed_modules("src/r/mod.rs", room), found);
    assert_kept(unnamed_modules);
}

/// A Rust file that has a twin names the WGSL file at its own path, and that file exists.
fn broken_twins(path: &str, text: &str) -> Vec<String> {
    let twin = path.replace("src/", "wgsl/").replace(".rs", ".wgsl");
    let docs: String = text
        .lines()
        .map_while(|line| line.strip_prefix("//!"))
        .collect();
    let fault = match (
        Path::new(env!("CARGO_MANIFEST_DIR")).join(&twin).exists(),
        docs.contains(&twin),
        docs.contains("Twin: `wgsl/"),
    ) {
        (true, false, _) => "the docs do not name it",
        (false, true, _) => "it does not exist",
        (false, _, true) => "the docs name a twin at another path",
        _ => return Vec::new(),
    };
    vec![format!("{path}: of the twin {twin}, {fault}")]
}

/// Places that the changes of a page show, and that are not in their files, or twice.
fn lost_places(page: &str, file: impl Fn(&str) -> String) -> Vec<String> {
    let mut lost = Vec::new();
    for block in page.split("```diff\n").skip(1) {
        let change = block.split("```").next().unwrap();
        let (path, parts) = change.split_once('\n').unwrap();
        let text = format!("\n{}", file(path));
        for part in parts.split("@@\n") {
            let [old, new] = [[' ', '-'], [' ', '+']].map(|signs| {
                let lines = part.lines().filter_map(|line| line.strip_prefix(signs));
                lines.map(|line| format!("\n{line}")).collect::<String>() + "\n"
            });
            // Who has followed the page has the new lines.
            let is_there = text.matches(&old).count() == 1 || text.contains(&new);
            lost.extend((!is_there).then(|| format!("{path}: {old}")));
        }
    }
    lost
}

#[test]
fn what_the_page_on_extending_changes_is_there() {
    let change = "Add c:\n\n```diff\nsrc/x.rs\n a\n-b\n+c\n@@\n d\n```\n";
    for (text, lost) in [
        ("a\nb\ne\nd\n", 0),
        ("a\nc\nd\n", 0),
        ("a\ne\nb\nd\n", 1),
        ("a\nbd\n", 2),
    ] {
        let found = lost_places(change, |_| text.into());
        assert_eq!(found.len(), lost, "{text:?}: {found:?}");
    }
    let read = |path: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
        std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    };
    let page = read("docs/extending.md");
    assert!(page.matches("```diff\n").count() >= 10);
    let lost = lost_places(&page, read);
    assert!(lost.is_empty(), "not there, or twice:\n{}", lost.join("\n"));
}

fn too_long(path: &str, text: &str) -> Vec<String> {
    let lines = text.lines().count();
    let fault = format!("{path}: {lines} lines, at most {MOST_LINES}");
    Vec::from_iter((lines > MOST_LINES).then_some(fault))
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
        found
            .iter()
            .map(|f| f.split('`').nth(3).unwrap().to_string())
            .collect::<Vec<_>>()
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
    let two = of("use crate::{plan::Plan, gpu};\nuse crate::gpu::device;");
    assert_eq!(two, ["gpu", "plan"]);
    for (path, text, found) in [
        // A neighbour on the same floor is not below.
        ("src/cpu/mod.rs", "use super::gpu::render;", 1),
        ("src/cpu/mod.rs", "use super::picture::frame;", 0),
        ("src/attic/mod.rs", "", 1),
        ("src/lib.rs", "use crate::command::line;", 0),
    ] {
        assert_eq!(upward_paths(path, text).len(), found, "{path}: {text}");
    }
}

#[test]
fn broken_twins_and_long_files_are_found() {
    for (path, docs, found) in [
        ("src/pass/trace.rs", "Twin: `wgsl/pass/trace.wgsl`.", 0),
        ("src/pass/trace.rs", "Rays.", 1),
        ("src/pass/trace.rs", "Twin: `wgsl/pass/march.wgsl`.", 1),
        ("src/pass/rays.rs", "Rays.", 0),
        ("src/pass/rays.rs", "Twin: `wgsl/pass/trace.wgsl`.", 1),
        ("src/pass/rays.rs", "Twin: `wgsl/pass/rays.wgsl`.", 1),
    ] {
        let docs = format!("//! {docs}\n");
        assert_eq!(broken_twins(path, &docs).len(), found, "{path}: {docs}");
    }
    for lines in [MOST_LINES, MOST_LINES + 1] {
        let found = too_long("src/a.rs", &"\n".repeat(lines));
        assert_eq!(found.len(), lines - MOST_LINES);
    }
}

/// Marks of a page without a partner. Programs write tables between `<!-- name -->` and `<!-- /name -->`,
/// or `<!-- command: begin -->` and `<!-- command: end -->`.
fn lone_marks(text: &str) -> Vec<String> {
    let (mut lone, mut open) = (Vec::new(), None);
    for line in text.lines() {
        let Some(mark) = line
            .strip_prefix("<!-- ")
            .and_then(|m| m.strip_suffix(" -->"))
        else {
            continue;
        };
        let end = mark.strip_prefix('/').or(mark.strip_suffix(": end"));
        let begin = mark.strip_suffix(": begin").unwrap_or(mark);
        match (end, open.take()) {
            (Some(end), Some(begin)) if end == begin => {}
            // A remark.
            (None, None) if begin.contains(';') => {}
            (None, None) => open = Some(begin),
            (None, Some(other)) => {
                lone.push(other.to_string());
                open = Some(begin);
            }
            (Some(_), other) => {
                lone.extend([Some(mark), other].into_iter().flatten().map(String::from));
            }
        }
    }
    lone.extend(open.map(String::from));
    lone
}

#[test]
fn a_place_of_a_table_has_both_marks() {
    for (text, lone) in [
        ("<!-- a -->\n1\n<!-- /a -->", vec![]),
        ("<!-- a b: begin -->\n1\n<!-- a b: end -->", vec![]),
        ("<!-- Made by a program; do not edit. -->", vec![]),
        ("<!-- a -->\n<!-- b -->\n<!-- /b -->", vec!["a"]),
        ("<!-- /a -->", vec!["/a"]),
        ("<!-- a -->", vec!["a"]),
        ("<!-- a -->\n<!-- /b -->", vec!["/b", "a"]),
    ] {
        assert_eq!(lone_marks(text), lone, "{text}");
    }
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let pages = std::fs::read_dir(docs)
        .unwrap()
        .map(|page| page.unwrap().path());
    for page in pages.filter(|page| page.extension().is_some_and(|e| e == "md")) {
        let lone = lone_marks(&std::fs::read_to_string(&page).unwrap());
        assert!(lone.is_empty(), "{}: {lone:?}", page.display());
    }
}
