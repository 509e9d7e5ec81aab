//! The figures that matter most, for the terminal.

use super::{FeaturesResults, tables};
use report::figure::Table;

/// The overview and the limit cycle as text.
#[must_use]
pub fn summary(results: &FeaturesResults) -> String {
    aligned(&tables::overview(&results.models))
        + "\n"
        + &aligned(&tables::limit_cycle(&results.limit_cycle))
}

/// A table with its columns aligned by spaces.
fn aligned(table: &Table) -> String {
    let lines = || std::iter::once(&table.columns).chain(&table.rows);
    let width = |column: usize| {
        lines()
            .filter_map(|line| line.get(column))
            .map(|cell| cell.chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..table.columns.len()).map(width).collect();
    let mut text = String::new();
    for line in lines() {
        let cells: Vec<String> =
            line.iter().zip(&widths).map(|(cell, &width)| format!("{cell:<width$}")).collect();
        text += cells.join("  ").trim_end();
        text += "\n";
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned_and_lines_have_no_trailing_blanks() {
        let table = Table {
            columns: vec!["a".into(), "long head".into()],
            rows: vec![vec!["wide cell".into(), "x".into()]],
            ..Table::default()
        };
        assert_eq!(aligned(&table), "a          long head\nwide cell  x\n");
    }
}
