//! Every run that Tables 5.1 and 5.2 and their explanation need.

use std::sync::atomic::AtomicBool;

use friction_model::ModelError;
use serde::Serialize;

use super::{ExampleModel, ExampleRun, PositionExample, VelocityExample};
use experiment_runner::compensation::limit_cycle::LimitCycle;
use work::progress::Progress;
use work::sequencer::run_in_order;

/// Error injection with which the velocity rows come near the printed ones, each observer on its
/// own plant.
pub const VELOCITY_INJECTION: f64 = 0.035;
/// The same for the position rows.
pub const POSITION_INJECTION: f64 = 0.002;

/// One row of the velocity example.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct VelocityCase {
    /// Friction of the plant.
    pub plant: Option<ExampleModel>,
    /// The observer.
    pub observer: Option<ExampleModel>,
    /// Error injection gain k of the observer.
    pub injection: f64,
    /// Proportional gain P [N m s/rad].
    pub p: f64,
}

impl VelocityCase {
    /// Without any friction.
    pub const NO_FRICTION: Self = Self { plant: None, observer: None, injection: 0.0, p: 4.0 };

    /// `observer` on the plant with the proposed model's friction, without injection.
    #[must_use]
    pub const fn on_proposed(observer: Option<ExampleModel>) -> Self {
        Self { plant: Some(ExampleModel::Proposed), observer, injection: 0.0, p: 4.0 }
    }

    /// `model` as plant and as observer, with injection.
    #[must_use]
    pub const fn on_its_own(model: ExampleModel) -> Self {
        Self { plant: Some(model), observer: Some(model), injection: VELOCITY_INJECTION, p: 4.0 }
    }

    /// No friction and no observer, but the proportional gain that injection amounts to.
    #[must_use]
    pub const fn gain(p: f64) -> Self {
        Self { p, ..Self::NO_FRICTION }
    }

    /// Every case.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let mut cases = vec![Self::NO_FRICTION, Self::on_proposed(None)];
        cases.extend(ExampleModel::PRINTED.map(|model| Self::on_proposed(Some(model))));
        cases.extend(
            [ExampleModel::StiffGms, ExampleModel::StiffXiong]
                .map(|model| Self::on_proposed(Some(model))),
        );
        cases.extend(ExampleModel::PRINTED.map(Self::on_its_own));
        cases.extend([6.1, 4.7].map(Self::gain));
        cases
    }
}

/// One row of the position example.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PositionCase {
    /// Friction of the plant.
    pub plant: Option<ExampleModel>,
    /// The observer.
    pub observer: Option<ExampleModel>,
    /// Error injection gain k of the observer.
    pub injection: f64,
    /// Length of the run \[s\].
    pub duration: f64,
}

impl PositionCase {
    /// Without any friction.
    #[must_use]
    pub const fn no_friction(duration: f64) -> Self {
        Self { plant: None, observer: None, injection: 0.0, duration }
    }

    /// `observer` on the plant with the proposed model's friction, without injection.
    #[must_use]
    pub const fn on_proposed(observer: Option<ExampleModel>, duration: f64) -> Self {
        Self { plant: Some(ExampleModel::Proposed), observer, injection: 0.0, duration }
    }

    /// `model` as plant and as observer, with injection.
    #[must_use]
    pub const fn on_its_own(model: ExampleModel, duration: f64) -> Self {
        Self { plant: Some(model), observer: Some(model), injection: POSITION_INJECTION, duration }
    }

    /// Every case: over 20 s, in which the printed ratio of the rows without an observer is met,
    /// the observers on one plant; over 50 s, which give the printed row without friction, each on
    /// its own. Linear control with friction also runs for 100 s, where its limit cycle is read.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let mut cases = Vec::new();
        for duration in [20.0, 50.0] {
            cases.extend([Self::no_friction(duration), Self::on_proposed(None, duration)]);
        }
        cases.extend(ExampleModel::PRINTED.map(|model| Self::on_proposed(Some(model), 20.0)));
        cases.extend(ExampleModel::PRINTED.map(|model| Self::on_its_own(model, 50.0)));
        cases.push(Self::on_proposed(None, 100.0));
        cases
    }
}

/// How the example is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExampleOptions {
    /// Noise seeds of the velocity task.
    pub seeds: u32,
    /// Threads; the results do not depend on it.
    pub workers: usize,
}

impl ExampleOptions {
    /// Time that the runs simulate \[s\].
    #[must_use]
    pub fn rig_seconds(&self) -> f64 {
        let velocity = VelocityCase::all().len() as f64 * f64::from(self.seeds);
        let position = PositionCase::all().iter().map(|case| case.duration).sum::<f64>();
        velocity * VelocityExample::default().duration + position
    }
}

/// What was found; cases that were not reached before the user stopped are missing.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Example {
    /// Each velocity case with a run for each seed.
    pub velocity: Vec<(VelocityCase, Vec<ExampleRun>)>,
    /// Each position case with its limit cycle, where it has one.
    pub position: Vec<(PositionCase, ExampleRun, Option<LimitCycle>)>,
}

#[derive(Debug, Clone, Copy)]
enum Job {
    Velocity(VelocityCase, u64),
    Position(PositionCase),
}

impl Example {
    /// Runs every case, the velocity cases with each seed; all cases of one seed meet the same
    /// disturbance.
    ///
    /// # Errors
    /// [`ModelError`] never for the parameters of the example.
    pub fn compute(
        options: &ExampleOptions,
        progress: &Progress,
        cancel: &AtomicBool,
    ) -> Result<Self, ModelError> {
        let seeds = 1..=u64::from(options.seeds);
        let mut jobs: Vec<Job> = VelocityCase::all()
            .into_iter()
            .flat_map(|case| seeds.clone().map(move |seed| Job::Velocity(case, seed)))
            .collect();
        jobs.extend(PositionCase::all().into_iter().map(Job::Position));
        let mut found = Self::default();
        progress.stage("example of section 5.4");
        let work = |job: &Job| match *job {
            Job::Velocity(VelocityCase { plant, observer, injection, p }, seed) => {
                let example = VelocityExample { p, ..Default::default() };
                Ok((example.run(plant, observer, injection, seed)?, None))
            }
            Job::Position(PositionCase { plant, observer, injection, duration }) => {
                PositionExample { duration, ..Default::default() }.run(plant, observer, injection)
            }
        };
        run_in_order(&jobs, options.workers, cancel, work, |job, (run, cycle)| {
            let seconds = match *job {
                Job::Velocity(..) => VelocityExample::default().duration,
                Job::Position(case) => case.duration,
            };
            match *job {
                Job::Velocity(case, _) => match found.velocity.last_mut() {
                    Some((last, runs)) if *last == case => runs.push(run),
                    _ => found.velocity.push((case, vec![run])),
                },
                Job::Position(case) => found.position.push((case, run, cycle)),
            }
            progress.advance(seconds);
            Ok(())
        })?;
        Ok(found)
    }

    /// The runs of a velocity case.
    #[must_use]
    pub fn velocity(&self, case: &VelocityCase) -> Option<&[ExampleRun]> {
        self.velocity.iter().find(|(other, _)| other == case).map(|(_, runs)| runs.as_slice())
    }

    /// Mean over the seeds of the mean square error of `case` over that without friction.
    #[must_use]
    pub fn relative(&self, case: &VelocityCase) -> Option<f64> {
        let (of_case, none) = (self.velocity(case)?, self.velocity(&VelocityCase::NO_FRICTION)?);
        let n = of_case.len().min(none.len());
        let ratios = of_case.iter().zip(none).map(|(run, none)| run.mse / none.mse);
        (n > 0).then(|| ratios.sum::<f64>() / n as f64)
    }

    /// The run of a position case.
    #[must_use]
    pub fn position(&self, case: &PositionCase) -> Option<(ExampleRun, Option<LimitCycle>)> {
        self.position.iter().find(|(other, ..)| other == case).map(|(_, run, cycle)| (*run, *cycle))
    }
}
