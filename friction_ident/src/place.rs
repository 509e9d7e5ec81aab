//! Where something was measured, as far as a spring or gravity depends on it.

use crate::axis_term::AxisTerm;

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
