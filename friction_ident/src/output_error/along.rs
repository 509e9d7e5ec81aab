//! What a model predicts along a stretch.

use friction_model::{AnyModel, FrictionModel, ModelVisitor, Stepper, TimeStep};

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
        let substeps = (stretch.time_step / LONGEST_STEP).ceil().max(1.0);
        let Ok(dt) = TimeStep::new(stretch.time_step / substeps) else {
            out.fill(f64::NAN);
            return;
        };
        let mut stepper = Stepper::new(model, dt);
        if stretch.before == Before::Slid {
            slide(&mut stepper, stretch.velocity[0]);
        }
        let last = stretch.len() - 1;
        for (k, out) in out.iter_mut().enumerate() {
            let velocity = stretch.velocity[k];
            let state = stepper.state();
            let still = velocity == 0.0 || rest.get(k).copied().unwrap_or(false);
            *out = if still && stepper.model().holding(0.0).is_some() {
                // Models without pre-sliding say nothing about rest: they hold whatever is applied.
                let holding = stepper.model().holding(0.0);
                holding.map_or(0.0, |holding| holding.force(stretch.friction[k]))
            } else {
                stepper.model().evaluate(&state.continuous, &state.memory, velocity).force
            };
            if k < last {
                let mean = stretch.between(k);
                for _ in 0..substeps as usize {
                    stepper.step(mean);
                }
            }
        }
    }
}

/// Slides at `velocity` until the friction no longer changes.
fn slide<M: FrictionModel>(stepper: &mut Stepper<M>, velocity: f64) {
    if velocity == 0.0 {
        return;
    }
    let steady = stepper.model().steady_state(velocity);
    let mut quiet = 0;
    for _ in 0..SETTLING {
        let force = stepper.step(velocity);
        quiet = if (force - steady).abs() <= 1e-13 * steady.abs() { quiet + 1 } else { 0 };
        if quiet > 3 {
            break;
        }
    }
}
