//! What a model must keep before it exists: numbers that stay finite wherever it may be driven.

use crate::{ContinuousState, FrictionModel, MAX_SPEED, ModelError, Real, State, TimeStep};

/// Periods that are tried \[s\]: the longest, and one far below any loop's.
const PERIODS: [f64; 2] = [0.01, 1e-9];

/// Velocities that are tried one after the other \[m/s or rad/s\]: the largest from rest and back,
/// and down through all that machines do.
const VELOCITIES: [f64; 10] =
    [MAX_SPEED, MAX_SPEED, -MAX_SPEED, -1.0, 1e-3, -1e-6, 1e-12, 0.0, 1e-9, -MAX_SPEED];

/// The model, if it keeps its numbers finite at any accepted period and velocity.
///
/// # Errors
/// [`ModelError::NotFinite`] with the first quantity that is not.
pub fn finite<T: Real, M: FrictionModel<T>>(model: M) -> Result<M, ModelError> {
    for seconds in PERIODS {
        let dt = TimeStep::new(seconds)?;
        let discrete = model.discretise(dt);
        let mut state = model.rest();
        for v in VELOCITIES.map(T::of) {
            look::<T, M>("force", model.step(&discrete, &mut state, v), v)?;
            settled(&model, &state, v)?;
            let driven = model.step_injected(&discrete, dt, &mut state, v, -v);
            look::<T, M>("force", driven, v)?;
            settled(&model, &state, v)?;
            model.advance(&discrete, &mut state, v, -v);
            settled(&model, &state, v)?;
        }
    }
    Ok(model)
}

/// Looks at all that `state` tells.
fn settled<T: Real, M: FrictionModel<T>>(
    model: &M,
    state: &State<M::Continuous, M::Memory>,
    v: T,
) -> Result<(), ModelError> {
    let mut worst = 0.0;
    state.continuous.each(&mut |x| {
        if !x.is_finite() {
            worst = x;
        }
    });
    look::<T, M>("state", T::of(worst), v)?;
    let inside = model.internals(state, v);
    look::<T, M>("deflection", inside.deflection, v)?;
    look::<T, M>("level", inside.gamma, v)?;
    look::<T, M>("steady force", model.steady_state(v), v)?;
    let now = model.evaluate(&state.continuous, &state.memory, v);
    look::<T, M>("force", now.force, v)?;
    look::<T, M>("force", model.force(state, v), v)?;
    look::<T, M>("stored energy", model.stored_energy(state).unwrap_or(T::ZERO), v)
}

fn look<T: Real, M: FrictionModel<T>>(
    quantity: &'static str,
    value: T,
    velocity: T,
) -> Result<(), ModelError> {
    if value.is_finite() {
        return Ok(());
    }
    Err(ModelError::NotFinite {
        model: M::NAME,
        quantity,
        value: value.double(),
        velocity: velocity.double(),
    })
}
