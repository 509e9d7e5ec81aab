//! Parameters of the nodes: asked now and then, told to viewers when they change, set one by one.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use ros_node::{Described, Graph, ParameterValue, RemoteParameters, RosNode, RosNodeError};
use serde_json::{Value, json};
use view::{Channel, ChannelId, Hub, Parameter};

use super::channels::Heard;
use super::clock::now_ns;
use super::{curve, json};

/// Longest wait for a node that is asked now and then.
const PATIENCE: Duration = Duration::from_millis(1500);
/// Longest wait for a node that is to change.
const SETTING: Duration = Duration::from_secs(5);
/// The node whose model is drawn.
const OBSERVER: &str = "friction_observer";

/// The parameters of all nodes.
pub(super) struct Settings {
    hub: Hub,
    document: ChannelId,
    curve: ChannelId,
    nodes: Vec<(String, RemoteParameters)>,
    /// Who is there, where that may be nobody: then nobody is asked in vain.
    graph: Option<Graph>,
    known: Mutex<BTreeMap<String, Known>>,
}

/// What is known of a node.
#[derive(Default, Clone, PartialEq)]
struct Known {
    described: Vec<Described>,
    values: BTreeMap<String, ParameterValue>,
}

impl Settings {
    /// Of nodes that the code calls so.
    pub(super) fn new(
        node: &RosNode,
        names: &[&str],
        hub: &Hub,
        heard: Heard,
    ) -> Result<Self, RosNodeError> {
        let namespace = node.identity().namespace.trim_end_matches('/').to_owned();
        let nodes = names
            .iter()
            .map(|name| {
                let name = format!("{namespace}/{name}");
                Ok((name.clone(), RemoteParameters::new(node, &name)?))
            })
            .collect::<Result<_, RosNodeError>>()?;
        Ok(Self {
            document: hub.offer(Channel::latched_json("/view/parameters", "view.Parameters")),
            curve: hub.offer(Channel::latched_json("/view/curve", "view.Curve")),
            hub: hub.clone(),
            nodes,
            graph: (heard == Heard::Network).then(|| node.watch_graph()).transpose()?,
            known: Mutex::default(),
        })
    }

    /// Asks all nodes, and tells viewers what is new.
    pub(super) fn refresh(&self) {
        let mut changed = Vec::new();
        let mut anything = false;
        for (name, remote) in self.nodes.iter().filter(|(name, _)| self.is_there(name)) {
            let before = self.known().get(name).cloned().unwrap_or_default();
            let Some(now) = ask(remote, before.described.clone()) else { continue };
            if now == before {
                continue;
            }
            anything = true;
            for (parameter, value) in &now.values {
                if before.values.get(parameter) != Some(value) {
                    changed.push(told(name, parameter, value));
                }
            }
            self.known().insert(name.clone(), now);
        }
        if anything {
            self.hub.changed(&changed);
            self.tell();
        }
    }

    fn is_there(&self, name: &str) -> bool {
        self.graph.as_ref().is_none_or(|graph| graph.nodes().iter().any(|node| node.name == name))
    }

    /// The document with all parameters, and the curve.
    fn tell(&self) {
        let known = self.known();
        let nodes: Vec<Value> = known
            .iter()
            .map(|(name, known)| {
                let all: Vec<Value> = known.described.iter().map(|one| row(one, known)).collect();
                json!({ "node": name, "parameters": all })
            })
            .collect();
        let curve = known
            .iter()
            .find(|(name, _)| name.ends_with(OBSERVER))
            .and_then(|(_, known)| curve::of(&known.values));
        drop(known);
        let now = now_ns();
        self.hub.publish(self.document, now, json!({ "nodes": nodes }).to_string().as_bytes());
        if let Some(curve) = curve {
            self.hub.publish(self.curve, now, curve.to_string().as_bytes());
        }
    }

    /// Values by whole names; of all if there is none.
    pub(super) fn values(&self, names: &[String]) -> Vec<Parameter> {
        let known = self.known();
        let all = known.iter().flat_map(|(node, known)| {
            known.values.iter().map(move |(name, value)| told(node, name, value))
        });
        all.filter(|one| names.is_empty() || names.contains(&one.name)).collect()
    }

    /// Sets parameters of one or several nodes: of each node all or none.
    pub(super) fn set(&self, parameters: Vec<Parameter>) -> Result<(), String> {
        let mut of_nodes: BTreeMap<String, BTreeMap<String, ParameterValue>> = BTreeMap::new();
        for Parameter { name, value, .. } in parameters {
            let (node, parameter) =
                name.split_once('.').ok_or_else(|| format!("there is no parameter {name}"))?;
            let known = self.known();
            let now = known.get(node).and_then(|known| known.values.get(parameter));
            let now = now.ok_or_else(|| format!("there is no parameter {name}"))?;
            let value = json::typed(&value, now).map_err(|why| format!("{parameter} {why}"))?;
            of_nodes.entry(node.to_owned()).or_default().insert(parameter.to_owned(), value);
        }
        for (node, values) in of_nodes {
            let remote = self.nodes.iter().find(|(name, _)| *name == node);
            let (_, remote) = remote.ok_or_else(|| format!("there is no node {node}"))?;
            remote.set(&values, SETTING).map_err(|error| match error {
                RosNodeError::Refused { reason, .. } => reason,
                error => error.to_string(),
            })?;
        }
        Ok(())
    }

    fn known(&self) -> MutexGuard<'_, BTreeMap<String, Known>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Asks one node; descriptions only once.
fn ask(remote: &RemoteParameters, described: Vec<Described>) -> Option<Known> {
    let described = if described.is_empty() { remote.describe(PATIENCE).ok()? } else { described };
    let names: Vec<String> = described.iter().map(|one| one.name.clone()).collect();
    let values = remote.get(&names, PATIENCE).ok()?;
    Some(Known { described, values })
}

fn told(node: &str, name: &str, value: &ParameterValue) -> Parameter {
    let kind = match value {
        ParameterValue::Double(_) => Some("float64".to_owned()),
        ParameterValue::DoubleArray(_) => Some("float64_array".to_owned()),
        _ => None,
    };
    Parameter { name: format!("{node}.{name}"), value: json::value(value), kind }
}

fn row(one: &Described, known: &Known) -> Value {
    let value = known.values.get(&one.name);
    json!({
        "name": one.name,
        "value": value.map(json::value),
        "type": value.map_or("not set", |value| value.kind()),
        "description": one.description,
        "constraints": one.constraints,
        "readOnly": one.read_only,
        "range": one.range.map(|(low, high)| [low, high]),
    })
}
