//! What the place of the shaft alone asks for: a load that hangs, a cable that winds up.

use ::parameters::parameters;
use serde::{Deserialize, Serialize};

use crate::{ControlMode, Reference};

parameters! {
    /// `offset + sine sin(q) + cosine cos(q) + slope q` at the place `q` of the reference, in the
    /// position mode. It depends on the reference alone, so that the loop stays what it is.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct Load {
        offset: f64, "Voltage that holds the load, whatever its place", unit("V");
        sine: f64, "Voltage that holds a load that hangs, by the sine of the place", unit("V");
        cosine: f64, "The same by the cosine of the place", unit("V");
        slope: f64, "Voltage that holds a spring, by the place", unit("V/rad");
    }
}

impl Load {
    /// No load.
    pub const NONE: Self = Self { offset: 0.0, sine: 0.0, cosine: 0.0, slope: 0.0 };

    /// The voltage at a place \[rad\] \[V\].
    #[inline]
    #[must_use]
    pub fn at(&self, place: f64) -> f64 {
        let (sin, cos) = place.sin_cos();
        self.offset + self.sine * sin + self.cosine * cos + self.slope * place
    }

    /// What is fed forward for `reference` \[V\].
    #[inline]
    #[must_use]
    pub(crate) fn volts(&self, mode: ControlMode, reference: &Reference) -> f64 {
        // What is not there need not be computed, nor be a number.
        if *self == Self::NONE || mode == ControlMode::Velocity {
            return 0.0;
        }
        self.at(reference.position)
    }

    /// The same load for whoever counts places from `origin` \[rad\] on.
    #[must_use]
    pub fn from(&self, origin: f64) -> Self {
        let (sin, cos) = origin.sin_cos();
        Self {
            offset: self.offset + self.slope * origin,
            sine: self.sine * cos - self.cosine * sin,
            cosine: self.sine * sin + self.cosine * cos,
            slope: self.slope,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_load_is_the_same_wherever_places_are_counted_from() {
        let load = Load { offset: 0.1, sine: 0.4, cosine: -0.3, slope: 0.05 };
        let moved = load.from(1.3);
        for place in [-2.0, 0.0, 0.7, 9.0] {
            assert!((moved.at(place) - load.at(place + 1.3)).abs() < 1e-12, "{place}");
        }
    }
}
