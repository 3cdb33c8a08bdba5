//! Structs that both sides read have the same layout in Rust and in WGSL.

use std::collections::BTreeMap;
use std::mem::{offset_of, size_of};
use std::path::Path;

use conemarch::base::view::ViewUniform;
use conemarch::formula::balls::BallsUniform;
use conemarch::formula::mandelbox::MandelboxUniform;
use conemarch::formula::rotation::RotationUniform;
use conemarch::heightfield::conemap::generate::uniform::{
    GenerateUniform, MipUniform, NineUniform, PyramidUniform, Search, SlopesUniform,
};
use conemarch::heightfield::height_surface::ReliefUniform;
use conemarch::pass::look::LookUniform;
use conemarch::pass::march::LevelUniform;
use conemarch::pass::queue::{COUNT_AT, Turn};
use conemarch::scene::distance::DistanceUniform;
use conemarch::scene::heightfield::HeightfieldUniform;
use conemarch::scene::slab::SlabUniform;
use wgpu::naga::{AddressSpace, Module, TypeInner};

use super::files_below;
use super::programs::ALL;

/// The layout of a struct.
#[derive(Clone, Debug, PartialEq)]
struct Layout {
    /// Name, offset and size of each field, in order.
    fields: Vec<(String, usize, usize)>,
    /// Bytes of the struct.
    size: usize,
}

/// Size of the field that a function picks.
fn field_size<T, F>(_pick: fn(&T) -> &F) -> usize {
    size_of::<F>()
}

/// Makes the list of layouts out of the structs' names and fields.
macro_rules! layouts {
    ($($type:ident: $($field:ident)*;)*) => {
        vec![$((stringify!($type), Layout {
            fields: vec![$((
                stringify!($field).to_string(),
                offset_of!($type, $field),
                field_size(|t: &$type| &t.$field),
            )),*],
            size: size_of::<$type>(),
        })),*]
    };
}

/// Every `#[repr(C)]` struct of the sources. The numbers of [`Turn`] lead two WGSL structs
/// beside its own.
fn layouts() -> Vec<(&'static str, Layout)> {
    layouts! {
        Turn: chunk done limit row parent_width visits;
        ViewUniform: right pixel up slack forward pad size block_origin block_size pad2;
        MandelboxUniform: julia scale fold_limit min2 fixed2 bail2 reach tail classic_reach classic_skin;
        BallsUniform: ball0 ball1 ball2 box0 box1 rod;
        RotationUniform: row0 pad0 row1 pad1 row2 pad2;
        DistanceUniform: eye detail centre radius half far lipschitz shell relaxation stride
            iterations clip pad0 pad1;
        HeightfieldUniform: row_x texel row_y depth row_z far eye pad0 slack pad1;
        ReliefUniform: samples cells domain wrap places offset scale levels steps lod rounds starts;
        SlabUniform: eye half normal radius side far other pad;
        GenerateUniform: size wrap first rows rounds levels begins keeps aim steps offset top pad0
            pad1 at;
        Search: squared top note stage node_x node_y pending_low pending_high;
        PyramidUniform: below size below_at at first pad;
        MipUniform: below size below_at at pad0 pad1;
        NineUniform: width rows wrap channels;
        SlopesUniform: size wrap first rows pad0 pad1;
        LevelUniform: divisor fudge origin cells;
        LookUniform: light key light_color fill sky_high fog sky_low gloss world_up softness
            occlusion_reach occlusion_strength shadow_steps stops palette_cycles flag pad palette;
    }
}

/// The layouts of a module's structs, by name.
fn structs(module: &Module) -> Vec<(String, Layout)> {
    let mut found = Vec::new();
    for (_, kind) in module.types.iter() {
        if let (Some(name), TypeInner::Struct { members, span }) = (&kind.name, &kind.inner) {
            let fields = members.iter().map(|m| {
                let size = module.types[m.ty].inner.size(module.to_ctx());
                (m.name.clone().unwrap(), m.offset as usize, size as usize)
            });
            let (fields, size) = (fields.collect(), *span as usize);
            found.push((name.clone(), Layout { fields, size }));
        }
    }
    found
}

/// The layouts of all structs of all programs. A name may stand for different structs in
/// different scenes (`Walk`, say).
fn in_wgsl() -> BTreeMap<String, Vec<Layout>> {
    let mut all = BTreeMap::<String, Vec<Layout>>::new();
    for checked in ALL.values() {
        for (name, layout) in structs(checked.module.as_ref().unwrap()) {
            let known = all.entry(name).or_default();
            if !known.contains(&layout) {
                known.push(layout);
            }
        }
    }
    all
}

#[test]
fn structs_have_the_layout_that_the_shaders_read() {
    let wgsl = in_wgsl();
    for (name, own) in layouts() {
        let filled: usize = own.fields.iter().map(|f| f.2).sum();
        assert_eq!(
            filled, own.size,
            "{name}: a field is not listed, or there is a gap"
        );
        let found = wgsl
            .get(name)
            .unwrap_or_else(|| panic!("no program has a struct {name}"));
        let [wgsl] = &found[..] else {
            panic!("{name} has several layouts: {found:?}");
        };
        let led = if name == "Turn" {
            &truncated(wgsl, own.fields.len())
        } else {
            wgsl
        };
        assert_eq!(&own, led, "{name}");
        // The comparison sees a field that is moved, renamed, resized or lost.
        let spoil: [fn(&mut Layout); 4] = [
            |l| l.fields[1].1 += 4,
            |l| l.fields[0].0 = l.fields[1].0.clone(),
            |l| l.fields[1].2 += 4,
            |l| drop(l.fields.pop()),
        ];
        for spoil in spoil {
            let mut spoilt = own.clone();
            spoil(&mut spoilt);
            assert_ne!(&spoilt, led, "{name}");
        }
    }
}

/// The struct that a struct's first fields make.
fn truncated(layout: &Layout, fields: usize) -> Layout {
    Layout {
        size: layout.fields[fields].1,
        fields: layout.fields[..fields].to_vec(),
    }
}

#[test]
fn a_turn_leads_both_queues() {
    let wgsl = in_wgsl();
    let turn = &wgsl["Turn"][0];
    let count = turn.fields.len() - 1;
    let queue = &wgsl["Queue"][0].fields;
    assert_eq!(queue[..=count], turn.fields);
    assert_ne!(queue[1..=count], turn.fields[..count]);
    assert_eq!(turn.fields[count], ("count".into(), COUNT_AT as usize, 4));
    for name in ["Listed", "Queue"] {
        let (cells, at, _) = wgsl[name][0].fields.last().unwrap();
        assert_eq!(
            (cells.as_str(), *at as u64),
            ("cells", COUNT_AT + 4),
            "{name}"
        );
    }
}

#[test]
fn no_struct_that_both_sides_read_is_left_out() {
    let listed: Vec<&str> = layouts().into_iter().map(|l| l.0).collect();
    // In Rust: what is laid out for the device.
    let mut found = 0;
    for path in files_below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src")) {
        let text = std::fs::read_to_string(&path).unwrap();
        for part in text.split("#[repr(C)]").skip(1) {
            let after = part.split("pub struct ").nth(1).unwrap();
            let name = after.split([' ', '(', '<']).next().unwrap();
            assert!(listed.contains(&name), "{name} in {}", path.display());
            found += 1;
        }
    }
    assert_eq!(found, listed.len());
    // In WGSL: what is bound. The queues are only led by numbers of the host.
    let mut bound = 0;
    for (listing, checked) in ALL.iter() {
        let module = checked.module.as_ref().unwrap();
        for (_, global) in module.global_variables.iter() {
            let kind = &module.types[global.ty];
            let host = matches!(
                global.space,
                AddressSpace::Uniform | AddressSpace::Storage { .. }
            );
            if host && matches!(kind.inner, TypeInner::Struct { .. }) {
                let name = kind.name.as_deref().unwrap();
                let known = listed.contains(&name) || ["Queue", "Listed"].contains(&name);
                assert!(known, "no Rust struct for {name} in {listing}");
                bound += 1;
            }
        }
    }
    assert!(bound > ALL.len(), "only {bound} bound structs");
}
