//! The tasks that compensations are compared in: which there are, and how each is driven.

use controller::ControlMode;
use friction_model::ModelName;

use super::bench::{Bench, Made};
use super::options::stream_seed;
use super::recorder::{Recorder, Timeline};
use super::results::{Comparison, TaskComparison};
use super::trace::Trace;
use super::{Compensators, Experiment, RunError, RunOptions};
use crate::compensation::Arm;
use crate::protocol::TrackingProtocol;
use crate::tracking::{TrackingJob, TrackingRun};
use work::sequencer::Completion;

/// One task of a run.
#[derive(Debug, Clone)]
pub(super) struct TrackedTask {
    /// Name in tables.
    pub name: String,
    /// What is driven.
    pub protocol: TrackingProtocol,
    /// Stream of its sensor noise.
    pub stream: u64,
    /// Whether it is one of the compensation experiments.
    pub compared: bool,
}

impl TrackedTask {
    /// Every task of the run, in its order.
    pub fn of(options: &RunOptions) -> Vec<Self> {
        let mut tasks = Vec::new();
        for (wanted, name, protocol, stream) in [
            (
                options.experiment.tracks_velocity(),
                "velocity tracking",
                &options.velocity_tracking,
                1 << 32,
            ),
            (
                options.experiment.tracks_position(),
                "position tracking",
                &options.position_tracking,
                2 << 32,
            ),
        ] {
            if wanted {
                let protocol = protocol.clone();
                tasks.push(Self { name: name.to_owned(), protocol, stream, compared: false });
            }
        }
        if options.experiment == Experiment::Compensation {
            tasks.extend(options.compensation.tasks.iter().zip(3u64..).map(|(task, n)| Self {
                name: task.name.clone(),
                protocol: task.protocol.clone(),
                stream: n << 32,
                compared: true,
            }));
        }
        tasks
    }
}

/// What the tasks found, where the results have a place for it.
#[derive(Debug, Default)]
pub(super) struct Sorted {
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

/// Runs of one task.
pub(super) struct Tracked {
    /// Figures of each run.
    pub runs: Vec<TrackingRun>,
    /// The first repetition of each arm.
    pub traces: Vec<(Arm, Trace)>,
    /// Whether all were made.
    pub completion: Completion,
}

impl Bench<'_> {
    /// One task, with its name and its stream of noise, under each compensation.
    pub(super) fn track(
        &self,
        (name, protocol, stream): (&str, &TrackingProtocol, u64),
        arms: &[Arm],
        models: &Compensators,
        recorder: &mut Recorder,
        timeline: &mut Timeline,
    ) -> Result<Tracked, RunError> {
        let jobs: Vec<(u64, TrackingJob)> = TrackingJob::all(protocol, arms)
            .into_iter()
            .map(|job| (timeline.start_of(protocol.duration), job))
            .collect();
        let work = |&(start_ns, job): &(u64, TrackingJob)| {
            // Repetition n has the same noise under every compensation: differences are the
            // compensation's.
            let seed = stream_seed(self.options.seed, stream + u64::from(job.repetition));
            let model = models.get(job.arm.model().unwrap_or(ModelName::Proposed));
            let bed = self.options.test_bed.with_inverse(protocol.inverse);
            let task = (protocol.mode, protocol.reference);
            let control =
                self.control_loop(&bed, task, &model, job.arm.means(), (seed, start_ns))?;
            let start_ns = control.start_ns();
            let mut kept = self.kept(Some(self.options.record.every_of_tracking(&job)));
            let mut trace = Trace::default();
            let run = job.run(protocol, control, |sample| {
                kept.add(sample);
                if job.repetition == 0 {
                    trace.add(sample);
                }
            })?;
            Ok(Made { start_ns, kept, result: (run, trace), replayed: false })
        };
        let total = jobs.len() as f64;
        let mut runs: Vec<TrackingRun> = Vec::with_capacity(jobs.len());
        let mut traces = Vec::new();
        let completion = self.in_order(&jobs, work, |(_, job), made| {
            let Made { start_ns, kept, result: (run, trace), replayed } = made;
            let stage = format!("compensation {}", job.arm);
            if job.repetition == 0 {
                self.progress.stage(format!("{name}: {}", job.arm));
                if !replayed {
                    recorder.status(start_ns, name, &stage, runs.len() as f64 / total)?;
                }
                traces.push((job.arm, trace));
            }
            recorder.write(kept)?;
            self.progress.advance(protocol.duration);
            runs.push(run);
            Ok(())
        })?;
        recorder.flush()?;
        Ok(Tracked { runs, traces, completion })
    }
}
