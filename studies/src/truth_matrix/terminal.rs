//! The matrix as text.

use super::{Matrix, page};
use report::numbers;

/// One line a truth.
#[must_use]
pub fn summary(matrix: &Matrix) -> String {
    let mut text = format!(
        "Held-out error, rms [1e-3 N m], median of {} (* best, ~ cannot be told from it)\n\n",
        numbers::count(matrix.seeds as usize, "seed")
    );
    text += &format!("{:22}", "truth \\ model");
    for model in &matrix.models {
        text += &format!("{:>16}", model.as_str());
    }
    text.push('\n');
    for row in &matrix.rows {
        text += &format!("{:22}", row.truth.title());
        for &model in &matrix.models {
            // The median and the mark; the spread is in the report.
            let cell = page::text(row, model);
            let mark = cell.chars().last().filter(|c| "*~".contains(*c)).unwrap_or(' ');
            let median = cell.split(' ').next().unwrap_or_default();
            text += &format!("{:>16}", format!("{median} {mark}"));
        }
        text.push('\n');
    }
    if matrix.stopped {
        text += "\nstopped before the end: rows are missing or rest on fewer seeds\n";
    }
    text
}
