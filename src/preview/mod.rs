//! The preview: a window in which a scene is flown through, tuned and timed.
//!
//! The window runs the passes of `render`. Only this room knows a window.
//!
//! - [`window`]: how it opens, and the loop of its events
//! - `live`: the open window and its turns; `actions`: what events do to it; `gui`: what lies over
//!   the picture; `upkeep`: files, unsaved work and lost devices
//! - `input`: what keys and drags mean; `command`: the command line of a picture
//! - [`document`]: the plan that is edited, its history and its file; `keep`: unsaved work;
//!   `leaving`: what may be dropped;
//!   `reload`: files that change
//! - [`flight`]: how the camera moves; [`probe`]: what the CPU can tell about the scene at once;
//!   `question`: what there is at a pixel
//! - [`pictures`], each a `picture`: small ones at once, full ones at rest; `still`: one for a file;
//!   `views`: what of them is shown; `screen`: the window's surface, [`draw`]: its
//!   pipelines
//! - `panel`: the keys of the plan; [`play`], `film` and `timeline`: the film; `overlay`: times, notices
//!   and help; `notice`: what is told, and how long
//! - [`meter`]: how quickly the window answers; [`error`]: why a preview cannot go on

mod actions;
mod command;
pub mod document;
pub mod draw;
pub mod error;
mod film;
pub mod flight;
mod gui;
mod input;
mod keep;
mod leaving;
mod live;
pub mod meter;
mod notice;
mod overlay;
mod panel;
mod picture;
pub mod pictures;
pub mod play;
pub mod probe;
mod question;
mod reload;
pub mod screen;
mod still;
mod timeline;
mod upkeep;
mod views;
pub mod window;
