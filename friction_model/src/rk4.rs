//! The derivative form under a prescribed velocity: classical Runge-Kutta of fourth order.

use crate::body::sum;
use crate::{ContinuousState, FrictionModel, State};

/// Advances `state` by `dt` [s] under a velocity given at the start, the middle and the end of the step, commits, and returns the
/// force at the end.
///
/// Step sizes: LuGre needs `dt < 2.78 g / (sigma0 |v|)`; the proposed model `dt < 2.78 sigma / k` and `2.78 tau`.
#[inline]
pub fn step<M: FrictionModel>(
    model: &M,
    state: &mut State<M::Continuous, M::Memory>,
    [v0, v_mid, v1]: [f64; 3],
    dt: f64,
) -> f64 {
    let x = state.continuous;
    let memory = &state.memory;
    let k1 = model.evaluate(&x, memory, v0).rates;
    let k2 = model.evaluate(&x.plus_scaled(&k1, 0.5 * dt), memory, v_mid).rates;
    let k3 = model.evaluate(&x.plus_scaled(&k2, 0.5 * dt), memory, v_mid).rates;
    let k4 = model.evaluate(&x.plus_scaled(&k3, dt), memory, v1).rates;
    state.continuous = sum(&x, [&k1, &k2, &k3, &k4], dt);
    model.commit(state, v1, dt);
    model.evaluate(&state.continuous, &state.memory, v1).force
}
