//! Rows of cells as text: Markdown that also reads well on a terminal, and plain columns.
//!
//! Crates for tables write no line of alignments in Markdown, which `docs/` shows.

/// The width of the widest cell of each column.
fn widths<'a>(rows: impl Iterator<Item = &'a [String]>) -> Vec<usize> {
    let mut widths = Vec::new();
    for row in rows {
        widths.resize(widths.len().max(row.len()), 0);
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = cell.chars().count().max(*width);
        }
    }
    widths
}

/// A Markdown table. Columns that hold a number are aligned to the right.
pub fn markdown<const N: usize>(heads: [&str; N], rows: &[[String; N]]) -> String {
    let heads = heads.map(str::to_string);
    let widths = widths(rows.iter().chain([&heads]).map(|row| &row[..]));
    let right: Vec<bool> = (0..N)
        .map(|i| rows.iter().any(|row| row[i].parse::<f64>().is_ok()))
        .collect();
    let line = |row: &[String; N]| {
        let cells = row.iter().zip(widths.iter().zip(&right));
        let cells = cells.map(|(cell, (&w, right))| match right {
            true => format!(" {cell:>w$} |"),
            false => format!(" {cell:<w$} |"),
        });
        format!("|{}\n", cells.collect::<String>())
    };
    let rule = widths.iter().zip(&right).map(|(&w, right)| match right {
        true => format!("{}:|", "-".repeat(w + 1)),
        false => format!(":{}|", "-".repeat(w + 1)),
    });
    let rule = format!("|{}\n", rule.collect::<String>());
    line(&heads) + &rule + &rows.iter().map(line).collect::<String>()
}

/// Rows in columns, two blanks apart.
pub fn columns<const N: usize>(rows: &[[String; N]]) -> String {
    let widths = widths(rows.iter().map(|row| &row[..]));
    let line = |row: &[String; N]| {
        let cells = row.iter().zip(&widths);
        let cells: String = cells.map(|(cell, &w)| format!("{cell:<w$}  ")).collect();
        format!("{}\n", cells.trim_end())
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_stand_under_each_other() {
        let rows = [["a", "1.50"], ["long", "n/a"]].map(|row| row.map(str::to_string));
        let table = "| who  |   ms |\n|:-----|-----:|\n| a    | 1.50 |\n| long |  n/a |\n";
        assert_eq!(markdown(["who", "ms"], &rows), table);
        assert_eq!(columns(&rows), "a     1.50\nlong  n/a\n");
    }
}
