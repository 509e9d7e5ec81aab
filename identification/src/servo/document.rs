//! `servo.json`.
//!
//! ```text
//! format, format_version, program_version
//! servo, level, notes          what it was taken for; what the headers say otherwise and what cannot be told apart
//! failure                      why the fit is a failure; null where it is none
//! stopped, evaluations_per_search
//! evaluations_per_second       in the search; whole_simulations_per_second where nothing is given up early (both one thread)
//! train, held_out              quartiles of the mean position error over the seeds [mrad]; the latter null where nothing is held out
//! parameters                   of the seed with the least training error: name, unit, value, 95 % interval from disjoint halves of the logs, verdict
//! halves                       values of the fits of both halves of each split
//! logs                         file, trajectory, gain, mass, length, held_out, error_mrad of those parameters
//! seeds                        seed, train_mrad, held_out_mrad, evaluations, values
//! ```

use friction_ident::statistics::Quartiles;
use serde_json::{Value, json};

use super::ServoIdentification;
use super::logs::NamedServoLog;

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
                "file": named.file.path.display().to_string(),
                "trajectory": named.file.text("trajectory").unwrap_or_default(),
                "gain": named.log.gain(),
                "mass": named.file.mass,
                "length": named.file.length,
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
    let halves: Vec<[&Vec<f64>; 2]> =
        found.halves.iter().map(|[a, b]| [&a.values, &b.values]).collect();
    let document = json!({
        "format": "frictionlab-servo",
        "format_version": 1,
        "program_version": env!("CARGO_PKG_VERSION"),
        "servo": found.settings.servo,
        "level": found.settings.level,
        "notes": found.settings.notes,
        "failure": found.failure(),
        "stopped": found.stopped,
        "evaluations_per_search": found.settings.effort.evaluations,
        "evaluations_per_second": found.rate,
        "whole_simulations_per_second": found.whole_rate,
        "train": milli(&found.train),
        "held_out": found.held_out.as_ref().map(milli),
        "parameters": found.estimates.parameters,
        "halves": halves,
        "logs": all,
        "seeds": seeds,
    });
    format!("{document:#}\n")
}
