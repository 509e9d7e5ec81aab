//! Who commands the motor over the network, and what is told of it.
//!
//! After an activation it is the first writer of `/motor_voltage`, or of the node that the
//! parameter `commander` names, until the node is deactivated. Its GUID is what the messages say:
//! without DDS Security it can be forged (see [`ros_node::one_writer`]).

use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use msgs::{
    diagnostic_msgs::{DiagnosticStatus, KeyValue},
    topics,
};
use ros_node::{Gate, Logger, ParticipantId, Passes, RosNode, RosNodeError, Sent};

use super::{
    control::{Counters, WAITED},
    locked::locked,
};

/// Shortest time between two lines of the log about commands that were refused.
const LINES: Duration = Duration::from_secs(10);

/// Lets the commands of one writer through. Clones are one.
#[derive(Clone)]
pub(super) struct Commander {
    gate: Gate,
    /// The node that the parameter names; empty for any.
    named: Arc<Mutex<String>>,
    /// Commands without a stamp that had waited.
    waited: Arc<AtomicU64>,
    /// Commands come in memory, from this process: then those of others do not stand in the way of
    /// an activation, and what its controller publishes of them for others to see is none.
    in_memory: Option<ParticipantId>,
    logger: Logger,
    logged: Arc<Mutex<Option<Instant>>>,
    told: Arc<Mutex<[u64; 4]>>,
}

impl Commander {
    pub(super) fn new(node: &RosNode, in_memory: bool) -> Result<Self, RosNodeError> {
        Ok(Self {
            gate: Gate::new(node, topics::MOTOR_VOLTAGE.name_in_namespace(), None)?,
            named: Arc::default(),
            waited: Arc::default(),
            in_memory: in_memory.then(|| node.participant()),
            logger: node.logger().clone(),
            logged: Arc::default(),
            told: Arc::default(),
        })
    }

    /// The node of that absolute name, or any, may command from the next activation on.
    ///
    /// # Errors
    /// A sentence if it is no absolute name.
    pub(super) fn name(&self, node: &str) -> Result<(), String> {
        if !node.is_empty() && !node.starts_with('/') {
            return Err(format!(
                "commander must be a node's whole name as in /controller or /axis_1/controller, or empty for the first that commands after an activation, but is `{node}`"
            ));
        }
        node.clone_into(&mut locked(&self.named));
        Ok(())
    }

    /// Whether a command counts, by who sent it and, without a stamp, by how long it waited.
    pub(super) fn hear(&self, sent: Sent, has_stamp: bool) -> bool {
        if self.in_memory.is_some_and(|own| sent.writer.is_of(&own)) {
            return false;
        }
        // It waited somewhere: the one who sent it did not mean now.
        if !has_stamp && sent.age > WAITED {
            self.waited.fetch_add(1, Ordering::Relaxed);
            return false;
        }
        self.gate.hear(sent.writer) != Passes::No
    }

    /// Obeys the first that commands from now on.
    ///
    /// # Errors
    /// A sentence that names two who do.
    pub(super) fn open(&self) -> Result<(), String> {
        self.gate.only(&locked(&self.named));
        if self.in_memory.is_some() {
            self.gate.open_contested();
            return Ok(());
        }
        self.gate.open().map_err(|reason| {
            format!(
                "{reason}, or name the one that may command in the parameter `commander`, as in /controller"
            )
        })
    }

    /// Obeys nobody.
    pub(super) fn close(&self) {
        self.gate.close();
    }

    /// Who commands, and what was refused; an error while anything is.
    pub(super) fn status(
        &self,
        node: &str,
        counters: &Counters,
        twin: Option<String>,
    ) -> DiagnosticStatus {
        let report = self.gate.report();
        let count = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        let now = [
            count(&counters.future),
            count(&counters.unknown),
            count(&counters.outside),
            count(&self.waited),
        ];
        // They begin anew with each configuration.
        let new = {
            let told = std::mem::replace(&mut *locked(&self.told), now);
            std::array::from_fn::<_, 4, _>(|index| {
                now[index].checked_sub(told[index]).unwrap_or(now[index])
            })
        };
        let reasons = [
            "with a stamp from the future",
            "with a stamp of no measurement",
            "from elsewhere while the controller in this process commands",
            "without a stamp that had waited for more than 0.1 s",
        ];
        let mend = [
            "; a command carries the stamp of the measurement it answers to",
            "; a command carries the stamp of the measurement it answers to",
            "; end the other publisher, or deactivate the controller and activate the rig anew",
            "; is the machine too busy?",
        ];
        let refused = (0..4).find(|index| new[*index] > 0).map(|index| {
            format!("{} commands {} were refused{}", new[index], reasons[index], mend[index])
        });
        if let Some(refused) = &refused {
            let mut logged = locked(&self.logged);
            if logged.is_none_or(|logged| logged.elapsed() >= LINES) {
                *logged = Some(Instant::now());
                self.logger.error(refused);
            }
        }
        let error = twin.or(report.error).or(refused);
        let mut values = report.values;
        values.push(KeyValue { key: "may command".into(), value: locked(&self.named).clone() });
        values.extend(reasons.iter().zip(now).map(|(reason, count)| KeyValue {
            key: format!("commands {reason}"),
            value: count.to_string(),
        }));
        values.push(KeyValue {
            key: "stale commands".into(),
            value: count(&counters.stale).to_string(),
        });
        DiagnosticStatus {
            level: if error.is_some() { DiagnosticStatus::ERROR } else { DiagnosticStatus::OK },
            name: format!("{}: commands", node.trim_start_matches('/')),
            message: error.unwrap_or_else(|| "from one writer, or none".to_owned()),
            hardware_id: "rig".to_owned(),
            values,
        }
    }
}
