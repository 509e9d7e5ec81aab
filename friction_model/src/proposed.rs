//! The thesis's own model: non-drift, with hysteresis of non-local memory in pre-sliding and
//! frictional lag in sliding.
//!
//! ```text
//! gamma' = (g(v) - gamma) / tau
//! c      = sat(gamma, F_hyst(z) + sigma v)
//! z'     = (c - F_hyst(z)) / sigma
//! F      = c + f_v v
//! F_hyst : virgin curve F_s sin(pi z / (2 Z_b)), |z| <= Z_b, with the memory of [`crate::Hysteresis`]
//! ```
//!
//! Thesis eqs. 3.8 to 3.18 and 3.53, with the signs that 3.11, 3.12, 3.17 and 3.18 omit, and with
//! the sine that its listing B.2 forgets. At rest `gamma(0) = F_s` and `z = 0`.
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_s`, `f_c`, `v_s`, `delta` | | | Stribeck curve `g`, see [`StribeckCurve`] |
//! | `sigma` | N s/m or N m s/rad | > 0 | micro-damping (the thesis's table B.1 lists it as a stiffness: it is not) |
//! | `tau` | s | > 0 | time constant of the lag |
//! | `z_b` | m or rad | > 0 | breakaway deflection |
//! | `f_v` | N s/m or N m s/rad | >= 0 | viscous coefficient |
//!
//! While the contact sticks, `z' = v` and `F = F_hyst(z) + (sigma + f_v) v`; while it slips,
//! `F = +-gamma + f_v v` and `z` relaxes to where the hysteresis carries `+-gamma`. Since gamma
//! falls in sliding, `z` moves back then: a genuine reversal, which the memory records. It does not
//! drift, closes inner loops exactly, never exceeds `F_s + f_v |v|` and dissipates. Its hysteresis
//! is rate-independent; what depends on rate is the lag alone.
//!
//! Fixed-step form: `gamma` exactly for a held velocity; `z` by an implicit step with the steepest
//! slope of the hysteresis, `k = F_s pi / (2 Z_b)`:
//! `dz = dt sat-between(v, (-gamma - F_hyst) / (sigma + k dt), (gamma - F_hyst) / (sigma + k dt))`,
//! which can neither overshoot nor oscillate at any period.

use core::fmt::Debug;

use crate::arithmetic::{between, bounded, mean, relaxed, saturate};
use crate::finite::finite;
use crate::stribeck_curve::SHAPE;
use crate::virgin_curve::Sine;
use crate::{
    Evaluation, FrictionModel, Hysteresis, Internals, ModelError, ParameterSet, Range, Real,
    Regime, State, StribeckCurve, TimeStep, VirginCurve, built_from, parameters,
};

parameters! {
    /// Parameters of [`Proposed`] as files carry them.
    ProposedParameters<T> {
        /// Static friction F_s \[N or N m\], at least `f_c`.
        f_s: T, Force, Range::Positive;
        /// Kinetic friction F_c \[N or N m\], above zero.
        f_c: T, Force, Range::Positive;
        /// Stribeck velocity v_s \[m/s or rad/s\], above zero.
        v_s: T, Speed, Range::Positive;
        /// Shape exponent of the Stribeck curve, above 0 and at most 10; 2 if left out.
        #[serde(default = "StribeckCurve::gaussian")]
        delta: T, None, SHAPE;
        /// Micro-damping sigma \[N s/m or N m s/rad\], above zero.
        sigma: T, Damping, Range::Positive;
        /// Time constant of the lag \[s\], above zero.
        tau: T, Time, Range::Positive;
        /// Breakaway deflection Z_b \[m or rad\], above zero.
        z_b: T, Deflection, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more.
        f_v: T, Damping, Range::NonNegative;
    }
}

/// The structure of the proposed model over a virgin curve: [`Proposed`] with the thesis's sine,
/// [`ProposedLinear`](crate::ProposedLinear) with a straight line. State: `[gamma, z]` and the reversal points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NonDrift<C, T: Real = f64> {
    parameters: ProposedParameters<T>,
    curve: StribeckCurve<T>,
    virgin: C,
    inverse_sigma: T,
}

/// The proposed model with valid parameters.
pub type Proposed<T = f64> = NonDrift<Sine<T>, T>;

/// A virgin curve that [`NonDrift`] can be built over.
pub trait Branch<T: Real = f64>: VirginCurve<T> + Copy + Debug + PartialEq {
    /// Name of the model with this curve.
    const NAME: &'static str;

    /// The curve that ends at the force `f_s` and the deflection `z_b`.
    fn new(f_s: T, z_b: T) -> Self;

    /// Its steepest slope \[N/m or N m/rad\].
    fn stiffness(&self) -> T;
}

impl<T: Real> Branch<T> for Sine<T> {
    const NAME: &'static str = "proposed";
    fn new(f_s: T, z_b: T) -> Self {
        Self::new(f_s, z_b)
    }
    #[inline]
    fn stiffness(&self) -> T {
        self.stiffness()
    }
}

impl<T: Real, C: Branch<T>> NonDrift<C, T> {
    /// The hysteresis force alone along a path: moves `memory` to deflection `z` \[m or rad\] and
    /// returns `F_hyst` there.
    pub fn hysteresis_force(&self, memory: &mut Hysteresis<T>, z: T) -> T {
        memory.commit(&self.virgin, z)
    }

    /// Steepest slope of the hysteresis, `F_s pi / (2 Z_b)` for the sine, `F_s / Z_b` for the line
    /// \[N/m or N m/rad\].
    #[must_use]
    pub fn stiffness(&self) -> T {
        self.virgin.stiffness()
    }
}

impl<T: Real, C: Branch<T>> NonDrift<C, T> {
    /// How far a force of one beyond the hysteresis moves `z` in `dt` \[s\] where the hysteresis
    /// has this `slope`.
    #[inline]
    fn gain(&self, slope: T, dt: T) -> T {
        relaxed(slope * self.inverse_sigma, dt) * self.inverse_sigma
    }
}

impl<T: Real, C: Branch<T>> TryFrom<ProposedParameters<T>> for NonDrift<C, T> {
    type Error = ModelError;

    fn try_from(p: ProposedParameters<T>) -> Result<Self, ModelError> {
        p.check(C::NAME)?;
        let curve = StribeckCurve::new(C::NAME, p.f_s, p.f_c, p.v_s, p.delta)?;
        let virgin = C::new(p.f_s, p.z_b);
        let steep = "large enough for a finite stiffness";
        p.require(C::NAME, virgin.stiffness().is_finite(), "z_b", p.z_b, steep)?;
        let divisor = "large enough to divide by";
        p.require(C::NAME, (T::ONE / p.sigma).is_finite(), "sigma", p.sigma, divisor)?;
        finite(Self { parameters: p, curve, virgin, inverse_sigma: T::ONE / p.sigma })
    }
}

built_from!([T: Real, C: Branch<T>] NonDrift<C, T>, ProposedParameters<T>);

/// Coefficients of the fixed-step form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProposedDiscrete<T = f64> {
    dt: T,
    /// `exp(-dt / tau)`, and `exp(-dt / (2 tau))`.
    gamma_decay: T,
    midway_decay: T,
    /// `1 / (sigma + k dt)`.
    implicit_gain: T,
    /// How far a force of one beyond the hysteresis moves `z` in a period where its slope is `k`.
    steepest_gain: T,
}

impl<T: Real, C: Branch<T>> FrictionModel<T> for NonDrift<C, T> {
    const NAME: &'static str = C::NAME;
    type Parameters = ProposedParameters<T>;
    type Continuous = [T; 2];
    type Memory = Hysteresis<T>;
    type Discrete = ProposedDiscrete<T>;

    fn parameters(&self) -> &ProposedParameters<T> {
        &self.parameters
    }

    fn rest(&self) -> State<[T; 2], Hysteresis<T>> {
        State { continuous: [self.parameters.f_s, T::ZERO], memory: Hysteresis::default() }
    }

    #[inline]
    fn evaluate(
        &self,
        state: &[T; 2],
        memory: &Hysteresis<T>,
        velocity: T,
    ) -> Evaluation<[T; 2], T> {
        self.at(velocity)(state, memory)
    }

    #[inline]
    fn at(&self, velocity: T) -> impl Fn(&[T; 2], &Hysteresis<T>) -> Evaluation<[T; 2], T> {
        let p = &self.parameters;
        let g = self.curve.level(velocity);
        move |&[gamma, z], memory| {
            let hysteresis = memory.peek(&self.virgin, z);
            let contact = saturate(gamma, hysteresis + p.sigma * velocity);
            Evaluation {
                force: contact + p.f_v * velocity,
                rates: [(g - gamma) / p.tau, (contact - hysteresis) * self.inverse_sigma],
            }
        }
    }

    #[inline]
    fn commit(&self, state: &mut State<[T; 2], Hysteresis<T>>, _: T, _: T) {
        let [gamma, z] = state.continuous;
        let z = saturate(self.parameters.z_b, z);
        state.continuous = [between(self.parameters.f_c, self.parameters.f_s, gamma), z];
        state.memory.commit(&self.virgin, z);
    }

    fn discretise(&self, dt: TimeStep) -> ProposedDiscrete<T> {
        let dt = T::of(dt.seconds());
        ProposedDiscrete {
            dt,
            gamma_decay: (-dt / self.parameters.tau).exp(),
            midway_decay: (-T::HALF * dt / self.parameters.tau).exp(),
            steepest_gain: self.gain(self.stiffness(), dt),
            implicit_gain: T::ONE / (self.parameters.sigma + self.stiffness() * dt),
        }
    }

    #[inline(always)]
    fn step(
        &self,
        discrete: &ProposedDiscrete<T>,
        state: &mut State<[T; 2], Hysteresis<T>>,
        velocity: T,
    ) -> T {
        let p = &self.parameters;
        let v = bounded(velocity);
        let g = self.curve.level(v);
        let [gamma, z] = state.continuous;
        let hysteresis = state.memory.force();
        let contact = saturate(gamma, hysteresis + p.sigma * v);
        let slowest = (-gamma - hysteresis) * discrete.implicit_gain;
        let fastest = (gamma - hysteresis) * discrete.implicit_gain;
        state.memory.commit(&self.virgin, z + discrete.dt * between(slowest, fastest, v));
        state.continuous = [g + (gamma - g) * discrete.gamma_decay, state.memory.deflection()];
        contact + p.f_v * v
    }

    /// The force alone, without the rates.
    #[inline(always)]
    fn force(&self, state: &State<[T; 2], Hysteresis<T>>, velocity: T) -> T {
        let p = &self.parameters;
        let (v, [gamma, z]) = (bounded(velocity), state.continuous);
        let hysteresis = state.memory.peek(&self.virgin, z);
        saturate(gamma, hysteresis + p.sigma * v) + p.f_v * v
    }

    /// `gamma` exactly for the mean velocity; in slip `z` relaxes with the slope that the
    /// hysteresis has where the step begins, towards the level midway: of second order, and never
    /// beyond it, because the slope falls along every branch.
    #[inline]
    fn advance(
        &self,
        discrete: &ProposedDiscrete<T>,
        state: &mut State<[T; 2], Hysteresis<T>>,
        from: T,
        to: T,
    ) {
        let v = mean(from, to);
        let g = self.curve.level(v);
        let [gamma, z] = state.continuous;
        let level = g + (gamma - g) * discrete.midway_decay;
        let hysteresis = state.memory.force();
        let stuck = v * discrete.dt;
        let most = |level: T| {
            let excess = level - hysteresis;
            let steepest = excess * discrete.steepest_gain;
            if (stuck - steepest) * level.signum() <= T::ZERO {
                return steepest;
            }
            excess * self.gain(state.memory.slope(&self.virgin, excess), discrete.dt)
        };
        let moved = between(most(-level), most(level), stuck);
        state.memory.commit(&self.virgin, z + moved);
        state.continuous = [g + (gamma - g) * discrete.gamma_decay, state.memory.deflection()];
    }

    #[inline]
    fn inject(&self, dt: TimeStep, state: &mut State<[T; 2], Hysteresis<T>>, _: T, rate: T) -> T {
        let p = &self.parameters;
        let [gamma, z] = state.continuous;
        let gamma = gamma + rate * relaxed(T::ONE / p.tau, T::of(dt.seconds()));
        state.memory.commit(&self.virgin, z + rate * T::of(dt.seconds()));
        state.continuous = [between(p.f_c, p.f_s, gamma), state.memory.deflection()];
        p.sigma * rate
    }

    fn steady_state(&self, velocity: T) -> T {
        self.curve.signed_level(velocity) + self.parameters.f_v * velocity
    }

    fn internals(&self, state: &State<[T; 2], Hysteresis<T>>, velocity: T) -> Internals<T> {
        let [gamma, z] = state.continuous;
        let trial = state.memory.peek(&self.virgin, z) + self.parameters.sigma * velocity;
        let regime = if trial.abs() > gamma { Regime::Slip } else { Regime::Stick };
        Internals { deflection: z, gamma, regime }
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    fn stored_energy(&self, state: &State<[T; 2], Hysteresis<T>>) -> Option<T> {
        Some(state.memory.stored_energy(&self.virgin))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stepper;

    #[test]
    fn reaches_the_stribeck_curve() {
        for model in [Proposed::chapter_3(), Proposed::test_bed()] {
            for v in [0.001, 0.005, 0.01, 0.02, 0.05, 0.1, 0.5, -0.02] {
                let mut stepper = Stepper::new(model, TimeStep::new(1e-3).unwrap());
                for _ in 0..20_000 {
                    stepper.step(v);
                }
                assert!((stepper.step(v) - model.steady_state(v)).abs() < 1e-9, "v {v}");
            }
        }
    }

    /// Stiff, barely damped bristles: an explicit step of 10 ms would diverge at once.
    #[test]
    fn the_fixed_step_neither_diverges_nor_oscillates_when_stiff() {
        let model = Proposed::try_from(ProposedParameters {
            sigma: 1e-6,
            z_b: 1e-6,
            tau: 1e-6,
            ..*Proposed::test_bed().parameters()
        })
        .unwrap();
        let mut stepper = Stepper::new(model, TimeStep::new(0.01).unwrap());
        for _ in 0..500 {
            stepper.step(0.05);
        }
        let forces: Vec<f64> = (0..50).map(|_| stepper.step(0.05)).collect();
        for force in forces {
            assert!((force - model.steady_state(0.05)).abs() < 1e-9, "{force}");
        }
    }

    #[test]
    fn the_stiffness_is_the_slope_of_the_sine_at_rest() {
        let stiffness = Proposed::test_bed().stiffness();
        assert!((stiffness - 0.0994 * std::f64::consts::PI / 0.012).abs() < 1e-12);
    }
}
