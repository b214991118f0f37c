//! The table of cases, for people, for a page, and for programs.

use super::rows::{Args, Cells, Row};
use crate::command::console::{Failure, colored};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use surefoot_compiler::diagnostic::Severity;

/// The columns' names.
const COLUMNS: [&str; 4] = ["finite", "converged", "missed", "error"];
/// How wide the first column is.
const NAME: usize = 46;

/// What stands above the table.
pub fn head(adapter: &str) -> String {
    let mut text = format!("each cell: in 64 bits | on {adapter}\n{:<NAME$}", "case");
    for name in COLUMNS {
        let _ = write!(text, "{name:>16}");
    }
    text + "\n"
}

/// What a cell holds: the two machines' numbers.
fn cell(row: &Row, column: &str) -> String {
    let of = |c: &Cells| match column {
        "finite" if c.finite.1 == 0 => "all".to_owned(),
        "finite" => format!("-{}", c.finite.1),
        "converged" if c.ended.1 == 0 => "all".to_owned(),
        "converged" => format!("-{}", c.ended.1),
        "missed" if c.missed.0 == 0 => "-".to_owned(),
        "missed" => c.missed.1.to_string(),
        _ => c.error.map_or("-".to_owned(), |(p99, _)| format!("{p99:.3}")),
    };
    let [exact, device] = &row.cells;
    if row.refused { "refused".to_owned() } else { format!("{} | {}", of(exact), of(device)) }
}

/// A case's line, with what is said of it below where a cell is red or the scene is refused.
pub fn line(row: &Row) -> String {
    let (red, green, plain) = if colored(&std::io::stdout()) { ("\u{1b}[31m", "\u{1b}[32m", "\u{1b}[0m") } else { ("", "", "") };
    let reds = row.red();
    let mut text = format!("{:<NAME$}", row.name);
    for name in COLUMNS {
        let color = if reds.contains(&name) { red } else { green };
        let _ = write!(text, "{color}{:>16}{plain}", cell(row, name));
    }
    text.push('\n');
    if let Some(words) = why(row) {
        let _ = writeln!(text, "    {words}");
    }
    text
}

/// Why a row is red or refused, and what a user sees of it.
fn why(row: &Row) -> Option<String> {
    let reds = row.red();
    let mut words = match row.known {
        _ if row.refused => "refused".to_owned(),
        _ if reds.is_empty() => return None,
        Some(why) => format!("{} red: {why}", reds.join(", ")),
        None => format!("{} red, nobody knows why", reds.join(", ")),
    };
    for (severity, said) in &row.said {
        let name = if *severity == Severity::Error { "error" } else { "warning" };
        let _ = write!(words, "; the user sees {name}{said}");
    }
    if row.said.is_empty() {
        words.push_str("; the user sees no diagnostic");
    }
    Some(words)
}

/// How many are red.
pub fn summary(rows: &[Row]) -> String {
    let red = rows.iter().filter(|row| !row.red().is_empty()).count();
    let unexplained = rows.iter().filter(|row| row.unexplained()).count();
    let refused = rows.iter().filter(|row| row.refused).count();
    let mut text = format!("{} cases: {} green", rows.len(), rows.len() - red);
    for (count, words) in [(refused, "of them refused with an error"), (red, "red"), (unexplained, "of these without a reason")] {
        if count > 0 {
            let _ = write!(text, ", {count} {words}");
        }
    }
    text + "\n"
}

/// The section of the page.
pub fn page(adapter: &str, args: &Args, rows: &[Row]) -> String {
    let command = std::env::args().skip(1).collect::<Vec<_>>().join(" ");
    let mut text = format!(
        "## Stress\n\n\
         Written by `surefoot {command}`, in 64 bits (before the bar) and on {adapter} (after it): pictures of {0}×{0} pixels, costly scenes smaller.\n\n\
         *Finite*: no NaN and no infinity in the picture, the rays, and the functions at points on the surface, near it, and far away. \
         *Converged*: no ray spends its looks between surfaces, and balls come to rest. *Missed*: rays that surely hit and do not, or surely miss \
         and hit, silhouettes aside; balls that passed a wall. *Error*: distance between the hit and the surface, in widths of a pixel, at the 99th percentile; \
         half of one is allowed. Of balls how deep they stand in the surface, in radii; a twentieth is allowed.\n\n\
         | case | finite | converged | missed | error | unknown | |\n|---|---|---|---|---|---:|---|\n",
        args.size
    );
    for row in rows {
        let reds = row.red();
        let cells: Vec<String> = COLUMNS
            .iter()
            .map(|name| {
                let held = cell(row, name).replace('|', "\\|");
                if reds.contains(name) { format!("🔴 {held}") } else { format!("🟢 {held}") }
            })
            .collect();
        let words = why(row).unwrap_or_default().replace('|', "\\|");
        let _ = writeln!(text, "| {} | {} | {} | {words} |", row.name.replace('|', "\\|"), cells.join(" | "), row.unknown.0);
    }
    let _ = write!(text, "\n{}", summary(rows));
    text
}

/// Writes all numbers.
pub fn write_json(file: &Path, adapter: &str, rows: &[Row]) -> Result<(), Failure> {
    let value = json!({ "adapter": adapter, "cases": rows.iter().map(row_json).collect::<Vec<_>>() });
    std::fs::write(file, format!("{value:#}\n")).map_err(|e| Failure::usage(format!("can't write {}: {e}", file.display())))
}

fn row_json(row: &Row) -> Value {
    let cells = |c: &Cells| {
        json!({
            "numbers": c.finite.0, "not_finite": c.finite.1,
            "sent": c.ended.0, "without_end": c.ended.1,
            "judged": c.missed.0, "missed": c.missed.1,
            "error_p99": c.error.map(|e| e.0), "error_max": c.error.map(|e| e.1),
        })
    };
    json!({
        "case": row.name,
        "exact": cells(&row.cells[0]),
        "device": cells(&row.cells[1]),
        "unknown": row.unknown.0,
        "red": row.red(),
        "why": row.known,
        "refused": row.refused,
        "said": row.said.iter().map(|(_, words)| words).collect::<Vec<_>>(),
    })
}
