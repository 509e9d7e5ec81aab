//! Given parameters scored on logs, without a fit.

use std::fmt::Write;

use friction_ident::servo::{Drive, FitQuality};
use serde_json::{Value, json};

use super::given::GivenParameters;
use super::logs::NamedServoLog;
use super::{lanes_of, quality_of};

/// The score.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// Of all logs.
    pub all: FitQuality,
    /// Of each log, in their order.
    pub logs: Vec<FitQuality>,
    /// Simulated positions \[rad\].
    pub positions: Vec<Vec<f64>>,
}

/// Simulates every log with the parameters.
pub fn evaluate(logs: &[NamedServoLog], drive: &Drive, given: &GivenParameters) -> Evaluation {
    let lanes = lanes_of(drive, &logs.iter().collect::<Vec<_>>());
    let physics = given.physics();
    let errors = lanes.errors(&physics);
    let one =
        |(named, error): (&NamedServoLog, &f64)| quality_of(std::slice::from_ref(named), *error);
    Evaluation {
        all: quality_of(logs, lanes.error(&physics, f64::INFINITY)),
        logs: logs.iter().zip(&errors).map(one).collect(),
        positions: lanes.positions(&physics),
    }
}

/// `evaluation.json`: servo, notes, error_mrad of all, failure; logs with file, trajectory, gain,
/// mass, length, error_mrad, motion_mrad, failure.
pub fn document(
    found: &Evaluation,
    logs: &[NamedServoLog],
    servo: &str,
    notes: &[String],
) -> String {
    let failure = |quality: &FitQuality| quality.doubt().map(|doubt| doubt.to_string());
    let logs: Vec<Value> = logs
        .iter()
        .zip(&found.logs)
        .map(|(named, quality)| {
            json!({
                "file": named.file.path.display().to_string(),
                "trajectory": named.file.text("trajectory").unwrap_or_default(),
                "gain": named.log.gain(),
                "mass": named.file.mass,
                "length": named.file.length,
                "error_mrad": 1e3 * quality.error,
                "motion_mrad": 1e3 * quality.motion,
                "failure": failure(quality),
            })
        })
        .collect();
    let document = json!({
        "format": "frictionlab-servo-evaluation",
        "format_version": 1,
        "program_version": env!("CARGO_PKG_VERSION"),
        "servo": servo,
        "notes": notes,
        "error_mrad": 1e3 * found.all.error,
        "failure": failure(&found.all),
        "logs": logs,
    });
    format!("{document:#}\n")
}

/// What the terminal shows.
pub fn text(found: &Evaluation, logs: &[NamedServoLog], servo: &str, notes: &[String]) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail, hence the ignored results.
    if let Some(doubt) = found.all.doubt() {
        let _ = writeln!(text, "FAILED: {doubt}.");
    }
    for note in notes {
        let _ = writeln!(text, "note: {note}");
    }
    let _ = writeln!(
        text,
        "servo {servo}: mean position error {:.2} mrad over {} logs (motion {:.0} mrad)",
        1e3 * found.all.error,
        logs.len(),
        1e3 * found.all.motion
    );
    let _ = writeln!(text, "  {:<44} {:>12} {:>14}", "log", "error [mrad]", "motion [mrad]");
    for (named, quality) in logs.iter().zip(&found.logs) {
        let _ = writeln!(
            text,
            "  {:<44} {:>12.2} {:>14.0}{}",
            named.title(),
            1e3 * quality.error,
            1e3 * quality.motion,
            if quality.doubt().is_some() { "  failed" } else { "" }
        );
    }
    text
}
