//! A design as a document for programs: `design.json`, and what `--json` prints.

use controller::VelocityLaw;
use controller::design::LoopLaw;
use controller::design::frequency::Margins;
use serde_json::{Value, json};

use super::Assessment;
use super::worth::sentences;

/// The document; docs/reference/json.md explains its keys.
#[must_use]
pub fn document(found: &Assessment) -> Value {
    let options = &found.options;
    let (law, gains) = match options.linear.law {
        LoopLaw::Velocity(VelocityLaw::Lag(gains)) => ("velocity_lag", json!(gains)),
        LoopLaw::Velocity(VelocityLaw::Pi(gains)) => ("velocity_pi", json!(gains)),
        LoopLaw::Position { gains, .. } => ("position_pid", json!(gains)),
    };
    let steps: Vec<Value> = found
        .figures
        .iter()
        .map(|(definition, figures)| {
            json!({
                "rise_from": definition.rise_from,
                "band": definition.band,
                "rise_time_s": figures.rise_time,
                "settling_time_s": figures.settling_time,
                "overshoot": figures.overshoot,
                "steady_state_error": figures.steady_state_error,
                "largest_voltage_V": figures.peak_voltage,
            })
        })
        .collect();
    json!({
        "format": "frictionlab-design",
        "format_version": 1,
        "program_version": env!("CARGO_PKG_VERSION"),
        "asked": options.asked,
        "law": law,
        "gains": gains,
        "drive": {
            "gain_rad_s_per_V": options.linear.drive.gain,
            "time_constant_s": options.linear.drive.time_constant,
            "volts_per_newton_metre": options.volts_per_newton_metre,
        },
        "period_s": options.period,
        "step": steps,
        "margins": { "continuous": margins(&found.continuous), "sampled": margins(&found.sampled) },
        "on_the_rig": found.worth,
        "mse_over_default": found.worth.map(|worth| worth.ratio()),
        "remarks": sentences(found),
    })
}

fn margins(found: &Margins) -> Value {
    json!({
        "crossover_rad_s": found.crossover,
        "phase_margin_deg": found.phase_margin,
        "gain_margin": found.gain_margin,
        "gain_reduction": found.gain_reduction,
        "delay_margin_s": found.delay_margin,
        "sensitivity_peak": found.sensitivity_peak,
    })
}
