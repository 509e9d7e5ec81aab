//! Tables.

use maud::{Markup, html};

use super::figure::Table;
use super::html::prose;

/// A table with its caption; columns of numbers are set so that decimal points stand below each
/// other.
///
/// A row shorter than the head is filled with empty cells, a longer one widens the table: showing a
/// mistake is better than hiding it.
pub(super) fn render(table: &Table, number: usize) -> Markup {
    let width = table.rows.iter().map(Vec::len).max().unwrap_or(0).max(table.columns.len());
    let columns: Vec<Column> =
        (0..width).map(|c| Column::of(table.rows.iter().map(|row| cell(row, c)))).collect();
    let head = |c: usize| table.columns.get(c).map_or("", String::as_str);
    let widths: Vec<usize> =
        columns.iter().enumerate().map(|(c, column)| column.width(head(c))).collect();
    let dense = widths.iter().sum::<usize>() > ROOMY;
    let long = table.rows.len() > LONG;
    let title = table.title.trim_end_matches('.');
    let caption = format!("table-caption-{number}");
    html! {
        div .table .dense[dense] .long[long] id={ "table-" (number) } {
            p class="caption" id=(caption) {
                b { "Table " (number) ". " (title) "." } " " (prose(&table.caption)) " "
                button type="button" class="csv" data-table=(number) { "Save as CSV" }
            }
            // What is wider than the window moves within here, by keyboard too.
            div class="sideways" role="region" tabindex="0"
                aria-label={ "Table " (number) ": " (title) } {
                @for part in parts(&widths) {
                    table aria-labelledby=(caption) {
                        thead { tr { @for &c in &part { (columns[c].head(head(c))) } } }
                        tbody {
                            @for (r, row) in table.rows.iter().enumerate() {
                                (self::row(row, &columns, &part, table.highlight == Some(r)))
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The cells of a row that stand in one part of the table; `best` sets it apart.
fn row(row: &[String], columns: &[Column], part: &[usize], best: bool) -> Markup {
    html! {
        tr class=[best.then_some("best")] {
            @for &c in part {
                @let (column, text) = (&columns[c], cell(row, c));
                td class=[column.class()] {
                    (prose(text)) (column.padding(text))
                    @if best && c == 0 { span class="hidden" { " (set apart)" } }
                }
            }
        }
        "\n"
    }
}

/// The text of a cell; none where the row is too short.
fn cell(row: &[String], column: usize) -> &str {
    row.get(column).map_or("", String::as_str).trim()
}

/// Widths, in characters, up to which a table is set in the usual size, and in the small one, so
/// that it fits A4.
const ROOMY: usize = 84;
const NARROW: usize = 108;

/// Rows from which on a table may run over the end of a page.
const LONG: usize = 12;

/// The columns of each part of a table that is wider than the page: the first column stands in each
/// of them.
fn parts(widths: &[usize]) -> Vec<Vec<usize>> {
    let mut parts: Vec<Vec<usize>> = Vec::new();
    let first = widths.first().copied().unwrap_or(0);
    let mut room = 0;
    for (c, &width) in widths.iter().enumerate() {
        match parts.last_mut() {
            Some(part) if width <= room => part.push(c),
            None => parts.push(vec![c]),
            Some(_) => {
                parts.push(vec![0, c]);
                room = NARROW.saturating_sub(first);
            }
        }
        room = if c == 0 { NARROW.saturating_sub(width) } else { room.saturating_sub(width) };
    }
    parts
}

/// A column's head; its unit stays together.
fn headed(head: &str) -> Markup {
    match head.split_once('[').filter(|(before, _)| !before.is_empty()) {
        Some((before, unit)) => html! { (prose(before)) span class="unit" { "[" (unit) } },
        None => prose(head),
    }
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
    /// Characters of the longest cell, and of the longest word.
    longest: (usize, usize),
}

/// Lines that a head may have.
const HEAD_LINES: usize = 3;

/// Characters that a column of sentences has at least.
const SENTENCE: usize = 24;

/// Characters that the space between two columns is worth.
const BETWEEN: usize = 3;

/// Characters of a word that is broken where the line ends: of a path, say.
const BROKEN: usize = 28;

impl Column {
    fn of<'a>(cells: impl Iterator<Item = &'a str>) -> Self {
        let cells: Vec<&str> = cells.filter(|c| !c.is_empty() && !is_dash(c)).collect();
        let longest = cells.iter().map(|cell| cell.chars().count()).max().unwrap_or(0);
        let word = cells
            .iter()
            .flat_map(|cell| cell.split_whitespace())
            .map(|word| word.chars().count())
            .max();
        let longest = (longest, word.unwrap_or(0));
        let mut column = Column { numeric: false, short: false, decimals: 0, longest };
        for cell in &cells {
            if !is_number(cell) {
                column.numeric = false;
                column.decimals = 0;
                let short = cells.iter().all(|cell| cell.chars().count() <= ONE_LINE)
                    && cells.iter().any(|cell| cell.contains(' '));
                return Column { short, ..column };
            }
            column.numeric = true;
            column.decimals = column.decimals.max(decimals(cell).unwrap_or(0));
        }
        column
    }

    /// How wide it is at least, in characters, the space behind it included.
    fn width(&self, head: &str) -> usize {
        let (longest, word) = self.longest;
        let cells = if self.numeric || self.short {
            longest
        } else {
            longest.min(SENTENCE).max(word.min(BROKEN))
        };
        let (text, unit) = head.split_once('[').unwrap_or((head, ""));
        let words = text.split_whitespace().map(|word| word.chars().count()).max().unwrap_or(0);
        let head =
            head.chars().count().div_ceil(HEAD_LINES).max(words).max(unit.chars().count() + 1);
        cells.max(head) + BETWEEN
    }

    /// The cell above it; where nothing is said there, it is the head of nothing.
    fn head(&self, text: &str) -> Markup {
        html! {
            @if text.trim().is_empty() { td class=[self.class()] {} }
            @else { th scope="col" class=[self.class()] { (headed(text)) } }
        }
    }

    fn class(&self) -> Option<&'static str> {
        match (self.numeric, self.short) {
            (false, false) if self.longest.1 > BROKEN => Some("broken"),
            (true, _) => Some("num"),
            (false, true) => Some("short"),
            (false, false) => None,
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

/// Digits behind the point of a plain number; `None` for anything with an exponent or a second
/// part.
fn decimals(cell: &str) -> Option<usize> {
    let plain =
        cell.chars().all(|c| c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | '\u{2212}'));
    (plain && !cell.is_empty() && !is_dash(cell))
        .then(|| cell.split_once('.').map_or(0, |(_, behind)| behind.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn render(table: &Table, number: usize) -> String {
        super::render(table, number).0
    }

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
        let html =
            render(&table(&[&["[1.0, 2.0]", sentence], &["[-1.25e-3, 1.25e-3]", "short one"]]), 1);
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
    fn a_table_that_is_wider_than_the_page_comes_in_parts() {
        let names: Vec<String> = (0..30).map(|i| format!("column {i} [N m]")).collect();
        let cells: Vec<String> = (0..30).map(|i| format!("1.234e-{i}")).collect();
        let wide = Table { columns: names, rows: vec![cells], ..Table::default() };
        let html = render(&wide, 1);
        assert!(html.contains("class=\"table dense\""), "{html}");
        let tables = html.matches("<table").count();
        assert!(tables > 2, "{tables}");
        assert_eq!(
            html.matches("<th ").count(),
            30 + tables - 1,
            "the first column stands in each part"
        );
        assert_eq!(html.matches("Save as CSV").count(), 1);
        // A short one is one.
        assert_eq!(render(&table(&[&["a", "1"]]), 1).matches("<table").count(), 1);
        assert!(render(&Table::default(), 1).contains("Table 1"));
        for part in parts(&[10, 50, 50, 200, 5]) {
            assert_eq!(part[0], 0);
        }
        assert_eq!(parts(&[10, 50, 50, 200, 5]), [vec![0, 1], vec![0, 2], vec![0, 3], vec![0, 4]]);
    }

    #[test]
    fn units_and_code_are_set_as_such() {
        let html = render(&table(&[&["`--quick`", "1"]]), 1);
        assert!(html.contains("<code>--quick</code>") && !html.contains('`'), "{html}");
        assert!(html.contains("mse <span class=\"unit\">[N² m²]</span>"), "{html}");
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
        assert_eq!(html.matches("<th ").count(), 2);
        assert_eq!(html.matches("<td").count(), 1 + 6, "a column without a head");
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
