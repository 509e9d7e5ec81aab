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

use crate::finite::finite;
use crate::{
    FrictionModel, Internals, ModelError, ParameterSet, Range, Real, Regime, State, built_from,
    memoryless, parameters,
};

parameters! {
    /// Parameters of [`Viscous`] as files carry them.
    ViscousParameters<T> {
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more.
        f_v: T, Damping, Range::NonNegative;
    }
}

/// Viscous friction with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viscous<T: Real = f64> {
    parameters: ViscousParameters<T>,
}

impl<T: Real> TryFrom<ViscousParameters<T>> for Viscous<T> {
    type Error = ModelError;

    fn try_from(parameters: ViscousParameters<T>) -> Result<Self, ModelError> {
        parameters.check(Self::NAME)?;
        finite(Self { parameters })
    }
}

built_from!([T: Real] Viscous<T>, ViscousParameters<T>);

impl<T: Real> FrictionModel<T> for Viscous<T> {
    const NAME: &'static str = "viscous";
    memoryless!([T] ViscousParameters<T>);

    fn steady_state(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    fn internals(&self, _: &State<[T; 0], ()>, _: T) -> Internals<T> {
        Internals { deflection: T::ZERO, gamma: T::ZERO, regime: Regime::Slip }
    }

    fn viscous(&self, velocity: T) -> T {
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
