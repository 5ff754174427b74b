//! Columns of text.

/// `rows` as lines, each column as wide as its widest cell; the first row is the head.
pub(super) fn table<const N: usize>(rows: &[[String; N]]) -> String {
    let width = |column: usize| {
        rows.iter().map(|row| row[column].chars().count()).max().unwrap_or_default()
    };
    let widths: Vec<usize> = (0..N).map(width).collect();
    let line = |row: &[String; N]| {
        let cells: Vec<String> =
            row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:<width$}")).collect();
        cells.join("  ").trim_end().to_owned() + "\n"
    };
    rows.iter().map(line).collect()
}

/// `lines` below each other behind `head`, which is six letters wide at most.
pub(super) fn listed(head: &str, lines: &[String]) -> String {
    format!("{head:<6}{}", lines.join("\n      "))
}

/// A number without the digits rounding left at its end.
pub(super) fn number(value: f64) -> String {
    ((value * 1e6).round() / 1e6).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up_and_lines_end_without_blanks() {
        let rows = [["A", "LONG", ""], ["ñandú", "x", ""]].map(|row| row.map(str::to_owned));
        assert_eq!(table(&rows), "A      LONG\nñandú  x\n");
    }

    #[test]
    fn a_list_stands_behind_its_head() {
        assert_eq!(listed("wrote", &["a".into(), "b".into()]), "wrote a\n      b");
    }

    #[test]
    fn a_number_shows_no_rounding() {
        assert_eq!(number(0.1 + 0.2), "0.3");
        assert_eq!(number(1000.0), "1000");
    }
}
