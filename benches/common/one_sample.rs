//! Pictures that two programs can both make.

use std::process::Command;

use anyhow::Result;

/// The options of `render` for one sample of each pixel, if a program has samples. One from before
/// takes no other.
pub fn one_sample(program: &str) -> Result<Vec<&'static str>> {
    let help = Command::new(program).args(["render", "--help"]).output()?;
    let options = ["--samples", "1", "--set", "image.reference=auto"];
    let has_samples = String::from_utf8_lossy(&help.stdout).contains(options[0]);
    Ok(options.into_iter().filter(|_| has_samples).collect())
}
