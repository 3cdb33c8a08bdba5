//! The list of formulas.

pub mod balls;
mod contract;
pub mod mandelbox;
pub mod rotation;

pub use contract::{Bounds, Formula};

/// Makes the enum of all formulas out of one list: module and type of each.
macro_rules! formulas {
    ($($module:ident :: $type:ident),* $(,)?) => {
        /// One of the built-in formulas with its parameters.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Shape {
            $(#[doc = concat!("See [`", stringify!($module), "`].")] $type($module::$type)),*
        }

        impl Shape {
            /// Every formula with its default parameters.
            pub fn all() -> Vec<Shape> {
                vec![$(Shape::$type($module::$type::default())),*]
            }
        }

        impl std::ops::Deref for Shape {
            type Target = dyn Formula + Send + Sync;
            fn deref(&self) -> &Self::Target {
                match self { $(Shape::$type(f) => f),* }
            }
        }

        impl std::ops::DerefMut for Shape {
            fn deref_mut(&mut self) -> &mut Self::Target {
                match self { $(Shape::$type(f) => f),* }
            }
        }
    };
}

formulas![mandelbox::Mandelbox, balls::Balls];

impl Shape {
    /// The formula of a name, with its default parameters.
    pub fn named(name: &str) -> Option<Shape> {
        Self::all().into_iter().find(|f| f.name() == name)
    }
}
