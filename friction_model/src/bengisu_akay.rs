//! Bengisu and Akay's continuous characteristic.
//!
//! ```text
//! F = F_s [1 - (|v|/v_0 - 1)^2] sgn v + f_v v                          |v| <= v_0
//! F = [F_c + (F_s - F_c) exp(-xi (|v| - v_0))] sgn v + f_v v           |v| >  v_0
//! ```
//!
//! M. T. Bengisu and A. Akay, "Stability of friction-induced vibrations in multi-degree-of-freedom
//! systems", Journal of Sound and Vibration 171 (1994), 557-570. The viscous term is an addition of
//! this crate, zero if left out; theirs has none.
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_s` | N or N m | >= `f_c` | static friction, the top of the characteristic |
//! | `f_c` | N or N m | > 0 | kinetic friction |
//! | `v_0` | m/s or rad/s | > 0 | speed at the top |
//! | `xi` | s/m or s/rad | > 0 | rate of the fall beyond the top |
//! | `f_v` | N s/m or N m s/rad | >= 0, 0 if left out | viscous coefficient |
//!
//! The jump of the static models at zero velocity is replaced by a parabola, which ends level at
//! the top. Integrators without events can run it, and it shows stick-slip: friction falls with
//! speed beyond `v_0`.
//!
//! It creeps. Below `F_s` every force has its speed, `v = v_0 [1 - sqrt(1 - F/F_s)]` (without
//! viscous friction): a loaded contact never stands still, and nothing holds. It has no pre-sliding
//! displacement, no lag and no memory. At zero velocity it is a damper of `2 F_s / v_0`: a small
//! `v_0` creeps less and makes the simulation stiffer (Runge-Kutta steps below `1.39 m v_0 / F_s`).
//! Use it where a smooth static law is wanted and holding does not matter.
//!
//! Fixed-step form: the law itself; there is no state.

use crate::arithmetic::sign;
use crate::finite::finite;
use crate::{
    FrictionModel, Internals, ModelError, ParameterSet, Range, Real, Regime, State, built_from,
    memoryless, parameters,
};

parameters! {
    /// Parameters of [`BengisuAkay`] as files carry them.
    BengisuAkayParameters<T> {
        /// Static friction F_s \[N or N m\], at least `f_c`.
        f_s: T, Force, Range::Positive;
        /// Kinetic friction F_c \[N or N m\], above zero.
        f_c: T, Force, Range::Positive;
        /// Speed v_0 at which friction is largest \[m/s or rad/s\], above zero.
        v_0: T, Speed, Range::Positive;
        /// Rate xi at which friction falls with speed beyond v_0 \[s/m or s/rad\], above zero.
        xi: T, PerSpeed, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more; 0 if left out.
        #[serde(default)]
        f_v: T, Damping, Range::NonNegative;
    }
}

/// Bengisu and Akay's characteristic with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BengisuAkay<T: Real = f64> {
    parameters: BengisuAkayParameters<T>,
}

impl<T: Real> BengisuAkay<T> {
    /// Friction without its viscous part and without its sign.
    #[inline]
    fn level(&self, velocity: T) -> T {
        let p = &self.parameters;
        let speed = velocity.abs();
        if speed <= p.v_0 {
            let below = speed / p.v_0 - T::ONE;
            p.f_s * (T::ONE - below * below)
        } else {
            p.f_c + (p.f_s - p.f_c) * (-p.xi * (speed - p.v_0)).exp()
        }
    }
}

impl<T: Real> TryFrom<BengisuAkayParameters<T>> for BengisuAkay<T> {
    type Error = ModelError;

    fn try_from(p: BengisuAkayParameters<T>) -> Result<Self, ModelError> {
        p.check(Self::NAME)?;
        let condition = "at most f_s: kinetic friction does not exceed static friction";
        p.require(Self::NAME, p.f_c <= p.f_s, "f_c", p.f_c, condition)?;
        finite(Self { parameters: p })
    }
}

built_from!([T: Real] BengisuAkay<T>, BengisuAkayParameters<T>);

impl<T: Real> FrictionModel<T> for BengisuAkay<T> {
    const NAME: &'static str = "bengisu_akay";
    memoryless!([T] BengisuAkayParameters<T>);

    #[inline]
    fn steady_state(&self, velocity: T) -> T {
        sign(velocity) * self.level(velocity) + self.parameters.f_v * velocity
    }

    /// Slip beyond the top; below it the contact creeps where others stick.
    fn internals(&self, _: &State<[T; 0], ()>, velocity: T) -> Internals<T> {
        let regime =
            if velocity.abs() > self.parameters.v_0 { Regime::Slip } else { Regime::Stick };
        Internals { deflection: T::ZERO, gamma: self.level(velocity), regime }
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets::Presets;
    use crate::{Body, Drive};

    #[test]
    fn rises_to_the_static_level_and_falls_to_the_kinetic_one() {
        let model = BengisuAkay::chapter_3();
        assert_eq!(model.steady_state(0.0), 0.0);
        assert_eq!(model.steady_state(0.001), 1.5);
        assert!((model.steady_state(0.0005) - 1.5 * 0.75).abs() < 1e-15);
        assert!((model.steady_state(0.011) - (1.0 + 0.5 * (-1.0f64).exp())).abs() < 1e-15);
        assert!((model.steady_state(1.0) - 1.0).abs() < 1e-15);
        assert_eq!(model.steady_state(-0.011), -model.steady_state(0.011));
    }

    /// Continuous at zero and at the top; the parabola starts with the slope `2 F_s / v_0` and ends
    /// level.
    #[test]
    fn is_continuous_and_starts_as_a_damper() {
        let model = BengisuAkay::chapter_3();
        let h = 1e-9;
        let slope = |v: f64| (model.steady_state(v + h) - model.steady_state(v - h)) / (2.0 * h);
        assert!((slope(0.0) / 3000.0 - 1.0).abs() < 1e-5, "{}", slope(0.0));
        assert!((model.steady_state(0.001 + h) - model.steady_state(0.001 - h)).abs() < 1e-7);
        let before_the_top = (model.steady_state(0.001) - model.steady_state(0.001 - h)) / h;
        assert!(before_the_top.abs() < 0.01, "{before_the_top}");
    }

    /// Under four fifths of the static friction a body drifts at the speed that the law gives that
    /// force.
    #[test]
    fn creeps_below_the_static_level() {
        let mut body = Body::<_, 0>::new(BengisuAkay::chapter_3(), 1.0);
        for _ in 0..20_000 {
            body.advance(1e-4, |_| Drive::from(1.2));
        }
        let creep = 0.001 * (1.0 - (1.0f64 - 1.2 / 1.5).sqrt());
        assert!((body.moment().velocity - creep).abs() < 1e-12, "{}", body.moment().velocity);
        assert_eq!(BengisuAkay::chapter_3().holding(0.0), None);
    }

    #[test]
    fn refuses_a_kinetic_level_above_the_static_one() {
        let wrong = BengisuAkayParameters { f_c: 2.0, ..BengisuAkayParameters::chapter_3() };
        let message = BengisuAkay::try_from(wrong).unwrap_err().to_string();
        assert!(message.starts_with("bengisu_akay.f_c must be at most f_s"), "{message}");
    }
}
