//! One run of one arm under the beliefs of one draw.

use std::time::Instant;

use friction_ident::information::or_nan;
use friction_model::{AnyModel, ModelName, ViscousParameters};
use serde::{Deserialize, Serialize};

use super::{StudyError, StudyOptions, Task, bench};
use experiment_runner::compensation::Arm;
use experiment_runner::test_bed::TestBed;
use experiment_runner::tracking::{TrackingJob, TrackingRun};

/// Figures of a run, of the shaft itself.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Mean square of the error [(rad/s)^2 or rad^2].
    #[serde(deserialize_with = "or_nan")]
    pub mse: f64,
    /// Largest magnitude of the error [rad/s or rad].
    #[serde(deserialize_with = "or_nan")]
    pub max_error: f64,
    /// Root mean square of the voltage \[V\].
    #[serde(deserialize_with = "or_nan")]
    pub effort: f64,
}

impl From<TrackingRun> for Trial {
    fn from(run: TrackingRun) -> Self {
        Self { mse: run.mse, max_error: run.max_error, effort: run.effort }
    }
}

impl StudyOptions {
    /// Runs `task` on a plant of the test bed's friction `plant`, compensated by `arm` with what is
    /// believed in `draw`.
    ///
    /// # Errors
    /// [`StudyError`] if the beliefs cannot be drawn or the loop cannot be put together.
    pub fn trial(
        &self,
        task: Task,
        plant: ModelName,
        arm: Arm,
        draw: u32,
    ) -> Result<Trial, StudyError> {
        self.run(task, AnyModel::test_bed(plant), arm, draw)
    }

    /// The linear controller alone on a plant without friction: what is left of the error when
    /// compensation is perfect.
    ///
    /// # Errors
    /// [`StudyError`] if the loop cannot be put together.
    pub fn without_friction(&self, task: Task, draw: u32) -> Result<Trial, StudyError> {
        let none = AnyModel::Viscous(ViscousParameters { f_v: 0.0 }.try_into()?);
        self.run(task, none, Arm::None, draw)
    }

    /// Time that so many draws take on this machine \[s\], by one run of each task; nothing where it
    /// is no matter.
    ///
    /// # Errors
    /// [`StudyError`] if a loop cannot be put together.
    pub fn expected_seconds(&self, draws: usize) -> Result<Option<f64>, StudyError> {
        let (Some(&plant), Some(&arm)) = (self.plants.first(), self.arms.last()) else {
            return Ok(None);
        };
        let mut once = 0.0;
        for &task in &self.tasks {
            let started = Instant::now();
            self.trial(task, plant, arm, 0)?;
            once += started.elapsed().as_secs_f64();
        }
        // Beside the arms there is the linear controller alone, and the plant without friction.
        let runs = draws as f64 * (self.plants.len() * (self.arms.len() + 1) + 1) as f64;
        let seconds = once * runs / self.workers.max(1) as f64;
        Ok(Some(seconds).filter(|seconds| *seconds > 30.0))
    }

    fn run(
        &self,
        task: Task,
        friction: AnyModel,
        arm: Arm,
        draw: u32,
    ) -> Result<Trial, StudyError> {
        let mut bed = TestBed { friction, ..bench(self.setting) };
        // Techniques without a model are given the cheapest one, which they do not look at.
        let model = match arm.model() {
            Some(name) => self.errors.model(draw, &AnyModel::test_bed(name))?,
            None => AnyModel::test_bed(ModelName::Coulomb),
        };
        bed.estimator.drive = self.errors.drive(draw, &bed.estimator.drive);
        bed.controller.compensation.volts_per_newton_metre =
            bed.estimator.drive.volts_per_newton_metre;
        let protocol = task.protocol();
        let seed = self.errors.noise_seed(draw);
        let control =
            bed.control_loop(protocol.mode, protocol.reference, &model, arm.means(), seed, 0)?;
        Ok(TrackingJob { arm, repetition: draw }.run(&protocol, control, |_| {})?.into())
    }
}
