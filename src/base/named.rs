//! Enums whose variants are chosen by a word, each listed once.

/// Declares an enum from one list of variants and their words, with `ALL`, `WORDS`, `name` and
/// `named`. Files hold a variant as its word.
///
/// If a type follows the enum's name, each variant also has a value of that type, which
/// `facts` returns.
macro_rules! named_enum {
    (
        $(#[$meta:meta])*
        pub enum $type:ident: $facts:ty {
            $($(#[$doc:meta])* $variant:ident = $name:literal => $fact:expr),* $(,)?
        }
    ) => {
        $crate::base::named::named_enum! {
            $(#[$meta])*
            pub enum $type { $($(#[$doc])* $variant = $name),* }
        }

        impl $type {
            /// What is particular to the variant.
            pub fn facts(self) -> $facts {
                match self { $(Self::$variant => $fact),* }
            }
        }
    };
    (
        $(#[$meta:meta])*
        pub enum $type:ident {
            $($(#[$doc:meta])* $variant:ident = $name:literal),* $(,)?
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
        pub enum $type {
            $($(#[$doc])* #[serde(rename = $name)] $variant),*
        }

        impl $type {
            /// Every variant, in the order of the list.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$variant),*];

            /// Every variant with the word that chooses it.
            pub const WORDS: [(&'static str, Self); [$($name),*].len()] =
                [$(($name, Self::$variant)),*];

            /// The word that chooses the variant.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }

            /// The variant that a word chooses.
            pub fn named(name: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|variant| variant.name() == name)
            }
        }
    };
}

pub(crate) use named_enum;
