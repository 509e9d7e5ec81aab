//! The elasto-plastic model (Dupont, Hayward, Armstrong, Altpeter 2002): LuGre that does not drift.
//!
//! ```text
//! z' = v - alpha(z, v) sigma0 |v| z / g(v)          (thesis eq. 2.22 with g in units of force; with 2.20's g it has sigma0 twice)
//! F  = sigma0 z + sigma1 z' + f_v v
//! alpha = 0                                          if sgn v != sgn z, or |z| <= z_ba
//!         1                                          if |z| >= z_ss = g(v) / sigma0
//!         1/2 sin( pi (|z| - (z_ss + z_ba)/2) / (z_ss - z_ba) ) + 1/2      between      (eq. 2.23 with |z|)
//! ```
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_s`, `f_c`, `v_s`, `delta` | | | Stribeck curve `g`, see [`StribeckCurve`] |
//! | `sigma0` | N/m or N m/rad | > 0 | bristle stiffness |
//! | `sigma1` | N s/m or N m s/rad | >= 0 | micro-damping |
//! | `z_ba` | m or rad | > 0, below `f_c / sigma0` | deflection up to which the contact is purely elastic |
//! | `f_v` | N s/m or N m s/rad | >= 0 | viscous coefficient |
//!
//! `z_ba` must lie below the sliding deflection at every speed, that is below `F_c / sigma0`; 0.7
//! of it is usual. Below `sigma0 z_ba` the contact is a spring: it does not drift there, and it has
//! no hysteresis there either. Above, inner loops do not close. Everything else is as in LuGre:
//! steady state `sgn(v) g(v) + f_v v`, stick-slip, lag.
//!
//! Fixed-step form: the exact solution for velocity and `alpha` held over the period; a deflection
//! that moves outward stops at `z_ss`, which it could otherwise overshoot from within the elastic
//! range.

use core::f64::consts::PI;

use crate::arithmetic::{bounded, mean, relaxed, saturate, sign};
use crate::finite::finite;
use crate::stribeck_curve::SHAPE;
use crate::{
    Evaluation, FrictionModel, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    StribeckCurve, TimeStep, built_from, parameters,
};

parameters! {
    /// Parameters of [`ElastoPlastic`] as files carry them.
    ElastoPlasticParameters<T> {
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
        /// Deflection z_ba up to which the contact is elastic \[m or rad\], above zero and below
        /// `f_c / sigma0`.
        z_ba: T, Deflection, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more.
        f_v: T, Damping, Range::NonNegative;
    }
}

/// The elasto-plastic model with valid parameters. State: `[z]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElastoPlastic<T: Real = f64> {
    parameters: ElastoPlasticParameters<T>,
    curve: StribeckCurve<T>,
}

built_from!([T: Real] ElastoPlastic<T>, ElastoPlasticParameters<T>);

impl<T: Real> TryFrom<ElastoPlasticParameters<T>> for ElastoPlastic<T> {
    type Error = ModelError;

    fn try_from(p: ElastoPlasticParameters<T>) -> Result<Self, ModelError> {
        let name = Self::NAME;
        p.check(name)?;
        let curve = StribeckCurve::new(name, p.f_s, p.f_c, p.v_s, p.delta)?;
        let elastic = p.z_ba < p.f_c / p.sigma0;
        let below = "below f_c / sigma0, the deflection at which the contact slides fully";
        p.require(name, elastic, "z_ba", p.z_ba, below)?;
        finite(Self { parameters: p, curve })
    }
}

impl<T: Real> ElastoPlastic<T> {
    /// The part of the motion that is plastic, from 0 (elastic) to 1 (sliding), where the sliding
    /// deflection is `z_ss`.
    #[inline]
    fn alpha(&self, z: T, velocity: T, z_ss: T) -> T {
        let z_ba = self.parameters.z_ba;
        let deflection = z.abs();
        if sign(velocity) != sign(z) || deflection <= z_ba {
            T::ZERO
        } else if deflection >= z_ss {
            T::ONE
        } else {
            T::HALF * (T::of(PI) * (deflection - T::HALF * (z_ss + z_ba)) / (z_ss - z_ba)).sin()
                + T::HALF
        }
    }
}

impl<T: Real> ElastoPlastic<T> {
    /// `d alpha / d|z|`.
    #[inline]
    fn steepness(&self, z: T, velocity: T, z_ss: T) -> T {
        let z_ba = self.parameters.z_ba;
        let deflection = z.abs();
        if sign(velocity) != sign(z) || deflection <= z_ba || deflection >= z_ss {
            return T::ZERO;
        }
        let wave_number = T::of(PI) / (z_ss - z_ba);
        T::HALF * wave_number * (wave_number * (deflection - T::HALF * (z_ss + z_ba))).cos()
    }
}

impl<T: Real> FrictionModel<T> for ElastoPlastic<T> {
    const NAME: &'static str = "elasto_plastic";
    type Parameters = ElastoPlasticParameters<T>;
    type Continuous = [T; 1];
    type Memory = ();
    /// The period \[s\].
    type Discrete = T;

    fn parameters(&self) -> &ElastoPlasticParameters<T> {
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
        let z_ss = self.curve.level(velocity) / p.sigma0;
        move |&[z], ()| {
            let z_rate = velocity - self.alpha(z, velocity, z_ss) * velocity.abs() * z / z_ss;
            Evaluation {
                force: p.sigma0 * z + p.sigma1 * z_rate + p.f_v * velocity,
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
        let z_ss = self.curve.level(v) / p.sigma0;
        // Rate at which z relaxes while velocity and alpha are held [1/s].
        let rate = self.alpha(z, v, z_ss) * v.abs() / z_ss;
        let next = if rate > T::ZERO {
            let z_end = v / rate;
            z_end + (z - z_end) * (-rate * dt).exp()
        } else {
            z + v * dt
        };
        let outward = sign(v);
        let overshoots = outward * next > z_ss && outward * z <= z_ss;
        state.continuous = [if overshoots { outward * z_ss } else { next }];
        p.sigma0 * z + p.sigma1 * (v - rate * z) + p.f_v * v
    }

    /// Along the travel `z' = 1 - alpha |z| / z_ss`: relaxes with the slope that this has where the
    /// step begins.
    #[inline]
    fn advance(&self, &dt: &T, state: &mut State<[T; 1], ()>, from: T, to: T) {
        let v = mean(from, to);
        let [z] = state.continuous;
        let z_ss = self.curve.level(v) / self.parameters.sigma0;
        let outward = sign(v);
        let (alpha, steepness) = (self.alpha(z, v, z_ss), self.steepness(z, v, z_ss));
        let share = outward * z / z_ss;
        let moved = relaxed(alpha / z_ss + share * steepness, v.abs() * dt);
        let next = z + outward * (T::ONE - alpha * share) * moved;
        let overshoots = outward * next > z_ss && outward * z <= z_ss;
        state.continuous = [if overshoots { outward * z_ss } else { next }];
    }

    #[inline]
    fn inject(&self, dt: TimeStep, state: &mut State<[T; 1], ()>, velocity: T, rate: T) -> T {
        let p = &self.parameters;
        let [z] = state.continuous;
        let z_ss = self.curve.level(velocity) / p.sigma0;
        let relaxation = self.alpha(z, velocity, z_ss) * velocity.abs() / z_ss;
        let moved = rate * relaxed(relaxation, T::of(dt.seconds()));
        state.continuous = [saturate(p.f_s / p.sigma0, z + moved)];
        p.sigma1 * rate
    }

    fn steady_state(&self, velocity: T) -> T {
        self.curve.signed_level(velocity) + self.parameters.f_v * velocity
    }

    /// Slip once more than half of the motion is plastic.
    fn internals(&self, state: &State<[T; 1], ()>, velocity: T) -> Internals<T> {
        let [z] = state.continuous;
        let gamma = self.curve.level(velocity);
        let alpha = self.alpha(z, velocity, gamma / self.parameters.sigma0);
        Internals {
            deflection: z,
            gamma,
            regime: if alpha > T::HALF { Regime::Slip } else { Regime::Stick },
        }
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
    use crate::presets::Presets;
    use crate::{Stepper, rk4};

    #[test]
    fn reaches_the_stribeck_curve() {
        for model in [ElastoPlastic::chapter_3(), ElastoPlastic::test_bed()] {
            for v in [0.001, 0.005, 0.01, 0.02, 0.05, 0.1, 0.5, -0.02] {
                let mut stepper = Stepper::new(model, TimeStep::new(1e-3).unwrap());
                // The slowest needs a travel of many sliding deflections of 6 mrad.
                for _ in 0..200_000 {
                    stepper.step(v);
                }
                let error = stepper.step(v) - model.steady_state(v);
                assert!(error.abs() < 1e-9, "v {v}: {error}");
            }
        }
    }

    /// Below z_ba it is a spring with a damper: the deflection is the displacement, exactly.
    #[test]
    fn below_z_ba_the_bristle_follows_the_displacement() {
        let model = ElastoPlastic::test_bed();
        let z_ba = model.parameters().z_ba;
        let mut state = model.rest();
        let velocity = |t: f64| 0.9 * z_ba * 7.0 * (7.0 * t).cos();
        for k in 0..3000 {
            let t = 1e-3 * f64::from(k);
            rk4::step(
                &model,
                &mut state,
                [velocity(t), velocity(t + 5e-4), velocity(t + 1e-3)],
                1e-3,
            );
            let displacement = 0.9 * z_ba * (7.0 * (t + 1e-3)).sin();
            assert!((state.continuous[0] - displacement).abs() < 1e-8 * z_ba);
        }
    }

    /// The switch of eq. 2.23 is odd: the printed form without |z| is not.
    #[test]
    fn the_plastic_part_is_the_same_on_both_sides() {
        let model = ElastoPlastic::chapter_3();
        for z in [0.75e-5, 0.9e-5, 1.2e-5, 2e-5] {
            let z_ss = 1.4e-5;
            assert_eq!(model.alpha(z, 0.01, z_ss), model.alpha(-z, -0.01, z_ss));
            assert_eq!(model.alpha(z, -0.01, z_ss), 0.0);
        }
        assert!((model.alpha(1.05e-5, 0.01, 1.4e-5) - 0.5).abs() < 1e-12, "half plastic half way");
    }

    #[test]
    fn an_elastic_range_beyond_sliding_is_refused() {
        let p =
            ElastoPlasticParameters { z_ba: 0.7 * 1.5e-5, ..ElastoPlasticParameters::chapter_3() };
        let message = ElastoPlastic::try_from(p).unwrap_err().to_string();
        assert!(message.contains("elasto_plastic.z_ba must be below f_c / sigma0"), "{message}");
    }
}
