//! Rows of the simulated rig beside Tables 6.2 to 6.4, which were measured on the real one.

use std::sync::atomic::AtomicBool;

use friction_model::{AnyModel, ModelName};
use rig_driver::SimulationOptions;

use super::printed::Scheme;
use super::{Cell, matrix::MODELS};
use crate::rig::ThesisTask;
use experiment_runner::compensation::Arm;
use experiment_runner::protocol::{InverseUse, TrackingProtocol};
use experiment_runner::run::RunError;
use experiment_runner::test_bed::TestBed;
use experiment_runner::tracking::{TrackingJob, TrackingRun};
use work::progress::Progress;
use work::sequencer::run_in_order;

/// Repetitions, as in the thesis.
const REPETITIONS: u32 = 5;

/// The measured tables and their tasks.
const TABLES: [(&str, ThesisTask); 3] = [
    ("6.2", ThesisTask::VelocityTracking),
    ("6.3", ThesisTask::VelocityRegulation),
    ("6.4", ThesisTask::PositionTracking),
];

/// Runs of every table.
#[derive(Debug, Default)]
pub(super) struct RigRows(Vec<(&'static str, TrackingRun)>);

impl RigRows {
    /// Mean over the repetitions.
    pub fn cell(&self, number: &str, scheme: Scheme) -> Option<Cell> {
        let arm = match scheme {
            Scheme::NoFriction => return None,
            Scheme::Linear => Arm::None,
            Scheme::Observer(model) => Arm::observer(model),
        };
        let runs: Vec<_> =
            self.0.iter().filter(|(table, run)| *table == number && run.arm == arm).collect();
        let mean = |of: fn(&TrackingRun) -> f64| {
            runs.iter().map(|(_, run)| of(run)).sum::<f64>() / runs.len() as f64
        };
        (!runs.is_empty())
            .then(|| Cell { mse: mean(|run| run.mse), max_error: mean(|run| run.max_error) })
    }
}

/// What is driven: the references of section 6.5, without the inverse, so that the linear
/// controller is the same in all rows.
fn protocol(task: ThesisTask) -> TrackingProtocol {
    TrackingProtocol { inverse: InverseUse::Off, repetitions: REPETITIONS, ..task.protocol() }
}

/// Time that the rows would take on a rig \[s\].
pub(super) fn rig_seconds() -> f64 {
    TABLES.iter().map(|&(_, task)| protocol(task).rig_seconds(1 + MODELS.len())).sum()
}

/// Drives the simulated rig with the friction of the proposed model, in physical units, with the
/// noise and steps of its sensors.
pub(super) fn compute(
    seed: u64,
    workers: usize,
    progress: &Progress,
    cancel: &AtomicBool,
) -> Result<RigRows, RunError> {
    let arms: Vec<Arm> = std::iter::once(Arm::None).chain(MODELS.map(Arm::observer)).collect();
    let jobs: Vec<(&'static str, TrackingProtocol, TrackingJob)> = TABLES
        .iter()
        .flat_map(|&(number, task)| {
            let protocol = protocol(task);
            TrackingJob::all(&protocol, &arms)
                .into_iter()
                .map(move |job| (number, protocol.clone(), job))
        })
        .collect();
    let bed = TestBed {
        simulation: SimulationOptions::default(),
        friction: AnyModel::test_bed(ModelName::Proposed),
        controller: Default::default(),
        estimator: Default::default(),
    };
    let mut rows = RigRows::default();
    progress.stage("tables 6.2 to 6.4");
    let work = |(_, protocol, job): &(&str, TrackingProtocol, TrackingJob)| {
        let model = AnyModel::test_bed(job.arm.model().unwrap_or(ModelName::Proposed));
        // Repetition n has the same noise under every compensation.
        let seed = seed.wrapping_add(u64::from(job.repetition));
        let control =
            bed.control_loop(protocol.mode, protocol.reference, &model, job.arm.means(), seed, 0)?;
        Ok::<_, RunError>(job.run(protocol, control, |_| {})?)
    };
    run_in_order(&jobs, workers, cancel, work, |(number, protocol, _), run| {
        progress.advance(protocol.duration);
        rows.0.push((*number, run));
        Ok(())
    })?;
    Ok(rows)
}
