//! What is counted, and who is listened to, as `/diagnostics` tells it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use msgs::diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue};
use msgs::std_msgs::Header;
use msgs::topics;
use ros_node::{Gate, RosNode, RosNodeError, SUBSCRIBERS_THAT_LAG};

use super::locked;

/// Silence of the one that is listened to after which another may follow it: by then the loop
/// begins anew.
const SILENCE: Duration = Duration::from_millis(500);

#[derive(Default)]
pub(super) struct Counts {
    pub(super) published: AtomicU64,
    pub(super) refused: AtomicU64,
    pub(super) unusable: AtomicU64,
    /// Commands for which the estimate came too late.
    pub(super) without_estimate: AtomicU64,
    /// Joint states with a stamp that cannot follow the one before.
    pub(super) untimely: AtomicU64,
    /// Estimates that answer no joint state.
    pub(super) strange: Arc<AtomicU64>,
    pub(super) faulty: AtomicBool,
    pub(super) stale: AtomicBool,
    /// Those that let messages in.
    pub(super) gates: Mutex<Vec<Gate>>,
}

/// Who is listened to: one writer on each topic.
#[derive(Clone)]
pub(super) struct Gates {
    pub(super) joints: Gate,
    pub(super) frictions: Gate,
    pub(super) references: Gate,
}

impl Gates {
    pub(super) fn new(node: &RosNode) -> Result<Self, RosNodeError> {
        let gate = |topic: &str| Gate::new(node, topic, Some(SILENCE));
        Ok(Self {
            joints: gate(topics::JOINT_STATES.name_in_namespace())?,
            frictions: gate(topics::FRICTION_ESTIMATE.name_in_namespace())?,
            references: gate(topics::REFERENCE.name_in_namespace())?,
        })
    }
}

impl Counts {
    /// Counts a message that cannot be used; the first one is told.
    pub(super) fn complainer(self: &Arc<Self>, node: &RosNode) -> impl Fn(&str) + Send + 'static {
        let (counts, logger) = (Arc::clone(self), node.logger().clone());
        move |what| {
            if counts.unusable.fetch_add(1, Ordering::Relaxed) == 0 {
                logger.warn(&format!("{what}; such are left out and counted in /diagnostics"));
            }
        }
    }

    /// A gate of which `/diagnostics` tells from now on.
    pub(super) fn watched(&self, gate: &Gate) -> Gate {
        locked(&self.gates).push(gate.clone());
        gate.clone()
    }

    pub(super) fn message(&self, node: &RosNode, phase: &str, lost: u64) -> DiagnosticArray {
        let unusable = self.unusable.load(Ordering::Relaxed);
        let untimely = self.untimely.load(Ordering::Relaxed);
        let reports: Vec<_> = locked(&self.gates).iter().map(Gate::report).collect();
        let stranger =
            node.twin().or_else(|| reports.iter().find_map(|report| report.error.clone()));
        let (level, message) = if let Some(stranger) = stranger {
            (DiagnosticStatus::ERROR, stranger)
        } else if self.faulty.load(Ordering::Relaxed) {
            (
                DiagnosticStatus::ERROR,
                "zero volts: the joint states are no numbers; mend them, then call ~/reset"
                    .to_owned(),
            )
        } else if self.stale.load(Ordering::Relaxed) {
            (DiagnosticStatus::WARN, format!("{phase}; no reference comes"))
        } else if unusable + untimely + lost > 0 {
            (DiagnosticStatus::WARN, format!("{phase}; messages were left out"))
        } else {
            (DiagnosticStatus::OK, phase.to_owned())
        };
        let values = [
            ("commands", self.published.swap(0, Ordering::Relaxed)),
            ("commands with an older estimate", self.without_estimate.swap(0, Ordering::Relaxed)),
            ("messages without numbers", unusable),
            ("joint states with a stamp from the past or the future", untimely),
            ("estimates of no joint state", self.strange.load(Ordering::Relaxed)),
            ("not published", lost),
        ];
        DiagnosticArray {
            header: Header::at(node.clock().now_ns()),
            status: vec![DiagnosticStatus {
                level,
                name: node.identity().qualified().trim_start_matches('/').to_owned(),
                message,
                hardware_id: String::new(),
                values: std::iter::once(("node", phase.to_owned()))
                    .chain(values.map(|(key, value)| (key, value.to_string())))
                    .chain([(SUBSCRIBERS_THAT_LAG, node.lagging_readers().to_string())])
                    .map(|(key, value)| KeyValue { key: key.to_owned(), value })
                    .chain(reports.into_iter().flat_map(|report| report.values))
                    .collect(),
            }],
        }
    }
}
