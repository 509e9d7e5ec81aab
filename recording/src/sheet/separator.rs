//! What separates the columns of a table, and what a number in a cell looks like.

use serde::Serialize;

/// What separates the columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Separator {
    /// `1.5,2`
    Comma,
    /// `1.5;2`
    Semicolon,
    /// A tab.
    Tab,
    /// Any number of blanks, as NumPy's `savetxt` writes.
    Blanks,
}

impl Separator {
    /// In the order in which they are tried.
    pub(super) const ALL: [Self; 4] = [Self::Tab, Self::Semicolon, Self::Comma, Self::Blanks];

    /// In words.
    #[must_use]
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Comma => "commas",
            Self::Semicolon => "semicolons",
            Self::Tab => "tabs",
            Self::Blanks => "blanks",
        }
    }

    pub(super) const fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            // Blanks are turned into tabs.
            Self::Tab | Self::Blanks => b'\t',
        }
    }

    /// Fields of a line.
    pub(super) fn fields(self, line: &str) -> usize {
        self.split(line).len()
    }

    pub(super) fn split(self, line: &str) -> Vec<&str> {
        if self == Self::Blanks {
            return words(line);
        }
        let (separator, mut quoted) = (char::from(self.byte()), false);
        line.split(|c: char| {
            quoted ^= c == '"';
            c == separator && !quoted
        })
        .collect()
    }
}

/// Whether a cell is a number, with a point or a comma.
pub(super) fn is_number(cell: &str, decimal_comma: bool) -> bool {
    number(cell.trim().trim_matches('"'), decimal_comma).is_some()
}

/// The number in a cell. With decimal commas a point separates nothing.
pub(super) fn number(cell: &str, decimal_comma: bool) -> Option<f64> {
    if !decimal_comma {
        return cell.parse().ok();
    }
    if cell.contains('.') {
        return None;
    }
    if cell.contains(',') { cell.replacen(',', ".", 1).parse().ok() } else { cell.parse().ok() }
}

/// The words of a line. A unit in brackets belongs to the word before it, as in `q [rad]`.
pub(super) fn words(line: &str) -> Vec<&str> {
    let (mut words, mut start, mut open) = (Vec::new(), None, false);
    let begins =
        |at: usize| line.get(at..).unwrap_or_default().trim_start().starts_with(['[', '(']);
    for (at, c) in line.char_indices() {
        if c.is_whitespace() && !open {
            if let Some(from) = start.filter(|_| !begins(at)) {
                words.push(line[from..at].trim_end());
                start = None;
            }
            continue;
        }
        open = match c {
            '[' | '(' => true,
            ']' | ')' => false,
            _ => open,
        };
        start = start.or(Some(at));
    }
    words.extend(start.map(|from| line[from..].trim_end()));
    words
}
