//! The reset integrator of Haessig and Friedland.
//!
//! ```text
//! p' = 0   if v > 0 and p >= p_0, or v < 0 and p <= -p_0
//! p' = v   otherwise
//! F  = sigma0 p (1 + a) + sigma1 p' + f_v v        |p| < p_0   (stick)
//! F  = sigma0 p + sigma1 p' + f_v v                |p| = p_0   (slip: p' = 0 while the motion goes on)
//! ```
//!
//! D. A. Haessig and B. Friedland, "On the modeling and simulation of friction", ASME Journal of
//! Dynamic Systems, Measurement, and Control 113 (1991), 354-362, the second of the two models
//! there.
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `sigma0` | N/m or N m/rad | > 0 | stiffness in sliding; the contact sticks with `(1 + a) sigma0` |
//! | `sigma1` | N s/m or N m s/rad | >= 0 | damping while it sticks |
//! | `a` | - | >= 0 | static friction above kinetic friction: `F_s = (1 + a) F_c` |
//! | `p_0` | m or rad | > 0 | deflection at which it breaks away |
//! | `f_v` | N s/m or N m s/rad | >= 0, 0 if left out | viscous coefficient |
//!
//! The bristle model made cheap: one spring that gives way at `p_0`. Breakaway at
//! `(1 + a) sigma0 p_0`, sliding at `F_c = sigma0 p_0`, pre-sliding displacement, damped sticking.
//! The steady state is `F_c sgn v + f_v v`.
//!
//! It has no Stribeck curve beyond the drop from one level to the other and no lag. The force
//! jumps: down by `a F_c` at breakaway, and up by as much when the motion turns back. Below
//! breakaway it is a linear spring: inner loops enclose no area but the damping's. It does not
//! drift. With the storage `(1 + a) sigma0 p^2 / 2` it is passive. Bound:
//! `|F| <= (1 + a) sigma0 p_0 + (sigma1 + f_v) |v|`. Use it where sticking must be cheap to
//! simulate.
//!
//! Fixed-step form: `p <- sat(p_0, p + v dt)`, exact for a velocity held over the period.

use crate::arithmetic::{bounded, saturate, sign};
use crate::finite::finite;
use crate::{
    Evaluation, FrictionModel, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    TimeStep, built_from, parameters,
};

parameters! {
    /// Parameters of [`ResetIntegrator`] as files carry them.
    ResetIntegratorParameters<T> {
        /// Stiffness sigma_0 \[N/m or N m/rad\], above zero.
        sigma0: T, Stiffness, Range::Positive;
        /// Damping sigma_1 while the contact sticks \[N s/m or N m s/rad\], zero or more.
        sigma1: T, Damping, Range::NonNegative;
        /// Excess a of static over kinetic friction, relative to kinetic friction; zero or more.
        a: T, None, Range::NonNegative;
        /// Deflection p_0 at which the contact breaks away \[m or rad\], above zero.
        p_0: T, Deflection, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more; 0 if left out.
        #[serde(default)]
        f_v: T, Damping, Range::NonNegative;
    }
}

impl<T: Real> ResetIntegratorParameters<T> {
    /// From the levels `f_s >= f_c` \[N or N m\] and the stiffness `(1 + a) sigma0` of the sticking
    /// contact \[N/m or N m/rad\].
    #[must_use]
    pub fn from_levels(f_s: T, f_c: T, stiffness: T, sigma1: T, f_v: T) -> Self {
        let p_0 = f_s / stiffness;
        Self { sigma0: f_c / p_0, sigma1, a: f_s / f_c - T::ONE, p_0, f_v }
    }
}

/// The reset integrator with valid parameters. State: `[p]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResetIntegrator<T: Real = f64> {
    parameters: ResetIntegratorParameters<T>,
}

impl<T: Real> ResetIntegrator<T> {
    /// Sliding level F_c \[N or N m\].
    fn kinetic(&self) -> T {
        self.parameters.sigma0 * self.parameters.p_0
    }

    /// Whether the contact slides on: deflected to the end, and moving further.
    #[inline]
    fn slides(&self, p: T, velocity: T) -> bool {
        sign(velocity) * p >= self.parameters.p_0
    }
}

impl<T: Real> TryFrom<ResetIntegratorParameters<T>> for ResetIntegrator<T> {
    type Error = ModelError;

    fn try_from(p: ResetIntegratorParameters<T>) -> Result<Self, ModelError> {
        let name = Self::NAME;
        p.check(name)?;
        let static_level = p.sigma0 * p.p_0 * (T::ONE + p.a);
        let condition = "so that (1 + a) sigma0 p_0 is a finite number above zero";
        let holds = static_level.is_finite() && p.sigma0 * p.p_0 > T::ZERO;
        p.require(name, holds, "p_0", p.p_0, condition)?;
        finite(Self { parameters: p })
    }
}

built_from!([T: Real] ResetIntegrator<T>, ResetIntegratorParameters<T>);

impl<T: Real> FrictionModel<T> for ResetIntegrator<T> {
    const NAME: &'static str = "reset_integrator";
    type Parameters = ResetIntegratorParameters<T>;
    type Continuous = [T; 1];
    type Memory = ();
    /// The period \[s\].
    type Discrete = T;

    fn parameters(&self) -> &ResetIntegratorParameters<T> {
        &self.parameters
    }

    fn rest(&self) -> State<[T; 1], ()> {
        State { continuous: [T::ZERO], memory: () }
    }

    #[inline]
    fn evaluate(&self, &[p]: &[T; 1], (): &(), velocity: T) -> Evaluation<[T; 1], T> {
        let ResetIntegratorParameters { sigma0, sigma1, a, p_0, f_v } = self.parameters;
        let rate = if self.slides(p, velocity) { T::ZERO } else { velocity };
        let weight = if p.abs() < p_0 { T::ONE + a } else { T::ONE };
        let force = sigma0 * saturate(p_0, p) * weight + sigma1 * rate + f_v * velocity;
        Evaluation { force, rates: [rate] }
    }

    #[inline]
    fn commit(&self, state: &mut State<[T; 1], ()>, _: T, _: T) {
        state.continuous = state.continuous.map(|p| saturate(self.parameters.p_0, p));
    }

    fn discretise(&self, dt: TimeStep) -> T {
        T::of(dt.seconds())
    }

    #[inline]
    fn step(&self, &dt: &T, state: &mut State<[T; 1], ()>, velocity: T) -> T {
        let v = bounded(velocity);
        let [p] = state.continuous;
        let force = self.evaluate(&[p], &(), v).force;
        state.continuous = [saturate(self.parameters.p_0, p + v * dt)];
        force
    }

    #[inline]
    fn inject(&self, dt: TimeStep, state: &mut State<[T; 1], ()>, _: T, rate: T) -> T {
        let ResetIntegratorParameters { sigma1, p_0, .. } = self.parameters;
        state.continuous = state.continuous.map(|p| saturate(p_0, p + rate * T::of(dt.seconds())));
        sigma1 * rate
    }

    fn steady_state(&self, velocity: T) -> T {
        sign(velocity) * self.kinetic() + self.parameters.f_v * velocity
    }

    fn internals(&self, state: &State<[T; 1], ()>, velocity: T) -> Internals<T> {
        let [p] = state.continuous;
        let regime = if self.slides(p, velocity) { Regime::Slip } else { Regime::Stick };
        Internals { deflection: p, gamma: self.kinetic(), regime }
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    fn stored_energy(&self, state: &State<[T; 1], ()>) -> Option<T> {
        let [p] = state.continuous;
        Some(T::HALF * (T::ONE + self.parameters.a) * self.parameters.sigma0 * p * p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Stepper, rk4};

    /// Slowly pulled, the force rises to `F_s` over `p_0` and then drops to `F_c`.
    #[test]
    fn breaks_away_at_the_static_level_and_slides_at_the_kinetic_one() {
        let model = ResetIntegrator::test_bed();
        let p = *model.parameters();
        let v = 1e-5;
        let mut stepper = Stepper::new(model, TimeStep::new(1e-3).unwrap());
        let (mut peak, mut at) = (0.0, 0.0);
        for k in 0..400_000 {
            let force = stepper.step(v);
            if force > peak {
                (peak, at) = (force, v * 1e-3 * f64::from(k));
            }
        }
        let viscous = (p.sigma1 + p.f_v) * v;
        assert!((peak - viscous - 0.0994).abs() < 1e-6, "{peak}");
        assert!((at - p.p_0).abs() < 2e-8, "at {at}, not {}", p.p_0);
        assert!((stepper.step(v) - 0.0925 - p.f_v * v).abs() < 1e-15);
    }

    #[test]
    fn sticks_as_a_spring_of_the_given_stiffness() {
        let model = ResetIntegrator::test_bed();
        let force = |p: f64| model.evaluate(&[p], &(), 0.0).force;
        assert!((force(1e-3) - 0.0994 * std::f64::consts::PI / 0.012 * 1e-3).abs() < 1e-15);
        assert_eq!(force(-1e-3), -force(1e-3));
    }

    /// Any path in small steps: what goes in is at least what is stored.
    #[test]
    fn stores_no_more_than_was_put_in() {
        let model = ResetIntegrator::chapter_3();
        let dt = 1e-5;
        let mut stepper = Stepper::new(model, TimeStep::new(dt).unwrap());
        let (mut work, mut breakaways) = (0.0, 0);
        for k in 0..2_000_000 {
            let t = dt * f64::from(k);
            let v = 2e-3 * (3.1 * t).sin() + 3e-3 * (17.0 * t).sin();
            let slid = stepper.internals(v).regime == Regime::Slip;
            let before = stepper.step(v);
            let after = model.evaluate(&stepper.state().continuous, &(), v).force;
            breakaways += u32::from(!slid && stepper.internals(v).regime == Regime::Slip);
            work += 0.5 * (before + after) * v * dt;
            let stored = model.stored_energy(stepper.state()).unwrap();
            assert!(work >= stored - 1e-6, "step {k}: {work} put in, {stored} stored");
        }
        let most_stored = 0.5 * 1.5 * model.parameters().p_0;
        assert!(breakaways > 20 && work > 10.0 * most_stored, "{breakaways} breakaways, {work} J");
    }

    /// Runge-Kutta stages that overrun the end of the spring make the derivative form late by less
    /// than a step there.
    #[test]
    fn both_forms_agree_under_a_held_velocity() {
        let model = ResetIntegrator::test_bed();
        let dt = 1e-3;
        let mut stepper = Stepper::new(model, TimeStep::new(dt).unwrap());
        let mut state = model.rest();
        for v in [0.2, -0.3, 0.05, -1.0] {
            for _ in 0..40 {
                stepper.step(v);
                rk4::step(&model, &mut state, [v; 3], dt);
                assert!((stepper.state().continuous[0] - state.continuous[0]).abs() < v.abs() * dt);
            }
            assert!((stepper.state().continuous[0] - state.continuous[0]).abs() < 1e-15);
        }
    }
}
