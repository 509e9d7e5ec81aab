//! The friction curve of the observer's model, from its parameters.

use std::collections::BTreeMap;

use friction_observer::parameters::{ObserverSettings, declarations};
use ros_node::ParameterValue;
use ros_node::parameters::Values;
use serde_json::{Value, json};

/// Points on each side of zero velocity.
const POINTS: usize = 120;
/// Fastest velocity shown \[rad/s\].
const FASTEST: f64 = 20.0;
/// Slowest velocity shown \[rad/s\].
const SLOWEST: f64 = 1e-4;

/// Steady friction against velocity; none if the parameters are not those of an observer.
pub(super) fn of(parameters: &BTreeMap<String, ParameterValue>) -> Option<Value> {
    // What a node of another version lacks is as usual.
    parameters.get("model")?;
    let given: Vec<String> = parameters.keys().cloned().collect();
    let values = Values::given(&declarations(&given), parameters).ok()?;
    let model = ObserverSettings::read(&values).ok()?.model;
    let step = (FASTEST / SLOWEST).powf(1.0 / (POINTS - 1) as f64);
    let speeds: Vec<f64> = (0..POINTS).map(|at| SLOWEST * step.powi(at as i32)).collect();
    let velocity: Vec<f64> =
        speeds.iter().rev().map(|speed| -speed).chain(speeds.iter().copied()).collect();
    let torque: Vec<f64> = velocity.iter().map(|speed| model.steady_state(*speed)).collect();
    torque
        .iter()
        .all(|torque| torque.is_finite())
        .then(|| json!({ "model": model.name().as_str(), "velocity": velocity, "torque": torque }))
}
