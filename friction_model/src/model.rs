//! The one trait behind which every friction model stands.

use core::fmt::Debug;

use crate::arithmetic::{between, bounded, fused, mean};
use crate::{ModelError, ParameterSet, Real};

/// The continuous states of a model: a small fixed array, so that integrators neither allocate nor
/// loop over a length they do not know.
pub trait ContinuousState<T: Real = f64>: Copy + Debug + PartialEq {
    /// `self + h * rate`, element by element.
    #[must_use]
    fn plus_scaled(&self, rate: &Self, h: T) -> Self;

    /// `f` of each state of `self` and the same one of `other`.
    #[must_use]
    fn zip(&self, other: &Self, f: impl Fn(T, T) -> T + Copy) -> Self;

    /// Calls `f` with every state in its order: for recorders that do not know the model.
    fn each(&self, f: &mut dyn FnMut(f64));
}

impl<T: Real, const N: usize> ContinuousState<T> for [T; N] {
    #[inline]
    fn plus_scaled(&self, rate: &Self, h: T) -> Self {
        let mut sum = *self;
        for (s, r) in sum.iter_mut().zip(rate) {
            *s = fused(h, *r, *s);
        }
        sum
    }

    #[inline]
    fn zip(&self, other: &Self, f: impl Fn(T, T) -> T + Copy) -> Self {
        let mut both = *self;
        for (a, b) in both.iter_mut().zip(other) {
            *a = f(*a, *b);
        }
        both
    }

    fn each(&self, f: &mut dyn FnMut(f64)) {
        self.iter().for_each(|state| f(state.double()));
    }
}

/// Two states side by side, for instance of the two directions of an asymmetric contact.
impl<T: Real, A: ContinuousState<T>, B: ContinuousState<T>> ContinuousState<T> for (A, B) {
    #[inline]
    fn plus_scaled(&self, rate: &Self, h: T) -> Self {
        (self.0.plus_scaled(&rate.0, h), self.1.plus_scaled(&rate.1, h))
    }

    #[inline]
    fn zip(&self, other: &Self, f: impl Fn(T, T) -> T + Copy) -> Self {
        (self.0.zip(&other.0, f), self.1.zip(&other.1, f))
    }

    fn each(&self, f: &mut dyn FnMut(f64)) {
        self.0.each(f);
        self.1.each(f);
    }
}

/// State of a model: what is integrated, and what is remembered.
#[derive(Debug, Clone, PartialEq)]
pub struct State<C, M> {
    /// States with a rate, for instance `[gamma, z]`.
    pub continuous: C,
    /// Memory that only changes when a step is accepted, for instance the reversal points.
    pub memory: M,
}

/// Force and rates at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evaluation<C, T = f64> {
    /// Friction force \[N\] or torque \[N m\], opposing motion.
    pub force: T,
    /// Time derivatives of the continuous states.
    pub rates: C,
}

/// Whether the surfaces hold or slide.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "lowercase")
)]
pub enum Regime {
    /// Pre-sliding: the bristles deflect with the motion.
    #[default]
    Stick,
    /// Gross sliding.
    Slip,
}

/// The inner quantities that all models can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Internals<T = f64> {
    /// Bristle deflection z \[m or rad\]; zero for static models.
    pub deflection: T,
    /// Level at which the contact slides now, gamma \[N or N m\].
    pub gamma: T,
    /// Stick or slip.
    pub regime: Regime,
}

/// Period of a fixed-step model: above zero, at most 10 ms.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct TimeStep(f64);

impl TimeStep {
    /// A period in seconds.
    ///
    /// # Errors
    /// [`ModelError::TimeStep`] outside (0, 0.01] s.
    pub fn new(seconds: f64) -> Result<Self, ModelError> {
        if seconds > 0.0 && seconds <= 0.01 {
            Ok(Self(seconds))
        } else {
            Err(ModelError::TimeStep(seconds))
        }
    }

    /// The period \[s\].
    #[must_use]
    pub const fn seconds(self) -> f64 {
        self.0
    }
}

/// How a model that is discontinuous at zero velocity holds there. A simulator treats the sticking
/// as an event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Holding<T = f64> {
    /// Speeds up to this one count as standing still \[m/s or rad/s\]; zero for all models but
    /// Karnopp's.
    pub band: T,
    /// Largest force that is held against motion forward \[N or N m\].
    pub forward: T,
    /// Largest force that is held against motion backward, as a magnitude \[N or N m\].
    pub backward: T,
}

impl<T: Real> Holding<T> {
    /// Holds up to `level` both ways at exactly zero velocity.
    #[must_use]
    pub const fn up_to(level: T) -> Self {
        Self { band: T::ZERO, forward: level, backward: level }
    }

    /// Whether the contact stays where it is at `velocity` under the sum `applied` of all other
    /// forces.
    #[inline]
    #[must_use]
    pub fn holds(&self, velocity: T, applied: T) -> bool {
        velocity.abs() <= self.band && applied <= self.forward && applied >= -self.backward
    }

    /// The friction while standing still: it balances `applied` as far as the levels allow (thesis
    /// eqs. 2.7, 2.8, 2.13).
    #[inline]
    #[must_use]
    pub fn force(&self, applied: T) -> T {
        between(-self.backward, self.forward, applied)
    }
}

/// A friction model with valid parameters, in numbers of type `T`.
///
/// `F` opposes motion. For the derivative form use [`evaluate`](Self::evaluate) in the stages of an
/// integrator and [`commit`](Self::commit) once for each accepted step. For the fixed-step form use
/// a [`crate::Stepper`].
pub trait FrictionModel<T: Real = f64>: Clone + Debug {
    /// What messages call the model. A built-in model has the name that files have for it.
    const NAME: &'static str;
    /// Its parameters as files carry them.
    type Parameters: ParameterSet;
    /// Continuous states, `[T; N]`.
    type Continuous: ContinuousState<T>;
    /// Discrete memory; `()` for most models.
    type Memory: Clone + Debug + PartialEq;
    /// Coefficients of the fixed-step form that depend on the period only.
    type Discrete: Clone + Debug;

    /// The parameters.
    fn parameters(&self) -> &Self::Parameters;

    /// The state at rest, unloaded and having rested long: `z = 0`, `gamma = F_s`.
    fn rest(&self) -> State<Self::Continuous, Self::Memory>;

    /// Force and rates at `velocity`. Leaves the memory alone: for the stages of an integrator.
    fn evaluate(
        &self,
        state: &Self::Continuous,
        memory: &Self::Memory,
        velocity: T,
    ) -> Evaluation<Self::Continuous, T>;

    /// [`evaluate`](Self::evaluate) at one velocity: what depends on the velocity alone is computed
    /// here, and not again for each state.
    #[inline]
    fn at(
        &self,
        velocity: T,
    ) -> impl Fn(&Self::Continuous, &Self::Memory) -> Evaluation<Self::Continuous, T> {
        move |state, memory| self.evaluate(state, memory, velocity)
    }

    /// Accepts a step of `dt` \[s\] that ended at `velocity`: projects the states onto their bounds
    /// and lets the memory know where they arrived.
    fn commit(&self, state: &mut State<Self::Continuous, Self::Memory>, velocity: T, dt: T);

    /// Coefficients of the fixed-step form for the period `dt`.
    fn discretise(&self, dt: TimeStep) -> Self::Discrete;

    /// The fixed-step form: the force now at `velocity`, after which the state advances by one
    /// period under that velocity.
    ///
    /// Stable for every valid parameter set and period. A velocity beyond [`MAX_SPEED`](crate::MAX_SPEED) is cut to
    /// it; one that is not a number counts as zero, so that the state stays finite (whoever
    /// measures velocities must raise the fault).
    fn step(
        &self,
        discrete: &Self::Discrete,
        state: &mut State<Self::Continuous, Self::Memory>,
        velocity: T,
    ) -> T;

    /// What an extra `rate` in the derivative of every continuous state does in one period `dt`,
    /// after [`step`](Self::step) at `velocity`: moves the states, projects them back onto their
    /// bounds, and returns what the extra rates add to the force of that step where the force
    /// depends on them (micro-damping). The rate has each state's own unit per second, as in a
    /// state observer with one scalar gain (thesis eqs. 5.12 to 5.14). Models without states ignore
    /// it.
    fn inject(
        &self,
        _dt: TimeStep,
        _state: &mut State<Self::Continuous, Self::Memory>,
        _velocity: T,
        _rate: T,
    ) -> T {
        T::ZERO
    }

    /// [`step`](Self::step) with an extra `rate` in the derivative of every continuous state, see
    /// [`inject`](Self::inject). What is not a number counts as zero, and more than [`MAX_SPEED`](crate::MAX_SPEED)
    /// is cut to it.
    #[inline]
    fn step_injected(
        &self,
        discrete: &Self::Discrete,
        dt: TimeStep,
        state: &mut State<Self::Continuous, Self::Memory>,
        velocity: T,
        rate: T,
    ) -> T {
        let force = self.step(discrete, state, velocity);
        let rate = bounded(rate);
        if rate == T::ZERO {
            force
        } else {
            force + self.inject(dt, state, bounded(velocity), rate)
        }
    }

    /// Lets one period go by in which the velocity goes straight from `from` to `to`: the scheme
    /// `mean`. Unless a model says otherwise, it is [`step`](Self::step) under the mean of both,
    /// which is of second order where the step is exact for a held velocity, and as stable.
    #[inline]
    fn advance(
        &self,
        discrete: &Self::Discrete,
        state: &mut State<Self::Continuous, Self::Memory>,
        from: T,
        to: T,
    ) {
        self.step(discrete, state, mean(from, to));
    }

    /// The force in this state at `velocity`, which is bounded as [`step`](Self::step) bounds it.
    #[inline]
    fn force(&self, state: &State<Self::Continuous, Self::Memory>, velocity: T) -> T {
        self.evaluate(&state.continuous, &state.memory, bounded(velocity)).force
    }

    /// [`force`](Self::force) with an extra `rate` in the derivative of every continuous state over
    /// the next period, see [`inject`](Self::inject).
    #[inline]
    fn force_injected(
        &self,
        dt: TimeStep,
        state: &mut State<Self::Continuous, Self::Memory>,
        velocity: T,
        rate: T,
    ) -> T {
        let force = self.force(state, velocity);
        let rate = bounded(rate);
        if rate == T::ZERO {
            force
        } else {
            force + self.inject(dt, state, bounded(velocity), rate)
        }
    }

    /// The force after a long time at constant `velocity`.
    fn steady_state(&self, velocity: T) -> T;

    /// The inner quantities at this state and velocity.
    fn internals(&self, state: &State<Self::Continuous, Self::Memory>, velocity: T)
    -> Internals<T>;

    /// Calls `f` with each switch that the memory has, as a number that says where it stands: for
    /// integrators that must know when one was thrown, which is when a step is accepted. None,
    /// unless a model says otherwise.
    fn switches(&self, _memory: &Self::Memory, _f: &mut dyn FnMut(T)) {}

    /// The part of the force that is viscous, `f_v v`: what is left is the contact's. Zero for
    /// models without such a term.
    fn viscous(&self, _velocity: T) -> T {
        T::ZERO
    }

    /// How a model that is discontinuous at zero velocity holds there, where the applied force
    /// changes at `force_rate` \[N/s or N m/s\]. `None` for models that describe pre-sliding
    /// themselves.
    fn holding(&self, _force_rate: T) -> Option<Holding<T>> {
        None
    }

    /// Energy stored in the deflected bristles \[J\], where the model defines one.
    fn stored_energy(&self, _state: &State<Self::Continuous, Self::Memory>) -> Option<T> {
        None
    }
}

/// A [`FrictionModel`] that can be built from its parameters: every model of this crate.
pub trait FromParameters<T: Real = f64>:
    FrictionModel<T> + TryFrom<Self::Parameters, Error = ModelError>
{
}

impl<T: Real, M> FromParameters<T> for M where
    M: FrictionModel<T> + TryFrom<M::Parameters, Error = ModelError>
{
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_side_by_side_are_seen_in_their_order() {
        let mut seen = Vec::new();
        ([1.0, 2.0], [3.0]).each(&mut |state| seen.push(state));
        assert_eq!(seen, [1.0, 2.0, 3.0]);
    }

    #[test]
    fn time_steps_are_validated() {
        assert_eq!(TimeStep::new(1e-3).unwrap().seconds(), 1e-3);
        for wrong in [0.0, -1e-3, 0.011, f64::NAN, f64::INFINITY] {
            assert!(matches!(TimeStep::new(wrong), Err(ModelError::TimeStep(_))), "{wrong}");
        }
    }
}
