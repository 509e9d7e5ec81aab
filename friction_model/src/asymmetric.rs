//! A contact whose friction differs between the two directions.
//!
//! ```text
//! F = max(F_forward, 0) + min(F_backward, 0)
//! ```
//!
//! Two contacts of the same model see the same motion, each with its own parameters; one carries
//! the positive forces, the other the negative ones, as the two flanks of a gear tooth do. It is
//! the construction that keeps what makes a model trustworthy, for every model and for every
//! parameter, stiffness included:
//!
//! * with equal parameters it is the symmetric model, to the last bit;
//! * constant forward motion gives the forward parameters' steady state, backward motion the
//!   backward ones';
//! * the force is as continuous as the two are; at a reversal nothing jumps, because each side
//!   passes through zero by itself;
//! * cutting a force at zero is monotone in the force, and a monotone function of an operator whose
//!   loops close (return-point memory) dissipates where the operator does.
//!
//! Switching parameters by the sign of the velocity, as is often done, has none of these once the
//! stiffness differs: moving a stuck contact to and fro would then raise its force by
//! `(k_forward - k_backward) dx` a cycle, energy from nowhere.

use crate::{Evaluation, FrictionModel, Holding, Internals, Real, State, TimeStep};

/// One model with parameters for each direction. State: both contacts' states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asymmetric<M> {
    /// Carries positive forces: friction against forward motion.
    pub forward: M,
    /// Carries negative forces: friction against backward motion.
    pub backward: M,
}

impl<M> Asymmetric<M> {
    /// The side that a motion at `velocity` loads.
    fn side<T: Real>(&self, velocity: T) -> &M {
        if velocity < T::ZERO { &self.backward } else { &self.forward }
    }
}

/// The sum of what the forward contact pushes and the backward one pulls.
#[inline]
fn carried<T: Real>(forward: T, backward: T) -> T {
    let push = if forward > T::ZERO { forward } else { T::ZERO };
    let pull = if backward < T::ZERO { backward } else { T::ZERO };
    push + pull
}

type Pair<C> = (C, C);

/// Splits a joint state into those of the two contacts, runs `f`, and puts it together again.
#[inline]
fn with_both<C: Copy, M, R>(
    state: &mut State<Pair<C>, Pair<State<C, M>>>,
    f: impl FnOnce(&mut State<C, M>, &mut State<C, M>) -> R,
) -> R {
    let (a, b) = &mut state.memory;
    (a.continuous, b.continuous) = state.continuous;
    let result = f(a, b);
    state.continuous = (a.continuous, b.continuous);
    result
}

impl<T: Real, M: FrictionModel<T>> FrictionModel<T> for Asymmetric<M> {
    const NAME: &'static str = M::NAME;
    type Parameters = M::Parameters;
    type Continuous = Pair<M::Continuous>;
    /// Each contact's memory, kept with a copy of its continuous state.
    type Memory = Pair<State<M::Continuous, M::Memory>>;
    type Discrete = Pair<M::Discrete>;

    /// The parameters of the forward direction.
    fn parameters(&self) -> &M::Parameters {
        self.forward.parameters()
    }

    fn rest(&self) -> State<Self::Continuous, Self::Memory> {
        let (a, b) = (self.forward.rest(), self.backward.rest());
        State { continuous: (a.continuous, b.continuous), memory: (a, b) }
    }

    #[inline]
    fn evaluate(
        &self,
        state: &Self::Continuous,
        memory: &Self::Memory,
        velocity: T,
    ) -> Evaluation<Self::Continuous, T> {
        self.at(velocity)(state, memory)
    }

    #[inline]
    fn at(
        &self,
        velocity: T,
    ) -> impl Fn(&Self::Continuous, &Self::Memory) -> Evaluation<Self::Continuous, T> {
        let (forward, backward) = (self.forward.at(velocity), self.backward.at(velocity));
        move |(a, b), memory| {
            let forward = forward(a, &memory.0.memory);
            let backward = backward(b, &memory.1.memory);
            Evaluation {
                force: carried(forward.force, backward.force),
                rates: (forward.rates, backward.rates),
            }
        }
    }

    #[inline]
    fn commit(&self, state: &mut State<Self::Continuous, Self::Memory>, velocity: T, dt: T) {
        with_both(state, |a, b| {
            self.forward.commit(a, velocity, dt);
            self.backward.commit(b, velocity, dt);
        });
    }

    fn discretise(&self, dt: TimeStep) -> Self::Discrete {
        (self.forward.discretise(dt), self.backward.discretise(dt))
    }

    #[inline]
    fn step(
        &self,
        discrete: &Self::Discrete,
        state: &mut State<Self::Continuous, Self::Memory>,
        velocity: T,
    ) -> T {
        with_both(state, |a, b| {
            carried(
                self.forward.step(&discrete.0, a, velocity),
                self.backward.step(&discrete.1, b, velocity),
            )
        })
    }

    #[inline]
    fn step_injected(
        &self,
        discrete: &Self::Discrete,
        dt: TimeStep,
        state: &mut State<Self::Continuous, Self::Memory>,
        velocity: T,
        rate: T,
    ) -> T {
        with_both(state, |a, b| {
            let forward = self.forward.step_injected(&discrete.0, dt, a, velocity, rate);
            let backward = self.backward.step_injected(&discrete.1, dt, b, velocity, rate);
            carried(forward, backward)
        })
    }

    #[inline]
    fn advance(
        &self,
        discrete: &Self::Discrete,
        state: &mut State<Self::Continuous, Self::Memory>,
        from: T,
        to: T,
    ) {
        with_both(state, |a, b| {
            self.forward.advance(&discrete.0, a, from, to);
            self.backward.advance(&discrete.1, b, from, to);
        });
    }

    /// By the states that the memory keeps: they are those of the last step or commit.
    #[inline]
    fn force(&self, state: &State<Self::Continuous, Self::Memory>, velocity: T) -> T {
        let (a, b) = &state.memory;
        carried(self.forward.force(a, velocity), self.backward.force(b, velocity))
    }

    #[inline]
    fn force_injected(
        &self,
        dt: TimeStep,
        state: &mut State<Self::Continuous, Self::Memory>,
        velocity: T,
        rate: T,
    ) -> T {
        with_both(state, |a, b| {
            let forward = self.forward.force_injected(dt, a, velocity, rate);
            let backward = self.backward.force_injected(dt, b, velocity, rate);
            carried(forward, backward)
        })
    }

    fn steady_state(&self, velocity: T) -> T {
        self.side(velocity).steady_state(velocity)
    }

    fn switches(&self, (a, b): &Self::Memory, f: &mut dyn FnMut(T)) {
        self.forward.switches(&a.memory, f);
        self.backward.switches(&b.memory, f);
    }

    /// Those of the side that the motion loads.
    fn internals(
        &self,
        state: &State<Self::Continuous, Self::Memory>,
        velocity: T,
    ) -> Internals<T> {
        let (memory, continuous) = if velocity < T::ZERO {
            (&state.memory.1.memory, state.continuous.1)
        } else {
            (&state.memory.0.memory, state.continuous.0)
        };
        self.side(velocity).internals(&State { continuous, memory: memory.clone() }, velocity)
    }

    fn viscous(&self, velocity: T) -> T {
        self.side(velocity).viscous(velocity)
    }

    fn holding(&self, force_rate: T) -> Option<Holding<T>> {
        let (forward, backward) =
            (self.forward.holding(force_rate)?, self.backward.holding(force_rate)?);
        Some(Holding {
            band: forward.band.min(backward.band),
            forward: forward.forward,
            backward: backward.backward,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Coulomb, CoulombParameters, LuGre, LuGreParameters, Proposed, Stepper};

    #[test]
    fn equal_sides_are_the_symmetric_model() {
        let dt = TimeStep::new(1e-3).unwrap();
        let model = Proposed::test_bed();
        let mut both = Stepper::new(Asymmetric { forward: model, backward: model }, dt);
        let mut one = Stepper::new(model, dt);
        for k in 0..20_000 {
            let v = 0.3 * (0.0031 * f64::from(k)).sin() + 0.1 * (0.017 * f64::from(k)).sin();
            assert_eq!(both.step(v), one.step(v));
        }
    }

    #[test]
    fn each_direction_has_its_own_steady_state_and_nothing_jumps() {
        let forward = LuGre::test_bed();
        let p = *forward.parameters();
        let backward =
            LuGre::try_from(LuGreParameters { f_s: 0.08, f_c: 0.06, sigma0: 30.0, f_v: 0.02, ..p })
                .unwrap();
        let model = Asymmetric { forward, backward };
        let mut stepper = Stepper::new(model, TimeStep::new(1e-4).unwrap());
        let mut before = 0.0;
        for k in 0..60_000 {
            let v = 0.5 * (1e-3 * f64::from(k)).sin();
            let force = stepper.step(v);
            // A sign switch of the parameters would jump by F_c's difference of 0.03.
            assert!((force - before).abs() < 2e-3, "step {k}: from {before} to {force}");
            before = force;
        }
        for v in [0.4, -0.4] {
            for _ in 0..50_000 {
                before = stepper.step(v);
            }
            let side = if v > 0.0 { &forward } else { &backward };
            assert!((before - side.steady_state(v)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_static_model_holds_differently_both_ways() {
        let side = |f_c| Coulomb::try_from(CoulombParameters { f_c }).unwrap();
        let model = Asymmetric { forward: side(1.0), backward: side(2.0) };
        let holding = model.holding(0.0).unwrap();
        assert_eq!((holding.force(5.0), holding.force(-5.0)), (1.0, -2.0));
        assert_eq!((model.steady_state(0.1), model.steady_state(-0.1)), (1.0, -2.0));
    }
}
