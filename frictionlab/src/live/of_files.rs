//! What parameter files say of the nodes: where no option says otherwise it counts, so that a file
//! that was handed over does alone.

use std::collections::BTreeMap;

use controller::ControlMode;
use experiment_runner::run::Given;
use friction_model::ModelName;
use ros_node::ParameterValue;
use serde::Serialize;

/// Values by the names of their parameters.
type Values = BTreeMap<String, ParameterValue>;

/// Of the observer, what `live` says itself: the model and what is regulated are options, the period is
/// the rig's.
const OWN_OF_OBSERVER: [&str; 4] = ["model", "mode", "period", "autostart"];
/// Of the controller, what the options of a run leave out and a node takes.
const OF_CONTROLLER: [&str; 7] = [
    "compensation",
    "volts_per_newton_metre",
    "voltage_limit",
    "reference_timeout",
    "reference_deceleration",
    "estimate_timeout",
    "estimate_wait",
];

/// What files say of the nodes, beside the models and the controller's gains.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct OfFiles {
    /// Of the node `friction_observer`.
    pub observer: Values,
    /// Of the node `controller`.
    pub controller: Values,
}

impl OfFiles {
    /// What the files say; where an option says the `means`, neither technique nor compensation.
    #[must_use]
    pub fn of(given: &Given, means: bool) -> Self {
        let taken = |from: &Values, counts: &dyn Fn(&str) -> bool| {
            let counted = from.iter().filter(|(name, _)| counts(name));
            counted.map(|(name, value)| (name.clone(), value.clone())).collect()
        };
        let observer =
            |name: &str| !(OWN_OF_OBSERVER.contains(&name) || means && name == "technique");
        let controller =
            |name: &str| OF_CONTROLLER.contains(&name) && !(means && name == "compensation");
        Self {
            observer: taken(given.of_observer(), &observer),
            controller: taken(given.of_controller(), &controller),
        }
    }

    /// A number of the controller that the files say.
    #[must_use]
    pub fn of_controller(&self, name: &str) -> Option<f64> {
        match self.controller.get(name) {
            Some(ParameterValue::Double(value)) => Some(*value),
            _ => None,
        }
    }
}

/// What the files say is regulated.
#[must_use]
pub fn mode(given: &Given) -> Option<ControlMode> {
    named(given.of_controller().get("mode")?)
}

/// The model that they say estimates.
#[must_use]
pub fn model(given: &Given) -> Option<ModelName> {
    named(given.of_observer().get("model")?)
}

fn named<T: std::str::FromStr>(value: &ParameterValue) -> Option<T> {
    match value {
        ParameterValue::String(name) => name.parse().ok(),
        _ => None,
    }
}
