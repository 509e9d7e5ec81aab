//! `servo.json`.
//!
//! ```text
//! format, format_version, program_version
//! level, stopped, evaluations_per_search
//! evaluations_per_second       in the search; whole_simulations_per_second where nothing is given up early (both one thread)
//! train, held_out              quartiles of the mean position error over the seeds [mrad]; the latter null where nothing is held out
//! parameters                   of the seed with the least training error: name, unit, value, interval over equally good seeds, verdict
//! logs                         file, trajectory, gain, held_out, error_mrad of those parameters
//! seeds                        seed, train_mrad, held_out_mrad, evaluations, values
//! ```

use friction_ident::statistics::Quartiles;
use serde_json::{Value, json};

use super::ServoIdentification;
use recording::servo_log::NamedServoLog;

/// The document as text.
pub fn render(
    found: &ServoIdentification,
    train: &[NamedServoLog],
    held_out: &[NamedServoLog],
) -> String {
    let milli = |q: &Quartiles| json!({ "lower_mrad": 1e3 * q.lower, "median_mrad": 1e3 * q.median, "upper_mrad": 1e3 * q.upper });
    let logs = |logs: &[NamedServoLog], errors: &[f64], held_out: bool| -> Vec<Value> {
        let log = |(named, error): (&NamedServoLog, &f64)| {
            json!({
                "file": named.path.display().to_string(),
                "trajectory": named.trajectory,
                "gain": named.log.gain(),
                "held_out": held_out,
                "error_mrad": 1e3 * error,
            })
        };
        logs.iter().zip(errors).map(log).collect()
    };
    let mut all = logs(train, &found.train_logs, false);
    all.extend(logs(held_out, &found.held_out_logs, true));
    let seeds: Vec<Value> = found
        .seeds
        .iter()
        .map(|result| {
            json!({
                "seed": result.seed,
                "train_mrad": 1e3 * result.found.error,
                "held_out_mrad": result.held_out.map(|error| 1e3 * error),
                "evaluations": result.found.evaluations,
                "values": result.found.values,
            })
        })
        .collect();
    let document = json!({
        "format": "frictionlab-servo",
        "format_version": 1,
        "program_version": env!("CARGO_PKG_VERSION"),
        "level": found.settings.level,
        "stopped": found.stopped,
        "evaluations_per_search": found.settings.effort.evaluations,
        "evaluations_per_second": found.rate,
        "whole_simulations_per_second": found.whole_rate,
        "train": milli(&found.train),
        "held_out": found.held_out.as_ref().map(milli),
        "parameters": found.estimates.parameters,
        "logs": all,
        "seeds": seeds,
    });
    format!("{document:#}\n")
}
