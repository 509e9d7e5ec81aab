//! What the compared tasks found, where the results have a place for it.

use controller::ControlMode;

use super::results::{Comparison, TaskComparison};
use super::trace::Trace;
use crate::compensation::Arm;
use crate::protocol::TrackingProtocol;

/// One task of a run.
#[derive(Debug, Clone)]
pub(crate) struct TrackedTask {
    /// Name in tables.
    pub name: String,
    /// What is driven.
    pub protocol: TrackingProtocol,
    /// Stream of its sensor noise.
    pub stream: u64,
    /// Whether it is one of the compensation experiments.
    pub compared: bool,
}

/// What the tasks found, where the results have a place for it.
#[derive(Debug, Default)]
pub(crate) struct Sorted {
    /// Velocity tracking.
    pub velocity: Option<Comparison>,
    /// Position tracking.
    pub position: Option<Comparison>,
    /// The compensation experiments.
    pub tasks: Vec<TaskComparison>,
    /// What the report draws, by the name of the task.
    pub traces: Vec<(String, Vec<(Arm, Trace)>)>,
}

impl Sorted {
    /// Takes in what one task found; nothing if not one run of it was made.
    pub fn take(
        &mut self,
        task: TrackedTask,
        comparison: Option<Comparison>,
        traces: Vec<(Arm, Trace)>,
    ) {
        let Some(comparison) = comparison else { return };
        self.traces.push((task.name.clone(), traces));
        match (task.compared, task.protocol.mode) {
            (true, _) => self.tasks.push(TaskComparison { name: task.name, comparison }),
            (false, ControlMode::Velocity) => self.velocity = Some(comparison),
            (false, ControlMode::Position) => self.position = Some(comparison),
        }
    }
}
