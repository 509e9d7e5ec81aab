//! What a model predicts along a stretch.

use friction_model::{AnyModel, FrictionModel, ModelVisitor, Real, State, TimeStep};

use crate::rest::{at_rest, holds};
use crate::stretch::{Before, Stretch};

/// Friction that `model` predicts along a stretch, one value a sample.
pub fn predict(model: &AnyModel, stretch: &Stretch) -> Vec<f64> {
    let mut predicted = vec![0.0; stretch.len()];
    let rest = if holds(model) { at_rest(stretch) } else { Vec::new() };
    model.visit(Along { stretch, rest: &rest, out: &mut predicted });
    predicted
}

/// Runs a model along a stretch.
pub(super) struct Along<'a> {
    pub stretch: &'a Stretch,
    /// Samples at which the contact stands still, as far as they are known; a model that predicts
    /// those too does not ask.
    pub rest: &'a [bool],
    pub out: &'a mut [f64],
}

/// Longest period of a fixed-step model \[s\].
const LONGEST_STEP: f64 = 0.01;
/// Steps within which a contact that slides at a constant velocity is taken to be steady, at most.
const SETTLING: usize = 4_000;

impl ModelVisitor for Along<'_> {
    type Output = ();

    fn visit<M: FrictionModel>(self, model: M) {
        let Self { stretch, rest, out } = self;
        run(&model, stretch, rest, |k, force| out[k] = force);
    }
}

/// Runs a model along a stretch, and hands the number of each sample and the force that is
/// predicted there to `out`. `rest` is as in [`Along`].
#[inline(always)]
pub(super) fn run<T: Real, M: FrictionModel<T>>(
    model: &M,
    stretch: &Stretch,
    rest: &[bool],
    mut out: impl FnMut(usize, T),
) {
    let substeps = (stretch.time_step / LONGEST_STEP).ceil().max(1.0);
    let Ok(dt) = TimeStep::new(stretch.time_step / substeps) else {
        (0..stretch.len()).for_each(|k| out(k, T::nan()));
        return;
    };
    let (discrete, mut state) = (model.discretise(dt), model.rest());
    if stretch.before == Before::Slid {
        slide(model, &discrete, &mut state, T::of(stretch.velocity[0]));
    }
    // Models without pre-sliding say nothing about rest: they hold whatever is applied.
    let holding = model.holding(T::ZERO);
    let last = stretch.len() - 1;
    for k in 0..stretch.len() {
        let velocity = stretch.velocity[k];
        let still = velocity == 0.0 || rest.get(k).copied().unwrap_or(false);
        let force = match &holding {
            Some(holding) if still => holding.force(T::of(stretch.friction[k])),
            _ => model.force(&state, T::of(velocity)),
        };
        out(k, force);
        if k < last {
            let mean = T::of(stretch.between(k));
            for _ in 0..substeps as usize {
                model.step(&discrete, &mut state, mean);
            }
        }
    }
}

/// Slides at `velocity` until the friction no longer changes.
fn slide<T: Real, M: FrictionModel<T>>(
    model: &M,
    discrete: &M::Discrete,
    state: &mut State<M::Continuous, M::Memory>,
    velocity: T,
) {
    if velocity == T::ZERO {
        return;
    }
    let steady = model.steady_state(velocity).double();
    let mut quiet = 0;
    for _ in 0..SETTLING {
        let force = model.step(discrete, state, velocity).double();
        quiet = if (force - steady).abs() <= 1e-13 * steady.abs() { quiet + 1 } else { 0 };
        if quiet > 3 {
            break;
        }
    }
}
