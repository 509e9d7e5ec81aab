//! LuGre (Canudas de Wit, Olsson, Astrom and Lischinsky 1995).
//!
//! ```text
//! z' = v - sigma0 |v| z / g(v)                 (thesis eq. 2.19 with g in units of force)
//! F  = sigma0 z + sigma1 z' + f_v v            (thesis eq. 2.18 with f_v(v) = f_v v)
//! ```
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_s`, `f_c`, `v_s`, `delta` | | | Stribeck curve `g`, see [`StribeckCurve`] |
//! | `sigma0` | N/m or N m/rad | > 0 | bristle stiffness |
//! | `sigma1` | N s/m or N m s/rad | >= 0 | micro-damping |
//! | `v_d` | m/s or rad/s | > 0, may be left out | micro-damping falls as `sigma1 exp(-(v/v_d)^2)` |
//! | `f_v` | N s/m or N m s/rad | >= 0 | viscous coefficient |
//!
//! Steady state `F = sgn(v) g(v) + f_v v`; gives stick-slip, pre-sliding displacement and lag. It
//! drifts under small oscillating loads, and its hysteresis has no non-local memory: inner loops do
//! not close.
//!
//! Fixed-step form: the exact solution for a velocity held over the period,
//! `z <- z_s + (z - z_s) exp(-sigma0 |v| dt / g)` with `z_s = sgn(v) g(v) / sigma0`; stable at any
//! period.

use crate::arithmetic::{bounded, relaxed, saturate};
use crate::finite::finite;
use crate::stribeck_curve::SHAPE;
use crate::{
    Evaluation, FrictionModel, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    StribeckCurve, TimeStep, built_from, parameters,
};

parameters! {
    /// Parameters of [`LuGre`] as files carry them.
    LuGreParameters<T> {
        /// Static friction F_s \[N or N m\], at least `f_c`.
        f_s: T, Force, Range::Positive;
        /// Kinetic friction F_c \[N or N m\], above zero.
        f_c: T, Force, Range::Positive;
        /// Stribeck velocity v_s \[m/s or rad/s\], above zero.
        v_s: T, Speed, Range::Positive;
        /// Shape exponent of the Stribeck curve, above 0 and at most 10; 2 if left out.
        #[serde(default = "StribeckCurve::gaussian")]
        delta: T, None, SHAPE;
        /// Bristle stiffness sigma_0 \[N/m or N m/rad\], above zero.
        sigma0: T, Stiffness, Range::Positive;
        /// Micro-damping sigma_1 \[N s/m or N m s/rad\], zero or more.
        sigma1: T, Damping, Range::NonNegative;
        /// Speed v_d at which the micro-damping has fallen to 1/e \[m/s or rad/s\], above zero;
        /// constant damping if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        v_d: Option<T>, Speed, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more.
        f_v: T, Damping, Range::NonNegative;
    }
}

/// LuGre with valid parameters. State: `[z]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LuGre<T: Real = f64> {
    parameters: LuGreParameters<T>,
    curve: StribeckCurve<T>,
}

impl<T: Real> LuGre<T> {
    /// `sigma1(v)`: constant, or falling as `sigma1 exp(-(v/v_d)^2)`.
    #[inline]
    fn damping(&self, velocity: T) -> T {
        match self.parameters.v_d {
            None => self.parameters.sigma1,
            Some(v_d) => {
                let r = velocity / v_d;
                self.parameters.sigma1 * (-r * r).exp()
            }
        }
    }
}

impl<T: Real> TryFrom<LuGreParameters<T>> for LuGre<T> {
    type Error = ModelError;

    fn try_from(p: LuGreParameters<T>) -> Result<Self, ModelError> {
        p.check(Self::NAME)?;
        let curve = StribeckCurve::new(Self::NAME, p.f_s, p.f_c, p.v_s, p.delta)?;
        finite(Self { parameters: p, curve })
    }
}

built_from!([T: Real] LuGre<T>, LuGreParameters<T>);

impl<T: Real> FrictionModel<T> for LuGre<T> {
    const NAME: &'static str = "lugre";
    type Parameters = LuGreParameters<T>;
    type Continuous = [T; 1];
    type Memory = ();
    /// The period \[s\].
    type Discrete = T;

    fn parameters(&self) -> &LuGreParameters<T> {
        &self.parameters
    }

    fn rest(&self) -> State<[T; 1], ()> {
        State { continuous: [T::ZERO], memory: () }
    }

    #[inline]
    fn evaluate(&self, state: &[T; 1], (): &(), velocity: T) -> Evaluation<[T; 1], T> {
        self.at(velocity)(state, &())
    }

    #[inline]
    fn at(&self, velocity: T) -> impl Fn(&[T; 1], &()) -> Evaluation<[T; 1], T> {
        let p = &self.parameters;
        let g = self.curve.level(velocity);
        move |&[z], ()| {
            let z_rate = velocity - p.sigma0 * velocity.abs() * z / g;
            Evaluation {
                force: p.sigma0 * z + self.damping(velocity) * z_rate + p.f_v * velocity,
                rates: [z_rate],
            }
        }
    }

    #[inline]
    fn commit(&self, _: &mut State<[T; 1], ()>, _: T, _: T) {}

    fn discretise(&self, dt: TimeStep) -> T {
        T::of(dt.seconds())
    }

    #[inline]
    fn step(&self, &dt: &T, state: &mut State<[T; 1], ()>, velocity: T) -> T {
        let p = &self.parameters;
        let v = bounded(velocity);
        let [z] = state.continuous;
        let g = self.curve.level(v);
        // Rate at which z relaxes towards its steady value while v is held [1/s].
        let rate = p.sigma0 * v.abs() / g;
        let z_steady = (g / p.sigma0).copysign(v);
        state.continuous = [z_steady + (z - z_steady) * (-rate * dt).exp()];
        p.sigma0 * z + self.damping(v) * (v - rate * z) + p.f_v * v
    }

    #[inline]
    fn inject(&self, dt: TimeStep, state: &mut State<[T; 1], ()>, velocity: T, rate: T) -> T {
        let p = &self.parameters;
        let [z] = state.continuous;
        let relaxation = p.sigma0 * velocity.abs() / self.curve.level(velocity);
        let moved = rate * relaxed(relaxation, T::of(dt.seconds()));
        state.continuous = [saturate(p.f_s / p.sigma0, z + moved)];
        self.damping(velocity) * rate
    }

    fn steady_state(&self, velocity: T) -> T {
        self.curve.signed_level(velocity) + self.parameters.f_v * velocity
    }

    /// Slip once the bristle force is within 5 % of the sliding level in the direction of motion;
    /// LuGre itself knows no switch.
    fn internals(&self, state: &State<[T; 1], ()>, velocity: T) -> Internals<T> {
        let [z] = state.continuous;
        let gamma = self.curve.level(velocity);
        let loaded = self.parameters.sigma0 * z * crate::arithmetic::sign(velocity);
        let regime = if loaded >= T::of(0.95) * gamma { Regime::Slip } else { Regime::Stick };
        Internals { deflection: z, gamma, regime }
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    fn stored_energy(&self, state: &State<[T; 1], ()>) -> Option<T> {
        let [z] = state.continuous;
        Some(T::HALF * self.parameters.sigma0 * z * z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stepper;

    #[test]
    fn reaches_the_stribeck_curve() {
        let model = LuGre::chapter_3();
        for v in [0.001, 0.005, 0.01, 0.02, 0.05, 0.1, 0.5, -0.02] {
            let mut stepper = Stepper::new(model, TimeStep::new(1e-3).unwrap());
            for _ in 0..3000 {
                stepper.step(v);
            }
            assert!((stepper.step(v) - model.steady_state(v)).abs() < 1e-9, "v {v}");
        }
    }

    #[test]
    fn the_fixed_step_is_exact_for_a_held_velocity() {
        let model = LuGre::test_bed();
        let (v, dt) = (0.3, 1e-3);
        let mut coarse = Stepper::new(model, TimeStep::new(10.0 * dt).unwrap());
        let mut fine = Stepper::new(model, TimeStep::new(dt).unwrap());
        for _ in 0..20 {
            coarse.step(v);
            for _ in 0..10 {
                fine.step(v);
            }
            let (a, b) = (coarse.state().continuous[0], fine.state().continuous[0]);
            assert!((a - b).abs() < 1e-15, "{a} {b}");
        }
    }
}
