//! `conemarch conemap make|inspect|convert`

mod canvas;
mod common;
mod convert;
mod describe;
mod generate;
mod glyphs;
mod inspect;
mod make;
mod panels;
pub mod verb;
