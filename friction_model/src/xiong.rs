//! Xiong's multistate model (Xiong, Kikuuwe, Yamamoto 2013): Maxwell-slip elements that lag and
//! need no switches.
//!
//! ```text
//! gamma' = (g(v) - gamma) / tau
//! c_i    = sat(lambda_i gamma, K_i z_i + sigma_i v)
//! z_i'   = (c_i - K_i z_i) / sigma_i
//! F      = sum_i c_i + f_v v,      sum_i lambda_i = 1           (thesis eqs. 2.29 to 2.32; 2.32 forgets f_v v)
//! ```
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_s`, `f_c`, `v_s`, `delta` | | | Stribeck curve `g`, see [`StribeckCurve`] |
//! | `tau` | s | > 0 | time constant of the lag |
//! | `lambda` | - | > 0, sum 1 | share of each element |
//! | `k` | N/m or N m/rad | > 0 | stiffness of each element |
//! | `sigma` | N s/m or N m s/rad | > 0 | micro-damping of each element |
//! | `f_v` | N s/m or N m s/rad | >= 0 | viscous coefficient |
//!
//! While an element sticks, `z_i' = v`; while it slips, `z_i` relaxes to `+-lambda_i gamma / K_i`
//! with the time constant `sigma_i / K_i`. It has hysteresis with non-local memory, does not drift,
//! never exceeds `F_s + f_v |v|`, and dissipates. In steady gross sliding `F = gamma + f_v v`,
//! exactly as the proposed model: measurements of frictional lag cannot tell the two apart. Its
//! virgin curve is a polygon with as many corners as elements.
//!
//! Fixed-step form: `gamma` exactly for a held velocity, each `z_i` by an implicit step of its
//! limited rate, see [`crate::Proposed`]; it can neither overshoot nor oscillate at any period, and
//! has no branches.
//!
//! `N` is the room for elements; parameter sets with fewer are filled up with elements that carry
//! nothing.

use crate::arithmetic::{between, bounded, mean, relaxed, saturate};
use crate::finite::finite;
use crate::stribeck_curve::SHAPE;
use crate::{
    Elements, Evaluation, FrictionModel, Internals, ModelError, ParameterSet, Range, Real, Regime,
    State, StribeckCurve, TimeStep, built_from, parameters,
};

parameters! {
    /// Parameters of [`Xiong`] as files carry them; the lists have one number an element, at most
    /// 16.
    XiongParameters<T> {
        /// Static friction F_s \[N or N m\], at least `f_c`.
        f_s: T, Force, Range::Positive;
        /// Kinetic friction F_c \[N or N m\], above zero.
        f_c: T, Force, Range::Positive;
        /// Stribeck velocity v_s \[m/s or rad/s\], above zero.
        v_s: T, Speed, Range::Positive;
        /// Shape exponent of the Stribeck curve, above 0 and at most 10; 2 if left out.
        #[serde(default = "StribeckCurve::gaussian")]
        delta: T, None, SHAPE;
        /// Time constant of the lag \[s\], above zero.
        tau: T, Time, Range::Positive;
        /// Share lambda of each element, above zero; they sum to 1.
        lambda: Elements<16, T>, None, Range::Positive;
        /// Stiffness K of each element \[N/m or N m/rad\], above zero.
        k: Elements<16, T>, Stiffness, Range::Positive;
        /// Micro-damping sigma of each element \[N s/m or N m s/rad\], above zero.
        sigma: Elements<16, T>, Damping, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more.
        f_v: T, Damping, Range::NonNegative;
    }
}

/// Xiong's model with valid parameters and room for `N` elements. State: `([gamma], [z_i])`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Xiong<const N: usize, T: Real = f64> {
    parameters: XiongParameters<T>,
    curve: StribeckCurve<T>,
    elements: [Element<T>; N],
}

/// One element; one that carries nothing has neither share nor stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Element<T: Real = f64> {
    lambda: T,
    k: T,
    sigma: T,
    inverse_sigma: T,
}

impl<T: Real> Element<T> {
    const NONE: Self = Self { lambda: T::ZERO, k: T::ZERO, sigma: T::ONE, inverse_sigma: T::ONE };
}

built_from!([T: Real, const N: usize] Xiong<N, T>, XiongParameters<T>);

impl<T: Real, const N: usize> TryFrom<XiongParameters<T>> for Xiong<N, T> {
    type Error = ModelError;

    fn try_from(p: XiongParameters<T>) -> Result<Self, ModelError> {
        let model = Self::NAME;
        p.check(model)?;
        let curve = StribeckCurve::new(model, p.f_s, p.f_c, p.v_s, p.delta)?;
        crate::elements::check(model, N, "lambda", &p.lambda, &[("k", &p.k), ("sigma", &p.sigma)])?;
        let mut elements = [Element::NONE; N];
        let lists = p.lambda.iter().zip(p.k.iter()).zip(p.sigma.iter());
        for (element, ((&lambda, &k), &sigma)) in elements.iter_mut().zip(lists) {
            *element = Element { lambda, k, sigma, inverse_sigma: T::ONE / sigma };
            let usable = element.inverse_sigma.is_finite();
            p.require(model, usable, "sigma", sigma, "large enough to divide by")?;
        }
        finite(Self { parameters: p, curve, elements })
    }
}

/// Coefficients of the fixed-step form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct XiongDiscrete<const N: usize, T: Real = f64> {
    dt: T,
    /// `exp(-dt / tau)`, and `exp(-dt / (2 tau))`.
    gamma_decay: T,
    midway_decay: T,
    /// How far a force of one beyond the spring moves each element in a period.
    gain: [T; N],
    /// `1 / (sigma_i + K_i dt)`.
    implicit_gain: [T; N],
}

impl<T: Real, const N: usize> FrictionModel<T> for Xiong<N, T> {
    const NAME: &'static str = "xiong";
    type Parameters = XiongParameters<T>;
    type Continuous = ([T; 1], [T; N]);
    type Memory = ();
    type Discrete = XiongDiscrete<N, T>;

    fn parameters(&self) -> &XiongParameters<T> {
        &self.parameters
    }

    fn rest(&self) -> State<Self::Continuous, ()> {
        State { continuous: ([self.parameters.f_s], [T::ZERO; N]), memory: () }
    }

    #[inline]
    fn evaluate(
        &self,
        state: &Self::Continuous,
        (): &(),
        velocity: T,
    ) -> Evaluation<Self::Continuous, T> {
        self.at(velocity)(state, &())
    }

    #[inline]
    fn at(
        &self,
        velocity: T,
    ) -> impl Fn(&Self::Continuous, &()) -> Evaluation<Self::Continuous, T> {
        let g = self.curve.level(velocity);
        move |&([gamma], z), ()| {
            let mut force = self.parameters.f_v * velocity;
            let mut rates = [T::ZERO; N];
            for ((element, z), rate) in self.elements.iter().zip(z).zip(&mut rates) {
                let elastic = element.k * z;
                let contact = saturate(element.lambda * gamma, elastic + element.sigma * velocity);
                force += contact;
                *rate = (contact - elastic) * element.inverse_sigma;
            }
            Evaluation { force, rates: ([(g - gamma) / self.parameters.tau], rates) }
        }
    }

    #[inline]
    fn commit(&self, state: &mut State<Self::Continuous, ()>, _: T, _: T) {
        let ([gamma], _) = &mut state.continuous;
        *gamma = between(self.parameters.f_c, self.parameters.f_s, *gamma);
    }

    fn discretise(&self, dt: TimeStep) -> XiongDiscrete<N, T> {
        let dt = T::of(dt.seconds());
        XiongDiscrete {
            dt,
            gamma_decay: (-dt / self.parameters.tau).exp(),
            midway_decay: (-T::HALF * dt / self.parameters.tau).exp(),
            gain: self.elements.map(|element| {
                relaxed(element.k * element.inverse_sigma, dt) * element.inverse_sigma
            }),
            implicit_gain: self.elements.map(|element| T::ONE / (element.sigma + element.k * dt)),
        }
    }

    #[inline]
    fn step(
        &self,
        discrete: &XiongDiscrete<N, T>,
        state: &mut State<Self::Continuous, ()>,
        velocity: T,
    ) -> T {
        let v = bounded(velocity);
        let g = self.curve.level(v);
        let ([gamma], z) = &mut state.continuous;
        let mut force = self.parameters.f_v * v;
        for ((element, z), &gain) in self.elements.iter().zip(z).zip(&discrete.implicit_gain) {
            let level = element.lambda * *gamma;
            let elastic = element.k * *z;
            force += saturate(level, elastic + element.sigma * v);
            *z += discrete.dt * between((-level - elastic) * gain, (level - elastic) * gain, v);
        }
        *gamma = g + (*gamma - g) * discrete.gamma_decay;
        force
    }

    /// Every element exactly, where it slips with the level midway.
    #[inline]
    fn advance(
        &self,
        discrete: &XiongDiscrete<N, T>,
        state: &mut State<Self::Continuous, ()>,
        from: T,
        to: T,
    ) {
        let v = mean(from, to);
        let g = self.curve.level(v);
        let ([gamma], z) = &mut state.continuous;
        let midway = g + (*gamma - g) * discrete.midway_decay;
        for ((element, z), &gain) in self.elements.iter().zip(z).zip(&discrete.gain) {
            let level = element.lambda * midway;
            let elastic = element.k * *z;
            *z += between((-level - elastic) * gain, (level - elastic) * gain, v * discrete.dt);
        }
        *gamma = g + (*gamma - g) * discrete.gamma_decay;
    }

    #[inline]
    fn inject(&self, dt: TimeStep, state: &mut State<Self::Continuous, ()>, _: T, rate: T) -> T {
        let p = &self.parameters;
        let ([gamma], z) = &mut state.continuous;
        *gamma =
            between(p.f_c, p.f_s, *gamma + rate * relaxed(T::ONE / p.tau, T::of(dt.seconds())));
        let mut damping = T::ZERO;
        for (element, z) in self.elements.iter().zip(z).take(p.lambda.len()) {
            *z = saturate(element.lambda * p.f_s / element.k, *z + rate * T::of(dt.seconds()));
            damping += element.sigma;
        }
        damping * rate
    }

    fn steady_state(&self, velocity: T) -> T {
        self.curve.signed_level(velocity) + self.parameters.f_v * velocity
    }

    /// The mean deflection, weighted by the shares; slip once all elements slip.
    fn internals(&self, state: &State<Self::Continuous, ()>, velocity: T) -> Internals<T> {
        let ([gamma], z) = state.continuous;
        let present = || self.elements.iter().zip(&z).take(self.parameters.lambda.len());
        let deflection = present().map(|(element, &z)| element.lambda * z).sum();
        let slips = |element: &Element<T>, z: T| {
            (element.k * z + element.sigma * velocity).abs() > element.lambda * gamma
        };
        let all = present().all(|(element, &z)| slips(element, z));
        let regime = if all { Regime::Slip } else { Regime::Stick };
        Internals { deflection, gamma, regime }
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    fn stored_energy(&self, state: &State<Self::Continuous, ()>) -> Option<T> {
        let (_, z) = &state.continuous;
        Some(self.elements.iter().zip(z).map(|(element, &z)| T::HALF * element.k * z * z).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets::Presets;
    use crate::{Proposed, ProposedParameters, Stepper, rk4};

    #[test]
    fn reaches_the_stribeck_curve() {
        fn check<const N: usize>(model: Xiong<N>) {
            for v in [0.001, 0.005, 0.01, 0.02, 0.05, 0.1, 0.5, -0.02] {
                let mut stepper = Stepper::new(model, TimeStep::new(1e-3).unwrap());
                for _ in 0..50_000 {
                    stepper.step(v);
                }
                assert!((stepper.step(v) - model.steady_state(v)).abs() < 1e-9, "v {v}");
            }
        }
        check(Xiong::test_bed());
        check(Xiong::chapter_3());
    }

    /// In unidirectional gross sliding `F = gamma + f_v v` in both models: lag cannot tell them
    /// apart.
    #[test]
    fn in_gross_sliding_it_is_the_proposed_model() {
        let xiong = Xiong::chapter_3();
        let p = *xiong.parameters();
        let proposed: Proposed = ProposedParameters {
            f_s: p.f_s,
            f_c: p.f_c,
            v_s: p.v_s,
            tau: p.tau,
            ..ProposedParameters::chapter_3()
        }
        .try_into()
        .unwrap();
        let (mut a, mut b) = (xiong.rest(), proposed.rest());
        let velocity = |t: f64| 0.02 * (1.0 - 0.95 * (2.0 * t).cos());
        for k in 0..40_000 {
            let t = 1e-4 * f64::from(k);
            let v = [velocity(t), velocity(t + 5e-5), velocity(t + 1e-4)];
            let difference =
                rk4::step(&xiong, &mut a, v, 1e-4) - rk4::step(&proposed, &mut b, v, 1e-4);
            assert!(t < 1.0 || difference.abs() < 1e-14, "at {t} s: {difference}");
        }
    }

    /// Room for elements that are not there changes nothing but the last digits of the sum.
    #[test]
    fn empty_elements_carry_nothing() {
        let dt = TimeStep::new(1e-3).unwrap();
        let mut four = Stepper::new(Xiong::test_bed(), dt);
        let mut sixteen =
            Stepper::new(Xiong::<16>::try_from(XiongParameters::test_bed()).unwrap(), dt);
        for k in 0..5000 {
            let v = 0.3 * (0.003 * f64::from(k)).sin() + 0.1 * (0.02 * f64::from(k)).sin();
            assert!((four.step(v) - sixteen.step(v)).abs() < 1e-16);
        }
    }
}
