//! Runge and Kutta's steps, halved until each holds its tolerance.

use friction_model::{ContinuousState, FrictionModel, State, rk4};

/// How often a step is halved at most.
const MOST_HALVINGS: u32 = 12;

/// What was done to the steps that were asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Halvings {
    /// Steps that were taken.
    pub taken: u64,
    /// Steps that did not hold the tolerance and were halved.
    pub halved: u64,
    /// How often the shortest of them was halved.
    pub most: u32,
}

/// A step that holds the tolerance at no length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stiff {
    /// How far into the step that was asked for \[its length\].
    pub part: f64,
    /// The shortest step that was tried \[its length\].
    pub shortest: f64,
}

/// A model on its way.
pub(super) struct Integration<'m, M: FrictionModel> {
    model: &'m M,
    pub state: State<M::Continuous, M::Memory>,
    tolerance: f64,
    /// The largest magnitude that each state has had.
    seen: M::Continuous,
    /// How often the last step was halved.
    level: u32,
    pub done: Halvings,
}

impl<'m, M: FrictionModel> Integration<'m, M> {
    pub fn at_rest(model: &'m M, tolerance: f64) -> Self {
        let state = model.rest();
        let seen = state.continuous.zip(&state.continuous, |x, _| x.abs());
        Self { model, state, tolerance, seen, level: 0, done: Halvings::default() }
    }

    /// Goes on by `h` \[s\], along the velocity that `at` tells for each part of the way from 0 to
    /// 1.
    pub fn advance(&mut self, h: f64, at: impl Fn(f64) -> f64) -> Result<(), Stiff> {
        const WHOLE: u32 = 1 << MOST_HALVINGS;
        let part = |place: u32| f64::from(place) / f64::from(WHOLE);
        let mut from = 0;
        while from < WHOLE {
            let length = WHOLE >> self.level;
            let (start, end) = (part(from), part(from + length));
            let velocities = [at(start), at(0.5 * (start + end)), at(end)];
            let step = h * part(length);
            let attempt = rk4::attempt(self.model, &self.state, velocities, step);
            if attempt.holds(&mut self.seen, self.tolerance) {
                self.state.continuous = attempt.reached;
                self.model.commit(&mut self.state, velocities[2], step);
                self.done.taken += 1;
                from += length;
                // A longer one next, where it would begin at one of its own places.
                if self.level > 0 && from % (2 * length) == 0 {
                    self.level -= 1;
                }
            } else if self.level == MOST_HALVINGS {
                return Err(Stiff { part: start, shortest: part(length) });
            } else {
                self.level += 1;
                self.done.halved += 1;
                self.done.most = self.done.most.max(self.level);
            }
        }
        Ok(())
    }
}
