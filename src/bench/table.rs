//! Tables of reports: lines of cells, the first of them the columns' names.

use std::fmt::Write;

/// As aligned text, two spaces between columns; the first `left` columns to the left, as words are, the others to the right.
pub(super) fn aligned(lines: &[Vec<String>], left: usize) -> String {
    let columns = lines.first().map_or(0, Vec::len);
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut out = String::new();
    for line in lines {
        for (column, (text, width)) in line.iter().zip(&widths).enumerate() {
            out.push_str(if column == 0 { "" } else { "  " });
            // Writing to a String cannot fail.
            let _ = if column < left { write!(out, "{text:<width$}") } else { write!(out, "{text:>width$}") };
        }
        out.push('\n');
    }
    out
}

/// In Markdown.
pub(super) fn markdown(lines: &[Vec<String>], left: usize) -> String {
    let mut out = String::new();
    for (number, line) in lines.iter().enumerate() {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "| {} |", line.join(" | "));
        if number == 0 {
            let right = line.len().saturating_sub(left);
            let _ = writeln!(out, "|{}{}", "---|".repeat(line.len() - right), "---:|".repeat(right));
        }
    }
    out
}
