//! What was heard on a domain, and which of it is the laboratory's own.

use std::collections::BTreeMap;

use msgs::diagnostic_msgs::DiagnosticStatus;
use ros_node::SeenNode;
use ros_node::security::{Other, Prefix};

/// Names of the laboratory's nodes.
const OURS: [&str; 4] = ["rig_driver", "friction_observer", "controller", "experiment_runner"];

/// What was heard on a domain.
#[derive(Debug, Clone, Default)]
pub(super) struct Heard {
    /// The other nodes.
    pub(super) nodes: Vec<SeenNode>,
    /// Lifecycle states of the laboratory's nodes that say nothing of their health, by full name.
    pub(super) states: BTreeMap<String, &'static str>,
    /// Whether the doctor itself is secured.
    pub(super) secured: bool,
    /// The other participants, if it is.
    pub(super) participants: BTreeMap<Prefix, Other>,
    /// What each component said of itself, in order; by its name in `/diagnostics`.
    pub(super) health: BTreeMap<String, Vec<DiagnosticStatus>>,
}

impl Heard {
    /// The laboratory's nodes of which nothing was heard.
    pub(super) fn silent(&self) -> Vec<String> {
        let ours = self.nodes.iter().map(|node| node.name.clone()).filter(|name| is_ours(name));
        let mut silent: Vec<String> = ours.filter(|name| self.said_by(name).is_none()).collect();
        silent.dedup();
        silent
    }

    /// The last and worst thing that a node said of itself.
    pub(super) fn said_by(&self, name: &str) -> Option<&DiagnosticStatus> {
        self.health
            .iter()
            .filter(|(component, _)| node_of(component) == name.trim_start_matches('/'))
            .filter_map(|(_, statuses)| statuses.last())
            .max_by_key(|status| status.level)
    }
}

/// Whether a node, by its full name, has the name of one of the laboratory's.
pub(super) fn is_ours(name: &str) -> bool {
    name.rsplit('/').next().is_some_and(|last| OURS.contains(&last))
}

/// The node of a component as `/diagnostics` names it: what stands before the colon.
pub(super) fn node_of(component: &str) -> &str {
    component.split(':').next().unwrap_or(component).trim().trim_start_matches('/')
}
