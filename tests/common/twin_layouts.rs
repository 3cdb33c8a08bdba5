//! Structs of parameters have the layout that the shaders read.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

use super::layout::{Layout, layout};
use super::plans::every_program;
use conemarch::base::shader::Program;
use conemarch::base::view::ViewUniform;
use conemarch::formula::balls::BallsUniform;
use conemarch::formula::mandelbox::MandelboxUniform;
use conemarch::formula::rotation::RotationUniform;
use conemarch::heightfield::conemap::generate::uniform::{
    GenerateUniform, Min3x3Uniform, PyramidUniform, SearchState,
};
use conemarch::heightfield::height_surface::ReliefUniform;
use conemarch::pass::look::LookUniform;
use conemarch::pass::march::LevelUniform;
use conemarch::pass::queue::{COUNT_AT, Turn};
use conemarch::scene::distance::DistanceUniform;
use conemarch::scene::heightfield::HeightfieldUniform;
use conemarch::scene::slab::SlabUniform;

/// Every struct of parameters, as Rust lays it out.
fn layouts() -> Vec<(&'static str, Layout)> {
    vec![
        layout!(ViewUniform {
            right,
            pixel,
            up,
            slack,
            forward,
            pad,
            size,
            block_origin,
            block_size,
            pad2
        }),
        layout!(MandelboxUniform {
            julia,
            scale,
            fold_limit,
            min2,
            fixed2,
            bail2,
            reach,
            tail,
            classic_reach,
            classic_skin
        }),
        layout!(BallsUniform {
            ball0,
            ball1,
            ball2,
            box0,
            box1,
            rod
        }),
        layout!(RotationUniform {
            row0,
            pad0,
            row1,
            pad1,
            row2,
            pad2
        }),
        layout!(DistanceUniform {
            eye,
            detail,
            centre,
            radius,
            half,
            far,
            lipschitz,
            shell,
            relaxation,
            stride,
            iterations,
            clip,
            pad0,
            pad1
        }),
        layout!(HeightfieldUniform {
            row_x,
            texel,
            row_y,
            depth,
            row_z,
            far,
            eye,
            pad0,
            slack,
            pad1
        }),
        layout!(ReliefUniform {
            samples,
            cells,
            domain,
            wrap,
            places,
            offset,
            scale,
            levels,
            steps,
            lod,
            rounds,
            starts
        }),
        layout!(SlabUniform {
            eye,
            half,
            normal,
            radius,
            side,
            far,
            other,
            pad
        }),
        layout!(GenerateUniform {
            size,
            wrap,
            first,
            rows,
            rounds,
            levels,
            begins,
            keeps,
            sector,
            steps,
            offset,
            top,
            pad0,
            pad1,
            at
        }),
        layout!(SearchState {
            squared,
            top,
            note,
            stage,
            node_x,
            node_y,
            pending_low,
            pending_high
        }),
        layout!(PyramidUniform {
            below,
            size,
            below_at,
            at,
            first,
            pad
        }),
        layout!(Min3x3Uniform {
            width,
            rows,
            wrap,
            channels
        }),
        layout!(LevelUniform {
            divisor,
            fudge,
            origin,
            cells
        }),
        layout!(LookUniform {
            light,
            key,
            light_color,
            fill,
            sky_high,
            fog,
            sky_low,
            gloss,
            world_up,
            softness,
            occlusion_reach,
            occlusion_strength,
            shadow_steps,
            stops,
            palette_cycles,
            flag,
            pad,
            palette
        }),
    ]
}

/// The layout of a WGSL struct in the first program that has it.
fn in_any_program(name: &str) -> Layout {
    static PROGRAMS: LazyLock<BTreeMap<String, Program>> = LazyLock::new(every_program);
    let found = PROGRAMS.values().find_map(|p| Layout::in_wgsl(p, name));
    found.unwrap_or_else(|| panic!("no program has a struct {name}"))
}

#[test]
fn structs_have_the_layout_that_the_shaders_read() {
    for (name, own) in layouts() {
        assert!(
            own.complete(),
            "{name}: a field is not listed, or there is a gap"
        );
        let wgsl = in_any_program(name);
        assert_eq!(own, wgsl, "{name}");
        // The same comparison sees a field that is moved, renamed, resized or lost.
        let mut shifted = own.clone();
        shifted.fields[1].1 += 4;
        assert_ne!(shifted, wgsl, "{name}");
        let mut swapped = own.clone();
        let (first, second) = (own.fields[0].0.clone(), own.fields[1].0.clone());
        swapped.fields[0].0 = second;
        swapped.fields[1].0 = first;
        assert_ne!(swapped, wgsl, "{name}");
        let mut lost = own.clone();
        lost.fields.pop();
        assert_ne!(lost, wgsl, "{name}");
        assert!(!lost.complete());
    }
}

#[test]
fn a_turn_leads_both_queues() {
    let (_, turn) = layout!(Turn {
        chunk,
        done,
        limit,
        row,
        parent_width,
        visits
    });
    assert!(turn.complete());
    for name in ["Turn", "Queue"] {
        let queue = in_any_program(name);
        let led = turn.fields.len();
        assert_eq!(queue.fields[..led], turn.fields, "{name}");
        let count = &queue.fields[led];
        assert_eq!(
            (count.0.as_str(), count.1 as u64),
            ("count", COUNT_AT),
            "{name}"
        );
        assert_ne!(queue.fields[1..led], turn.fields[..led - 1]);
    }
    for name in ["Listed", "Queue"] {
        let cells = in_any_program(name).fields.pop().unwrap();
        let at = (cells.0.as_str(), cells.1 as u64);
        assert_eq!(at, ("cells", COUNT_AT + 4), "{name}");
    }
}

#[test]
fn no_struct_of_parameters_is_left_out() {
    let listed: Vec<&str> = layouts().into_iter().map(|l| l.0).chain(["Turn"]).collect();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src")];
    let mut found = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            for part in text.split("#[repr(C)]").skip(1) {
                let after = part.split("pub struct ").nth(1).unwrap();
                let name = after.split([' ', '(', '<']).next().unwrap();
                assert!(listed.contains(&name), "{name} in {}", path.display());
                found += 1;
            }
        }
    }
    assert_eq!(found, listed.len());
}
