//! The derivative form under a prescribed velocity: classical Runge-Kutta of fourth order.

use crate::body::sum;
use crate::{ContinuousState, FrictionModel, Real, State};

/// Advances `state` by `dt` \[s\] under a velocity given at the start, the middle and the end of
/// the step, commits, and returns the force at the end.
///
/// Step sizes: LuGre needs `dt < 2.78 g / (sigma0 |v|)`; the proposed model `dt < 2.78 sigma / k`
/// and `2.78 tau`. Beyond them the result is worthless, and nothing here says so: [`attempt`] does.
#[inline]
pub fn step<T: Real, M: FrictionModel<T>>(
    model: &M,
    state: &mut State<M::Continuous, M::Memory>,
    [v0, v_mid, v1]: [T; 3],
    dt: T,
) -> T {
    let (start, middle, end) = (model.at(v0), model.at(v_mid), model.at(v1));
    let x = state.continuous;
    let memory = &state.memory;
    let k1 = start(&x, memory).rates;
    let k2 = middle(&x.plus_scaled(&k1, T::HALF * dt), memory).rates;
    let k3 = middle(&x.plus_scaled(&k2, T::HALF * dt), memory).rates;
    let k4 = end(&x.plus_scaled(&k3, dt), memory).rates;
    state.continuous = sum(&x, [&k1, &k2, &k3, &k4], dt);
    model.commit(state, v1, dt);
    end(&state.continuous, &state.memory).force
}

/// Where a step of [`step`] would lead, before it is accepted, and its error as a step of third
/// order estimates it: `dt (k4 - k5) / 6`, with `k5` the rate at the end. A step that is too long
/// for the model's stiffness (see [`step`]) has an estimate of the size of the states.
///
/// The third-order companion has the weights `(1/6, 1/3, 1/3, 0, 1/6)` over the four stages and
/// the end. Accept a step by storing the states and calling [`FrictionModel::commit`].
#[inline]
pub fn attempt<T: Real, M: FrictionModel<T>>(
    model: &M,
    state: &State<M::Continuous, M::Memory>,
    [v0, v_mid, v1]: [T; 3],
    dt: T,
) -> Attempt<M::Continuous> {
    let (start, middle, end) = (model.at(v0), model.at(v_mid), model.at(v1));
    let x = state.continuous;
    let memory = &state.memory;
    let k1 = start(&x, memory).rates;
    let k2 = middle(&x.plus_scaled(&k1, T::HALF * dt), memory).rates;
    let k3 = middle(&x.plus_scaled(&k2, T::HALF * dt), memory).rates;
    let k4 = end(&x.plus_scaled(&k3, dt), memory).rates;
    let reached = sum(&x, [&k1, &k2, &k3, &k4], dt);
    let k5 = end(&reached, memory).rates;
    let sixth = dt / T::of(6.0);
    let error = k4.plus_scaled(&k5, -T::ONE).zip(&k4, |difference, _| sixth * difference);
    Attempt { reached, error }
}

/// What [`attempt`] came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attempt<C> {
    /// The states at the end of the step.
    pub reached: C,
    /// By how much each may be wrong.
    pub error: C,
}

impl<C> Attempt<C> {
    /// Whether every state is a finite number and its error at most `tolerance` of its magnitude in
    /// `most`.
    pub fn holds<T: Real>(&self, most: &C, tolerance: T) -> bool
    where
        C: ContinuousState<T>,
    {
        // Above zero where a state is too wrong; not a number where it is none.
        let excess = self.error.zip(most, |error, most| error.abs() - tolerance * most.abs());
        let mut holds = true;
        excess.each(&mut |excess| holds &= excess <= 0.0);
        self.reached.each(&mut |x| holds &= x.is_finite());
        holds
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LuGre;

    /// LuGre at steady speed relaxes at `sigma0 v / g`: at three times the inverse the step is
    /// beyond the limit that [`step`] names, and the estimate says so; at a tenth it is right.
    #[test]
    fn a_step_beyond_the_limit_of_stability_does_not_hold() {
        let model = LuGre::chapter_3();
        let p = *model.parameters();
        let v = 0.5;
        let time = p.f_c / (p.sigma0 * v);
        for (part, expected) in [(3.0, false), (1.0, false), (0.02, true)] {
            let state = model.rest();
            let attempt = attempt(&model, &state, [v; 3], part * time);
            assert_eq!(attempt.holds(&attempt.reached, 1e-6), expected, "{part}: {attempt:?}");
        }
    }

    #[test]
    fn the_error_is_of_the_fourth_order_in_the_step() {
        let model = LuGre::test_bed();
        let error = |h: f64| attempt(&model, &model.rest(), [0.1; 3], h).error[0].abs();
        let order = (error(2e-3) / error(1e-3)).log2();
        assert!((order - 4.0).abs() < 0.1, "{order}");
    }

    #[test]
    fn what_is_no_number_never_holds() {
        for reached in [f64::NAN, f64::INFINITY] {
            let attempt = Attempt { reached: [reached], error: [0.0] };
            assert!(!attempt.holds(&[1.0], 1e-3));
        }
        let attempt = Attempt { reached: [1.0], error: [f64::NAN] };
        assert!(!attempt.holds(&[1.0], 1e-3));
    }
}
