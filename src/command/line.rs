//! The command line as a whole: its verbs, its exit codes, and every error as one sentence.

use std::panic::{AssertUnwindSafe, catch_unwind, set_hook};
use std::process::ExitCode;
use std::sync::Mutex;

use anyhow::Result;
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};

use crate::command::bench::Bench;
use crate::command::conemap::ConeMapVerb;
#[cfg(feature = "preview")]
use crate::command::preview;
use crate::command::print::say;
use crate::command::{
    animate, bench, completions, conemap, devices, failure, merge, presets, render,
};

/// Renders fractals and height maps by multi-pass cone marching.
///
/// Exit codes: 0 done, 1 failed, 2 wrong usage, 130 and 143 after SIGINT and SIGTERM.
#[derive(Debug, Parser)]
#[command(name = "conemarch", version, about)]
pub struct Line {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Render a preset to a picture
    Render(Box<render::Render>),
    /// Join the parts of a picture that `render --tile` wrote
    Merge(merge::Merge),
    /// Fly through a scene and tune it in a window
    #[cfg(feature = "preview")]
    Preview(preview::Preview),
    /// Render the frames of a film
    Animate(Box<animate::Animate>),
    /// Measure time and error
    #[command(subcommand)]
    Bench(Bench),
    /// Make, inspect and convert cone maps of height maps
    #[command(name = "conemap", subcommand)]
    ConeMap(ConeMapVerb),
    /// List the built-in presets, or print one
    Presets(presets::Presets),
    /// List the devices that can render
    Devices,
    /// Print a completion script for a shell
    Completions(completions::Completions),
}

/// The message of a panic and its place.
static PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Runs the command line of this process.
pub fn run() -> ExitCode {
    completions::answer(Line::command);
    let line = match Line::try_parse() {
        Ok(line) => line,
        Err(e) => return refuse(&e),
    };
    // A panic is a fault of this program, but no reason for a backtrace or a temporary file
    // that stays.
    set_hook(Box::new(|info| {
        if let Ok(mut said) = PANIC.lock() {
            said.get_or_insert(failure::one_line(&info.to_string()));
        }
    }));
    match catch_unwind(AssertUnwindSafe(|| line.run())) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(e)) => {
            say(&format!("error: {}", failure::sentence(&e)));
            ExitCode::from(failure::code(&e))
        }
        Err(_) => {
            let said = PANIC.lock().ok().and_then(|said| said.clone());
            let said = said.unwrap_or_default();
            say(&format!(
                "error: a fault in conemarch itself, please report it: {said}"
            ));
            ExitCode::FAILURE
        }
    }
}

/// Prints help or version, or says what is wrong with the arguments.
fn refuse(error: &clap::Error) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            // A reader that stops reading the help is no failure.
            let _ = error.print();
            ExitCode::SUCCESS
        }
        _ => {
            say(&format!("error: {}", failure::flatten(error)));
            ExitCode::from(2)
        }
    }
}

impl Line {
    fn run(&self) -> Result<()> {
        match &self.verb {
            Verb::Render(args) => render::run(args),
            Verb::Merge(args) => merge::run(args),
            #[cfg(feature = "preview")]
            Verb::Preview(args) => preview::run(args),
            Verb::Animate(args) => animate::run(args),
            Verb::Bench(Bench::Error(args)) => bench::error::run(args),
            Verb::Bench(Bench::Steps(args)) => bench::steps::run(args),
            Verb::Bench(Bench::Cones(args)) => bench::cones::run(args),
            Verb::Bench(Bench::Calibrate(args)) => bench::calibrate::run(args),
            #[cfg(feature = "preview")]
            Verb::Bench(Bench::Flight(args)) => bench::flight::run(args),
            Verb::ConeMap(ConeMapVerb::Make(args)) => conemap::make::run(args),
            Verb::ConeMap(ConeMapVerb::Inspect(args)) => conemap::inspect::run(args),
            Verb::ConeMap(ConeMapVerb::Convert(args)) => conemap::convert::run(args),
            Verb::Presets(args) => presets::run(args),
            Verb::Devices => devices::run(),
            Verb::Completions(args) => completions::run(args),
        }
    }
}
