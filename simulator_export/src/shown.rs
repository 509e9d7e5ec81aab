//! Numbers as people read them.

use std::fmt;

/// A number with at most four digits that count.
pub(crate) struct Shown(pub f64);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let short: f64 = format!("{:.3e}", self.0).parse().unwrap_or(self.0);
        if short != 0.0 && !(1e-4..1e7).contains(&short.abs()) {
            write!(f, "{short:e}")
        } else {
            write!(f, "{short}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let shown = [0.0994, 123_456.0, 1.234_567e-9, 0.0, -2.5].map(|x| Shown(x).to_string());
        assert_eq!(shown, ["0.0994", "123500", "1.235e-9", "0", "-2.5"]);
    }
}
