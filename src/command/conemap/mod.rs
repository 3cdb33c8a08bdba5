//! `conemarch conemap make|inspect|convert`

mod convert;
mod describe;
mod inspect;
mod make;
mod maker;
mod options;
mod panels;
mod sheet;
pub mod verb;
