//! `conemarch completions SHELL`

use anyhow::Result;
use clap::{Args, Command};
use clap_complete::Shell;

use crate::command::print::print;

/// What `completions` takes.
#[derive(Args, Debug)]
pub struct Completions {
    /// The shell to complete in
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Prints the completion script of a shell for a command line.
///
/// # Errors
/// Standard output cannot be written.
pub fn run(args: &Completions, line: &mut Command) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, line, "conemarch", &mut script);
    print(&script)
}
