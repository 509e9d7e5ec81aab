//! Forces beside friction: a constant one, and what the position alone decides.
//!
//! A torque that drives a joint holds its weight too, amplifiers have an offset, hoses and cables
//! are springs. A friction model that is fitted to all of it takes the weight up into its
//! parameters and says nothing. So these forces are estimated beside the model, in the same fit:
//! [`choose_position_load`] says which of them the recordings show, a [`Predictor`] is a model with
//! what was found.

mod choice;
#[cfg(test)]
mod tests;

use friction_model::AnyModel;
use serde::Serialize;

use crate::axis_term::AxisTerm;
use crate::estimate::Unknown;
use crate::output_error::predict;
use crate::parameter_id::ParameterId;
use crate::rigid_axis::Load;
use crate::steady_point::SteadyPoint;
use crate::stretch::Stretch;

pub(crate) use choice::first_values;
pub use choice::{PositionLoadChoice, choose_position_load};

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

/// Where something was measured, as far as a load depends on it: of one sample, or means over
/// many.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Position \[m or rad\].
    pub position: f64,
    /// Its sine.
    pub sin: f64,
    /// Its cosine.
    pub cos: f64,
}

impl Place {
    /// Of one sample.
    #[must_use]
    pub fn at(position: f64) -> Self {
        Self { position, sin: position.sin(), cos: position.cos() }
    }

    /// The means over samples; none where there is none.
    #[must_use]
    pub fn mean(positions: &[f64]) -> Option<Self> {
        if positions.is_empty() {
            return None;
        }
        let mean = |of: fn(f64) -> f64| {
            positions.iter().map(|&q| of(q)).sum::<f64>() / positions.len() as f64
        };
        Some(Self { position: mean(|q| q), sin: mean(f64::sin), cos: mean(f64::cos) })
    }

    /// What multiplies a term here.
    pub(crate) fn regressor(self, term: AxisTerm) -> f64 {
        match term {
            AxisTerm::Offset => 1.0,
            AxisTerm::Spring => self.position,
            AxisTerm::GravitySin => self.sin,
            AxisTerm::GravityCos => self.cos,
            _ => 0.0,
        }
    }
}

/// What multiplies a term where the place may be unknown: only the constant force acts there.
pub(crate) fn regressor(term: AxisTerm, place: Option<Place>) -> f64 {
    match place {
        Some(place) => place.regressor(term),
        None => f64::from(u8::from(term == AxisTerm::Offset)),
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
        (0..stretch.len()).map(|k| self.at(place(stretch, k))).collect()
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

/// Where a sample was measured, where that is known.
pub(crate) fn place(stretch: &Stretch, sample: usize) -> Option<Place> {
    stretch.position.as_ref().and_then(|position| position.get(sample)).copied().map(Place::at)
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

/// A friction model with what acts beside it: what is predicted of a measured force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predictor {
    /// Friction.
    pub model: AnyModel,
    /// What acts beside it.
    pub load: PositionLoad,
}

impl From<AnyModel> for Predictor {
    /// Friction alone.
    fn from(model: AnyModel) -> Self {
        Self { model, load: PositionLoad::default() }
    }
}

impl Predictor {
    /// The measured force at each sample of a stretch.
    #[must_use]
    pub fn along(&self, stretch: &Stretch) -> Vec<f64> {
        if self.load.is_none() {
            return predict(&self.model, stretch);
        }
        // What a model without pre-sliding holds at rest is what is applied beside the load.
        let mut predicted = predict(&self.model, &self.load.taken_from(stretch));
        predicted.iter_mut().zip(self.load.along(stretch)).for_each(|(all, load)| *all += load);
        predicted
    }

    /// The measured force of a steady point.
    #[must_use]
    pub fn steady(&self, point: &SteadyPoint) -> f64 {
        self.model.steady_state(point.velocity) + self.load.at(point.place)
    }
}
