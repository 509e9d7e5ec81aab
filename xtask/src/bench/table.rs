//! The tables, for a terminal and for a document.

use std::iter::once;

use super::statistics::{Choice, Comparison, Quartiles};

/// Cells under a head.
#[derive(Debug)]
pub struct Table {
    head: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Rust beside C; `bar` tells what a row is held to.
    pub fn of_comparisons(rows: &[Comparison], bar: impl Fn(&Comparison) -> Option<f64>) -> Self {
        let head = ["model", "scheme", "Rust [ns]", "C [ns]", "Rust / C", "bar", "sums differ by"];
        let cells = rows.iter().map(|row| {
            let (c, ratio, difference) = row.beside.as_ref().map_or(
                ("no peer".into(), String::new(), String::new()),
                |beside| {
                    let difference = format!("{:.0e}", beside.difference);
                    (median(beside.c), spread(beside.ratio, 3), difference)
                },
            );
            let verdict = bar(row).map_or(String::new(), |bar| verdict(row.keeps(bar), bar, ""));
            vec![
                row.model.to_string(),
                row.scheme.to_string(),
                median(row.rust),
                c,
                ratio,
                verdict,
                difference,
            ]
        });
        Self { head: head.map(String::from).into(), rows: cells.collect() }
    }

    /// Known at compile time, and chosen while the program runs.
    pub fn of_choices(rows: &[Choice], bar: f64) -> Self {
        let head = ["model", "known [ns]", "chosen [ns]", "difference [ns]", "bar"];
        let cells = rows.iter().map(|row| {
            vec![
                row.model.to_string(),
                median(row.known),
                median(row.chosen),
                spread(row.difference, 2),
                verdict(row.keeps(bar), bar, " ns"),
            ]
        });
        Self { head: head.map(String::from).into(), rows: cells.collect() }
    }

    /// One line a row, with every column as wide as its widest cell.
    pub fn render(&self, markdown: bool) -> String {
        let lines = || once(&self.head).chain(&self.rows);
        let widths: Vec<usize> = (0..self.head.len())
            .map(|column| {
                lines().filter_map(|row| row.get(column)).map(|cell| cell.len()).max().unwrap_or(0)
            })
            .collect();
        let line = |row: &[String]| {
            let cells: Vec<String> =
                row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:<width$}")).collect();
            if markdown {
                format!("| {} |\n", cells.join(" | "))
            } else {
                format!("{}\n", cells.join("  ").trim_end())
            }
        };
        let rule: Vec<String> = widths.iter().map(|&width| "-".repeat(width)).collect();
        once(line(&self.head))
            .chain(once(line(&rule)))
            .chain(self.rows.iter().map(|row| line(row)))
            .collect()
    }
}

fn median(quartiles: Quartiles) -> String {
    format!("{:.2}", quartiles.median())
}

/// The median, and the first and third quartile.
fn spread(Quartiles([first, median, third]): Quartiles, digits: usize) -> String {
    format!("{median:.digits$} ({first:.digits$} .. {third:.digits$})")
}

fn verdict(keeps: bool, bar: f64, unit: &str) -> String {
    format!("{} {bar}{unit}", if keeps { "within" } else { "ABOVE" })
}

#[cfg(test)]
mod tests {
    use friction_model::ModelName;

    use super::super::programs::Scheme;
    use super::super::statistics::Beside;
    use super::*;

    #[test]
    fn columns_line_up_and_the_verdict_is_told() {
        let row = |model, scheme, ratio, peer: bool| Comparison {
            model,
            scheme,
            rust: Quartiles([1.0, 2.0, 3.0]),
            beside: peer.then_some(Beside {
                c: Quartiles([1.0, 1.5, 2.0]),
                ratio: Quartiles([1.0, ratio, 1.5]),
                difference: 2e-16,
            }),
        };
        let rows = [
            row(ModelName::LuGre, Scheme::Exact, 1.25, true),
            row(ModelName::LuGre, Scheme::Rk4, 1.1, true),
            row(ModelName::ElastoPlastic, Scheme::Rk4, 9.0, true),
            row(ModelName::Bristle, Scheme::Exact, 0.0, false),
        ];
        let bar = |row: &Comparison| (row.model == ModelName::LuGre).then_some(1.2);
        let table = Table::of_comparisons(&rows, bar);
        let expected = "\
model           scheme  Rust [ns]  C [ns]   Rust / C                bar         sums differ by
--------------  ------  ---------  -------  ----------------------  ----------  --------------
lugre           exact   2.00       1.50     1.250 (1.000 .. 1.500)  ABOVE 1.2   2e-16
lugre           rk4     2.00       1.50     1.100 (1.000 .. 1.500)  within 1.2  2e-16
elasto_plastic  rk4     2.00       1.50     9.000 (1.000 .. 1.500)              2e-16
bristle         exact   2.00       no peer
";
        assert_eq!(table.render(false), expected);
        let markdown = table.render(true);
        let mut lines = markdown.lines();
        assert!(lines.next().unwrap().starts_with("| model          | scheme | Rust [ns] |"));
        assert!(lines.next().unwrap().starts_with("| -------------- | ------ | --------- |"));
        assert!(markdown.lines().all(|line| line.matches('|').count() == 8));
    }
}
