//! The name of a column in little room.

use std::fmt;

use serde::{Serialize, Serializer};

/// Bytes of a name that are kept.
const ROOM: usize = 48;

/// The name of a column, or as much of it as there is room for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Label {
    bytes: [u8; ROOM],
    length: usize,
    /// The name was longer.
    cut: bool,
}

impl Label {
    /// The label of a name.
    #[must_use]
    pub fn of(name: &str) -> Self {
        let mut length = name.len().min(ROOM);
        while !name.is_char_boundary(length) {
            length -= 1;
        }
        let mut bytes = [0; ROOM];
        bytes[..length].copy_from_slice(&name.as_bytes()[..length]);
        Self { bytes, length, cut: length < name.len() }
    }
}

impl fmt::Display for Label {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = self.bytes.get(..self.length).unwrap_or_default();
        to.write_str(std::str::from_utf8(text).unwrap_or_default())?;
        to.write_str(if self.cut { "…" } else { "" })
    }
}

impl fmt::Debug for Label {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "`{self}`")
    }
}

impl Serialize for Label {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_kept_and_a_long_one_is_cut_between_letters() {
        assert_eq!(Label::of("Winkel (°)").to_string(), "Winkel (°)");
        let long = Label::of(&"°".repeat(40)).to_string();
        assert_eq!(long, format!("{}…", "°".repeat(24)));
        assert_eq!(Label::of(&format!("a{}", "°".repeat(40))).to_string().chars().count(), 25);
    }
}
