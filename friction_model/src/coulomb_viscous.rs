//! Coulomb and viscous friction.
//!
//! ```text
//! F = F_c sgn v + f_v v    v != 0      (thesis eq. 2.6)
//! F = sat(F_c, F_e)        v = 0: friction balances the applied force up to F_c
//! ```
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_c` | N or N m | > 0 | kinetic friction |
//! | `f_v` | N s/m or N m s/rad | >= 0 | viscous coefficient |
//!
//! It reproduces sliding friction that grows with speed, and a contact that holds up to the kinetic
//! level. It has no static level above the kinetic one and no falling characteristic, so nothing
//! sticks and slips under it; it has no pre-sliding displacement, no lag and no memory.
//!
//! Use it for well lubricated axes, for a first identification (both parameters are linear in the
//! force) and for speeds well above the Stribeck velocity.
//!
//! Fixed-step form: the formula itself, with 0 at `v = 0`, where the applied force would have to be
//! known (see [`FrictionModel::holding`]).

use crate::arithmetic::sign;
use crate::finite::finite;
use crate::{
    FrictionModel, Holding, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    built_from, memoryless, parameters,
};

parameters! {
    /// Parameters of [`CoulombViscous`] as files carry them.
    CoulombViscousParameters<T> {
        /// Kinetic friction F_c \[N or N m\], above zero.
        f_c: T, Force, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more.
        f_v: T, Damping, Range::NonNegative;
    }
}

/// Coulomb and viscous friction with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoulombViscous<T: Real = f64> {
    parameters: CoulombViscousParameters<T>,
}

impl<T: Real> TryFrom<CoulombViscousParameters<T>> for CoulombViscous<T> {
    type Error = ModelError;

    fn try_from(parameters: CoulombViscousParameters<T>) -> Result<Self, ModelError> {
        parameters.check(Self::NAME)?;
        finite(Self { parameters })
    }
}

built_from!([T: Real] CoulombViscous<T>, CoulombViscousParameters<T>);

impl<T: Real> FrictionModel<T> for CoulombViscous<T> {
    const NAME: &'static str = "coulomb_viscous";
    memoryless!([T] CoulombViscousParameters<T>);

    #[inline]
    fn steady_state(&self, velocity: T) -> T {
        self.parameters.f_c * sign(velocity) + self.parameters.f_v * velocity
    }

    fn internals(&self, _: &State<[T; 0], ()>, velocity: T) -> Internals<T> {
        let regime = if velocity == T::ZERO { Regime::Stick } else { Regime::Slip };
        Internals { deflection: T::ZERO, gamma: self.parameters.f_c, regime }
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    fn holding(&self, _: T) -> Option<Holding<T>> {
        Some(Holding::up_to(self.parameters.f_c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Body, Drive};

    #[test]
    fn is_a_level_and_a_slope() {
        let model = CoulombViscous::test_bed();
        for v in [1e-9, 0.03, 0.5, 4.0] {
            assert!((model.steady_state(v) - (0.0925 + 0.0403 * v)).abs() < 1e-15, "{v}");
            assert_eq!(model.steady_state(-v), -model.steady_state(v));
            assert!((model.steady_state(v) - model.viscous(v) - 0.0925).abs() < 1e-15);
        }
        assert_eq!(model.steady_state(0.0), 0.0);
        assert_eq!(model.holding(1.0), Some(Holding::up_to(0.0925)));
        for (f_c, f_v) in
            [(0.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)]
        {
            assert!(
                CoulombViscous::try_from(CoulombViscousParameters { f_c, f_v }).is_err(),
                "{f_c} {f_v}"
            );
        }
    }

    /// `m v' = F_e - F_c - f_v v`: the speed settles exponentially at `(F_e - F_c) / f_v`.
    #[test]
    fn a_pushed_body_settles_exponentially() {
        let model =
            CoulombViscous::try_from(CoulombViscousParameters { f_c: 1.0, f_v: 0.5 }).unwrap();
        let mut body = Body::<_, 0>::new(model, 2.0);
        for k in 1..=8000 {
            body.advance(1e-3, |_| Drive::from(3.0));
            let expected = 4.0 * (1.0 - (-0.25e-3 * f64::from(k)).exp());
            assert!((body.moment().velocity - expected).abs() < 1e-12, "step {k}");
        }
    }
}
