//! The static Stribeck model: Coulomb, viscous and static friction with the falling characteristic
//! between.
//!
//! ```text
//! F = [F_c + (F_s - F_c) exp(-|v/v_s|^delta)] sgn v + f_v v      v != 0      (thesis eq. 2.11, sgn and |.| restored)
//! F = sat(F_s, F_e)                                              v = 0
//! ```
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_s` | N or N m | >= `f_c` | static friction |
//! | `f_c` | N or N m | > 0 | kinetic friction |
//! | `v_s` | m/s or rad/s | > 0 | Stribeck velocity |
//! | `delta` | - | (0, 10], 2 if left out | shape exponent |
//! | `f_v` | N s/m or N m s/rad | >= 0 | viscous coefficient |
//!
//! It gives the steady sliding characteristic of every dynamic model here and stick-slip where
//! sticking is handled as an event. It has no pre-sliding displacement, no lag and no memory.

use crate::finite::finite;
use crate::stribeck_curve::SHAPE;
use crate::{
    FrictionModel, Holding, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    StribeckCurve, built_from, memoryless, parameters,
};

parameters! {
    /// Parameters of [`Stribeck`] as files carry them.
    StribeckParameters<T> {
        /// Static friction F_s \[N or N m\], at least `f_c`.
        f_s: T, Force, Range::Positive;
        /// Kinetic friction F_c \[N or N m\], above zero.
        f_c: T, Force, Range::Positive;
        /// Stribeck velocity v_s \[m/s or rad/s\], above zero.
        v_s: T, Speed, Range::Positive;
        /// Shape exponent of the Stribeck curve, above 0 and at most 10; 2 if left out.
        #[serde(default = "StribeckCurve::gaussian")]
        delta: T, None, SHAPE;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more.
        f_v: T, Damping, Range::NonNegative;
    }
}

/// The static Stribeck model with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stribeck<T: Real = f64> {
    parameters: StribeckParameters<T>,
    curve: StribeckCurve<T>,
}

impl<T: Real> TryFrom<StribeckParameters<T>> for Stribeck<T> {
    type Error = ModelError;

    fn try_from(p: StribeckParameters<T>) -> Result<Self, ModelError> {
        p.check(Self::NAME)?;
        let curve = StribeckCurve::new(Self::NAME, p.f_s, p.f_c, p.v_s, p.delta)?;
        finite(Self { parameters: p, curve })
    }
}

built_from!([T: Real] Stribeck<T>, StribeckParameters<T>);

impl<T: Real> FrictionModel<T> for Stribeck<T> {
    const NAME: &'static str = "stribeck";
    memoryless!([T] StribeckParameters<T>);

    #[inline]
    fn steady_state(&self, velocity: T) -> T {
        self.curve.signed_level(velocity) + self.parameters.f_v * velocity
    }

    fn internals(&self, _: &State<[T; 0], ()>, velocity: T) -> Internals<T> {
        let regime = if velocity == T::ZERO { Regime::Stick } else { Regime::Slip };
        Internals { deflection: T::ZERO, gamma: self.curve.level(velocity), regime }
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    fn holding(&self, _: T) -> Option<Holding<T>> {
        Some(Holding::up_to(self.parameters.f_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falls_from_the_static_to_the_kinetic_level_then_rises() {
        let model = Stribeck::test_bed();
        assert!((model.steady_state(1e-12) - 0.0994).abs() < 1e-12);
        let at_v_s = 0.0925 + 0.0069 * (-1.0f64).exp() + 0.0403 * 0.1407;
        assert!((model.steady_state(0.1407) - at_v_s).abs() < 1e-15);
        assert!((model.steady_state(4.0) - (0.0925 + 0.0403 * 4.0)).abs() < 1e-15);
        assert_eq!(model.steady_state(-4.0), -model.steady_state(4.0));
    }
}
