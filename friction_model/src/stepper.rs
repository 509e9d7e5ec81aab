//! A model running in real time: its parameters, its coefficients for one period, and its state.

use crate::{FrictionModel, Internals, Real, State, TimeStep};

/// A model with its state, stepped once a period.
#[derive(Debug, Clone)]
pub struct Stepper<M: FrictionModel<T>, T: Real = f64> {
    model: M,
    dt: TimeStep,
    discrete: M::Discrete,
    state: State<M::Continuous, M::Memory>,
}

impl<T: Real, M: FrictionModel<T>> Stepper<M, T> {
    /// Starts `model` at rest with the period `dt`.
    #[must_use]
    pub fn new(model: M, dt: TimeStep) -> Self {
        let (discrete, state) = (model.discretise(dt), model.rest());
        Self { model, dt, discrete, state }
    }

    /// The friction now at `velocity` \[m/s or rad/s]; the state then advances by one period.
    #[inline]
    pub fn step(&mut self, velocity: T) -> T {
        self.model.step(&self.discrete, &mut self.state, velocity)
    }

    /// [`step`](Self::step) with an extra `rate` in the derivative of every continuous state, for
    /// an observer's error injection. See [`FrictionModel::step_injected`].
    #[inline]
    pub fn step_injected(&mut self, velocity: T, rate: T) -> T {
        self.model.step_injected(&self.discrete, self.dt, &mut self.state, velocity, rate)
    }

    /// The part of the force at `velocity` that is viscous.
    #[inline]
    #[must_use]
    pub fn viscous(&self, velocity: T) -> T {
        self.model.viscous(velocity)
    }

    /// Back to rest.
    pub fn reset(&mut self) {
        self.state = self.model.rest();
    }

    /// The inner quantities at `velocity`.
    #[must_use]
    pub fn internals(&self, velocity: T) -> Internals<T> {
        self.model.internals(&self.state, velocity)
    }

    /// The model.
    #[must_use]
    pub const fn model(&self) -> &M {
        &self.model
    }

    /// The state.
    #[must_use]
    pub const fn state(&self) -> &State<M::Continuous, M::Memory> {
        &self.state
    }

    /// The period.
    #[must_use]
    pub const fn period(&self) -> TimeStep {
        self.dt
    }
}
