//! Tables out: comma-separated values, cell by cell.

use std::fmt::{Display, Write};

/// A table in the making. Cells that hold a comma, a quote or the end of a line are quoted.
///
/// ```
/// use recording::csv_table::CsvTable;
///
/// let mut table = CsvTable::new(["t_s", "remark"]);
/// table.cell(format_args!("{:.3}", 0.5));
/// table.cell("cold, new");
/// table.end_row();
/// assert_eq!(table.text(), "t_s,remark\n0.500,\"cold, new\"\n");
/// ```
#[derive(Debug)]
pub struct CsvTable {
    writer: csv::Writer<Vec<u8>>,
    cell: String,
}

// Writing to memory cannot fail, and rows may have any length: results are let go below.
impl CsvTable {
    /// A table with these names at the head of its columns.
    pub fn new<C: Display>(columns: impl IntoIterator<Item = C>) -> Self {
        let writer = csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
        let mut table = Self { writer, cell: String::new() };
        columns.into_iter().for_each(|name| table.cell(name));
        table.end_row();
        table
    }

    /// The next cell of the row.
    pub fn cell(&mut self, value: impl Display) {
        self.cell.clear();
        let _ = write!(self.cell, "{value}");
        let _ = self.writer.write_field(&self.cell);
    }

    /// Ends the row.
    pub fn end_row(&mut self) {
        let _ = self.writer.write_record(None::<&[u8]>);
    }

    /// The table as text.
    #[must_use]
    pub fn text(self) -> String {
        let bytes = self.writer.into_inner().unwrap_or_default();
        String::from_utf8(bytes).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_stands_in_a_cell_reads_back() {
        let odd = ["a,b", "\"quoted\"", "two\nlines", "=1+1", "<script>", "", "ä"];
        let mut table = CsvTable::new(odd);
        odd.iter().for_each(|text| table.cell(text));
        table.end_row();
        let text = table.text();
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        assert_eq!(reader.headers().unwrap().iter().collect::<Vec<_>>(), odd);
        let row = reader.records().next().unwrap().unwrap();
        assert_eq!(row.iter().collect::<Vec<_>>(), odd);
    }

    #[test]
    fn rows_may_have_empty_cells_and_lines_end_as_everywhere_here() {
        let mut table = CsvTable::new(["a", "b"]);
        table.cell(1);
        table.cell("");
        table.end_row();
        assert_eq!(table.text(), "a,b\n1,\n");
    }
}
