//! The derivative form under a prescribed velocity: classical Runge-Kutta of fourth order.

use crate::body::sum;
use crate::{ContinuousState, FrictionModel, Real, State};

/// Advances `state` by `dt` \[s\] under a velocity given at the start, the middle and the end of
/// the step, commits, and returns the force at the end.
///
/// Step sizes: LuGre needs `dt < 2.78 g / (sigma0 |v|)`; the proposed model `dt < 2.78 sigma / k`
/// and `2.78 tau`.
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
