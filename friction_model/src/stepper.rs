//! A model running in real time: its parameters, its coefficients for one period, and its state.

use crate::{AnyStepper, FrictionModel, Internals, Real, Scheme, State, TimeStep};

/// A model with its state, stepped once a period.
#[derive(Debug, Clone)]
pub struct Stepper<M: FrictionModel<T>, T: Real = f64> {
    model: M,
    dt: TimeStep,
    discrete: M::Discrete,
    state: State<M::Continuous, M::Memory>,
    scheme: Scheme,
    /// The velocity of the last step; none at rest, and none where it is held.
    before: Option<T>,
}

impl<T: Real, M: FrictionModel<T>> Stepper<M, T> {
    /// Starts `model` at rest with the period `dt`, each velocity held for it.
    #[must_use]
    pub fn new(model: M, dt: TimeStep) -> Self {
        Self::by(Scheme::Held, model, dt)
    }

    /// Starts `model` at rest with the period `dt`, stepped by `scheme`.
    #[must_use]
    pub fn by(scheme: Scheme, model: M, dt: TimeStep) -> Self {
        let (discrete, state) = (model.discretise(dt), model.rest());
        Self { model, dt, discrete, state, scheme, before: None }
    }

    /// How velocities between two steps are taken.
    #[must_use]
    pub const fn scheme(&self) -> Scheme {
        self.scheme
    }

    /// The friction now at `velocity` \[m/s or rad/s\]. [`Scheme`] says whether the state is then
    /// that of now or that of the next step.
    #[inline]
    pub fn step(&mut self, velocity: T) -> T {
        match self.scheme {
            Scheme::Held => self.model.step(&self.discrete, &mut self.state, velocity),
            Scheme::Mean => {
                self.arrive(velocity);
                self.model.force(&self.state, velocity)
            }
        }
    }

    /// The period up to `velocity` goes by.
    #[inline]
    fn arrive(&mut self, velocity: T) {
        if let Some(before) = self.before.replace(velocity) {
            self.model.advance(&self.discrete, &mut self.state, before, velocity);
        }
    }

    /// [`step`](Self::step) with an extra `rate` in the derivative of every continuous state, for
    /// an observer's error injection. See [`FrictionModel::step_injected`].
    #[inline]
    pub fn step_injected(&mut self, velocity: T, rate: T) -> T {
        match self.scheme {
            Scheme::Held => {
                self.model.step_injected(&self.discrete, self.dt, &mut self.state, velocity, rate)
            }
            Scheme::Mean => {
                self.arrive(velocity);
                self.model.force_injected(self.dt, &mut self.state, velocity, rate)
            }
        }
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
        self.before = None;
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

/// A contact that runs, stepped once a period: a [`Stepper`] of a model known at compile time, of
/// this crate or not, or an [`AnyStepper`]. What an observer is built over.
pub trait RunningContact {
    /// What messages call the model, see [`FrictionModel::NAME`].
    fn model_name(&self) -> &'static str;

    /// How velocities between two steps are taken; held, unless the contact says otherwise.
    fn scheme(&self) -> Scheme {
        Scheme::Held
    }

    /// See [`Stepper::step`].
    fn step(&mut self, velocity: f64) -> f64;

    /// See [`Stepper::step_injected`].
    fn step_injected(&mut self, velocity: f64, rate: f64) -> f64;

    /// See [`Stepper::viscous`].
    fn viscous(&self, velocity: f64) -> f64;

    /// See [`Stepper::reset`].
    fn reset(&mut self);

    /// See [`Stepper::internals`].
    fn internals(&self, velocity: f64) -> Internals;
}

/// Hands every method on to the type's own.
macro_rules! running {
    ($contact:ty, $self:ident => $name:expr $(, [$($generics:tt)+])?) => {
        impl $(<$($generics)+>)? RunningContact for $contact {
            fn model_name(&$self) -> &'static str {
                $name
            }
            fn scheme(&$self) -> Scheme {
                $self.scheme()
            }
            #[inline]
            fn step(&mut self, velocity: f64) -> f64 {
                self.step(velocity)
            }
            #[inline]
            fn step_injected(&mut self, velocity: f64, rate: f64) -> f64 {
                self.step_injected(velocity, rate)
            }
            #[inline]
            fn viscous(&self, velocity: f64) -> f64 {
                self.viscous(velocity)
            }
            fn reset(&mut self) {
                self.reset();
            }
            #[inline]
            fn internals(&self, velocity: f64) -> Internals {
                self.internals(velocity)
            }
        }
    };
}

running!(Stepper<M>, self => M::NAME, [M: FrictionModel]);
running!(AnyStepper, self => self.name().as_str());
