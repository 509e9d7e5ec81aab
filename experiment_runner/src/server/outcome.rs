//! What came of an experiment, as messages.

use std::sync::Arc;

use controller::ControlMode;
use msgs::friction_msgs::{EstimatedParameter, Figure, RunExperimentResult};

use super::Refusal;
use super::ended::{Came, Ended, Started};
use crate::characterise::Measured;
use crate::errand::Ending;
use crate::run::{BreakawayFigures, Characterisation, Comparison, RunError, RunResults, Status};

/// The result of a request that was refused.
#[must_use]
pub fn refused(refusal: &Refusal) -> RunExperimentResult {
    let outcome = match refusal {
        Refusal::Busy { .. } => RunExperimentResult::BUSY,
        Refusal::BadRequest(_) => RunExperimentResult::BAD_REQUEST,
        Refusal::Inactive | Refusal::Leaving => RunExperimentResult::FAILED,
    };
    RunExperimentResult { outcome, message: refusal.to_string(), ..Default::default() }
}

/// The result of an experiment that was run.
#[must_use]
pub fn result(ended: &Ended) -> RunExperimentResult {
    let Started { run_id, folder, .. } = &ended.started;
    let file = |name: &str| {
        let path = folder.join(name);
        if path.exists() { path.display().to_string() } else { String::new() }
    };
    let (outcome, parameters, figures) = match &ended.came {
        Came::Errand(carried) => {
            let outcome = match carried.ending {
                Ending::Complete => RunExperimentResult::SUCCEEDED,
                Ending::Stopped => RunExperimentResult::CANCELED,
                Ending::Failed => RunExperimentResult::FAILED,
            };
            (outcome, carried.parameters.clone(), Vec::new())
        }
        Came::Run(results) => of_run(results),
    };
    RunExperimentResult {
        success: outcome == RunExperimentResult::SUCCEEDED,
        outcome,
        message: message(ended),
        run_id: run_id.clone(),
        folder: folder.display().to_string(),
        bag_path: file("bag"),
        report: file("report.html"),
        parameters_file: file("parameters.yaml"),
        parameters,
        figures,
    }
}

/// Outcome, parameters and figures of an experiment.
fn of_run(
    results: &Result<RunResults, Arc<RunError>>,
) -> (u8, Vec<EstimatedParameter>, Vec<Figure>) {
    match results {
        Ok(results) => {
            let outcome = match (results.status, &results.ended) {
                (_, Some(_)) => RunExperimentResult::FAILED,
                (Status::Complete, None) => RunExperimentResult::SUCCEEDED,
                (Status::Interrupted, None) => RunExperimentResult::CANCELED,
            };
            (outcome, parameters(results), figures(results))
        }
        Err(_) => (RunExperimentResult::FAILED, Vec::new(), Vec::new()),
    }
}

/// One sentence on how it ended.
#[must_use]
pub fn message(ended: &Ended) -> String {
    let Started { run_id, folder, .. } = &ended.started;
    let results = match &ended.came {
        Came::Errand(carried) => return format!("{run_id}: {}", carried.message),
        Came::Run(results) => results.as_ref(),
    };
    match results {
        Ok(results) => {
            let timing = &results.timing;
            if let Some(reason) = &results.ended {
                return format!(
                    "{run_id} ended early: {reason}. What was measured until then is in {}",
                    folder.display()
                );
            }
            match results.status {
                Status::Complete => format!(
                    "{run_id} is complete: {:.0} s of rig time in {:.1} s; the report is {}",
                    timing.rig_seconds,
                    timing.wall_seconds,
                    folder.join("report.html").display()
                ),
                Status::Interrupted => format!(
                    "{run_id} was stopped before its end, after {:.0} s of rig time; what was measured until then is in {}",
                    timing.rig_seconds,
                    folder.display()
                ),
            }
        }
        Err(reason) => format!("{run_id} failed: {reason}"),
    }
}

fn parameters(results: &RunResults) -> Vec<EstimatedParameter> {
    let Some(found) = &results.identification else { return Vec::new() };
    found
        .parameters
        .iter()
        .map(|parameter| {
            let estimate = &parameter.estimate;
            let (low, high) = estimate.interval.unwrap_or((f64::NAN, f64::NAN));
            let open = |end: f64| if end.is_finite() { end } else { f64::NAN };
            EstimatedParameter {
                model: "stribeck".to_owned(),
                name: parameter.name.to_owned(),
                unit: parameter.unit.to_owned(),
                value: estimate.value,
                standard_error: estimate.standard_error.unwrap_or(f64::NAN),
                low: open(low),
                high: open(high),
                identified: estimate.unidentifiable.is_none(),
                explanation: estimate.unidentifiable.map(|why| why.to_string()).unwrap_or_default(),
            }
        })
        .collect()
}

fn figures(results: &RunResults) -> Vec<Figure> {
    let mut table = characterised(&results.characterisation);
    for (task, comparison) in results.comparisons() {
        table.extend(compared(task, comparison));
    }
    table
}

fn figure(
    task: &str,
    row: &str,
    name: &str,
    unit: &str,
    value: f64,
    deviation: Option<f64>,
) -> Figure {
    Figure {
        task: task.to_owned(),
        row: row.to_owned(),
        name: name.to_owned(),
        unit: unit.to_owned(),
        value,
        deviation: deviation.unwrap_or(f64::NAN),
    }
}

fn measured(task: &str, row: &str, name: &str, unit: &str, found: &Measured) -> Figure {
    figure(
        task,
        row,
        name,
        unit,
        found.mean,
        Some(found.uncertainty()).filter(|known| *known > 0.0),
    )
}

fn characterised(found: &Characterisation) -> Vec<Figure> {
    let mut table = Vec::new();
    for lag in &found.lag {
        let row = format!("{} rad/s", lag.frequency);
        table.push(measured("varying-velocity", &row, "loop_area", "N m rad/s", &lag.area));
    }
    let mut breakaway = |task: &str, found: &BreakawayFigures| {
        let row = &found.excitation;
        table.push(measured(task, row, "breakaway_torque", "N m", &found.torque));
        table.push(measured(task, row, "breakaway_displacement", "rad", &found.displacement));
        table.push(figure(task, row, "torque_rate", "N m/s", found.rate, None));
    };
    found.ramps.iter().for_each(|ramp| breakaway("pre-sliding", ramp));
    found.rates.iter().for_each(|rate| breakaway("breakaway-rate", rate));
    for closure in &found.closures {
        let row = format!("turns {} and {}", closure.turns.0, closure.turns.1);
        table.push(measured("pre-sliding", &row, "gap", "rad", &closure.gap));
    }
    table
}

fn compared(task: &str, comparison: &Comparison) -> Vec<Figure> {
    let (unit, square) = match comparison.mode {
        ControlMode::Velocity => ("rad/s", "(rad/s)^2"),
        ControlMode::Position => ("rad", "rad^2"),
    };
    // A single repetition has no scatter to tell.
    let scattered = comparison.runs.iter().any(|run| run.repetition > 0);
    let mut table = Vec::new();
    for row in &comparison.rows {
        let arm = row.arm.to_string();
        let mut add = |name: &str, unit: &str, value: f64, deviation: Option<f64>| {
            table.push(figure(task, &arm, name, unit, value, deviation));
        };
        add("mse", square, row.mse, scattered.then_some(row.mse_deviation));
        add("max_error", unit, row.max_error, scattered.then_some(row.max_error_deviation));
        add("mse_improvement", "%", row.mse_improvement, None);
        add("max_error_improvement", "%", row.max_error_improvement, None);
        add("effort", "V", row.effort, scattered.then_some(row.effort_deviation));
        add("torque_residual", "N m", row.torque_residual, None);
    }
    table
}
