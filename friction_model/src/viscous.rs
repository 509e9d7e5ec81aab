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

use crate::{
    FrictionModel, Internals, ModelError, ParameterSet, Range, Regime, State, built_from,
    memoryless, parameters,
};

parameters! {
    /// Parameters of [`Viscous`] as files carry them.
    ViscousParameters {
        /// Viscous coefficient f_v [N s/m or N m s/rad], zero or more.
        f_v: f64, Damping, Range::NonNegative;
    }
}

/// Viscous friction with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viscous {
    parameters: ViscousParameters,
}

impl TryFrom<ViscousParameters> for Viscous {
    type Error = ModelError;

    fn try_from(parameters: ViscousParameters) -> Result<Self, ModelError> {
        parameters.check(Self::NAME)?;
        Ok(Self { parameters })
    }
}

built_from!(Viscous, ViscousParameters);

impl FrictionModel for Viscous {
    const NAME: &'static str = "viscous";
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
