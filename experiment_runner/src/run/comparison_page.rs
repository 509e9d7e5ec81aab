//! Compensations side by side: table and pictures of one task.

use controller::ControlMode;

use super::results::Comparison;
use super::trace::Trace;
use crate::compensation::Arm;
use crate::report::figure::{Figure, LineStyle, Panel, Table, Trace as Drawn};

/// The figures of every compensation.
pub(super) fn comparison_table(title: &str, comparison: &Comparison) -> Table {
    let (unit, square) = match comparison.mode {
        ControlMode::Velocity => ("rad/s", "(rad/s)²"),
        ControlMode::Position => ("rad", "rad²"),
    };
    let repetitions = comparison.runs.iter().map(|run| run.repetition + 1).max().unwrap_or(0);
    // A single repetition has no scatter to show.
    let spread = |value: String, deviation: String| {
        if repetitions > 1 { format!("{value} ± {deviation}") } else { value }
    };
    let of = if repetitions > 1 {
        format!("Mean over {repetitions} repetitions ± standard deviation")
    } else {
        "One repetition".to_owned()
    };
    let hunting = comparison.rows.iter().any(|row| row.limit_cycle.is_some());
    let mut columns = vec![
        "compensation".to_owned(),
        format!("mse [{square}]"),
        format!("largest error [{unit}]"),
        "mse better by [%]".to_owned(),
        "largest error better by [%]".to_owned(),
        format!("mse as measured [{square}]"),
        "rms voltage [V]".to_owned(),
        "rms torque error against the sensor [N m]".to_owned(),
        "against the true friction [N m]".to_owned(),
    ];
    let mut caption = format!(
        "{of}. {} Improvements are against the linear controller alone.",
        if comparison.runs.iter().any(|run| run.torque_error.is_some()) {
            "Errors are those of the shaft itself, which the simulated rig knows; the mean square as measured contains the sensor's noise. The plant's friction is one \
             of the models: a ranking among observers says which is nearest to that plant, no more."
        } else {
            "Errors are as measured, the sensor's noise included."
        }
    );
    if hunting {
        columns.push("limit cycle: amplitude, period".to_owned());
        caption += " A limit cycle is read in the last three fifths of the run: half the distance of the extremes, and the mean time between rises \
                    through the middle.";
    }
    let rows = comparison
        .rows
        .iter()
        .map(|row| {
            let percent =
                |value: f64| if row.arm == Arm::None { "-".to_owned() } else { format!("{value:.1}") };
            // Without compensation an observer runs too, but nobody listens to it.
            let torque = |rms: Option<f64>| match rms.filter(|_| row.arm != Arm::None) {
                Some(rms) => format!("{rms:.4}"),
                None => "-".to_owned(),
            };
            let mut cells = vec![
                row.arm.to_string(),
                spread(format!("{:.3e}", row.mse), format!("{:.0e}", row.mse_deviation)),
                spread(format!("{:.4}", row.max_error), format!("{:.4}", row.max_error_deviation)),
                percent(row.mse_improvement),
                percent(row.max_error_improvement),
                format!("{:.3e}", row.mse_measured),
                spread(format!("{:.3}", row.effort), format!("{:.3}", row.effort_deviation)),
                torque(Some(row.torque_residual)),
                torque(row.torque_error),
            ];
            if hunting {
                cells.push(row.limit_cycle.map_or("none".to_owned(), |cycle| {
                    let of = if cycle.repetitions < repetitions as usize {
                        format!(", in {} of {repetitions}", cycle.repetitions)
                    } else {
                        String::new()
                    };
                    format!("{:.4} rad, {:.2} s{of}", cycle.amplitude, cycle.period)
                }));
            }
            cells
        })
        .collect();
    Table {
        title: format!("{title}: compensations compared"),
        caption,
        columns,
        rows,
        highlight: comparison.best(),
    }
}

/// Reference, response, error, friction and voltage over time.
pub(super) fn tracking_figure(title: &str, mode: ControlMode, traces: &[(Arm, Trace)]) -> Figure {
    let (quantity, unit) = match mode {
        ControlMode::Velocity => ("velocity", "rad/s"),
        ControlMode::Position => ("position", "rad"),
    };
    let line = |name: String, trace: &Trace, y: &[f64], style| Drawn::Line {
        name,
        x: trace.t.clone(),
        y: y.to_vec(),
        style,
    };
    let mut response = Vec::new();
    let mut error = Vec::new();
    let mut friction = Vec::new();
    let mut voltage = Vec::new();
    if let Some((_, first)) = traces.first() {
        response.push(line("reference".to_owned(), first, &first.reference, LineStyle::Dashed));
    }
    // What the sensor shows lies behind everything else.
    if let Some((arm, last)) = traces.last() {
        friction.push(line(format!("measured ({arm})"), last, &last.friction_measured, LineStyle::Faint));
        friction.push(line(format!("true ({arm})"), last, &last.friction_true, LineStyle::Dashed));
    }
    for (arm, trace) in traces {
        let name = arm.to_string();
        response.push(line(name.clone(), trace, &trace.response, LineStyle::Solid));
        error.push(line(name.clone(), trace, &trace.error, LineStyle::Solid));
        voltage.push(line(name.clone(), trace, &trace.voltage, LineStyle::Solid));
        if *arm != Arm::None {
            friction.push(line(name, trace, &trace.friction_estimated, LineStyle::Solid));
        }
    }
    Figure {
        title: format!("{title} over time"),
        caption: "First repetition of each compensation: reference and response, error of the shaft, friction as measured, as it truly is \
                  and as each observer estimates it, and the voltage of the motor."
            .to_owned(),
        x_label: "time [s]".to_owned(),
        log_x: false,
        panels: vec![
            Panel { y_label: format!("{quantity} [{unit}]"), traces: response },
            Panel { y_label: format!("error [{unit}]"), traces: error },
            Panel { y_label: "friction torque [N m]".to_owned(), traces: friction },
            Panel { y_label: "voltage [V]".to_owned(), traces: voltage },
        ],
    }
}
