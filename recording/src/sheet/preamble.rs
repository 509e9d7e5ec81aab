//! Lines of text above the names, as measuring programs write them without a mark: `Recorder v2`,
//! `Operator: Bob`.

use super::separator::{Separator, is_number};
use crate::units;

/// Lines among which the names must stand.
const LOOKED_AT: usize = 200;
/// Rows below the names that must fit them, where there are as many.
const ROWS: usize = 3;

/// How many lines stand above the names; 0 where the first line has them, or where no line has.
pub(super) fn lines_above_names(text: &[u8]) -> usize {
    let lines: Vec<(usize, String)> = text
        .split(|&byte| byte == b'\n')
        .enumerate()
        .take(LOOKED_AT)
        .map(|(at, line)| (at, String::from_utf8_lossy(line.trim_ascii()).into_owned()))
        .filter(|(_, line)| !line.is_empty())
        .collect();
    // A table of numbers alone has no names.
    let first = lines.first().map_or("", |(_, line)| line.as_str());
    let numbers_alone = |separator: Separator| {
        let cells = separator.split(first);
        cells.len() > 1 && cells.iter().all(|cell| is_value(cell))
    };
    if Separator::ALL.into_iter().any(numbers_alone) {
        return 0;
    }
    let fits = |from: usize| {
        let below: Vec<&str> =
            lines.iter().skip(from).take(ROWS + 1).map(|(_, line)| line.as_str()).collect();
        Separator::ALL.into_iter().any(|separator| are_names(separator, &below))
    };
    let from = (0..lines.len()).find(|from| fits(*from)).or_else(|| above_numbers(&lines));
    from.map_or(0, |from| lines[from].0)
}

/// The first row of a table of numbers alone, below lines that are no rows.
fn above_numbers(lines: &[(usize, String)]) -> Option<usize> {
    /// Columns that it must have: two may be one with a decimal comma.
    const COLUMNS: usize = 3;
    [Separator::Tab, Separator::Semicolon, Separator::Comma].into_iter().find_map(|separator| {
        let cells: Vec<Vec<&str>> = lines.iter().map(|(_, line)| separator.split(line)).collect();
        let first = cells.iter().position(|cells| cells.len() > 1)?;
        let rows = cells.get(first..)?.iter().take(ROWS);
        let count = cells[first].len();
        let all = |row: &Vec<&str>| row.len() == count && row.iter().all(|cell| is_value(cell));
        (first > 0 && count >= COLUMNS && rows.clone().all(all)).then_some(first)
    })
}

/// Whether the first of the lines has names, and those below it have values for them; the second
/// may have units.
fn are_names(separator: Separator, lines: &[&str]) -> bool {
    let [names, rows @ ..] = lines else { return false };
    let names = separator.split(names);
    let named = names.iter().filter(|name| !name.trim().is_empty()).count();
    if names.len() < 2 || 2 * named < names.len() || names.iter().any(|name| is_value(name)) {
        return false;
    }
    let rows: Vec<Vec<&str>> = rows.iter().map(|row| separator.split(row)).collect();
    let values = |row: &Vec<&str>| 2 * row.iter().filter(|cell| is_value(cell)).count() > row.len();
    let Some((first, others)) = rows.split_first() else { return false };
    let units = 2 * first.iter().filter(|cell| is_unit(cell)).count() > first.len();
    rows.iter().all(|row| row.len() == names.len())
        && (values(first) || units && !others.is_empty())
        && others.iter().all(values)
}

/// Whether a cell has a unit, or says that there is none.
fn is_unit(cell: &str) -> bool {
    let bare = cell.trim().trim_matches('"').trim();
    let inner = bare.trim_start_matches(['[', '(', '{']).trim_end_matches([']', ')', '}']);
    inner.len() < bare.len() || matches!(bare, "" | "-" | "1") || units::unit_of(bare).is_some()
}

/// Whether a cell has a number, or a date or time of day.
fn is_value(cell: &str) -> bool {
    let cell = cell.trim().trim_matches('"');
    let date = |c: char| c.is_ascii_digit() || ":.,-/+ TZAPM".contains(c);
    is_number(cell, false)
        || is_number(cell, true)
        || cell.starts_with(|c: char| c.is_ascii_digit())
            && cell.contains(':')
            && cell.chars().all(date)
}

/// The text with so many lines emptied, so that the others keep their numbers.
pub(super) fn without(text: &[u8], lines: usize) -> Vec<u8> {
    let mut rest = text;
    for _ in 0..lines {
        let end = rest.iter().position(|&byte| byte == b'\n').map_or(rest.len(), |at| at + 1);
        rest = rest.get(end..).unwrap_or_default();
    }
    let mut blank = vec![b'\n'; lines];
    blank.extend_from_slice(rest);
    blank
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_names_are_found_below_whatever_stands_above_them() {
        for (text, lines) in [
            ("t,q,tau\n0,1,2\n", 0),
            ("t,q,tau\ns,rad,Nm\n0,1,2\n1,2,3\n", 0),
            // A unit that is not known is for the reader of the rows to refuse.
            ("t,q,tau\ns,rad,cubits\n0,1,2\n1,2,3\n", 0),
            ("0,1,2\n1,2,3\n", 0),
            (",t,q\n0,0,1\n", 0),
            ("Rig 5\nt,q,tau\n0,1,2\n1,2,3\n", 1),
            ("Operator: Bob, Alice\nDate: 2026-02-13\n\nt,q,tau\n0,1,2\n", 3),
            ("\"Name\",\"Rig 5\"\n\"Rate\",\"500\"\nt_s,q,tau\n0,1,2\n1,1,2\n", 2),
            ("Rig of ours\nTime;q;tau\n13.02.2026 10:11:12,5;1;2\n", 1),
            ("of ours\nmade by hand\nt q tau\n0 1 2\n0.1 1 2\n", 2),
            ("Rig 5, run 3\nof ours\n0;1;2\n1;2;3\n", 2),
            ("q\n0,5\n0,7\n", 0),
            // Nothing fits: whoever reads it says so.
            ("t,q,tau\n0,0,1,5,2,0\n", 0),
            ("a\nb\nc\n", 0),
            ("", 0),
        ] {
            assert_eq!(lines_above_names(text.as_bytes()), lines, "{text:?}");
        }
        assert_eq!(without(b"a\nb\nc\n", 2), b"\n\nc\n");
    }
}
