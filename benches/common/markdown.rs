//! Markdown tables, and the places of a page that a program fills.

use anyhow::{Context, Result};

/// A table. The head and each row have ` | ` between their cells. `align` has an `l` for each
/// column that is aligned to the left and an `r` for each that is aligned to the right; its last
/// letter holds for all further columns.
pub fn table(head: &str, align: &str, rows: impl IntoIterator<Item = String>) -> String {
    let last = align.chars().last().into_iter().cycle();
    let letters = align.chars().chain(last).take(head.split('|').count());
    let rule: String = letters
        .map(|l| if l == 'l' { ":--|" } else { "--:|" })
        .collect();
    let rows = rows.into_iter().map(|row| format!("| {row} |\n"));
    format!("| {head} |\n|{rule}\n{}", rows.collect::<String>())
}

/// Puts text between the two lines that mark a section.
pub fn replace(page: &mut String, [begin, end]: [&str; 2], content: &str) -> Result<()> {
    let mark = |line: &str| format!("the page has no line {line}");
    let start = page.find(begin).with_context(|| mark(begin))? + begin.len();
    let length = page[start..].find(end).with_context(|| mark(end))?;
    let content = format!("\n\n{}\n\n", content.trim());
    page.replace_range(start..start + length, &content);
    Ok(())
}
