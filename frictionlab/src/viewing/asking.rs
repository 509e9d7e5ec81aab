//! What viewers ask of the nodes.

use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};

use msgs::friction_msgs::{MotorVoltage, Reference};
use msgs::topics;
use ros_node::parameters::Parameters;
use ros_node::{Named, Participant, Publisher, RosNode, RosNodeError};
use serde_json::{Value, json};
use view::{Access, Parameter, Service, Steering};

use super::services::Offer;
use super::settings::Settings;

/// The service that sets parameters with an answer that people read.
const SET: &str = "/view/set_parameters";

/// Asks the nodes as one more of their clients.
pub(super) struct Asking {
    pub(super) offers: Vec<Offer>,
    pub(super) settings: Arc<Settings>,
    pub(super) publishing: Publishing,
    /// Wakes whoever looks after the parameters.
    pub(super) poke: Mutex<Sender<()>>,
}

impl Steering for Asking {
    fn services(&self) -> Vec<Service> {
        let set = Service {
            name: SET.to_owned(),
            kind: "view/srv/SetParameters".to_owned(),
            request: json!({ "node": "", "values": {} }),
            response: json!({ "success": false, "message": "" }),
            access: Access::Full,
            stops: false,
        };
        self.offers.iter().map(|offer| offer.service.clone()).chain([set]).collect()
    }

    fn call(&self, service: &str, request: Value) -> Result<Value, String> {
        if service == SET {
            let done = self.set_one_node(&request);
            self.poke();
            return Ok(match done {
                Ok(()) => json!({ "success": true, "message": "" }),
                Err(why) => json!({ "success": false, "message": why }),
            });
        }
        let offer = self.offers.iter().find(|offer| offer.service.name == service);
        let answer = offer.ok_or_else(|| format!("there is no service {service}"))?.ask(&request);
        self.poke();
        answer
    }

    fn parameters(&self, names: &[String]) -> Result<Vec<Parameter>, String> {
        Ok(self.settings.values(names))
    }

    fn set_parameters(&self, parameters: Vec<Parameter>) -> Result<(), String> {
        let done = self.settings.set(parameters);
        self.settings.refresh();
        done
    }

    fn publish(&self, topic: &str, message: Value) -> Result<(), String> {
        self.publishing.publish(topic, &message)
    }
}

impl Asking {
    fn set_one_node(&self, request: &Value) -> Result<(), String> {
        let node = request["node"].as_str().ok_or("`node` must be the name of a node")?;
        let values = request["values"].as_object().ok_or("`values` must be parameters by name")?;
        let named = |(name, value): (&String, &Value)| Parameter {
            name: format!("{node}.{name}"),
            value: value.clone(),
            kind: None,
        };
        self.settings.set(values.iter().map(named).collect())
    }

    fn poke(&self) {
        // Who looks after them has gone when the view ends.
        let _ = self.poke.lock().unwrap_or_else(PoisonError::into_inner).send(());
    }
}

/// Messages of viewers, each under the rules that the nodes have for anybody's: a voltage without a
/// stamp counts from the moment it comes, for the command age and no longer.
pub(super) struct Publishing {
    /// Knows the names of topics.
    node: Arc<RosNode>,
    join: Join,
    /// Another participant: a driver takes no voltages from a network that is its own process.
    by_hand: Mutex<Option<ByHand>>,
}

/// Joins the network once more, as the process did.
pub type Join = Box<dyn Fn() -> Result<Participant, RosNodeError> + Send + Sync>;

/// The node that says what people at a page say.
struct ByHand {
    voltage: Publisher<MotorVoltage>,
    reference: Publisher<Reference>,
    _parameters: Parameters,
    _node: RosNode,
}

impl ByHand {
    fn new(join: &Join) -> Result<Self, RosNodeError> {
        let node = join()?.node("view_by_hand")?;
        Ok(Self {
            voltage: node.publisher(&topics::MOTOR_VOLTAGE)?,
            reference: node.publisher(&topics::REFERENCE)?,
            _parameters: Parameters::usual(&node)?,
            _node: node,
        })
    }
}

impl Publishing {
    pub(super) fn new(node: Arc<RosNode>, join: Join) -> Self {
        Self { node, join, by_hand: Mutex::default() }
    }

    fn publish(&self, topic: &str, message: &Value) -> Result<(), String> {
        let is = |name: &str| {
            self.node.resolve(Named::Topic, name).is_ok_and(|resolved| resolved == topic)
        };
        let number = |field: &str| {
            let number = message[field].as_f64();
            number.ok_or_else(|| format!("{topic}: `{field}` must be a number"))
        };
        if is(topics::MOTOR_VOLTAGE.name_in_namespace()) {
            let voltage = MotorVoltage { voltage: number("voltage")?, ..MotorVoltage::default() };
            return self.by_hand(|hand| hand.voltage.publish(voltage));
        }
        if is(topics::REFERENCE.name_in_namespace()) {
            let reference = Reference {
                position: number("position")?,
                velocity: number("velocity")?,
                acceleration: number("acceleration")?,
                ..Reference::default()
            };
            return self.by_hand(|hand| hand.reference.publish(reference));
        }
        Err(format!("nobody takes messages on {topic}"))
    }

    /// Says something; the node is made with the first message.
    fn by_hand(&self, say: impl FnOnce(&ByHand) -> Result<(), RosNodeError>) -> Result<(), String> {
        let mut slot = self.by_hand.lock().unwrap_or_else(PoisonError::into_inner);
        let hand = match &*slot {
            Some(hand) => hand,
            None => slot.insert(ByHand::new(&self.join).map_err(|error| error.to_string())?),
        };
        say(hand).map_err(|error| error.to_string())
    }
}
