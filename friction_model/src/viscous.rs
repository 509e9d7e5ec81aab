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

use crate::memoryless::memoryless;
use crate::parameter::{built_from, parameters};
use crate::{
    FrictionModel, Internals, ModelError, ModelName, ParameterSet, Presets, Range, Regime, State,
};

parameters! {
    /// Parameters of [`Viscous`] as files carry them.
    ViscousParameters {
        /// Viscous coefficient f_v [N s/m or N m s/rad], zero or more.
        f_v: f64, Damping, Range::NonNegative;
    }
}

impl Presets for ViscousParameters {
    fn test_bed() -> Self {
        Self { f_v: 0.0403 }
    }
    /// The viscous coefficient of the thesis's velocity example (section 5.4): chapter 3 has none.
    fn chapter_3() -> Self {
        Self { f_v: 0.0176 }
    }
}

/// Viscous friction with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ViscousParameters", into = "ViscousParameters")]
pub struct Viscous {
    parameters: ViscousParameters,
}

impl TryFrom<ViscousParameters> for Viscous {
    type Error = ModelError;

    fn try_from(parameters: ViscousParameters) -> Result<Self, ModelError> {
        parameters.check(ModelName::Viscous)?;
        Ok(Self { parameters })
    }
}

built_from!(Viscous, ViscousParameters);

impl FrictionModel for Viscous {
    const NAME: ModelName = ModelName::Viscous;
    memoryless!(ViscousParameters);

    fn steady_state(&self, velocity: f64) -> f64 {
        self.parameters.f_v * velocity
    }

    fn internals(&self, _: &State<[f64; 0], ()>, _: f64) -> Internals {
        Internals { deflection: 0.0, gamma: 0.0, regime: Regime::Slip }
    }

    fn viscous(&self, velocity: f64) -> f64 {
        self.parameters.f_v * velocity
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
