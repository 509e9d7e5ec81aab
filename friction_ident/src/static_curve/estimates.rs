//! The fit as [`Estimates`], like every other stage.

use friction_model::Unit;

use super::{StribeckFit, StribeckParameter, Unidentifiable};
use crate::estimate::{Doubt, Estimate, Estimates, Verdict};

/// What to measure where the dip is not seen.
const SEE_DIP: &str = "average more runs at each speed, and measure at more speeds below 2 v_s";
/// What to measure where friction and slope are not told apart.
const SEE_SLOPE: &str = "measure at more speeds, and at higher ones";

impl From<Unidentifiable> for Doubt {
    fn from(reason: Unidentifiable) -> Self {
        match reason {
            Unidentifiable::LargeError { relative_error } => Self::LargeError { relative_error },
            Unidentifiable::NoDip { dip, standard_error } => {
                Self::BelowNoise { effect: dip, standard_error }
            }
            Unidentifiable::OutsideSpeeds { slowest, fastest } => {
                Self::OutsideRange { low: slowest, high: fastest }
            }
            Unidentifiable::OpenInterval { .. } => Self::OpenInterval,
            Unidentifiable::AtBound { bound } => Self::AtBound { bound },
        }
    }
}

impl StribeckFit {
    /// The four parameters with intervals and verdicts; units are those of a rotating axis.
    pub fn to_estimates(&self) -> Estimates {
        use StribeckParameter::{StribeckVelocity, Viscous};
        let parameters = self
            .estimates()
            .iter()
            .map(|estimate| {
                let unit = match estimate.parameter {
                    StribeckVelocity => Unit::Speed,
                    Viscous => Unit::Damping,
                    _ => Unit::Force,
                };
                let verdict = match estimate.unidentifiable {
                    None => Verdict::Identified,
                    Some(reason) => Verdict::NotIdentifiable {
                        doubt: reason.into(),
                        remedy: if estimate.parameter == Viscous { SEE_SLOPE } else { SEE_DIP },
                    },
                };
                Estimate {
                    id: estimate.parameter.name().into(),
                    unit: unit.rotary(),
                    value: estimate.value,
                    standard_error: estimate.standard_error,
                    interval: self.intervals[estimate.parameter as usize],
                    verdict,
                }
            })
            .collect();
        let correlation = StribeckParameter::ALL
            .map(|a| {
                StribeckParameter::ALL
                    .map(|b| if a == b { 1.0 } else { self.correlation(a, b).unwrap_or(0.0) })
                    .to_vec()
            })
            .to_vec();
        Estimates {
            parameters,
            correlation,
            covariance: self.covariance.map(|row| row.to_vec()).to_vec(),
            residual_deviation: self.variance.sqrt(),
            degrees_of_freedom: self.degrees_of_freedom,
        }
    }
}
