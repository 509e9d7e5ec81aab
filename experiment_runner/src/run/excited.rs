//! Runs under a profile: driven from rest, recorded, taken apart where they ran, averaged over the
//! repetitions.

use friction_ident::FrictionTorque;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::experiment::{Progressed, Running};
use super::made::Made;
use super::mean_record::MeanRecord;
use super::options::stream_seed;
use super::{RecordPolicy, RunError};
use crate::characterise::Channels;
use crate::profile::Excitation;
use crate::protocol::Displacement;
use work::sequencer::Completion;

/// Cycles of a run that a thinned bag holds at most.
const KEPT_CYCLES: f64 = 10_000.0;

/// One run to be driven.
#[derive(Debug, Clone)]
pub struct ExcitedJob {
    /// What it is, in words.
    pub stage: String,
    /// Which of the experiment's groups of repetitions, from 0.
    pub group: usize,
    /// Repetition, from 0.
    pub repetition: u32,
    /// What is driven.
    pub excitation: Excitation,
    /// Whether the reference goes through the inverse of the drive too.
    pub feed_forward: bool,
    /// Ends the run once the encoder has moved so far \[rad\].
    pub until: Option<f64>,
}

/// What the runs of an experiment gave.
pub struct Driven<R> {
    /// What was made of each run, with its group.
    pub results: Vec<(usize, R)>,
    /// The means of each group.
    pub means: Vec<MeanRecord>,
    /// Time on the rig \[s\].
    pub rig_seconds: f64,
    /// Whether all were driven.
    pub completion: Completion,
}

impl<R> From<&Driven<R>> for Progressed {
    fn from(driven: &Driven<R>) -> Self {
        Self::new(driven.completion, driven.rig_seconds)
    }
}

impl<R> Driven<R> {
    /// What was made of the runs of a group.
    pub fn of(&self, group: usize) -> impl Iterator<Item = &R> {
        self.results.iter().filter(move |result| result.0 == group).map(|result| &result.1)
    }
}

/// Name, noise stream and displacement sensor of an experiment.
#[derive(Debug, Clone, Copy)]
pub struct Series {
    /// Name on `/experiment_status`.
    pub name: &'static str,
    /// Stream of the sensors' noise; no two experiments share one.
    pub stream: u64,
    /// The sensor of the position.
    pub displacement: Displacement,
    /// Whether the bag holds every cycle, however it is thinned: what is identified from the bag
    /// needs an even, full rate.
    pub every_cycle: bool,
}

impl Running<'_, '_> {
    /// Drives the jobs in order and makes something of each; what is made is kept for a run that
    /// goes on after a stop.
    ///
    /// # Errors
    /// [`RunError`] for what ends the run.
    pub fn drive<R: Send + Serialize + DeserializeOwned>(
        &mut self,
        series: Series,
        jobs: Vec<ExcitedJob>,
        reduce: impl Fn(&ExcitedJob, &Channels, &FrictionTorque) -> R + Sync,
    ) -> Result<Driven<R>, RunError> {
        let Self { bench, recorder, timeline, .. } = self;
        let options = bench.options;
        let period = options.test_bed.simulation.period;
        let jobs: Vec<(u64, u64, ExcitedJob)> = jobs
            .into_iter()
            .zip(series.stream << 32..)
            .map(|(job, stream)| {
                let seconds = job.excitation.profile.duration() + period;
                (timeline.start_of(seconds), stream_seed(options.seed, stream), job)
            })
            .collect();
        let every = |job: &ExcitedJob| match (options.record, job.repetition) {
            _ if series.every_cycle => Some(1),
            (RecordPolicy::Full, _) => Some(1),
            (RecordPolicy::Thinned, 0) => {
                Some((job.excitation.profile.duration() / period / KEPT_CYCLES).ceil() as u64)
            }
            (RecordPolicy::Thinned, _) => None,
        };
        let work = |(start_ns, seed, job): &(u64, u64, ExcitedJob)| {
            let mut control =
                bench.excited_loop(job.excitation.clone(), job.feed_forward, (*seed, *start_ns))?;
            let start_ns = control.start_ns();
            let mut kept = bench.kept(every(job));
            let mut channels = Channels::new(period);
            for _ in 0..=(job.excitation.profile.duration() / period).round() as u64 {
                let sample = control.step()?;
                kept.add(&sample);
                channels.add(&sample);
                if job.until.is_some_and(|far| sample.measurement.encoder_position.abs() > far) {
                    break;
                }
            }
            control.stop()?;
            let friction = options.torque.friction(&channels).map_err(RunError::Torque)?;
            let result = reduce(job, &channels, &friction);
            let record = MeanRecord::one(channels, friction, series.displacement);
            Ok(Made { start_ns, kept, result: (result, record), replayed: false })
        };
        let groups = jobs.iter().map(|job| job.2.group + 1).max().unwrap_or(0);
        let mut driven = Driven {
            results: Vec::with_capacity(jobs.len()),
            means: vec![MeanRecord::default(); groups],
            rig_seconds: 0.0,
            completion: Completion::All,
        };
        let total = jobs.len() as f64;
        driven.completion = bench.in_order(&jobs, work, |(_, _, job), made| {
            let Made { start_ns, kept, result: (result, record), replayed } = made;
            let stage = format!("{}, repetition {}", job.stage, job.repetition + 1);
            if job.repetition == 0 {
                bench.progress.stage(format!("{}: {}", series.name, job.stage));
            }
            if every(job).is_some() && !replayed {
                recorder.status(
                    start_ns,
                    series.name,
                    &stage,
                    driven.results.len() as f64 / total,
                )?;
            }
            recorder.write(kept)?;
            let seconds = record.time.len() as f64 * period;
            bench.progress.advance(job.excitation.profile.duration());
            driven.rig_seconds += seconds;
            driven.means[job.group].add(&record);
            driven.results.push((job.group, result));
            Ok(())
        })?;
        recorder.flush()?;
        Ok(driven)
    }
}
