//! The tasks that compensations are compared in: which there are, and how each is driven.

use friction_model::ModelName;

use super::RunError;
use super::experiment::{Progressed, Running};
use super::made::Made;
use super::options::stream_seed;
use super::results::Comparison;
use super::sorted::TrackedTask;
use super::trace::Trace;
use crate::compensation::Arm;
use crate::protocol::TrackingProtocol;
use crate::tracking::{TrackingJob, TrackingRun};
use work::sequencer::Completion;

/// Runs of one task.
pub(super) struct Tracked {
    /// Figures of each run.
    pub runs: Vec<TrackingRun>,
    /// The first repetition of each arm.
    pub traces: Vec<(Arm, Trace)>,
    /// Whether all were made.
    pub completion: Completion,
}

impl Running<'_, '_> {
    /// One task under each compensation, its runs side by side.
    pub(crate) fn compare(&mut self, task: TrackedTask) -> Result<Progressed, RunError> {
        let options = self.options();
        let arms = Arm::all(&options.means, &options.models);
        let tracked = self.track((&task.name, &task.protocol, task.stream), &arms)?;
        let rig_seconds = task.protocol.duration * tracked.runs.len() as f64;
        let comparison = Comparison::new(task.protocol.mode, &arms, tracked.runs);
        self.found.tracked.take(task, comparison, tracked.traces);
        Ok(Progressed::new(tracked.completion, rig_seconds))
    }

    fn track(
        &mut self,
        (name, protocol, stream): (&str, &TrackingProtocol, u64),
        arms: &[Arm],
    ) -> Result<Tracked, RunError> {
        let Self { bench, recorder, timeline, models, .. } = self;
        let jobs: Vec<(u64, TrackingJob)> = TrackingJob::all(protocol, arms)
            .into_iter()
            .map(|job| (timeline.start_of(protocol.duration), job))
            .collect();
        let work = |&(start_ns, job): &(u64, TrackingJob)| {
            // Repetition n has the same noise under every compensation: differences are the
            // compensation's.
            let seed = stream_seed(bench.options.seed, stream + u64::from(job.repetition));
            let model = models.get(job.arm.model().unwrap_or(ModelName::Proposed));
            let bed = bench.options.test_bed.with_inverse(protocol.inverse);
            let task = (protocol.mode, protocol.reference);
            let control =
                bench.control_loop(&bed, task, &model, job.arm.means(), (seed, start_ns))?;
            let start_ns = control.start_ns();
            let mut kept = bench.kept(Some(bench.options.record.every_of_tracking(&job)));
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
        let completion = bench.in_order(&jobs, work, |(_, job), made| {
            let Made { start_ns, kept, result: (run, trace), replayed } = made;
            let stage = format!("compensation {}", job.arm);
            if job.repetition == 0 {
                bench.progress.stage(format!("{name}: {}", job.arm));
                if !replayed {
                    recorder.status(start_ns, name, &stage, runs.len() as f64 / total)?;
                }
                traces.push((job.arm, trace));
            }
            recorder.write(kept)?;
            bench.progress.advance(protocol.duration);
            runs.push(run);
            Ok(())
        })?;
        recorder.flush()?;
        Ok(Tracked { runs, traces, completion })
    }
}
