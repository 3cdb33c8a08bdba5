//! The layout of structs that both sides read: of a Rust struct by its fields, and of
//! the WGSL struct of the same name by naga.

use conemarch::base::shader::Program;
use wgpu::naga;
use wgpu::naga::valid::Capabilities;

/// Name, offset and size of each field, and the size of the whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Fields in order.
    pub fields: Vec<(String, usize, usize)>,
    /// Bytes of the struct.
    pub size: usize,
}

/// Size of the field that a function picks.
pub fn field_size<T, F>(_pick: fn(&T) -> &F) -> usize {
    std::mem::size_of::<F>()
}

/// The layout of a Rust struct, its fields listed.
macro_rules! layout {
    ($type:ident { $($field:ident),* $(,)? }) => {
        (stringify!($type), $crate::common::layout::Layout {
            fields: vec![$((
                stringify!($field).to_string(),
                std::mem::offset_of!($type, $field),
                $crate::common::layout::field_size(|t: &$type| &t.$field),
            )),*],
            size: std::mem::size_of::<$type>(),
        })
    };
}
pub(crate) use layout;

impl Layout {
    /// The layout that naga gives a struct of a program, if the program has it.
    pub fn in_wgsl(program: &Program, name: &str) -> Option<Self> {
        if !program.source().contains(&format!("struct {name} {{")) {
            return None;
        }
        let valid = program.validate(Capabilities::default());
        let (module, _) = valid.unwrap_or_else(|e| panic!("{e}"));
        let mut types = module.types.iter();
        let (_, found) = types.find(|(_, t)| t.name.as_deref() == Some(name))?;
        let naga::TypeInner::Struct { members, span } = &found.inner else {
            return None;
        };
        let field = |m: &naga::StructMember| {
            let size = module.types[m.ty].inner.size(module.to_ctx()) as usize;
            (m.name.clone().unwrap_or_default(), m.offset as usize, size)
        };
        Some(Self {
            fields: members.iter().map(field).collect(),
            size: *span as usize,
        })
    }

    /// Whether the listed fields fill the struct: none is left out.
    pub fn complete(&self) -> bool {
        self.fields.iter().map(|f| f.2).sum::<usize>() == self.size
    }
}
