//! The Leuven model (Swevers, Al-Bender, Ganseman, Prajogo 2000), as modified by Lampaert, Swevers
//! and Al-Bender (2002).
//!
//! ```text
//! z' = v (1 - sgn(r) |r|^n),     r = F_h(z) / s(v),   s(v) = sgn(v) g(v)
//! F  = F_h(z) + sigma1 z' + f_v v
//! F_h : virgin curve f_h sin(pi z / (2 z_b)), |z| <= z_b, with the memory of [`crate::Hysteresis`]
//! ```
//!
//! Thesis eqs. 2.24 to 2.26. The original's transition force `r = F_d / (s(v) - F_b)` jumps where
//! branches meet; the modified form used here is continuous. The virgin curve is free (any odd
//! concave one); here it is the sine of the proposed model.
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_s`, `f_c`, `v_s`, `delta` | | | Stribeck curve `g`, see [`StribeckCurve`] |
//! | `f_h` | N or N m | >= `f_s` | end of the virgin curve |
//! | `z_b` | m or rad | > 0 | deflection at the end of the virgin curve |
//! | `n` | - | \[1, 20\], 2 if left out | how sharply pre-sliding turns into sliding |
//! | `sigma1` | N s/m or N m s/rad | >= 0 | micro-damping |
//! | `f_v` | N s/m or N m s/rad | >= 0 | viscous coefficient |
//!
//! The hysteresis has non-local memory in `z`, where inner loops close exactly. In the displacement
//! `x` they close only as `n` grows, because the bristles slip a little in pre-sliding too: so for
//! small `n` the model drifts. Steady state `sgn(v) g(v) + f_v v` for every `n`, since `r` tends to
//! 1. Use it where the measured pre-sliding curve is to be reproduced and its inner loops matter
//!    more than a strictly closed displacement.
//!
//! Fixed-step form: along the travel, `z` relaxes with the fall of `h = 1 - sgn(r)|r|^n` where the
//! step begins: `dz = h int_0^d exp(-B x) dx` with `B = n |r|^(n-1) F_h'(z) / g` and `d = |v| dt`. A
//! step that would pass the deflection at which the contact slides ends there. Of second order in
//! the travel, whatever `n`, and stable at any period.

use crate::arithmetic::{bounded, mean, relaxed, saturate, sign};
use crate::finite::finite;
use crate::stribeck_curve::SHAPE;
use crate::virgin_curve::Sine;
use crate::{
    Evaluation, FrictionModel, Hysteresis, Internals, ModelError, ParameterSet, Range, Real,
    Regime, State, StribeckCurve, TimeStep, built_from, parameters,
};

parameters! {
    /// Parameters of [`Leuven`] as files carry them.
    LeuvenParameters<T> {
        /// Static friction F_s \[N or N m\], at least `f_c`.
        f_s: T, Force, Range::Positive;
        /// Kinetic friction F_c \[N or N m\], above zero.
        f_c: T, Force, Range::Positive;
        /// Stribeck velocity v_s \[m/s or rad/s\], above zero.
        v_s: T, Speed, Range::Positive;
        /// Shape exponent of the Stribeck curve, above 0 and at most 10; 2 if left out.
        #[serde(default = "StribeckCurve::gaussian")]
        delta: T, None, SHAPE;
        /// End of the virgin curve f_h \[N or N m\], at least `f_s`.
        f_h: T, Force, Range::Positive;
        /// Deflection z_b at the end of the virgin curve \[m or rad\], above zero.
        z_b: T, Deflection, Range::Positive;
        /// Exponent n of the transition to sliding, from 1 to 20; 2 if left out.
        #[serde(default = "StribeckCurve::gaussian")]
        n: T, None, Range::FromTo(1.0, 20.0);
        /// Micro-damping sigma_1 \[N s/m or N m s/rad\], zero or more.
        sigma1: T, Damping, Range::NonNegative;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more.
        f_v: T, Damping, Range::NonNegative;
    }
}

/// The modified Leuven model with valid parameters. State: `[z]` and the reversal points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leuven<T: Real = f64> {
    parameters: LeuvenParameters<T>,
    curve: StribeckCurve<T>,
    sine: Sine<T>,
}

built_from!([T: Real] Leuven<T>, LeuvenParameters<T>);

impl<T: Real> TryFrom<LeuvenParameters<T>> for Leuven<T> {
    type Error = ModelError;

    fn try_from(p: LeuvenParameters<T>) -> Result<Self, ModelError> {
        let name = Self::NAME;
        p.check(name)?;
        let curve = StribeckCurve::new(name, p.f_s, p.f_c, p.v_s, p.delta)?;
        let reaches = "at least f_s: otherwise the bristles cannot carry the sliding level";
        p.require(name, p.f_h >= p.f_s, "f_h", p.f_h, reaches)?;
        let sine = Sine::new(p.f_h, p.z_b);
        let steep = "large enough for a finite stiffness";
        p.require(name, sine.stiffness().is_finite(), "z_b", p.z_b, steep)?;
        finite(Self { parameters: p, curve, sine })
    }
}

impl<T: Real> Leuven<T> {
    /// `h = 1 - sgn(r) |r|^n`, the part of the motion that deflects the bristles, and `|r|`.
    #[inline]
    fn elastic_part(&self, hysteresis: T, velocity: T, g: T) -> (T, T) {
        let r = hysteresis * sign(velocity) / g;
        let magnitude = r.abs();
        let n = self.parameters.n;
        let power = if n == T::TWO { magnitude * magnitude } else { magnitude.powf(n) };
        (T::ONE - sign(r) * power, magnitude)
    }

    /// Moves the deflection as a motion at `velocity`, where the contact slides at `g`, moves it in
    /// `dt` \[s\].
    #[inline]
    fn travel(&self, state: &mut State<[T; 1], Hysteresis<T>>, velocity: T, g: T, dt: T) {
        let n = self.parameters.n;
        let [z] = state.continuous;
        let memory = &state.memory;
        let direction = sign(velocity);
        let (elastic, r) = self.elastic_part(memory.force(), velocity, g);
        let power = if n == T::TWO { r } else { r.powf(n - T::ONE) };
        let fall = n * power * memory.slope(&self.sine, direction * elastic) / g;
        let moved = elastic * relaxed(fall, velocity.abs() * dt);
        let mut next = saturate(self.parameters.z_b, z + direction * moved);
        // The steepest slope tells most steps from those that may pass the sliding deflection.
        let forward = direction * memory.force();
        let may_pass = forward < g && forward + self.sine.stiffness() * moved > g;
        if may_pass && direction * memory.peek(&self.sine, next) > g {
            next = self.sliding_deflection(memory, direction, g, [z, next]);
        }
        state.memory.commit(&self.sine, next);
        state.continuous = [state.memory.deflection()];
    }

    /// The deflection between two at which the hysteresis carries `g` in this direction, from
    /// below: by the rule of false position in its Illinois form.
    fn sliding_deflection(
        &self,
        memory: &Hysteresis<T>,
        direction: T,
        g: T,
        [mut low, mut high]: [T; 2],
    ) -> T {
        let excess = |z| direction * memory.peek(&self.sine, z) - g;
        let (mut below, mut above) = (excess(low), excess(high));
        let mut last = T::ZERO;
        for _ in 0..30 {
            let z = low + (high - low) * (below / (below - above));
            let here = excess(z);
            if here > T::ZERO {
                (high, above) = (z, here);
                if last > T::ZERO {
                    below *= T::HALF;
                }
            } else {
                (low, below) = (z, here);
                if last < T::ZERO {
                    above *= T::HALF;
                }
                if -here <= T::of(4.0) * T::epsilon() * g {
                    break;
                }
            }
            last = if here > T::ZERO { T::ONE } else { -T::ONE };
        }
        low
    }
}

impl<T: Real> FrictionModel<T> for Leuven<T> {
    const NAME: &'static str = "leuven";
    type Parameters = LeuvenParameters<T>;
    type Continuous = [T; 1];
    type Memory = Hysteresis<T>;
    /// The period \[s\].
    type Discrete = T;

    fn parameters(&self) -> &LeuvenParameters<T> {
        &self.parameters
    }

    fn rest(&self) -> State<[T; 1], Hysteresis<T>> {
        State { continuous: [T::ZERO], memory: Hysteresis::default() }
    }

    #[inline]
    fn evaluate(
        &self,
        state: &[T; 1],
        memory: &Hysteresis<T>,
        velocity: T,
    ) -> Evaluation<[T; 1], T> {
        self.at(velocity)(state, memory)
    }

    #[inline]
    fn at(&self, velocity: T) -> impl Fn(&[T; 1], &Hysteresis<T>) -> Evaluation<[T; 1], T> {
        let p = &self.parameters;
        let g = self.curve.level(velocity);
        move |&[z], memory| {
            let hysteresis = memory.peek(&self.sine, z);
            let (elastic, _) = self.elastic_part(hysteresis, velocity, g);
            let z_rate = velocity * elastic;
            Evaluation { force: hysteresis + p.sigma1 * z_rate + p.f_v * velocity, rates: [z_rate] }
        }
    }

    #[inline]
    fn commit(&self, state: &mut State<[T; 1], Hysteresis<T>>, _: T, _: T) {
        let z = saturate(self.parameters.z_b, state.continuous[0]);
        state.continuous = [z];
        state.memory.commit(&self.sine, z);
    }

    fn discretise(&self, dt: TimeStep) -> T {
        T::of(dt.seconds())
    }

    #[inline]
    fn step(&self, &dt: &T, state: &mut State<[T; 1], Hysteresis<T>>, velocity: T) -> T {
        let p = &self.parameters;
        let v = bounded(velocity);
        let g = self.curve.level(v);
        let hysteresis = state.memory.force();
        let (elastic, _) = self.elastic_part(hysteresis, v, g);
        self.travel(state, v, g, dt);
        hysteresis + p.sigma1 * v * elastic + p.f_v * v
    }

    #[inline]
    fn advance(&self, &dt: &T, state: &mut State<[T; 1], Hysteresis<T>>, from: T, to: T) {
        let v = mean(from, to);
        self.travel(state, v, self.curve.level(v), dt);
    }

    #[inline]
    fn inject(&self, dt: TimeStep, state: &mut State<[T; 1], Hysteresis<T>>, _: T, rate: T) -> T {
        let [z] = state.continuous;
        state.memory.commit(&self.sine, z + rate * T::of(dt.seconds()));
        state.continuous = [state.memory.deflection()];
        self.parameters.sigma1 * rate
    }

    fn steady_state(&self, velocity: T) -> T {
        self.curve.signed_level(velocity) + self.parameters.f_v * velocity
    }

    /// Slip once more than half of the motion passes under the bristles.
    fn internals(&self, state: &State<[T; 1], Hysteresis<T>>, velocity: T) -> Internals<T> {
        let [z] = state.continuous;
        let gamma = self.curve.level(velocity);
        let (elastic, _) = self.elastic_part(state.memory.peek(&self.sine, z), velocity, gamma);
        let regime = if elastic.abs() < T::HALF { Regime::Slip } else { Regime::Stick };
        Internals { deflection: z, gamma, regime }
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    fn stored_energy(&self, state: &State<[T; 1], Hysteresis<T>>) -> Option<T> {
        Some(state.memory.stored_energy(&self.sine))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets::Presets;
    use crate::{Stepper, rk4};

    fn with_exponent(n: f64) -> Leuven {
        LeuvenParameters { n, ..LeuvenParameters::chapter_3() }.try_into().unwrap()
    }

    /// With a virgin curve that ends flat at the static level, slow sliding comes close to its end:
    /// the approach takes long.
    #[test]
    fn reaches_the_stribeck_curve_for_every_exponent() {
        for n in [1.0, 2.0, 5.0, 10.0, 20.0] {
            for v in [0.001, 0.005, 0.01, 0.02, 0.05, 0.1, 0.5, -0.02] {
                let model = with_exponent(n);
                let mut stepper = Stepper::new(model, TimeStep::new(1e-3).unwrap());
                for _ in 0..300_000 {
                    stepper.step(v);
                }
                let error = stepper.step(v) - model.steady_state(v);
                assert!(error.abs() < 1e-9, "n {n}, v {v}: {error}");
            }
        }
    }

    /// Force at the second arrival at the inner loop's start minus the first, over the loop's
    /// height: closes as n grows.
    #[test]
    fn inner_loops_close_in_displacement_only_as_the_exponent_grows() {
        let gap = |n: f64| {
            let model = with_exponent(n);
            let (mut state, mut x, mut at_turns) = (model.rest(), 0.0, Vec::new());
            let steps = 20_000;
            let amplitude = 6e-4;
            for turn in [1.0, -0.5, 0.5, -0.1, 0.5] {
                let v: f64 =
                    (turn * amplitude - x) / f64::abs(turn * amplitude - x) * amplitude / 10.0;
                let dt = (turn * amplitude - x) / v / f64::from(steps);
                let force =
                    (0..steps).map(|_| rk4::step(&model, &mut state, [v; 3], dt)).last().unwrap();
                at_turns.push(force);
                x = turn * amplitude;
            }
            (at_turns[4] - at_turns[2]) / (at_turns[2] - at_turns[3])
        };
        // An independent implementation, whose settings are not known, has -10.2 %, -3.4 %, -0.14 %
        // and -3e-5; here -9.74 %, -3.20 %, -0.132 %.
        for (n, figure) in [(1.0, -0.102), (2.0, -0.034), (5.0, -1.4e-3)] {
            assert!((gap(n) / figure - 1.0).abs() < 0.07, "n {n}: {}", gap(n));
        }
        assert!(gap(10.0).abs() < 3e-5 && gap(20.0).abs() < 1e-8);
    }
}
