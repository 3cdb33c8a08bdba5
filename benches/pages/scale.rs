//! The plot of `docs/benchmarks.md` that shows how times grow.

use conemarch::command::bench::plot::{PANEL, axes, axes_at, head, line};

/// Panels beside each other.
const COLUMNS: usize = 2;

/// The colour of a mode, as in the other plot.
fn color_of(mode: &str) -> &'static str {
    match mode {
        "safe" => "#0072b2",
        _ => "#000000",
    }
}

/// A table of `benches/scale.rs`.
struct Table {
    caption: String,
    column: String,
    /// The two modes.
    modes: [String; 2],
    /// What was changed, and the times of both.
    rows: Vec<[f64; 3]>,
    exponents: [String; 2],
}

/// The number in a cell; of a size, its pixels.
fn number(cell: &str) -> Option<f64> {
    let sides: Option<Vec<f64>> = cell.split(" x ").map(|side| side.parse().ok()).collect();
    Some(sides?.iter().product())
}

/// The tables in a text.
fn tables(text: &str) -> Vec<Table> {
    let mut tables: Vec<Table> = Vec::new();
    for row in text.lines().filter(|line| !line.is_empty()) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        match (cells[..].as_ref(), tables.last_mut()) {
            ([caption], _) => tables.push(Table {
                caption: caption.split(',').next().unwrap_or("").replace('`', ""),
                column: String::new(),
                modes: Default::default(),
                rows: Vec::new(),
                exponents: Default::default(),
            }),
            (["exponent", one, two, ..], Some(table)) => {
                table.exponents = [one, two].map(|e| e.to_string());
            }
            ([x, one, two, ..], Some(table)) => match [x, one, two].map(|c| number(c)) {
                [Some(x), Some(one), Some(two)] => {
                    // Maps are square, and the exponent is that of a side.
                    let x = if table.column == "map" { x.sqrt() } else { x };
                    table.rows.push([x, one, two]);
                }
                _ if table.column.is_empty() => {
                    table.column = x.to_string();
                    table.modes = [one, two].map(|mode| mode.replace(", ms", ""));
                }
                _ => {}
            },
            _ => {}
        }
    }
    tables
}

/// The plot of all tables in a text.
pub fn draw(text: &str) -> String {
    let tables = tables(text);
    let lines = tables.len().div_ceil(COLUMNS).max(1);
    let (w, h) = (COLUMNS as f64 * PANEL[0], lines as f64 * PANEL[1]);
    let mut svg = vec![head(w, h)];
    for (i, table) in tables.iter().enumerate() {
        let corner = [
            (i % COLUMNS) as f64 * PANEL[0],
            (i / COLUMNS) as f64 * PANEL[1],
        ];
        let times = table.rows.iter().flat_map(|row| row[1..].to_vec());
        let [x, y] = axes_at(corner, table.rows.iter().map(|row| row[0]), times);
        let column = match table.column.as_str() {
            "size" => "pixels",
            "factor" => "factor by which the eye is nearer",
            "iterations" => "iteration limit",
            "map" => "samples along a side of the map",
            other => other,
        };
        let labels = [column, "march and trace, ms"];
        axes(&mut svg, [&x, &y], &table.caption, labels);
        for (of, mode) in table.modes.iter().enumerate() {
            let color = color_of(mode);
            let place = |row: &[f64; 3]| [x.place(row[0]), y.place(row[of + 1])];
            line(&mut svg, table.rows.iter().map(place), color);
            for row in &table.rows {
                let [cx, cy] = place(row);
                svg.push(format!(
                    r##"<circle cx="{cx:.1}" cy="{cy:.1}" r="3" fill="{color}"/>"##
                ));
            }
            let (left, top) = (x.at + 10.0, y.at + y.length + 18.0 + 15.0 * of as f64);
            let exponent = &table.exponents[of];
            svg.push(format!(
                r##"<text x="{left:.1}" y="{top:.1}" fill="{color}">{mode}, exponent {exponent}</text>"##
            ));
        }
    }
    svg.push("</svg>\n".into());
    svg.join("\n")
}
