//! Coulomb's model.
//!
//! ```text
//! F = F_c sgn v            v != 0      (thesis eq. 2.4)
//! F = sat(F_c, F_e)        v = 0: friction balances the applied force up to F_c
//! ```
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_c` | N or N m | > 0 | kinetic friction |
//!
//! It gives the direction and the size of sliding friction. It knows no pre-sliding displacement,
//! no static level above the kinetic one and no dependence on speed; at zero velocity a simulator
//! needs the applied force (see [`FrictionModel::holding`]).

use crate::arithmetic::sign;
use crate::{
    FrictionModel, Holding, Internals, ModelError, ParameterSet, Range, Regime, State, built_from,
    memoryless, parameters,
};

parameters! {
    /// Parameters of [`Coulomb`] as files carry them.
    CoulombParameters {
        /// Kinetic friction F_c [N or N m], above zero.
        f_c: f64, Force, Range::Positive;
    }
}

/// Coulomb friction with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb {
    parameters: CoulombParameters,
}

impl TryFrom<CoulombParameters> for Coulomb {
    type Error = ModelError;

    fn try_from(parameters: CoulombParameters) -> Result<Self, ModelError> {
        parameters.check(Self::NAME)?;
        Ok(Self { parameters })
    }
}

built_from!(Coulomb, CoulombParameters);

impl FrictionModel for Coulomb {
    const NAME: &'static str = "coulomb";
    memoryless!(CoulombParameters);

    fn steady_state(&self, velocity: f64) -> f64 {
        self.parameters.f_c * sign(velocity)
    }

    fn internals(&self, _: &State<[f64; 0], ()>, velocity: f64) -> Internals {
        let regime = if velocity == 0.0 { Regime::Stick } else { Regime::Slip };
        Internals { deflection: 0.0, gamma: self.parameters.f_c, regime }
    }

    fn holding(&self, _: f64) -> Option<Holding> {
        Some(Holding::up_to(self.parameters.f_c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opposes_motion_with_a_constant_force() {
        let model = Coulomb::try_from(CoulombParameters { f_c: 0.7 }).unwrap();
        assert_eq!(model.steady_state(1e-9), 0.7);
        assert_eq!(model.steady_state(-3.0), -0.7);
        assert_eq!(model.steady_state(0.0), 0.0);
        assert_eq!(model.holding(0.0), Some(Holding::up_to(0.7)));
    }
}
