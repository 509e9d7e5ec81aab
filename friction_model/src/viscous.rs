//! Viscous friction.
//!
//! ```text
//! F = f_v v        (thesis eq. 2.5)
//! ```
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_v` | N s/m or N m s/rad | >= 0 | viscous coefficient |
//!
//! Right for a full fluid film. It has no static friction at all: nothing sticks.

use serde::{Deserialize, Serialize};

use crate::model::bounded;
use crate::parameter::Check;
use crate::{Evaluation, FrictionModel, Internals, ModelError, ModelName, Regime, State, TimeStep};

/// Parameters of [`Viscous`] as files carry them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViscousParameters {
    /// Viscous coefficient f_v [N s/m or N m s/rad], zero or more.
    pub f_v: f64,
}

/// Viscous friction with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ViscousParameters", into = "ViscousParameters")]
pub struct Viscous {
    parameters: ViscousParameters,
}

impl Viscous {
    /// The test bed's viscous coefficient (thesis Table 4.13).
    #[must_use]
    pub const fn test_bed() -> Self {
        Self { parameters: ViscousParameters { f_v: 0.0403 } }
    }

    /// The parameters.
    #[must_use]
    pub const fn parameters(&self) -> &ViscousParameters {
        &self.parameters
    }
}

impl TryFrom<ViscousParameters> for Viscous {
    type Error = ModelError;

    fn try_from(parameters: ViscousParameters) -> Result<Self, ModelError> {
        Check(ModelName::Viscous).non_negative("f_v", parameters.f_v, "N m s/rad")?;
        Ok(Self { parameters })
    }
}

impl From<Viscous> for ViscousParameters {
    fn from(model: Viscous) -> Self {
        model.parameters
    }
}

impl FrictionModel for Viscous {
    const NAME: ModelName = ModelName::Viscous;
    type Continuous = [f64; 0];
    type Memory = ();
    type Discrete = ();

    fn rest(&self) -> State<[f64; 0], ()> {
        State { continuous: [], memory: () }
    }

    fn evaluate(&self, _: &[f64; 0], (): &(), velocity: f64) -> Evaluation<[f64; 0]> {
        Evaluation { force: self.steady_state(velocity), rates: [] }
    }

    fn commit(&self, _: &mut State<[f64; 0], ()>) {}

    fn discretise(&self, _: TimeStep) {}

    fn step(&self, (): &(), _: &mut State<[f64; 0], ()>, velocity: f64) -> f64 {
        self.steady_state(bounded(velocity))
    }

    fn steady_state(&self, velocity: f64) -> f64 {
        self.parameters.f_v * velocity
    }

    fn internals(&self, _: &State<[f64; 0], ()>, _: f64) -> Internals {
        Internals { deflection: 0.0, gamma: 0.0, regime: Regime::Slip }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_proportional_to_velocity() {
        let model = Viscous::try_from(ViscousParameters { f_v: 0.0403 }).unwrap();
        assert_eq!(model.steady_state(2.0), 0.0806);
        assert!(Viscous::try_from(ViscousParameters { f_v: -0.1 }).is_err());
    }
}
