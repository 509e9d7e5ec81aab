//! What the comments of a parameter file say: where each value comes from, the speeds of the
//! recordings, the units, who wrote it.
//!
//! The values themselves are read by whoever reads parameter files; comments are nobody's but
//! people's, and this module's.

use std::collections::BTreeMap;

use crate::{Axis, Refusal, Speeds, SpeedsFrom};

/// How the line of the speeds begins; behind it stand the lowest, `to`, the highest and the unit.
pub const SPEEDS: &str = "Speeds of the recordings:";

/// The line of the speeds, without the sign of a comment.
#[must_use]
pub fn speeds_line(low: f64, high: f64, axis: Axis) -> String {
    format!("{SPEEDS} {low:?} to {high:?} {}", axis.speed())
}

/// What is known of where a value comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// Recordings tell it.
    Identified,
    /// It was not estimated, and the file says why that is as it should be.
    Given(String),
    /// Recordings do not tell it, or nobody says so: what the file says.
    Doubtful(String),
}

/// What the comments of a parameter file say.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Annotations {
    /// The first line, where it is a comment: who wrote the file, and from what.
    pub first: Option<String>,
    /// The lowest and the highest speed \[rad/s or m/s\].
    pub speeds: Option<(f64, f64)>,
    /// Whether the axis turns.
    pub axis: Option<Axis>,
    /// Whether the friction is in volts.
    pub volts: bool,
    /// What stands behind each value, by its path without `ros__parameters`, as in
    /// `/friction_observer.lugre.f_s`.
    comments: BTreeMap<String, String>,
}

impl Annotations {
    /// Reads the comments of a parameter file.
    ///
    /// # Errors
    /// [`Refusal::Speeds`] for a line of speeds that are no range.
    pub fn read(text: &str) -> Result<Self, Refusal> {
        let mut found = Self::default();
        let mut path: Vec<(usize, String)> = Vec::new();
        for (number, line) in text.lines().enumerate() {
            let content = line.trim_start();
            if let Some(comment) = content.strip_prefix('#') {
                let comment = comment.trim();
                if number == 0 {
                    found.first = Some(comment.to_owned());
                }
                found.head(comment)?;
                continue;
            }
            let Some((key, rest)) = content.split_once(':') else { continue };
            let indent = line.len() - content.len();
            while path.last().is_some_and(|(above, _)| *above >= indent) {
                path.pop();
            }
            let key = key.trim().trim_matches(['"', '\'']).to_owned();
            let comment = rest.split_once(" #").map(|(_, comment)| comment.trim().to_owned());
            path.push((indent, key));
            if !rest.trim().is_empty() {
                let parts: Vec<&str> = path
                    .iter()
                    .map(|(_, key)| key.as_str())
                    .filter(|key| *key != "ros__parameters")
                    .collect();
                found.comments.insert(parts.join("."), comment.unwrap_or_default());
            }
        }
        Ok(found)
    }

    fn head(&mut self, comment: &str) -> Result<(), Refusal> {
        if let Some(range) = comment.strip_prefix(SPEEDS) {
            let words: Vec<&str> = range.split_whitespace().collect();
            let number = |place: usize| words.get(place).and_then(|word| word.parse::<f64>().ok());
            let (low, high) = (number(0).unwrap_or(f64::NAN), number(2).unwrap_or(f64::NAN));
            Speeds::new(low, high, SpeedsFrom::File)?;
            self.speeds = Some((low, high));
            self.axis = match words.get(3) {
                Some(&"rad/s") => Some(Axis::Rotary),
                Some(&"m/s") => Some(Axis::Linear),
                _ => self.axis,
            };
        }
        self.volts |= comment.contains("in volts");
        Ok(())
    }

    /// Where the parameter `name` of `model` comes from, of an asymmetric contact the worse of both
    /// sides; none where the file has no such value.
    #[must_use]
    pub fn origin(&self, model: &str, name: &str) -> Option<Origin> {
        let mut worst: Option<Origin> = None;
        for (path, comment) in &self.comments {
            let parts: Vec<&str> = path.split('.').collect();
            let is_it = match parts[..] {
                [.., of, last] if of == model => last == name,
                [.., "asymmetric", of, "forward" | "backward", last] if of == model => last == name,
                [.., "forward" | "backward", last] | [last] => last == name,
                _ => false,
            };
            if !is_it {
                continue;
            }
            let origin = Origin::of(comment);
            let rank = |origin: &Origin| match origin {
                Origin::Identified => 0,
                Origin::Given(_) => 1,
                Origin::Doubtful(_) => 2,
            };
            if worst.as_ref().is_none_or(|worst| rank(&origin) > rank(worst)) {
                worst = Some(origin);
            }
        }
        worst
    }
}

impl Origin {
    /// What a comment behind a value says.
    fn of(comment: &str) -> Self {
        let given = [
            "not estimated:",
            "worked out of",
            "moved in proportion",
            "fixed while",
            "the Coulomb level over",
        ];
        // A value that changes nothing need not be known.
        let idle = ["without effect", "has no effect", "no damping of the bristle"];
        if comment.starts_with("identified") {
            Self::Identified
        } else if given.iter().any(|start| comment.starts_with(start))
            || idle.iter().any(|part| comment.contains(part))
        {
            Self::Given(comment.to_owned())
        } else {
            Self::Doubtful(comment.to_owned())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "\
# Friction models fitted by frictionlab 0.1.0 to a.csv.
# Speeds of the recordings: 0.05 to 3.0 rad/s
/friction_observer:
  ros__parameters:
    model: lugre  # the model chosen
    lugre:
      f_s: 0.0994  # identified, +- 1e-5
      sigma0: 17.3  # not identifiable from these recordings
      delta: 2.0  # not estimated: Gaussian
      f_v: 0.04
";

    #[test]
    fn comments_tell_origins_speeds_and_units() {
        let read = Annotations::read(FILE).unwrap();
        assert_eq!(
            (read.speeds, read.axis, read.volts),
            (Some((0.05, 3.0)), Some(Axis::Rotary), false)
        );
        assert!(read.first.as_ref().unwrap().contains("a.csv"));
        assert_eq!(read.origin("lugre", "f_s"), Some(Origin::Identified));
        assert!(
            matches!(read.origin("lugre", "sigma0"), Some(Origin::Doubtful(said)) if said.contains("not identifiable"))
        );
        assert!(matches!(read.origin("lugre", "delta"), Some(Origin::Given(_))));
        assert_eq!(read.origin("lugre", "f_v"), Some(Origin::Doubtful(String::new())));
        assert_eq!(read.origin("lugre", "f_c"), None);
        let line = speeds_line(1e-3, 2.0, Axis::Linear);
        let read =
            Annotations::read(&format!("# {line}\n# Friction is told in volts: so\n")).unwrap();
        assert_eq!(
            (read.speeds, read.axis, read.volts),
            (Some((1e-3, 2.0)), Some(Axis::Linear), true)
        );
    }

    #[test]
    fn of_two_directions_the_worse_counts() {
        let text = "asymmetric:\n  coulomb:\n    forward:\n      f_c: 1.0  # identified\n    backward:\n      f_c: 1.0\n";
        let origin = Annotations::read(text).unwrap().origin("coulomb", "f_c");
        assert_eq!(origin, Some(Origin::Doubtful(String::new())));
    }

    #[test]
    fn speeds_that_are_none_are_refused() {
        for line in ["", "a to b", "3 to 1 rad/s", "1"] {
            assert!(Annotations::read(&format!("# {SPEEDS} {line}\n")).is_err(), "{line}");
        }
        assert_eq!(Annotations::read(""), Ok(Annotations::default()));
    }
}
