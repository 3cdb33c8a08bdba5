//! `conemarch bench`: the time that pictures take, and their errors.
//!
//! - [`error`]: run time against error, with [`setting`], what is measured, and [`row`]
//! - [`steps`]: the work of every pass, with [`steps_row`]
//! - [`cones`]: cone maps and tracers of heightfields, with [`cone_rows`]
//! - [`calibrate`]: the fastest settings for a share of lost pixels
//! - [`common`]: the options of measurements; [`runner`]: their renders
//! - [`files`]: rows as files; [`table`]: as tables; [`plot`]: as a picture
//! - `flight`: how quickly a preview answers, without its window

use clap::Subcommand;

pub mod calibrate;
pub mod common;
pub mod cone_rows;
pub mod cones;
pub mod error;
pub mod files;
#[cfg(feature = "preview")]
pub mod flight;
pub mod plot;
pub mod row;
pub mod runner;
pub mod setting;
pub mod steps;
pub mod steps_row;
pub mod table;

/// What to measure.
#[derive(Debug, Subcommand)]
pub enum Bench {
    /// Time and error of every mode, compared with a slow reference, the truth
    Error(error::ErrorBench),
    /// Work of every pass: evaluations, iterations, and time lost while rays wait for others
    ///
    /// An evaluation computes once how far a point is from the surface. For a fractal it takes several
    /// iterations of the formula. A cone contains the rays of a block of pixels. Cones move forward
    /// first, and rays start where they stop.
    Steps(steps::StepsBench),
    /// Cone maps and tracers of heightfields: time, width, steps, missed hits
    ///
    /// A heightfield is the surface over a height map. A cone map stores, for each place of it, how
    /// wide a cone above that place stays empty. A tracer finds where a ray hits the surface, mostly by
    /// means of a cone map.
    Cones(cones::ConesBench),
    /// Propose values of scene.lipschitz, march.shell and march.fudge for mode calibrated
    ///
    /// They get at most a given share of the pixels wrong. The command also says whether they are
    /// faster than mode safe.
    Calibrate(calibrate::CalibrateBench),
    /// How quickly a preview answers, without its window
    #[cfg(feature = "preview")]
    Flight(flight::FlightBench),
}
