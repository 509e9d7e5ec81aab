//! A linear loop around friction, with an observer in it: everything integrated together by RK4.
//!
//! The observer is integrated in the same stages as the plant: with the plant's own model and no
//! injection it cancels the friction exactly, as a continuous observer does, whatever the step.

use friction_model::{ContinuousState, FrictionModel, State};

/// The linear part of a loop: axis, controller, disturbance.
pub trait LinearPart<const A: usize> {
    /// Velocity of the axis [rad/s].
    fn velocity(&self, x: &[f64; A]) -> f64;

    /// Controlled output minus its reference [rad/s or rad].
    fn error(&self, x: &[f64; A]) -> f64;

    /// Derivatives of the states while `friction` [N m] brakes and `estimate` [N m] is added to the
    /// command.
    fn rates(&self, x: &[f64; A], friction: f64, estimate: f64) -> [f64; A];
}

/// States that can all be moved by the same amount, as error injection does with their rates.
pub trait Shift: ContinuousState {
    /// Every element plus `by`.
    #[must_use]
    fn shifted(&self, by: f64) -> Self;
}

impl<const N: usize> Shift for [f64; N] {
    fn shifted(&self, by: f64) -> Self {
        self.map(|value| value + by)
    }
}

impl<A: Shift, B: Shift> Shift for (A, B) {
    fn shifted(&self, by: f64) -> Self {
        (self.0.shifted(by), self.1.shifted(by))
    }
}

/// A friction model, its state, and how strongly its friction follows the rate of its bristles.
#[derive(Debug, Clone)]
pub struct Contact<M: FrictionModel> {
    model: M,
    state: State<M::Continuous, M::Memory>,
    damping: f64,
}

impl<M: FrictionModel> Contact<M> {
    /// `model` at rest; `damping` is dF/dz' [N m s/rad], summed over its elements.
    pub fn new(model: M, damping: f64) -> Self {
        Self { state: model.rest(), model, damping }
    }
}

/// The whole loop, for the friction `P` of the plant and `O` of the observer.
#[derive(Debug, Clone)]
pub struct ClosedLoop<L, P: FrictionModel, O: FrictionModel, const A: usize> {
    /// The linear part; what it holds over a step may be changed between steps.
    pub linear: L,
    x: [f64; A],
    plant: Contact<P>,
    observer: Contact<O>,
    injection: f64,
}

impl<L, P, O, const A: usize> ClosedLoop<L, P, O, A>
where
    L: LinearPart<A>,
    P: FrictionModel,
    O: FrictionModel<Continuous: Shift>,
{
    /// A loop at rest with the linear states `x`. `injection` is k of the observer: `-k e` in the
    /// derivative of each of its states, with e the controlled output minus its reference.
    pub fn new(
        linear: L,
        x: [f64; A],
        plant: Contact<P>,
        observer: Contact<O>,
        injection: f64,
    ) -> Self {
        Self { linear, x, plant, observer, injection }
    }

    /// Controlled output minus its reference now [rad/s or rad].
    pub fn error(&self) -> f64 {
        self.linear.error(&self.x)
    }

    /// Advances by `h` \[s\].
    pub fn advance(&mut self, h: f64) {
        let Self { linear, x, plant, observer, injection } = self;
        let rates = |x: &[f64; A], p: &P::Continuous, o: &O::Continuous| {
            let velocity = linear.velocity(x);
            let friction = plant.model.evaluate(p, &plant.state.memory, velocity);
            let seen = observer.model.evaluate(o, &observer.state.memory, velocity);
            let injected = -*injection * linear.error(x);
            let estimate = seen.force + observer.damping * injected;
            (
                linear.rates(x, friction.force, estimate),
                friction.rates,
                seen.rates.shifted(injected),
            )
        };
        let (x0, p0, o0) = (*x, plant.state.continuous, observer.state.continuous);
        let ahead = |(dx, dp, dy): &([f64; A], P::Continuous, O::Continuous), h: f64| {
            rates(&x0.plus_scaled(dx, h), &p0.plus_scaled(dp, h), &o0.plus_scaled(dy, h))
        };
        let k1 = rates(&x0, &p0, &o0);
        let k2 = ahead(&k1, 0.5 * h);
        let k3 = ahead(&k2, 0.5 * h);
        let k4 = ahead(&k3, h);
        let (mut x1, mut p1, mut o1) = (x0, p0, o0);
        for (k, weight) in [(&k1, h / 6.0), (&k2, h / 3.0), (&k3, h / 3.0), (&k4, h / 6.0)] {
            x1 = x1.plus_scaled(&k.0, weight);
            p1 = p1.plus_scaled(&k.1, weight);
            o1 = o1.plus_scaled(&k.2, weight);
        }
        *x = x1;
        (plant.state.continuous, observer.state.continuous) = (p1, o1);
        let velocity = linear.velocity(x);
        plant.model.commit(&mut plant.state, velocity, h);
        observer.model.commit(&mut observer.state, velocity, h);
    }
}
