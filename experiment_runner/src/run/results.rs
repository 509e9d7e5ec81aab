//! What a run found: the content of `run.json`.

use std::collections::BTreeMap;

use controller::ControlMode;
use friction_ident::statistics::Sample;
use friction_ident::{StribeckEstimate, StribeckFit};
use friction_model::AnyModel;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{Appended, Characterisation, Origins, RunOptions};
use crate::compensation::{Arm, LimitCycle};
use crate::constant_velocity::SteadyRun;
use crate::tracking::TrackingRun;

/// Whether a run came to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Everything was done.
    Complete,
    /// Stopped by the user; what is there is whole, what is missing was not measured.
    Interrupted,
}

/// Everything a run found.
#[derive(Debug, Clone, Serialize)]
pub struct RunResults {
    /// Version of the program.
    pub program_version: &'static str,
    /// Whether it came to its end.
    pub status: Status,
    /// Why it ended early: what a real rig said, or why no curve fits.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ended: Option<String>,
    /// How often the line to the rig failed and came back: each time the run at hand was repeated.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub reconnections: Vec<Reconnection>,
    /// The sittings of a run that was stopped and went on; none of a run in one piece.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sessions: Vec<Session>,
    /// What was asked for.
    pub options: RunOptions,
    /// Where each value of `parameters.yaml` comes from.
    pub origin: Origins,
    /// Points at constant velocity.
    pub constant_velocity: Vec<SteadyRun>,
    /// The Stribeck curve through them.
    pub identification: Option<Identification>,
    /// Experiments 2 to 4.
    pub characterisation: Characterisation,
    /// Velocity tracking.
    pub velocity_tracking: Option<Comparison>,
    /// Position tracking.
    pub position_tracking: Option<Comparison>,
    /// Compensations compared in each task of the compensation experiments.
    pub compensation: Vec<TaskComparison>,
    /// What was computed besides.
    pub thesis_tables: Option<Appended>,
    /// Figures of experiments that are not part of this crate, by name.
    #[serde(flatten)]
    pub own: BTreeMap<String, Value>,
    /// The bag.
    pub bag: BagFigures,
    /// How long it took: the only part that differs between two runs with the same seed.
    pub timing: Timing,
}

impl RunResults {
    /// Every comparison with the name of its task, in the order they were driven.
    pub fn comparisons(&self) -> impl Iterator<Item = (&str, &Comparison)> {
        let tracking = [
            ("velocity tracking", &self.velocity_tracking),
            ("position tracking", &self.position_tracking),
        ];
        let tracking =
            tracking.into_iter().filter_map(|(name, found)| Some((name, found.as_ref()?)));
        tracking.chain(self.compensation.iter().map(|task| (task.name.as_str(), &task.comparison)))
    }

    /// What was repeated because the line failed, in words.
    #[must_use]
    pub fn repeated(&self) -> Option<String> {
        let first = self.reconnections.first()?;
        let times = match self.reconnections.len() {
            1 => "once".to_owned(),
            n => format!("{n} times"),
        };
        Some(format!(
            "The line to the rig failed {times} and came back; the run at hand was repeated each time, and what it had measured before is in the bag but in no figure. \
             The first time: {}.",
            first.said
        ))
    }

    /// In which sittings it was measured, in words.
    #[must_use]
    pub fn resumed(&self) -> Option<String> {
        if self.sessions.len() < 2 {
            return None;
        }
        let first = self.sessions.first()?.began;
        let each: Vec<String> = self
            .sessions
            .iter()
            .map(|Session { began, ended, first_job, jobs, bag }| {
                let which = match jobs {
                    0 => "no run".to_owned(),
                    1 => format!("run {}", first_job + 1),
                    _ => format!("runs {} to {}", first_job + 1, first_job + jobs),
                };
                let recorded =
                    bag.as_ref().map_or(String::new(), |bag| format!(", recorded in {bag}"));
                format!(
                    "{which} in {} s, begun after {} s{recorded}",
                    (ended - began).round(),
                    (began - first).round()
                )
            })
            .collect();
        Some(format!("This run was stopped and went on. Its sittings: {}.", each.join("; ")))
    }

    /// What a torque without a sensor adds to the uncertainty of the steady points, in words.
    #[must_use]
    pub fn added_to_points(&self) -> Option<String> {
        let systematic = || self.constant_velocity.iter().map(|run| run.torque_systematic);
        let most = systematic().max_by(f64::total_cmp).filter(|&most| most > 0.0)?;
        let least = systematic().min_by(f64::total_cmp)?;
        Some(format!(
            "The torque is worked out of the motor's {}: the errors of the drive's constants add a standard deviation of {least:.4} to {most:.4} N m to the \
             points, the same in every repetition, which the parameters' standard errors do not contain.",
            self.options.torque.source.name()
        ))
    }
}

/// One sitting of a run that was stopped and went on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Session {
    /// When it began [s since the Unix epoch].
    pub began: f64,
    /// When its last run ended [s since the Unix epoch].
    pub ended: f64,
    /// Number of its first run, from 0, counted over the whole job.
    pub first_job: u64,
    /// Runs that it measured.
    pub jobs: u64,
    /// Folder of its bag, relative to the run's; none if it left no bag.
    pub bag: Option<String>,
}

/// A line that failed and came back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reconnection {
    /// When it was back [s since the Unix epoch].
    pub at: f64,
    /// How long the rig was away \[s\].
    pub seconds: f64,
    /// How it failed.
    pub said: String,
}

/// The identified curve.
#[derive(Debug, Clone, Serialize)]
pub struct Identification {
    /// The fit to the first set.
    pub fit: StribeckFit,
    /// Each parameter with its uncertainty.
    pub parameters: Vec<Parameter>,
    /// Mean square residual of the first set [(N m)^2].
    pub mse_identification: f64,
    /// Mean square residual of the other sets, which the fit has not seen [(N m)^2].
    pub mse_validation: Option<f64>,
}

/// One identified parameter beside the truth, which a simulated rig knows.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Parameter {
    /// Name in files.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Value and uncertainty.
    #[serde(flatten)]
    pub estimate: StribeckEstimate,
    /// The plant's own value, where it has such a parameter.
    pub truth: Option<f64>,
}

/// The plant's value of the static parameters `f_s`, `f_c`, `v_s`, `f_v`, as far as its model has
/// them.
#[must_use]
pub(crate) fn static_truth(plant: &AnyModel) -> [Option<f64>; 4] {
    ["f_s", "f_c", "v_s", "f_v"].map(|name| plant.parameter(name))
}

/// Compensations of one task side by side.
#[derive(Debug, Clone, Serialize)]
pub struct Comparison {
    /// What is regulated.
    pub mode: ControlMode,
    /// One row a compensation, the first without any.
    pub rows: Vec<ArmFigures>,
    /// Every run.
    pub runs: Vec<TrackingRun>,
}

/// One compensation, mean over its repetitions.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct ArmFigures {
    /// What compensated.
    pub arm: Arm,
    /// Mean square error of the shaft [(rad/s)^2 or rad^2].
    pub mse: f64,
    /// Standard deviation of `mse` over the repetitions.
    pub mse_deviation: f64,
    /// Largest error of the shaft, mean over the repetitions [rad/s or rad].
    pub max_error: f64,
    /// Standard deviation of `max_error` over the repetitions.
    pub max_error_deviation: f64,
    /// Improvement of `mse` over no compensation [%].
    pub mse_improvement: f64,
    /// Improvement of `max_error` over no compensation [%].
    pub max_error_improvement: f64,
    /// Mean square error as measured, with the sensors' noise.
    pub mse_measured: f64,
    /// Root mean square voltage \[V\].
    pub effort: f64,
    /// Standard deviation of `effort` over the repetitions \[V\].
    pub effort_deviation: f64,
    /// Root mean square of measured minus estimated friction [N m].
    pub torque_residual: f64,
    /// Root mean square of true minus estimated friction [N m], where the rig is simulated.
    pub torque_error: Option<f64>,
    /// The oscillation that remains after a step of position.
    pub limit_cycle: Option<LimitCycleFigures>,
}

/// Limit cycles of one compensation, over the repetitions that have one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LimitCycleFigures {
    /// Repetitions that end in one.
    pub repetitions: usize,
    /// Mean amplitude \[rad\].
    pub amplitude: f64,
    /// Standard deviation of the amplitude \[rad\].
    pub amplitude_deviation: f64,
    /// Mean period \[s\].
    pub period: f64,
    /// Standard deviation of the period \[s\].
    pub period_deviation: f64,
}

impl LimitCycleFigures {
    /// Of the runs of one arm; `None` if no run has one.
    fn of(runs: &[&TrackingRun]) -> Option<Self> {
        let found: Vec<LimitCycle> = runs.iter().filter_map(|run| run.limit_cycle).collect();
        let amplitude = Sample::of(found.iter().map(|cycle| cycle.amplitude));
        let period = Sample::of(found.iter().map(|cycle| cycle.period));
        (!found.is_empty()).then_some(Self {
            repetitions: found.len(),
            amplitude: amplitude.mean,
            amplitude_deviation: amplitude.deviation(),
            period: period.mean,
            period_deviation: period.deviation(),
        })
    }
}

/// Compensations compared in one task.
#[derive(Debug, Clone, Serialize)]
pub struct TaskComparison {
    /// Name of the task.
    pub name: String,
    /// What the compensations are worth in it.
    pub comparison: Comparison,
}

impl Comparison {
    /// Sums up the runs of each arm, in the order given; arms without a run are left out. `None` if
    /// there is no run at all.
    #[must_use]
    pub fn new(mode: ControlMode, arms: &[Arm], runs: Vec<TrackingRun>) -> Option<Self> {
        let mut rows: Vec<ArmFigures> = Vec::with_capacity(arms.len());
        for &arm in arms {
            let of_arm: Vec<&TrackingRun> = runs.iter().filter(|run| run.arm == arm).collect();
            if of_arm.is_empty() {
                continue;
            }
            let figures = |value: fn(&TrackingRun) -> f64| {
                let sample = Sample::of(of_arm.iter().map(|run| value(run)));
                (sample.mean, sample.deviation())
            };
            let (mse, mse_deviation) = figures(|run| run.mse);
            let (max_error, max_error_deviation) = figures(|run| run.max_error);
            let against = |value: f64, none: Option<f64>| {
                none.map_or(0.0, |none| 100.0 * (1.0 - value / none))
            };
            let none = rows.first().copied();
            rows.push(ArmFigures {
                arm,
                mse,
                mse_deviation,
                max_error,
                max_error_deviation,
                mse_improvement: against(mse, none.map(|row| row.mse)),
                max_error_improvement: against(max_error, none.map(|row| row.max_error)),
                mse_measured: figures(|run| run.mse_measured).0,
                effort: figures(|run| run.effort).0,
                effort_deviation: figures(|run| run.effort).1,
                torque_residual: figures(|run| run.torque_residual).0,
                torque_error: of_arm
                    .iter()
                    .all(|run| run.torque_error.is_some())
                    .then(|| figures(|run| run.torque_error.unwrap_or_default()).0),
                limit_cycle: LimitCycleFigures::of(&of_arm),
            });
        }
        (!rows.is_empty()).then_some(Self { mode, rows, runs })
    }

    /// Index of the row with the smallest mean square error.
    #[must_use]
    pub fn best(&self) -> Option<usize> {
        (0..self.rows.len()).min_by(|&a, &b| self.rows[a].mse.total_cmp(&self.rows[b].mse))
    }
}

/// The bag in figures.
#[derive(Debug, Clone, Serialize)]
pub struct BagFigures {
    /// Folder, relative to the run's.
    pub folder: &'static str,
    /// Messages of all topics.
    pub messages: u64,
    /// Size of the MCAP file \[B\].
    pub bytes: u64,
    /// What was left out.
    pub recorded: &'static str,
}

/// How long it took.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Timing {
    /// Time on the clock \[s\].
    pub wall_seconds: f64,
    /// Time the same would have taken on a rig \[s\].
    pub rig_seconds: f64,
    /// Rig time over clock time.
    pub times_real_time: f64,
}

#[cfg(test)]
mod tests {
    use friction_model::ModelName;

    use super::*;

    #[test]
    fn improvements_are_against_the_first_row() {
        let run = |arm, repetition, mse, max_error| TrackingRun {
            arm,
            repetition,
            mse,
            max_error,
            mse_measured: mse,
            max_error_measured: max_error,
            effort: 1.0,
            torque_residual: 0.0,
            torque_error: None,
            limit_cycle: None,
        };
        let arms = [Arm::None, Arm::observer(ModelName::LuGre), Arm::observer(ModelName::Proposed)];
        let runs = vec![
            run(arms[0], 0, 4.0, 2.0),
            run(arms[0], 1, 6.0, 2.0),
            run(arms[1], 0, 1.0, 1.0),
            run(arms[1], 1, 1.0, 1.0),
        ];
        let comparison = Comparison::new(ControlMode::Velocity, &arms, runs).unwrap();
        // The third arm was not run.
        assert_eq!(comparison.rows.len(), 2);
        assert_eq!((comparison.rows[0].mse, comparison.rows[0].mse_improvement), (5.0, 0.0));
        assert!((comparison.rows[0].mse_deviation - 2f64.sqrt()).abs() < 1e-15);
        assert_eq!(
            (comparison.rows[1].mse_improvement, comparison.rows[1].max_error_improvement),
            (80.0, 50.0)
        );
        assert_eq!(comparison.best(), Some(1));
        assert!(Comparison::new(ControlMode::Velocity, &arms, vec![]).is_none());
    }
}
