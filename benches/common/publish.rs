//! Where the tables of a program go.

use std::path::Path;

use anyhow::Result;

use crate::markdown;

/// Prints tables, and with `--write` puts them between two marks of a page in `docs/` too.
pub fn publish(page: &str, marks: [&str; 2], tables: &str) -> Result<()> {
    println!("{tables}");
    if std::env::args().any(|a| a == "--write") {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("docs")
            .join(page);
        let mut page = std::fs::read_to_string(&path)?;
        markdown::replace(&mut page, marks, tables)?;
        std::fs::write(path, page)?;
    }
    Ok(())
}
