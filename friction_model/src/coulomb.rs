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
use crate::finite::finite;
use crate::{
    FrictionModel, Holding, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    built_from, memoryless, parameters,
};

parameters! {
    /// Parameters of [`Coulomb`] as files carry them.
    CoulombParameters<T> {
        /// Kinetic friction F_c \[N or N m\], above zero.
        f_c: T, Force, Range::Positive;
    }
}

/// Coulomb friction with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb<T: Real = f64> {
    parameters: CoulombParameters<T>,
}

impl<T: Real> TryFrom<CoulombParameters<T>> for Coulomb<T> {
    type Error = ModelError;

    fn try_from(parameters: CoulombParameters<T>) -> Result<Self, ModelError> {
        parameters.check(Self::NAME)?;
        finite(Self { parameters })
    }
}

built_from!([T: Real] Coulomb<T>, CoulombParameters<T>);

impl<T: Real> FrictionModel<T> for Coulomb<T> {
    const NAME: &'static str = "coulomb";
    memoryless!([T] CoulombParameters<T>);

    fn steady_state(&self, velocity: T) -> T {
        self.parameters.f_c * sign(velocity)
    }

    fn internals(&self, _: &State<[T; 0], ()>, velocity: T) -> Internals<T> {
        let regime = if velocity == T::ZERO { Regime::Stick } else { Regime::Slip };
        Internals { deflection: T::ZERO, gamma: self.parameters.f_c, regime }
    }

    fn holding(&self, _: T) -> Option<Holding<T>> {
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
