//! Structs that both sides read have the same layout in Rust and in WGSL.

use std::collections::BTreeMap;
use std::mem::{offset_of, size_of};

use conemarch::base::view::ViewUniform;
use conemarch::formula::balls::BallsUniform;
use conemarch::formula::mandelbox::MandelboxUniform;
use conemarch::formula::rotation::RotationUniform;
use conemarch::heightfield::conemap::generate::uniform::{
    GenerateUniform, Min3x3Uniform, PyramidUniform, SearchState,
};
use conemarch::heightfield::height_surface::HeightmapUniform;
use conemarch::pass::look::LookUniform;
use conemarch::pass::turn::{ListsHead, Stage, Turn};
use conemarch::scene::distance::DistanceUniform;
use conemarch::scene::heightfield::HeightfieldUniform;
use conemarch::scene::slab::SlabUniform;
use wgpu::naga::{StructMember, TypeInner};

use super::common::files::files_below;
use super::programs::ALL;

/// Name, offset and size of each field of a struct; last the end of the struct.
type Layout = Vec<(String, usize, usize)>;

/// The end of a struct as a field of its layout.
fn end(size: usize) -> (String, usize, usize) {
    ("its end".into(), size, 0)
}

/// Size of the field that a function picks.
fn field_size<T, F>(_pick: fn(&T) -> &F) -> usize {
    size_of::<F>()
}

/// Makes the list of layouts out of the structs' names and fields.
macro_rules! layouts {
    ($($type:ident: $($field:ident)*;)*) => {
        vec![$((stringify!($type), vec![
            $((
                stringify!($field).into(),
                offset_of!($type, $field),
                field_size(|t: &$type| &t.$field),
            ),)*
            end(size_of::<$type>()),
        ])),*]
    };
}

/// Every `#[repr(C)]` struct of the sources.
fn layouts() -> Vec<(&'static str, Layout)> {
    layouts! {
        Stage: number limit chunk most slice tiles parent_width divisor origin cells fudge index
            queues listed parents parent_front front state tally mark pad;
        Turn: stage number begun chunk done first groups visits count read filled dispatches pad;
        ListsHead: moving parents wrong pad dispatches;
        ViewUniform: right pixel up slack forward pad size pad2;
        MandelboxUniform: julia scale fold_limit min2 fixed2 bail2 reach tail classic_reach classic_skin;
        BallsUniform: ball0 ball1 ball2 box0 box1 rod;
        RotationUniform: row0 pad0 row1 pad1 row2 pad2;
        DistanceUniform: eye detail centre radius half far lipschitz shell relaxation stride
            iterations clip pad0 pad1;
        HeightfieldUniform: row_x texel row_y depth row_z far eye pad0 slack pad1;
        HeightmapUniform: samples cells domain wrap places offset scale levels steps lod rounds starts;
        SlabUniform: eye half normal radius side far other pad;
        GenerateUniform: size wrap first rows rounds levels begins keeps sector steps offset top pad0
            pad1 at;
        SearchState: squared top note stage node_x node_y pending_low pending_high;
        PyramidUniform: below size below_at at first pad;
        Min3x3Uniform: width rows wrap channels;
        LookUniform: light key light_color fill sky_high fog sky_low gloss world_up softness
            occlusion_reach occlusion_strength shadow_steps stops palette_cycles flag pad palette;
    }
}

/// The layouts of all structs of all programs. A name may stand for different structs in
/// different scenes (`Walk`, say).
fn in_wgsl() -> BTreeMap<String, Vec<Layout>> {
    let mut all = BTreeMap::<String, Vec<Layout>>::new();
    for module in ALL.values().map(|made| &made.module) {
        for (_, kind) in module.types.iter() {
            let (Some(name), TypeInner::Struct { members, span }) = (&kind.name, &kind.inner)
            else {
                continue;
            };
            let field = |m: &StructMember| {
                let size = module.types[m.ty].inner.size(module.to_ctx());
                (m.name.clone().unwrap(), m.offset as usize, size as usize)
            };
            let mut layout: Layout = members.iter().map(field).collect();
            layout.push(end(*span as usize));
            let known = all.entry(name.clone()).or_default();
            if !known.contains(&layout) {
                known.push(layout);
            }
        }
    }
    all
}

#[test]
fn structs_have_the_layout_that_the_shaders_read() {
    let all = in_wgsl();
    for (name, own) in layouts() {
        let full = own.windows(2).all(|f| f[0].1 + f[0].2 == f[1].1);
        assert!(full, "{name}: a field is not listed, or there is a gap");
        // The head of the lists is the part of `Lists` before the cells.
        let lists = name == "ListsHead";
        let [wgsl] = &all[if lists { "Lists" } else { name }][..] else {
            panic!("{name} has several layouts: {:?}", all[name]);
        };
        let mut wgsl = wgsl.clone();
        if lists {
            assert_eq!(
                wgsl[own.len() - 1],
                ("cells".into(), size_of::<ListsHead>(), 4)
            );
            wgsl.truncate(own.len() - 1);
            wgsl.push(end(size_of::<ListsHead>()));
        }
        assert_eq!(own, wgsl, "{name}");
        // The comparison sees a field that is moved, renamed, resized or lost.
        let spoil: [fn(&mut Layout); 4] = [
            |l| l[1].1 += 4,
            |l| l[0].0 = l[1].0.clone(),
            |l| l[1].2 += 4,
            |l| drop(l.remove(1)),
        ];
        for spoil in spoil {
            let mut spoilt = own.clone();
            spoil(&mut spoilt);
            assert_ne!(spoilt, wgsl, "{name}");
        }
    }
}

#[test]
fn no_struct_that_both_sides_read_is_left_out() {
    let listed: Vec<&str> = layouts().into_iter().map(|l| l.0).collect();
    // In Rust: what is laid out for the device.
    let mut found = 0;
    for (path, text) in files_below("src") {
        for part in text.split("#[repr(C)]").skip(1) {
            let after = part.split("pub struct ").nth(1).unwrap();
            let name = after.split([' ', '(', '<']).next().unwrap();
            assert!(
                listed.contains(&name),
                "{name} in {path}; add it to `layouts!` here"
            );
            found += 1;
        }
    }
    assert_eq!(found, listed.len());
    // In WGSL: what is bound. Numbers of the host are only the head of the lists.
    let mut bound = 0;
    for (listing, made) in ALL.iter() {
        for (_, global) in made.module.global_variables.iter() {
            let kind = &made.module.types[global.ty];
            if global.binding.is_some() && matches!(kind.inner, TypeInner::Struct { .. }) {
                let name = kind.name.as_deref().unwrap();
                let known = listed.contains(&name) || name == "Lists";
                assert!(known, "no Rust struct for {name} in {listing}");
                bound += 1;
            }
        }
    }
    assert!(bound > ALL.len(), "only {bound} bound structs");
}
