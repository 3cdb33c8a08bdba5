//! Writes `docs/presets.md`, the reference of all keys of a preset:
//! `cargo run --release --example presets`. A test fails where the page is not what this
//! would write.

use anyhow::{Context, Result};

fn main() -> Result<()> {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/presets.md");
    std::fs::write(page, conemarch::preset::reference()).context(page)?;
    println!("{page} is written");
    Ok(())
}
