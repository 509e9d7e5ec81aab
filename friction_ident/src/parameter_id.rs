//! Which number of a model or a fit is meant.

use std::fmt;

use serde::{Serialize, Serializer};

/// One direction of motion, or both.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Side {
    /// The same number for both directions.
    #[default]
    Both,
    /// Against forward motion.
    Forward,
    /// Against backward motion.
    Backward,
}

impl Side {
    /// The sides that have numbers of their own: the two directions, or both at once.
    pub const fn of(asymmetric: bool) -> &'static [Self] {
        if asymmetric { &[Self::Forward, Self::Backward] } else { &[Self::Both] }
    }

    /// The direction of a velocity; forward at rest.
    pub fn of_velocity(velocity: f64) -> Self {
        if velocity < 0.0 { Self::Backward } else { Self::Forward }
    }
}

/// Names of numbers that may have either sign.
const SIGNED: [&str; 8] = [
    "offset",
    "spring",
    "f_c_slope",
    "f_c_curvature",
    "harmonic_cos",
    "harmonic_sin",
    "gravity_sin",
    "gravity_cos",
];

/// One number: a parameter, an element of one that is a list, one direction's value of it.
///
/// It is told from others by its parts; its text is for reports and files.
///
/// ```
/// use friction_ident::{ParameterId, Side};
///
/// let third = ParameterId::new("sigma0").element(2);
/// assert_eq!(third.to_string(), "sigma0[2]");
/// let backward = ParameterId::new("f_c").side(Side::Backward);
/// assert_eq!(backward.to_string(), "f_c.backward");
/// assert_eq!(backward, "f_c.backward".into());
/// assert_ne!(backward, "f_c".into());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ParameterId {
    /// Name as in parameter files.
    pub name: &'static str,
    /// Which element of a list, from zero; none for a plain number.
    pub element: Option<usize>,
    /// Which direction.
    pub side: Side,
}

impl ParameterId {
    /// A plain number that holds for both directions.
    #[must_use]
    pub const fn new(name: &'static str) -> Self {
        Self { name, element: None, side: Side::Both }
    }

    /// An element of the list.
    #[must_use]
    pub const fn element(self, element: usize) -> Self {
        Self { element: Some(element), ..self }
    }

    /// The value for one direction.
    #[must_use]
    pub const fn side(self, side: Side) -> Self {
        Self { side, ..self }
    }

    /// Whether it may have either sign: what acts beside friction, and how friction changes along
    /// the axis.
    #[must_use]
    pub fn is_signed(self) -> bool {
        SIGNED.contains(&self.name)
    }

    /// Place among the parameter's numbers: the element, zero for a plain number.
    #[must_use]
    pub fn index(self) -> usize {
        self.element.unwrap_or(0)
    }
}

impl From<&'static str> for ParameterId {
    /// Reads its text; what has neither the form of an element nor that of a direction is a name.
    fn from(text: &'static str) -> Self {
        let (text, side) = match text.rsplit_once('.') {
            Some((text, "forward")) => (text, Side::Forward),
            Some((text, "backward")) => (text, Side::Backward),
            _ => (text, Side::Both),
        };
        let element = text.strip_suffix(']').and_then(|text| {
            let (name, element) = text.rsplit_once('[')?;
            Some((name, element.parse().ok()?))
        });
        match element {
            Some((name, element)) => Self::new(name).element(element).side(side),
            None => Self::new(text).side(side),
        }
    }
}

impl fmt::Display for ParameterId {
    /// As reports and files spell it: `f_s`, `sigma0[2]`, `f_c.backward`.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let element = self.element.map(|element| format!("[{element}]")).unwrap_or_default();
        let side = match self.side {
            Side::Both => "",
            Side::Forward => ".forward",
            Side::Backward => ".backward",
        };
        // Padded as a whole, for tables.
        f.pad(&format!("{}{element}{side}", self.name))
    }
}

impl Serialize for ParameterId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_names_element_and_direction() {
        let id = ParameterId::new("sigma0").element(3).side(Side::Backward);
        assert_eq!(id.to_string(), "sigma0[3].backward");
        assert_eq!(
            format!("{:>6}|{:4}|", ParameterId::new("f_s"), ParameterId::new("k")),
            "   f_s|k   |"
        );
        assert_eq!(serde_json::to_string(&id).unwrap(), "\"sigma0[3].backward\"");
    }

    #[test]
    fn the_text_is_read_back() {
        for id in [ParameterId::new("f_s"), ParameterId::new("k").element(10)] {
            for side in [Side::Both, Side::Forward, Side::Backward] {
                let id = id.side(side);
                assert_eq!(ParameterId::from(id.to_string().leak() as &'static str), id);
            }
        }
        for name in ["", "a[b]", "a[-1]", "a]", "[", "lag.k_p"] {
            assert_eq!(ParameterId::from(name), ParameterId::new(name));
        }
    }

    #[test]
    fn elements_and_directions_are_numbers_of_their_own() {
        let whole = ParameterId::new("sigma0");
        assert!(whole != whole.element(0) && whole != whole.side(Side::Forward));
        assert_eq!((whole.index(), whole.element(2).index()), (0, 2));
    }
}
