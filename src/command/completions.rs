//! `conemarch completions SHELL`

use anyhow::Result;
use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::line::Line;
use super::print::print;

/// What `completions` takes.
#[derive(Args, Debug)]
pub struct Completions {
    /// The shell to complete in
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Prints the completion script of a shell.
pub fn run(args: &Completions) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Line::command(), "conemarch", &mut script);
    print(&script)
}
