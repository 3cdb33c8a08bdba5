//! Rows of cells as text: Markdown that also reads well on a terminal, and plain columns.
//!
//! Crates for tables write no line of alignments in Markdown, which `docs/` shows.

/// A column: its head, and the cell of a row.
pub type Column<'a, R> = (&'a str, &'a dyn Fn(&R) -> String);

/// Pads every cell to the width of its column: on the left in columns that hold a number if
/// `numbers` is set.
fn pad(rows: &mut [Vec<String>], numbers: bool) -> Vec<bool> {
    let columns = rows.first().map_or(0, Vec::len);
    let mut right = vec![false; columns];
    for (i, right) in right.iter_mut().enumerate() {
        *right = numbers && rows.iter().any(|row| row[i].parse::<f64>().is_ok());
        let width = rows.iter().map(|row| row[i].chars().count()).max();
        let width = width.unwrap_or(0);
        for row in &mut *rows {
            row[i] = match *right {
                true => format!("{:>width$}", row[i]),
                false => format!("{:<width$}", row[i]),
            };
        }
    }
    right
}

/// A Markdown table of rows. Columns that hold a number are aligned to the right.
pub fn table<R>(rows: &[R], columns: &[Column<'_, R>]) -> String {
    let heads = columns.iter().map(|(head, _)| (*head).to_string());
    let mut cells = vec![heads.collect()];
    for row in rows {
        cells.push(columns.iter().map(|(_, cell)| cell(row)).collect());
    }
    let right = pad(&mut cells, true);
    let rule = cells[0].iter().zip(right).map(|(head, right)| {
        let dashes = "-".repeat(head.chars().count() + 1);
        match right {
            true => dashes + ":",
            false => format!(":{dashes}"),
        }
    });
    let rule = format!("|{}|\n", rule.collect::<Vec<_>>().join("|"));
    let mut lines = cells.iter().map(|row| format!("| {} |\n", row.join(" | ")));
    let head = lines.next().unwrap_or_default();
    head + &rule + &lines.collect::<String>()
}

/// Rows of cells in columns, two blanks apart.
pub fn columns(mut rows: Vec<Vec<String>>) -> String {
    pad(&mut rows, false);
    let line = |row: &Vec<String>| format!("{}\n", row.join("  ").trim_end());
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_stand_under_each_other() {
        let rows = [("a", "1.50"), ("long", "n/a")];
        let who = |r: &(&str, &str)| r.0.to_string();
        let ms = |r: &(&str, &str)| r.1.to_string();
        let text = "| who  |   ms |\n|:-----|-----:|\n| a    | 1.50 |\n| long |  n/a |\n";
        assert_eq!(table(&rows, &[("who", &who), ("ms", &ms)]), text);
        let rows = rows.map(|r| vec![who(&r), ms(&r)]);
        assert_eq!(columns(rows.to_vec()), "a     1.50\nlong  n/a\n");
    }
}
