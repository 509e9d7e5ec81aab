//! A sequence of one's own in the report: it has no figures, only what was recorded.

use super::characterisation::Characterisation;
use super::mean_record::MeanRecord;
use report::figure::{Block, Figure, LineStyle, Panel, Trace};
use report::numbers;

/// The section of the sequence; nothing where it was not driven.
pub(super) fn blocks(name: &str, repetitions: u32, found: &Characterisation) -> Vec<Block> {
    let file = format!("{name}.csv");
    let Some((_, record)) =
        found.records.iter().find(|(other, record)| *other == file && !record.time.is_empty())
    else {
        return Vec::new();
    };
    let text = format!(
        "{} of {} s, mean over {}. Every sample of it is in `{file}`, which `frictionlab identify` reads.",
        if repetitions == 1 { "One run" } else { "Runs" },
        numbers::plain(record.time.last().copied().unwrap_or(0.0), 6),
        numbers::count(repetitions as usize, "repetition"),
    );
    vec![
        Block::Heading(format!("The sequence {name}")),
        Block::Text(text),
        Block::Figure(over_time(name, record)),
        Block::Figure(over_velocity(name, record)),
    ]
}

fn over_time(name: &str, record: &MeanRecord) -> Figure {
    let panel = |label: &str, series: &str, y: &[f64]| Panel {
        y_label: label.to_owned(),
        traces: vec![Trace::Line {
            name: series.to_owned(),
            x: record.time.clone(),
            y: y.to_vec(),
            style: LineStyle::Solid,
        }],
    };
    Figure {
        title: format!("{name} over time"),
        caption:
            "Position, velocity, voltage and friction torque, each the mean over the repetitions."
                .to_owned(),
        x_label: "time [s]".to_owned(),
        log_x: false,
        panels: vec![
            panel("position [rad]", "position", &record.position),
            panel("velocity [rad/s]", "velocity", &record.velocity),
            panel("voltage [V]", "voltage", &record.voltage),
            panel("friction [N m]", "friction", &record.torque),
        ],
    }
}

fn over_velocity(name: &str, record: &MeanRecord) -> Figure {
    Figure {
        title: format!("{name}: friction over velocity"),
        caption:
            "Friction torque over velocity in the order of the sequence; arrows show its direction."
                .to_owned(),
        x_label: "velocity [rad/s]".to_owned(),
        log_x: false,
        panels: vec![Panel {
            y_label: "friction [N m]".to_owned(),
            traces: vec![Trace::Loop {
                name: "sequence".to_owned(),
                x: smoothed(&record.velocity),
                y: smoothed(&record.torque),
            }],
        }],
    }
}

/// Means over so many samples that some hundred are left: what a path shows is its course, not its
/// noise.
pub(super) fn smoothed(values: &[f64]) -> Vec<f64> {
    report::smooth::moving_mean(values, values.len() / 400)
}
