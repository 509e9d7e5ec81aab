//! The services that a viewer may call: a list, and how each is asked.

use std::time::Duration;

use msgs::RosService;
use msgs::friction_msgs::{ListExperiments, StartExperiment};
use msgs::lifecycle_msgs::{ChangeState, GetState};
use msgs::std_srvs::Trigger;
use ros_node::{Named, RosNode, RosNodeError};
use serde_json::Value;
use view::{Access, Service};

use super::json;

/// Longest wait for an answer.
const PATIENCE: Duration = Duration::from_secs(5);
/// Longest wait for the end of what runs.
const ENDING: Duration = Duration::from_secs(35);

/// Asks, and waits for the answer.
type Ask = Box<dyn Fn(&Value) -> Result<Value, String> + Send + Sync>;

/// A service, and how it is asked.
pub(super) struct Offer {
    pub(super) service: Service,
    ask: Ask,
}

impl Offer {
    /// Asks, and waits for the answer.
    pub(super) fn ask(&self, request: &Value) -> Result<Value, String> {
        (self.ask)(request)
    }
}

/// All of them, as far as the process has their nodes.
pub(super) fn all(node: &RosNode, experiments: bool) -> Result<Vec<Offer>, RosNodeError> {
    let mut offers = vec![stop(node, "rig_driver/emergency_stop")?];
    for name in [
        "rig_driver/clear_fault",
        "rig_driver/zero_sensors",
        "friction_observer/reset",
        "controller/reset",
    ] {
        offers.push(offer::<Trigger>(node, name, Access::Full, PATIENCE)?);
    }
    for name in ["rig_driver", "friction_observer", "controller"] {
        let (get, change) = (format!("{name}/get_state"), format!("{name}/change_state"));
        offers.push(offer::<GetState>(node, &get, Access::ReadOnly, PATIENCE)?);
        offers.push(offer::<ChangeState>(node, &change, Access::Full, PATIENCE)?);
    }
    if experiments {
        let runner = |name: &str| format!("experiment_runner/{name}");
        offers.push(offer::<ListExperiments>(
            node,
            &runner("list_experiments"),
            Access::ReadOnly,
            PATIENCE,
        )?);
        offers.push(offer::<StartExperiment>(
            node,
            &runner("start_experiment"),
            Access::Full,
            PATIENCE,
        )?);
        offers.push(offer::<Trigger>(node, &runner("abort"), Access::Full, ENDING)?);
    }
    Ok(offers)
}

/// What stops the motor may be asked until it answers.
fn stop(node: &RosNode, name: &str) -> Result<Offer, RosNodeError> {
    let client = node.client::<Trigger>(name)?;
    let service = Service { stops: true, ..service::<Trigger>(node, name, Access::Full)? };
    let ask = move |request: &Value| {
        let request = read::<Trigger>(request)?;
        let answer = client.call_until_answered(&request, PATIENCE);
        written::<Trigger>(answer)
    };
    Ok(Offer { service, ask: Box::new(ask) })
}

/// What changes something is asked once: a second request would find it changed.
fn offer<S: RosService>(
    node: &RosNode,
    name: &str,
    access: Access,
    patience: Duration,
) -> Result<Offer, RosNodeError> {
    let client = node.client::<S>(name)?;
    let service = service::<S>(node, name, access)?;
    let ask = move |request: &Value| {
        let request = read::<S>(request)?;
        written::<S>(if access == Access::ReadOnly {
            client.call_until_answered(&request, patience)
        } else {
            client.call(request, patience)
        })
    };
    Ok(Offer { service, ask: Box::new(ask) })
}

fn service<S: RosService>(
    node: &RosNode,
    name: &str,
    access: Access,
) -> Result<Service, RosNodeError> {
    Ok(Service {
        name: node.resolve(Named::Service, name)?,
        kind: format!("{}/srv/{}", S::PACKAGE, S::NAME),
        request: usual::<S::Request>(),
        response: usual::<S::Response>(),
        access,
        stops: false,
    })
}

fn usual<M: serde::Serialize + Default>() -> Value {
    serde_json::to_value(M::default()).unwrap_or_default()
}

fn read<S: RosService>(said: &Value) -> Result<S::Request, String> {
    let whole = json::with(usual::<S::Request>(), said)?;
    serde_json::from_value(whole).map_err(|error| format!("the request cannot be read: {error}"))
}

fn written<S: RosService>(answer: Result<S::Response, RosNodeError>) -> Result<Value, String> {
    let answer = answer.map_err(|error| error.to_string())?;
    serde_json::to_value(answer).map_err(|error| error.to_string())
}
