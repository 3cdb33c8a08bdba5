//! Structs that both sides read have the same layout in Rust and in WGSL.

use std::collections::BTreeMap;
use std::mem::{offset_of, size_of};
use std::sync::LazyLock;

use conemarch::pass::look::LookUniform;
use conemarch::pass::turn::Turn;
use conemarch::plan::look::MOST_STOPS;
use conemarch::preview::draw;
use glam::{IVec2, IVec3, IVec4, UVec2, UVec3, UVec4, Vec2, Vec3, Vec4};
use naga::front::wgsl::parse_str;
use wgpu::naga::{StructMember, TypeInner};

use super::common::files::files_below;
use super::programs::ALL;

/// Name, offset and size of each field of a struct; last the end of the struct.
type Layout = Vec<(String, usize, usize)>;

/// The end of a struct as a field of its layout.
fn end(size: usize) -> (String, usize, usize) {
    ("its end".into(), size, 0)
}

/// Names and sizes of types.
macro_rules! sizes {
    ($($type:ident)*) => { [$((stringify!($type), size_of::<$type>())),*] };
}

/// The types that fields can have, beside arrays and other structs.
const SIZES: &[(&str, usize)] =
    &sizes![f32 i32 u32 Vec2 Vec3 Vec4 IVec2 IVec3 IVec4 UVec2 UVec3 UVec4];

/// The size of a type, or the value of a constant.
fn size(of: &str, text: &str) -> usize {
    let array = of.strip_prefix('[').and_then(|of| of.strip_suffix(']'));
    if let Some((one, n)) = array.and_then(|of| of.rsplit_once("; ")) {
        return size(one, text) * size(n, text);
    }
    let constant = || text.split_once(&format!("const {of}: usize = "));
    let known = SIZES.iter().find(|(name, _)| *name == of).map(|s| s.1);
    let known = known.or_else(|| of.parse().ok());
    let known = known.or_else(|| constant()?.1.split(';').next()?.parse().ok());
    known.unwrap_or_else(|| layout(of, text).last().unwrap().1)
}

/// The layout of a struct, read from its text. There are no gaps between its fields, as `Pod`
/// refuses them when it is compiled.
fn layout(name: &str, text: &str) -> Layout {
    let start = format!("pub struct {name} {{\n");
    let found = text.split_once(&start).and_then(|t| t.1.split_once("\n}"));
    let (body, _) = found.unwrap_or_else(|| panic!("no struct {name}, and no such type"));
    let mut at = 0;
    let mut all = Layout::new();
    for line in body
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
    {
        let field = line.trim().trim_start_matches("pub ").strip_suffix(',');
        let field = field.and_then(|field| field.split_once(": "));
        let (field, kind) = field.unwrap_or_else(|| panic!("{name}: `{line}` is no field"));
        all.push((field.into(), at, size(kind, text)));
        at += all[all.len() - 1].2;
    }
    all.push(end(at));
    all
}

/// Every `#[repr(C)]` struct of the sources.
static IN_RUST: LazyLock<BTreeMap<String, Layout>> = LazyLock::new(|| {
    let text: String = files_below("src").into_iter().map(|file| file.1).collect();
    let mut all = BTreeMap::new();
    for part in text.split("#[repr(C)]\n").skip(1) {
        let (derived, rest) = part.split_once("pub struct ").unwrap();
        let name = rest.split(' ').next().unwrap();
        assert!(derived.contains("Pod"), "{name} may have gaps");
        let twice = all.insert(name.to_string(), layout(name, &text));
        assert!(twice.is_none(), "there are two structs {name}");
    }
    all
});

/// The layouts of all structs of all programs. A name may stand for different structs in
/// different scenes (`Walk`, say).
fn in_wgsl() -> BTreeMap<String, Vec<Layout>> {
    let mut all = BTreeMap::<String, Vec<Layout>>::new();
    let window = parse_str(&draw::module().source).unwrap();
    let programs = ALL.values().map(|made| &made.module);
    for module in programs.chain([&window]) {
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
fn the_text_of_a_struct_has_the_layout_that_is_compiled() {
    let palette = offset_of!(LookUniform, palette);
    let palette = ("palette".into(), palette, 16 * MOST_STOPS);
    assert!(IN_RUST["LookUniform"].contains(&palette));
    let number = ("number".into(), offset_of!(Turn, number), 4);
    assert_eq!(IN_RUST["Turn"][1], number);
    for (name, size) in sizes![LookUniform Turn] {
        assert_eq!(*IN_RUST[name].last().unwrap(), end(size));
    }
}

#[test]
fn structs_have_the_layout_that_the_shaders_read() {
    let all = in_wgsl();
    for (name, own) in &*IN_RUST {
        // The head of the cells is the part of `Cells` before the words.
        let lists = name == "CellsHead";
        let of = if lists { "Cells" } else { name };
        let Some([wgsl]) = all.get(of).map(|found| &found[..]) else {
            panic!("{name} has not one layout: {:?}", all.get(of));
        };
        let mut wgsl = wgsl.clone();
        if lists {
            let cells = ("words".into(), own[own.len() - 1].1, 4);
            assert_eq!(wgsl[own.len() - 1], cells);
            wgsl.truncate(own.len() - 1);
            wgsl.push(end(cells.1));
        }
        assert_eq!(*own, wgsl, "{name}");
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
fn no_struct_that_a_shader_binds_is_left_out() {
    // Numbers of the host are only the head of the lists.
    let mut bound = 0;
    for (listing, made) in ALL.iter() {
        for (_, global) in made.module.global_variables.iter() {
            let kind = &made.module.types[global.ty];
            if global.binding.is_some() && matches!(kind.inner, TypeInner::Struct { .. }) {
                let name = kind.name.as_deref().unwrap();
                let known = IN_RUST.contains_key(name) || name == "Cells";
                assert!(known, "no Rust struct for {name} in {listing}");
                bound += 1;
            }
        }
    }
    assert!(bound > ALL.len(), "only {bound} bound structs");
}
