//! How a table is written: what separates its columns, how its decimals are written, and which of
//! its lines are remarks.

use std::borrow::Cow;

use serde::Serialize;

use super::encoding::Encoding;
use super::preamble;
pub use super::separator::Separator;
use super::separator::{is_number, words};
use crate::grid::Form;

/// How a table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Dialect {
    /// What kind of file it is; what follows speaks of text.
    pub form: Form,
    /// How its characters are written.
    pub encoding: Encoding,
    /// What separates its columns.
    pub separator: Separator,
    /// Decimals are written with a comma.
    pub decimal_comma: bool,
    /// Lines that are remarks.
    pub remarks: usize,
    /// Lines above the names that are none of the table, the empty ones and remarks among them.
    pub above: usize,
    /// The names stand in the last remark above the numbers.
    pub names_in_remark: bool,
    /// There are no names: columns are counted from one.
    pub headerless: bool,
    /// The row below the names holds their units.
    pub units_below: bool,
}

impl Dialect {
    /// Of what is no text.
    pub(super) const fn of_grid(form: Form) -> Self {
        Self {
            form,
            encoding: Encoding::Utf8,
            separator: Separator::Comma,
            decimal_comma: false,
            remarks: 0,
            above: 0,
            names_in_remark: false,
            headerless: false,
            units_below: false,
        }
    }

    /// Where a line stands, in words.
    pub(in super::super) fn place(self, line: u64) -> String {
        let word = if self.form == Form::Text { "line" } else { "row" };
        format!("{word} {line}")
    }
}

/// A table without its remarks, whose lines keep their numbers.
pub(super) struct Plain<'a> {
    pub text: Cow<'a, [u8]>,
    pub dialect: Dialect,
    /// Names from a remark.
    pub names: Option<Vec<String>>,
}

/// Lines that are looked at to tell how the decimals are written.
const LOOKED_AT: usize = 1000;

/// Tells how a table is written.
pub(super) fn plain(bytes: &[u8]) -> Plain<'_> {
    let (text, remarks, last) = without_remarks(bytes);
    let above = preamble::lines_above_names(&text);
    let text = if above == 0 { text } else { Cow::Owned(preamble::without(&text, above)) };
    let separator = separator(&text);
    let text = if separator == Separator::Blanks { Cow::Owned(tabbed(&text)) } else { text };
    let decimal_comma = has_decimal_commas(&text, separator);
    let first = lines(&text).next().unwrap_or_default();
    let shown = if separator == Separator::Blanks { Separator::Tab } else { separator };
    let headerless = shown.split(&first).iter().all(|cell| is_number(cell, decimal_comma));
    // `numpy.savetxt` writes the names behind a hash.
    let names = last.filter(|_| headerless).and_then(|remark| {
        let names: Vec<String> =
            separator.split(&remark).iter().map(|name| name.trim().to_owned()).collect();
        let fits = names.len() == shown.fields(&first)
            && names.iter().all(|name| !name.is_empty() && !is_number(name, decimal_comma));
        fits.then_some(names)
    });
    let dialect = Dialect {
        form: Form::Text,
        encoding: Encoding::Utf8,
        units_below: false,
        separator,
        decimal_comma,
        remarks,
        above,
        names_in_remark: names.is_some(),
        headerless: headerless && names.is_none(),
    };
    Plain { text, dialect, names }
}

/// Lines with something in them.
fn lines(bytes: &[u8]) -> impl Iterator<Item = Cow<'_, str>> {
    let lines = bytes.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    lines.filter(|line| !line.is_empty()).map(String::from_utf8_lossy)
}

/// Whether a line is a remark, or tells a spreadsheet what separates the columns, as in `sep=;`.
pub(super) fn is_remark(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    let bare = line.strip_prefix(b"\"").unwrap_or(line);
    matches!(line.first(), Some(b'#' | b'%'))
        || line.len() < 8 && bare.get(..4).is_some_and(|start| start.eq_ignore_ascii_case(b"sep="))
}

/// The table with its remarks blanked out, how many there are, and the last one above the numbers.
fn without_remarks(bytes: &[u8]) -> (Cow<'_, [u8]>, usize, Option<String>) {
    if !bytes.split(|&byte| byte == b'\n').any(is_remark) {
        return (Cow::Borrowed(bytes), 0, None);
    }
    let mut text = Vec::with_capacity(bytes.len());
    let (mut remarks, mut last, mut above) = (0, None, true);
    for line in bytes.split_inclusive(|&byte| byte == b'\n') {
        if is_remark(line) {
            remarks += 1;
            if above {
                let words = String::from_utf8_lossy(line.trim_ascii());
                last = Some(words.trim_start_matches(['#', '%', ' ', '\t']).to_owned());
            }
            text.push(b'\n');
        } else {
            above &= line.trim_ascii().is_empty();
            text.extend_from_slice(line);
        }
    }
    (Cow::Owned(text), remarks, last)
}

/// The first of tab, semicolon, comma and blank that divides the first two lines alike; where none
/// does, whichever the first line has most of.
fn separator(bytes: &[u8]) -> Separator {
    let mut lines = lines(bytes);
    let first = lines.next().unwrap_or_default();
    let second = lines.next();
    let alike = |candidate: &Separator| {
        let fields = candidate.fields(&first);
        fields > 1 && second.as_ref().is_some_and(|second| candidate.fields(second) == fields)
    };
    // Of equals the last wins, so the comma comes last.
    let most = || {
        [Separator::Tab, Separator::Semicolon, Separator::Comma]
            .into_iter()
            .max_by_key(|candidate| candidate.fields(&first))
    };
    Separator::ALL.into_iter().find(alike).or_else(most).unwrap_or(Separator::Comma)
}

/// Blanks between columns as one tab each.
fn tabbed(bytes: &[u8]) -> Vec<u8> {
    let mut text = Vec::with_capacity(bytes.len());
    for line in bytes.split(|&byte| byte == b'\n') {
        text.extend(tabbed_line(line));
        text.push(b'\n');
    }
    text
}

/// Blanks between the columns of a line as one tab each. What is no UTF-8 is left for the reader to
/// refuse.
pub(super) fn tabbed_line(line: &[u8]) -> Vec<u8> {
    match std::str::from_utf8(line) {
        Ok(line) => words(line).join("\t").into_bytes(),
        Err(_) => line.to_owned(),
    }
}

/// Whether the first number with a decimal mark has a comma there. Between commas a number such as
/// `"1,234"` may be one of thousands, and says nothing.
fn has_decimal_commas(bytes: &[u8], separator: Separator) -> bool {
    let shown = if separator == Separator::Blanks { Separator::Tab } else { separator };
    for line in lines(bytes).take(LOOKED_AT) {
        for cell in shown.split(&line).into_iter().map(|cell| cell.trim().trim_matches('"')) {
            if cell.contains('.') && is_number(cell, false) {
                return false;
            }
            let thousands = || {
                let (whole, part) = cell.split_once(',').unwrap_or_default();
                part.len() == 3 && whole.trim_start_matches('-') != "0"
            };
            let tells = separator != Separator::Comma || !thousands();
            if cell.contains(',') && is_number(cell, true) && tells {
                return true;
            }
        }
    }
    false
}
