//! Tables.

use std::fmt::Write;

use super::figure::Table;
use super::html::escape;

/// A table with its caption; columns of numbers are set so that decimal points stand below each other.
///
/// A row shorter than the head is filled with empty cells, a longer one widens the table: showing a
/// mistake is better than hiding it.
pub(super) fn render(table: &Table, number: usize) -> String {
    let width = table.rows.iter().map(Vec::len).max().unwrap_or(0).max(table.columns.len());
    let cell =
        |row: &'_ [String], column: usize| row.get(column).map_or("", String::as_str).trim().to_owned();
    let columns: Vec<Column> =
        (0..width).map(|c| Column::of(table.rows.iter().map(|row| cell(row, c)))).collect();

    let mut out = String::new();
    // Writing to a String cannot fail, hence the results are let go.
    let _ = write!(
        out,
        "<div class=\"table\" id=\"table-{number}\" role=\"region\" tabindex=\"0\" aria-label=\"Table {number}: {title}\">\
         <table><caption><b>Table {number}. {title}.</b> {caption}</caption>\n<thead><tr>",
        title = escape(table.title.trim_end_matches('.')),
        caption = escape(&table.caption),
    );
    for (c, column) in columns.iter().enumerate() {
        let head = table.columns.get(c).map_or("", String::as_str);
        let _ = write!(out, "<th scope=\"col\"{}>{}</th>", column.class(), escape(head));
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for (r, row) in table.rows.iter().enumerate() {
        let best = table.highlight == Some(r);
        out.push_str(if best { "<tr class=\"best\">" } else { "<tr>" });
        for (c, column) in columns.iter().enumerate() {
            let text = cell(row, c);
            let mark = if best && c == 0 { "<span class=\"hidden\"> (set apart)</span>" } else { "" };
            let _ =
                write!(out, "<td{}>{}{}{mark}</td>", column.class(), escape(&text), column.padding(&text));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody></table></div>\n");
    out
}

/// Characters of a text that is kept on one line: those of an interval.
const ONE_LINE: usize = 26;

/// How a column is set.
struct Column {
    numeric: bool,
    /// Text that is short enough to stand on one line: intervals, units.
    short: bool,
    /// Most digits behind a decimal point among its plain numbers.
    decimals: usize,
}

impl Column {
    fn of(cells: impl Iterator<Item = String>) -> Self {
        let cells: Vec<String> = cells.filter(|c| !c.is_empty() && !is_dash(c)).collect();
        let mut column = Column { numeric: false, short: false, decimals: 0 };
        for cell in &cells {
            if !is_number(cell) {
                let short = cells.iter().all(|cell| cell.chars().count() <= ONE_LINE)
                    && cells.iter().any(|cell| cell.contains(' '));
                return Column { numeric: false, short, decimals: 0 };
            }
            column.numeric = true;
            column.decimals = column.decimals.max(decimals(cell).unwrap_or(0));
        }
        column
    }

    fn class(&self) -> &'static str {
        match (self.numeric, self.short) {
            (true, _) => " class=\"num\"",
            (false, true) => " class=\"short\"",
            (false, false) => "",
        }
    }

    /// Spaces as wide as the digits (and the point) that this number has less than the longest.
    fn padding(&self, cell: &str) -> String {
        let Some(own) = decimals(cell).filter(|_| self.numeric) else { return String::new() };
        let point = if own == 0 && self.decimals > 0 { "\u{2008}" } else { "" };
        point.to_owned() + &"\u{2007}".repeat(self.decimals - own)
    }
}

fn is_dash(cell: &str) -> bool {
    matches!(cell, "-" | "\u{2013}" | "\u{2014}")
}

/// A number, perhaps with sign, unit-free: `0.0994`, `+3`, `1.2e-5`, `0.10 ± 0.02`, `12 %`, `NaN`.
fn is_number(cell: &str) -> bool {
    let parts = cell.trim_end_matches('%').split('±');
    parts.into_iter().all(|part| part.trim().replace('\u{2212}', "-").parse::<f64>().is_ok())
}

/// Digits behind the point of a plain number; `None` for anything with an exponent or a second part.
fn decimals(cell: &str) -> Option<usize> {
    let plain = cell.chars().all(|c| c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | '\u{2212}'));
    (plain && !cell.is_empty() && !is_dash(cell))
        .then(|| cell.split_once('.').map_or(0, |(_, behind)| behind.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &[&[&str]]) -> Table {
        Table {
            title: "t".into(),
            columns: vec!["model".into(), "mse [N² m²]".into()],
            rows: rows.iter().map(|r| r.iter().map(|c| (*c).to_owned()).collect()).collect(),
            ..Table::default()
        }
    }

    #[test]
    fn intervals_and_units_stay_on_one_line_and_sentences_do_not() {
        let sentence = "a sentence that goes on for more than one line would";
        let html = render(&table(&[&["[1.0, 2.0]", sentence], &["[-1.25e-3, 1.25e-3]", "short one"]]), 1);
        assert!(html.contains("<td class=\"short\">[1.0, 2.0]</td>"), "{html}");
        assert!(html.contains("<td>short one</td>"), "{html}");
    }

    #[test]
    fn decimal_points_are_aligned() {
        let html = render(&table(&[&["a", "1.25"], &["b", "-10"], &["c", "-"]]), 1);
        assert!(html.contains("<td>a</td><td class=\"num\">1.25</td>"), "{html}");
        assert!(html.contains("<td class=\"num\">-10\u{2008}\u{2007}\u{2007}</td>"), "{html}");
        assert!(html.contains("<td class=\"num\">-</td>"), "{html}");
    }

    #[test]
    fn what_counts_as_a_number() {
        for yes in ["0.1", "+3", "1e-5", "0.10 ± 0.02", "12 %", "\u{2212}4", "NaN", "-4.5%"] {
            assert!(is_number(yes), "{yes}");
        }
        for no in ["LuGre", "3 s", "", "1 ± x", "v1"] {
            assert!(!is_number(no), "{no}");
        }
    }

    #[test]
    fn ragged_rows_are_shown_whole() {
        let html = render(&table(&[&["only"], &["a", "1", "surplus"]]), 1);
        assert_eq!(html.matches("<th ").count(), 3);
        assert_eq!(html.matches("<td").count(), 6);
        assert!(html.contains("surplus"));
    }

    #[test]
    fn cells_are_escaped_and_the_best_row_is_marked() {
        let mut table = table(&[&["<script>", "1"], &["b", "2"]]);
        table.highlight = Some(1);
        let html = render(&table, 3);
        assert!(html.contains("&lt;script&gt;") && !html.contains("<script>"));
        assert!(html.contains("<tr class=\"best\"><td>b<span"));
    }
}
