//! What a table without a time, with several joints or in several files needs besides the names of
//! its columns.

use std::path::PathBuf;

/// What a table needs besides the names of its columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layout {
    /// Which joint is read of columns that stand for several: the label behind their name, as in
    /// `q[2]` or `q2`.
    pub joint: Option<String>,
    /// Time from row to row \[s\], for a table without a column of the time.
    pub period: Option<f64>,
    /// Tables whose columns stand beside those of the file, row by row.
    pub beside: Vec<PathBuf>,
}
