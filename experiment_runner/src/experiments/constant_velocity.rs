//! Experiment 1: friction at constant velocities, and the Stribeck curve through them.

use friction_ident::{StribeckOptions, StribeckParameter, fit_stribeck};
use friction_model::ModelName;
use rig_setup::RigChoice;
use work::sequencer::Completion;

use crate::constant_velocity::{SteadyJob, SteadyRun};
use crate::protocol::{ConstantVelocityProtocol, ProtocolError, ProtocolFile};
use crate::run::experiment::{Experiment, Progressed, Put, Running};
use crate::run::made::Made;
use crate::run::options::stream_seed;
use crate::run::results::{Identification, Parameter, static_truth};
use crate::run::{RunError, RunOptions};

/// The experiment.
#[derive(Debug, Clone, Copy)]
pub struct ConstantVelocity;

impl Experiment for ConstantVelocity {
    fn name(&self) -> &'static str {
        ConstantVelocityProtocol::NAME
    }

    fn about(&self) -> &'static str {
        "Friction at constant velocities, and the Stribeck curve through them"
    }

    fn protocol(&self) -> Option<&'static str> {
        Some(ConstantVelocityProtocol::TEXT)
    }

    fn read(&self, text: &str) -> Result<Put, ProtocolError> {
        let protocol = ConstantVelocityProtocol::read(text)?;
        Ok(Box::new(|options| options.constant_velocity = protocol))
    }

    fn rig_seconds(&self, options: &RunOptions) -> f64 {
        options.constant_velocity.rig_seconds()
    }

    fn shorten(&self, options: &mut RunOptions) {
        options.constant_velocity = ConstantVelocityProtocol::quick();
    }

    fn repeat(&self, options: &mut RunOptions, repetitions: u32) {
        options.constant_velocity.repetitions = repetitions;
    }

    fn carry_out(&self, running: &mut Running<'_, '_>) -> Result<Progressed, RunError> {
        let (runs, completion) = measure(running)?;
        let options = running.options();
        let rig_seconds = options.constant_velocity.duration * runs.len() as f64;
        let mut progressed = Progressed::new(completion, rig_seconds);
        running.found.steady = runs;
        if completion == Completion::All {
            running.bench.progress.stage("identify");
            match identify(options, &running.found.steady) {
                Ok(found) => {
                    *running.models = running.models.clone().with_static(&found.fit.parameters)?;
                    running.found.identification = Some(found);
                }
                Err(error) => progressed.ended = Some(error.to_string()),
            }
        }
        Ok(progressed)
    }
}

/// Both sets.
fn measure(running: &mut Running<'_, '_>) -> Result<(Vec<SteadyRun>, Completion), RunError> {
    let Running { bench, recorder, timeline, .. } = running;
    let protocol = &bench.options.constant_velocity;
    let jobs: Vec<(u64, u64, SteadyJob)> = SteadyJob::all(protocol)
        .into_iter()
        .zip(0..)
        .map(|(job, index)| {
            (timeline.start_of(protocol.duration), stream_seed(bench.options.seed, index), job)
        })
        .collect();
    let work = |&(start_ns, seed, job): &(u64, u64, SteadyJob)| {
        let bed = &bench.options.test_bed;
        // Nothing compensates here: the observer only keeps the recorder's topics alike.
        let observer = bench.options.compensators.get(ModelName::Proposed);
        let task = (SteadyJob::MODE, job.reference());
        let control = bench.control_loop(bed, task, &observer, None, (seed, start_ns))?;
        let start_ns = control.start_ns();
        let mut kept = bench.kept(bench.options.record.every_of_steady(&job));
        let run = job.run(protocol, &bench.options.torque, control, |sample| kept.add(sample))?;
        Ok(Made { start_ns, kept, result: run, replayed: false })
    };
    let total = jobs.len() as f64;
    let mut runs: Vec<SteadyRun> = Vec::with_capacity(jobs.len());
    let completion = bench.in_order(&jobs, work, |(_, _, job), made| {
        let Made { start_ns, kept, result: run, replayed } = made;
        let stage =
            format!("set {} of {}, repetition {}", job.set + 1, protocol.sets, job.repetition + 1);
        if runs.last().is_none_or(|last| (last.set, last.repetition) != (job.set, job.repetition)) {
            bench.progress.stage(format!("friction: {stage}"));
            if !replayed {
                recorder.status(
                    start_ns,
                    "constant-velocity",
                    &stage,
                    runs.len() as f64 / total,
                )?;
            }
        }
        recorder.write(kept)?;
        bench.progress.advance(protocol.duration);
        runs.push(run);
        Ok(())
    })?;
    recorder.flush()?;
    Ok((runs, completion))
}

/// Fits the Stribeck curve to the first set and tries it on the others.
fn identify(options: &RunOptions, steady: &[SteadyRun]) -> Result<Identification, RunError> {
    let points: Vec<_> = steady.iter().filter(|run| run.set == 0).map(SteadyRun::point).collect();
    let fit =
        fit_stribeck(&points, &StribeckOptions::default()).map_err(RunError::Identification)?;
    let squares: Vec<f64> = steady
        .iter()
        .filter(|run| run.set != 0)
        .map(|run| (run.torque - fit.torque(run.velocity)).powi(2))
        .collect();
    let mse_validation =
        (!squares.is_empty()).then(|| squares.iter().sum::<f64>() / squares.len() as f64);
    let truth = match options.rig {
        RigChoice::Simulated => static_truth(&options.test_bed.friction),
        _ => [None; 4],
    };
    let units = ["N m", "N m", "rad/s", "N m s/rad"];
    let parameters = StribeckParameter::ALL
        .into_iter()
        .zip(units)
        .zip(truth)
        .map(|((parameter, unit), truth)| Parameter {
            name: parameter.name(),
            unit,
            estimate: fit.estimate(parameter),
            truth,
        })
        .collect();
    Ok(Identification { mse_identification: fit.mse, mse_validation, parameters, fit })
}
