//! Forces beside friction: a constant one, and what the position alone decides.
//!
//! A torque that drives a joint holds its weight too, amplifiers have an offset, hoses and cables
//! are springs. A friction model that is fitted to all of it takes the weight up into its
//! parameters and says nothing. So these forces are estimated beside the model, in the same fit:
//! [`choose_position_load`](crate::choose_position_load) says which of them the recordings show, a
//! [`Predictor`](crate::Predictor) is a model with what was found.

use serde::Serialize;

use crate::axis_term::AxisTerm;
use crate::estimate::Unknown;
use crate::parameter_id::ParameterId;
use crate::place::Place;
use crate::rigid_axis::Load;
use crate::steady_point::SteadyPoint;
use crate::stretch::Stretch;

/// Which forces beside friction a fit estimates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct LoadShape {
    /// A constant force.
    pub offset: bool,
    /// A force that the position alone decides.
    pub position: Load,
}

impl LoadShape {
    /// Friction alone.
    pub const NONE: Self = Self { offset: false, position: Load::None };

    /// The terms, in the order of the estimates.
    #[must_use]
    pub fn terms(self) -> Vec<AxisTerm> {
        let mut terms = Vec::new();
        if self.offset {
            terms.push(AxisTerm::Offset);
        }
        match self.position {
            Load::None => {}
            Load::Spring => terms.push(AxisTerm::Spring),
            Load::Gravity => terms.extend([AxisTerm::GravitySin, AxisTerm::GravityCos]),
        }
        terms
    }

    /// In words: `no offset and no load`, `an offset and gravity`.
    #[must_use]
    pub fn describe(self) -> String {
        match (self.offset, self.position) {
            (false, Load::None) => "no offset and no load".to_owned(),
            (false, position) => position.describe().to_owned(),
            (true, Load::None) => "an offset".to_owned(),
            (true, position) => format!("an offset and {}", position.describe()),
        }
    }
}

impl Default for LoadShape {
    fn default() -> Self {
        Self::NONE
    }
}

/// Forces beside friction with their values; zero is none.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct PositionLoad {
    /// Constant force \[N or N m\].
    pub offset: f64,
    /// Of a spring, per position \[N/m or N m/rad\].
    pub spring: f64,
    /// Of gravity, with the sine of the angle \[N m\].
    pub gravity_sin: f64,
    /// Of gravity, with the cosine of the angle \[N m\].
    pub gravity_cos: f64,
}

impl PositionLoad {
    pub(crate) fn of(terms: &[AxisTerm], values: &[f64]) -> Self {
        let of = |term| {
            let found = terms.iter().zip(values).find(|(other, _)| **other == term);
            found.map_or(0.0, |(_, value)| *value)
        };
        Self {
            offset: of(AxisTerm::Offset),
            spring: of(AxisTerm::Spring),
            gravity_sin: of(AxisTerm::GravitySin),
            gravity_cos: of(AxisTerm::GravityCos),
        }
    }

    pub(crate) fn value(&self, term: AxisTerm) -> f64 {
        match term {
            AxisTerm::Offset => self.offset,
            AxisTerm::Spring => self.spring,
            AxisTerm::GravitySin => self.gravity_sin,
            AxisTerm::GravityCos => self.gravity_cos,
            _ => 0.0,
        }
    }

    /// Both together.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            offset: self.offset + other.offset,
            spring: self.spring + other.spring,
            gravity_sin: self.gravity_sin + other.gravity_sin,
            gravity_cos: self.gravity_cos + other.gravity_cos,
        }
    }

    /// Whether nothing acts beside friction.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// The force at a place \[N or N m\]; the constant one alone where it is unknown.
    #[must_use]
    pub fn at(&self, place: Option<Place>) -> f64 {
        self.offset
            + place.map_or(0.0, |at| {
                self.spring * at.position + self.gravity_sin * at.sin + self.gravity_cos * at.cos
            })
    }

    /// The force at each sample of a stretch.
    #[must_use]
    pub fn along(&self, stretch: &Stretch) -> Vec<f64> {
        (0..stretch.len()).map(|k| self.at(stretch.place(k))).collect()
    }

    /// The stretch without this force: its friction alone.
    #[must_use]
    pub fn taken_from(&self, stretch: &Stretch) -> Stretch {
        let mut stretch = stretch.clone();
        let force = self.along(&stretch);
        stretch.friction.iter_mut().zip(force).for_each(|(friction, force)| *friction -= force);
        stretch
    }

    /// The point without this force.
    #[must_use]
    pub fn taken_from_point(&self, point: &SteadyPoint) -> SteadyPoint {
        SteadyPoint { torque: point.torque - self.at(point.place), ..*point }
    }
}

/// Name, unit and remedy of each term.
pub(crate) fn unknowns(terms: &[AxisTerm], rotary: bool) -> impl Iterator<Item = Unknown> {
    terms.iter().map(move |&term| Unknown {
        id: ParameterId::new(term.name()),
        unit: match (term, rotary) {
            (AxisTerm::Spring, true) => "N m/rad",
            (AxisTerm::Spring, false) => "N/m",
            (_, true) => "N m",
            (_, false) => "N",
        },
        remedy: "motion in both directions over the whole travel",
    })
}
