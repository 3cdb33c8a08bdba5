//! Every program that can be made is valid WGSL, in f32 and in f64, and sets exactly the
//! constants that it declares. Faults are reported by file and line, no shader file is
//! unused, and a feature that a plan lacks is not in its programs. Needs no adapter.
#![cfg(feature = "preview")]
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test may panic, and is read by its name"
)]

#[path = "../common"]
#[allow(dead_code, reason = "other crates use the rest")]
mod common {
    pub mod files;
    pub mod plans;
    pub mod programs;
}
mod explain;
mod layouts;
mod programs;

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use common::files::files_below;
use common::plans::{preset, program, solid};
use common::programs::in_f64;
use conemarch::base::shader::{Module, Program, ShaderError};
use conemarch::heightfield::texture::Texture;
use conemarch::plan::{Extras, Pass};
use conemarch::preview::draw;
use programs::{ALL, Made};
use rayon::prelude::*;
use wgpu::naga::valid::Capabilities;

/// A program known to be good, for tests that break a copy of it.
fn good() -> Program {
    let plan = preset("mandelbox", &[]);
    program(&plan, &solid(&plan), Pass::Trace, Extras::default())
}

fn has(program: &Program, path: &str) -> bool {
    program.modules.iter().any(|m| m.path == path)
}

#[test]
fn every_program_is_valid_in_f32_and_sets_its_constants() {
    // `ALL` panics for a program that is not valid.
    //
    // Three entries, two cone rules, ten scenes, eight looks: a small number would mean that
    // the list has lost something.
    assert!(ALL.len() > 150, "only {} programs", ALL.len());
}

#[test]
fn every_program_with_real_numbers_is_valid_in_f64() {
    let (real, other): (Vec<_>, Vec<_>) = (ALL.iter())
        .map(|(listing, made)| (listing, &made.program))
        .partition(|(_, program)| has(program, "wgsl/base/real.wgsl"));
    assert!(real.len() > 100, "only {} programs in f64", real.len());
    for (listing, program) in other {
        assert_eq!(&in_f64(program), program, "{listing}");
    }
    real.par_iter().for_each(|(listing, program)| {
        let wide = in_f64(program);
        assert!(!has(&wide, "wgsl/base/real.wgsl") && has(&wide, "wgsl/base/real64.wgsl"));
        let result = wide.validate(Capabilities::FLOAT64);
        assert!(result.is_ok(), "{}\n{listing}", result.unwrap_err());
    });
    // Without the capability f64 is refused: the text has really changed.
    let (_, first) = real[0];
    assert!(in_f64(first).validate(Capabilities::default()).is_err());
}

#[test]
fn no_name_is_given_a_constant_twice() {
    for (listing, made) in ALL.iter() {
        let constants = made.program.constants();
        let different: BTreeSet<_> = constants.iter().map(|c| c.0).collect();
        assert_eq!(different.len(), constants.len(), "{listing}");
    }
}

#[test]
fn a_missing_and_an_unknown_constant_are_errors() {
    let mut missing = good();
    let mut modules = missing.modules.iter_mut();
    let module = modules.find(|m| !m.constants.is_empty()).unwrap();
    let (gone, _) = module.constants.remove(0);
    let mut unknown = good();
    unknown.modules[0].constants.push(("NOBODY_ASKED", 1.0));
    for (program, name, wanted) in [
        (missing, gone, "a value"),
        (unknown, "NOBODY_ASKED", "is missing"),
    ] {
        let error = program.validate(Capabilities::default()).unwrap_err();
        let said = error.to_string();
        let ShaderError::Text { path, line, .. } = error;
        let text = program.modules.iter().find(|m| m.path == path).unwrap();
        let declares = text.source.lines().nth(line - 1).unwrap().contains(name);
        assert!(declares || name != gone, "{said}");
        assert!(
            said.contains(&format!("`{name}`")) && said.contains(wanted),
            "{said}"
        );
    }
}

const PATH: &str = "tests/broken.wgsl";

/// Texts with one fault each, and the lines that may be named for it. Parsing knows the
/// line; validation, which works on whole functions, may name any from the function's
/// first.
const BROKEN: &[(&str, RangeInclusive<usize>)] = &[
    // A syntax error.
    ("// one\n// two\nfn broken( {\n}\n", 3..=3),
    // A name that nothing declares.
    ("fn broken() -> f32 {\n    return nowhere;\n}\n", 2..=2),
    // An assignment to a value.
    (
        "\n\nfn broken() {\n    let a = 1.0;\n    a = 2.0;\n}\n",
        5..=5,
    ),
    // A type that does not fit, which only validation finds.
    (
        "\nfn broken() -> f32 {\n    let a = 1u;\n    return a;\n}\n\n",
        2..=4,
    ),
];

#[test]
fn a_fault_points_to_its_file_and_line_wherever_the_module_is_joined() {
    for (source, expected) in BROKEN {
        for at in [0, 3, good().modules.len()] {
            let mut program = good();
            let module = Module {
                path: PATH,
                source: (*source).into(),
                constants: Vec::new(),
                replaces: None,
            };
            program.modules.insert(at, module);
            let error = program.validate(Capabilities::default()).unwrap_err();
            let shown = error.to_string();
            let ShaderError::Text { path, line, .. } = error;
            assert_eq!(path, PATH, "{shown}");
            assert!(expected.contains(&line), "{shown}");
            assert!(shown.starts_with(&format!("{PATH}:{line}: ")), "{shown}");
        }
    }
}

#[test]
fn every_line_of_a_joined_text_is_located_in_its_file() {
    let program = good();
    let source = program.source();
    let mut expected = Vec::new();
    for module in &program.modules {
        for (i, text) in module.source.lines().enumerate() {
            expected.push((module.path, i + 1, text));
        }
    }
    assert_eq!(source.lines().count(), expected.len());
    for (i, (text, want)) in source.lines().zip(&expected).enumerate() {
        let (path, line) = program.locate(i + 1);
        assert_eq!((path, line, text), *want);
    }
}

#[test]
fn every_file_of_shaders_is_joined_by_some_program() {
    // A texture is in a program only where a preset names a picture, and the window draws alone.
    let mut joined = BTreeSet::from([Texture::module().path, draw::module().path]);
    for made in ALL.values() {
        let wide = in_f64(&made.program);
        joined.extend(
            made.program
                .modules
                .iter()
                .chain(&wide.modules)
                .map(|m| m.path),
        );
    }
    let found = files_below("wgsl");
    for (path, text) in &found {
        assert!(joined.contains(path.as_str()), "no program joins {path}");
        // Joining is concatenation: a last line without its end would run on.
        assert!(text.ends_with('\n'), "{path} does not end its last line");
        assert!(text.starts_with("// "), "{path} does not say what it is");
    }
    assert_eq!(joined.len(), found.len());
}

#[test]
fn no_program_binds_more_buffers_than_webgpu_promises() {
    let quads = [
        "scene.field=fbm:16x16",
        "scene.tracer=quad",
        "scene.paint=exact",
    ];
    let quads = preset("terrain", &quads);
    let quads = programs::programs_of(&quads, &solid(&quads));
    let quads = quads.into_iter().map(|program| Made::new(program).buffers);
    let all = ALL.values().map(|made| made.buffers).chain(quads);
    let promised = wgpu::Limits::default().max_storage_buffers_per_shader_stage;
    assert_eq!(all.max(), Some(promised as usize));
}
