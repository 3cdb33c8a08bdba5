//! Cone maps in files: what the papers' layouts hold and how, rounded to the safe side,
//! with a label that says what the map is and for which heights.

mod decode;
mod encode;
mod error;
mod fit;
mod form;
mod label;
mod round;
mod slopes;
mod words;

pub use decode::{Foreign, decode, decode_bytes, has_map, read_map};
pub use encode::encode;
pub use error::MapError;
pub use fit::Wanted;
pub use form::{Bits, Extra, Form, Label, Layout, MapFile, Slopes, digest};
pub use round::{Ratios, Steps, narrowed};
pub use words::{is_walk, kind_named, kind_word, promise, wrap_word};
