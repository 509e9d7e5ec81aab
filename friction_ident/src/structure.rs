//! Which terms the model of an axis has: a value, and its name.

use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};

/// The structure of an axis model. Every one has an inertia, viscous and Coulomb friction; the
/// fields say what it has beside them.
///
/// Written as a name: `symmetric` or `asymmetric`, then the rest joined by `+`, as in
/// `asymmetric+stribeck+delay`. `damping` brings `presliding` with it, `lag` that and `stribeck`.
///
/// ```
/// use friction_ident::axis_structure::AxisStructure;
///
/// let structure: AxisStructure = "asymmetric+delay+stribeck".parse()?;
/// assert_eq!(structure.to_string(), "asymmetric+stribeck+delay");
/// assert_eq!(structure.parameters(), 9);
/// # Ok::<(), friction_ident::axis_structure::UnknownStructure>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct AxisStructure {
    /// Friction parameters of their own for each direction, in place of one set and an offset.
    pub asymmetric: bool,
    /// Friction rises from `f_c` to `f_s` towards rest, as `exp(-(v/v_s)^2)` (Stribeck; thesis eq.
    /// 2.9 with exponent 2).
    pub stribeck: bool,
    /// Friction passes through zero over a displacement after a reversal (Dahl's bristle) instead
    /// of in a step.
    pub presliding: bool,
    /// The bristle damps itself: friction has a part that goes with the rate of its deflection, the
    /// micro-damping of LuGre (Canudas de Wit et al. 1995). Only beside `presliding`.
    pub damping: bool,
    /// The friction level follows the velocity as far as the bristle moves, as LuGre's does, and not
    /// at once. Only beside `stribeck` and `presliding`; no further parameter.
    pub lag: bool,
    /// The force acts later than it was recorded.
    pub delay: bool,
    /// The friction level and a constant force vary along the axis, as polynomials of the position.
    pub position: bool,
    /// The torque of a weight that turns with the axis, `a sin q + b cos q`, and a constant one.
    pub gravity: bool,
    /// A force that repeats along the axis: cogging, the turn of a screw.
    pub harmonic: bool,
}

/// The field that a part of a name switches on.
type Field = fn(&mut AxisStructure) -> &mut bool;

/// The parts of a name, with what they switch on.
const PARTS: [(&str, Field); 8] = [
    ("stribeck", |s| &mut s.stribeck),
    ("presliding", |s| &mut s.presliding),
    ("damping", |s| &mut s.damping),
    ("lag", |s| &mut s.lag),
    ("delay", |s| &mut s.delay),
    ("position", |s| &mut s.position),
    ("gravity", |s| &mut s.gravity),
    ("harmonic", |s| &mut s.harmonic),
];

impl AxisStructure {
    /// Of the levels of friction the one that is the bristle's stiffness times its displacement: that
    /// at rest where a dip follows at once, the kinetic one where it lags or there is none.
    pub fn level_of_stiffness<T>(&self, at_rest: T, kinetic: T) -> T {
        if self.stribeck && !self.lag { at_rest } else { kinetic }
    }

    /// Inertia, viscous and Coulomb friction, offset: the model that is published with the EMPS
    /// benchmark.
    pub const SYMMETRIC: Self = Self {
        asymmetric: false,
        stribeck: false,
        presliding: false,
        damping: false,
        lag: false,
        delay: false,
        position: false,
        gravity: false,
        harmonic: false,
    };
    /// The same with viscous and Coulomb friction of each direction.
    pub const ASYMMETRIC: Self = Self { asymmetric: true, ..Self::SYMMETRIC };

    /// The structures that have one part more or one less, or another symmetry. A bristle comes and
    /// goes with its damping as well as without: one whose force is mostly damping is worth nothing
    /// alone.
    pub fn neighbours(&self) -> Vec<Self> {
        let fields: [Field; 9] = [
            |s| &mut s.asymmetric,
            |s| &mut s.stribeck,
            |s| &mut s.presliding,
            |s| &mut s.damping,
            |s| &mut s.lag,
            |s| &mut s.delay,
            |s| &mut s.position,
            |s| &mut s.gravity,
            |s| &mut s.harmonic,
        ];
        let changed = |field: Field| {
            let mut other = *self;
            let part = field(&mut other);
            *part = !*part;
            if other.damping && !other.presliding {
                let both = !self.damping;
                (other.presliding, other.damping) = (both, both);
            }
            if other.lag && !self.lag {
                (other.stribeck, other.presliding) = (true, true);
            }
            other.lag &= other.stribeck && other.presliding;
            other
        };
        fields.into_iter().map(changed).collect()
    }

    /// All that there are.
    #[cfg(test)]
    pub(crate) fn all() -> Vec<Self> {
        let mut all = vec![Self::SYMMETRIC];
        let mut next = 0;
        while let Some(structure) = all.get(next).copied() {
            let new: Vec<Self> =
                structure.neighbours().into_iter().filter(|near| !all.contains(near)).collect();
            all.extend(new);
            next += 1;
        }
        all
    }

    /// Parameters to be estimated, the nonlinear ones included.
    pub fn parameters(&self) -> usize {
        let sides = if self.asymmetric { 2 } else { 1 };
        let extra = |has: bool, count: usize| if has { count } else { 0 };
        1 + 2 * sides
            + extra(!self.asymmetric, 1)
            + extra(self.stribeck, sides + 1)
            + extra(self.presliding, 1)
            + extra(self.damping, 1)
            + extra(self.delay, 1)
            + extra(self.position, 3)
            + extra(self.gravity, 2)
            + extra(self.harmonic, 3)
    }

    /// Whether its force is linear in all of its parameters.
    pub fn is_linear(&self) -> bool {
        !(self.stribeck || self.presliding || self.delay || self.harmonic)
    }

    /// Whether it needs the position, and not the velocity alone.
    pub fn needs_position(&self) -> bool {
        self.position || self.gravity || self.harmonic
    }
}

impl fmt::Display for AxisStructure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.asymmetric { "asymmetric" } else { "symmetric" })?;
        let mut own = *self;
        for (name, part) in PARTS {
            if *part(&mut own) {
                write!(f, "+{name}")?;
            }
        }
        Ok(())
    }
}

impl Serialize for AxisStructure {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// A name that is none of a structure.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{part}` in `{name}` is no part of an axis structure; expected `symmetric` or `asymmetric`, then any of stribeck, presliding, damping, lag, \
     delay, position, gravity, harmonic, joined by `+` as in `asymmetric+stribeck+delay`"
)]
pub struct UnknownStructure {
    /// The whole name.
    pub name: String,
    /// The part that is not known, or not there.
    pub part: String,
}

impl FromStr for AxisStructure {
    type Err = UnknownStructure;

    fn from_str(name: &str) -> Result<Self, UnknownStructure> {
        let unknown =
            |part: &str| UnknownStructure { name: name.to_owned(), part: part.to_owned() };
        let mut parts = name.split('+').map(str::trim);
        let mut structure = match parts.next() {
            Some("symmetric") => Self::SYMMETRIC,
            Some("asymmetric") => Self::ASYMMETRIC,
            other => return Err(unknown(other.unwrap_or_default())),
        };
        for part in parts {
            let (_, field) =
                PARTS.iter().find(|(known, _)| *known == part).ok_or_else(|| unknown(part))?;
            *field(&mut structure) = true;
        }
        structure.presliding |= structure.damping || structure.lag;
        structure.stribeck |= structure.lag;
        Ok(structure)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_reads_back() {
        for structure in AxisStructure::all() {
            assert_eq!(structure.to_string().parse(), Ok(structure));
        }
        let damped = "symmetric+damping".parse::<AxisStructure>().unwrap();
        assert_eq!(damped.to_string(), "symmetric+presliding+damping");
        let lugre = "symmetric+lag+damping".parse::<AxisStructure>().unwrap();
        assert_eq!(lugre.to_string(), "symmetric+stribeck+presliding+damping+lag");
        assert_eq!(lugre.parameters(), AxisStructure { lag: false, ..lugre }.parameters());
        for (name, part) in [("", "``"), ("lugre", "`lugre`"), ("asymmetric+stribec", "`stribec`")]
        {
            let message = name.parse::<AxisStructure>().unwrap_err().to_string();
            assert!(message.starts_with(part), "{message}");
        }
    }

    #[test]
    fn all_are_reached_by_one_part_after_the_other() {
        let all = AxisStructure::all();
        // Damping only where there is a bristle, lag only where that has a dip to follow.
        assert_eq!(all.len(), (2 * 3 + 2) << 5);
        for (i, a) in all.iter().enumerate() {
            assert!(!all[i + 1..].contains(a), "{a}");
        }
    }
}
