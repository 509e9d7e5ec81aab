//! Two runs beside each other.

use std::collections::BTreeSet;
use std::fmt::Write;

use report::numbers::significant;
use serde::Serialize;

use crate::contents::{Contents, Quantity};
use crate::run::{NoRun, Run};

/// Two runs, and where they differ.
#[derive(Debug, Clone, Serialize)]
pub struct Comparison {
    /// The runs.
    pub runs: [Run; 2],
    /// What was found with an interval, in either.
    pub parameters: Vec<Compared>,
    /// Other numbers that were found in both and are not equal.
    pub figures: Vec<Unequal>,
    /// Settings that differ.
    pub settings: Vec<Setting>,
}

/// A parameter in both runs.
#[derive(Debug, Clone, Serialize)]
pub struct Compared {
    /// Its place in the documents.
    pub place: String,
    /// What each run found; none where it has no such parameter.
    pub found: [Option<Quantity>; 2],
    /// Whether they differ.
    pub verdict: Verdict,
}

/// Whether two values differ, by their 95 % intervals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, strum::Display)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "lowercase")]
pub enum Verdict {
    /// By more than both intervals together explain. Of two that are equal, 5 % are called so.
    Differ,
    /// By no more than that.
    Alike,
    /// One has no interval, or is not there.
    #[strum(serialize = "not known")]
    Unknown,
}

/// A number that was found in both runs.
#[derive(Debug, Clone, Serialize)]
pub struct Unequal {
    /// Its place in the documents.
    pub place: String,
    /// What each run found.
    pub found: [f64; 2],
}

/// A setting that is not the same.
#[derive(Debug, Clone, Serialize)]
pub struct Setting {
    /// Its place in the documents.
    pub place: String,
    /// Its value as JSON in each run; none where it has no such setting.
    pub values: [Option<String>; 2],
}

impl Comparison {
    /// Holds two runs beside each other.
    ///
    /// # Errors
    /// [`NoRun`] of the first folder that is none of a run.
    pub fn of(first: &std::path::Path, second: &std::path::Path) -> Result<Self, NoRun> {
        let (first, of_first) = Run::open_with(first)?;
        let (second, of_second) = Run::open_with(second)?;
        let contents = [Contents::of(first.kind, &of_first), Contents::of(second.kind, &of_second)];
        Ok(Self {
            parameters: parameters(&contents),
            figures: figures(&contents),
            settings: settings(&contents),
            runs: [first, second],
        })
    }

    /// For the terminal.
    #[must_use]
    pub fn terminal(&self) -> String {
        let mut text = String::new();
        for (letter, run) in ["A", "B"].iter().zip(&self.runs) {
            // Writing to a string cannot fail.
            let made = run.made.as_deref().unwrap_or("-");
            let _ = writeln!(
                text,
                "{letter}  {}  {}  {made}  {}",
                run.folder.display(),
                run.title(),
                run.said
            );
        }
        let rows = |rows: Vec<[String; 4]>, heads: [&str; 4]| columns(&heads, &rows);
        if !self.parameters.is_empty() {
            let _ = writeln!(text, "\nParameters, with their 95 % intervals");
            text += &rows(
                self.parameters.iter().map(Compared::row).collect(),
                ["parameter", "A", "B", "verdict"],
            );
        }
        if !self.figures.is_empty() {
            let _ = writeln!(text, "\nFigures that are not equal");
            text += &rows(
                self.figures.iter().map(Unequal::row).collect(),
                ["figure", "A", "B", "B over A"],
            );
        }
        let _ = writeln!(text, "\nSettings that differ");
        text += &if self.settings.is_empty() {
            "none\n".to_owned()
        } else {
            let row = |setting: &Setting| {
                let [a, b] = setting.shown();
                [setting.place.clone(), a, b, String::new()]
            };
            rows(self.settings.iter().map(row).collect(), ["setting", "A", "B", ""])
        };
        text
    }
}

impl Compared {
    pub(crate) fn row(&self) -> [String; 4] {
        let [a, b] = self.found.each_ref().map(|one| one.as_ref().map_or("-".to_owned(), shown));
        [self.place.clone(), a, b, self.verdict.to_string()]
    }
}

impl Unequal {
    pub(crate) fn row(&self) -> [String; 4] {
        let [a, b] = self.found;
        let ratio = if a == 0.0 { "-".to_owned() } else { significant(b / a, 3) };
        [self.place.clone(), significant(a, 4), significant(b, 4), ratio]
    }
}

/// Longest setting that is shown whole, in characters.
const LONGEST: usize = 40;

impl Setting {
    /// The values as they are shown: long ones are cut.
    pub(crate) fn shown(&self) -> [String; 2] {
        self.values.each_ref().map(|value| match value {
            None => "-".to_owned(),
            Some(value) if value.chars().count() > LONGEST => {
                let begun: String = value.chars().take(LONGEST - 3).collect();
                format!("{begun}...")
            }
            Some(value) => value.clone(),
        })
    }
}

/// `0.09932 [0.09916, 0.09949] N m`.
fn shown(one: &Quantity) -> String {
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| significant(value, 4));
    let end = |end: Option<f64>| end.map_or("open".to_owned(), |end| significant(end, 4));
    let unit = one.unit.as_deref().map_or(String::new(), |unit| format!(" {unit}"));
    match (one.low, one.high) {
        (None, None) => format!("{}{unit}", number(one.value)),
        (low, high) => format!("{} [{}, {}]{unit}", number(one.value), end(low), end(high)),
    }
}

fn parameters([a, b]: &[Contents; 2]) -> Vec<Compared> {
    let places: BTreeSet<&String> = a.parameters.keys().chain(b.parameters.keys()).collect();
    let compared = |place: &String| {
        let found = [a.parameters.get(place).cloned(), b.parameters.get(place).cloned()];
        let verdict = match &found {
            [Some(a), Some(b)] => verdict(a, b),
            _ => Verdict::Unknown,
        };
        Compared { place: place.clone(), found, verdict }
    };
    places.into_iter().map(compared).collect()
}

/// The difference against the half widths of both on the sides that face each other, taken
/// together as errors that are independent.
fn verdict(a: &Quantity, b: &Quantity) -> Verdict {
    let (Some(at_a), Some(at_b)) = (a.value, b.value) else { return Verdict::Unknown };
    let (below, above) = if at_a <= at_b { (a, b) } else { (b, a) };
    let reach = |from: Option<f64>, end: Option<f64>| Some((end? - from?).abs());
    match (reach(below.value, below.high), reach(above.value, above.low)) {
        (Some(up), Some(down)) if (at_a - at_b).abs() > up.hypot(down) => Verdict::Differ,
        (Some(_), Some(_)) => Verdict::Alike,
        _ => Verdict::Unknown,
    }
}

fn figures([a, b]: &[Contents; 2]) -> Vec<Unequal> {
    let both = a.figures.iter().filter_map(|(place, &of_a)| {
        let found = [of_a, *b.figures.get(place)?];
        (found[0] != found[1]).then(|| Unequal { place: place.clone(), found })
    });
    both.collect()
}

fn settings([a, b]: &[Contents; 2]) -> Vec<Setting> {
    let places: BTreeSet<&String> = a.settings.keys().chain(b.settings.keys()).collect();
    let differing = places.into_iter().filter_map(|place| {
        let values = [a.settings.get(place).cloned(), b.settings.get(place).cloned()];
        (values[0] != values[1]).then(|| Setting { place: place.clone(), values })
    });
    differing.collect()
}

/// Rows with their columns below each other.
fn columns(heads: &[&str; 4], rows: &[[String; 4]]) -> String {
    let width = |at: usize| {
        let cells = rows.iter().map(|row| row[at].chars().count());
        cells.chain([heads[at].chars().count()]).max().unwrap_or(0)
    };
    let widths = [0, 1, 2, 3].map(width);
    let line = |cells: [&str; 4]| {
        let padded: Vec<String> = cells
            .iter()
            .zip(widths)
            .map(|(cell, width)| format!("{cell}{}", " ".repeat(width - cell.chars().count())))
            .collect();
        format!("{}\n", padded.join("  ").trim_end())
    };
    let rows = rows.iter().map(|row| line(row.each_ref().map(String::as_str)));
    line(*heads) + &rows.collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quantity(value: f64, low: Option<f64>, high: Option<f64>) -> Quantity {
        Quantity { value: Some(value), unit: None, low, high }
    }

    #[test]
    fn two_values_differ_where_both_intervals_do_not_explain_it() {
        let near = |at: f64| quantity(at, Some(at - 1.0), Some(at + 1.0));
        assert_eq!(verdict(&near(0.0), &near(1.4)), Verdict::Alike);
        assert_eq!(verdict(&near(0.0), &near(1.5)), Verdict::Differ);
        assert_eq!(verdict(&near(1.5), &near(0.0)), Verdict::Differ);
        // Only the ends that face each other count.
        let open = quantity(0.0, None, Some(1.0));
        assert_eq!(verdict(&open, &near(3.0)), Verdict::Differ);
        assert_eq!(verdict(&open, &near(-3.0)), Verdict::Unknown);
        assert_eq!(verdict(&quantity(0.0, None, None), &near(3.0)), Verdict::Unknown);
    }
}
