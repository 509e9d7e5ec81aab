//! Compensations side by side: table and pictures of one task.

use controller::ControlMode;

use super::results::{ArmFigures, Comparison};
use super::trace::Trace;
use crate::compensation::Arm;
use report::figure::{Figure, LineStyle, Panel, Table, Trace as Drawn};
use report::numbers;

/// The figures of every compensation.
pub(super) fn comparison_table(title: &str, comparison: &Comparison) -> Table {
    let shown = Shown::of(comparison);
    let (unit, square) = match comparison.mode {
        ControlMode::Velocity => ("rad/s", "(rad/s)²"),
        ControlMode::Position => ("rad", "rad²"),
    };
    let mut columns = vec![
        "compensation".to_owned(),
        format!("mse [{square}]"),
        "smaller by [%]".to_owned(),
        format!("largest error [{unit}]"),
        "smaller by [%]".to_owned(),
        "voltage [V]".to_owned(),
        "torque off by [N m]".to_owned(),
    ];
    columns.extend(shown.hunting.then(|| "limit cycle".to_owned()));
    Table {
        title: format!("{title}: compensations compared"),
        caption: shown.caption(),
        columns,
        rows: comparison.rows.iter().map(|row| shown.cells(row)).collect(),
        highlight: comparison.best(),
    }
}

/// What the table of a comparison can show.
struct Shown {
    repetitions: u32,
    /// The shaft's own motion and friction are known.
    known: bool,
    /// Something ran into a limit cycle.
    hunting: bool,
}

impl Shown {
    fn of(comparison: &Comparison) -> Self {
        Self {
            repetitions: comparison.runs.iter().map(|run| run.repetition + 1).max().unwrap_or(0),
            known: comparison.runs.iter().any(|run| run.torque_error.is_some()),
            hunting: comparison.rows.iter().any(|row| row.limit_cycle.is_some()),
        }
    }

    fn caption(&self) -> String {
        let of = match self.repetitions {
            0 | 1 => "One repetition".to_owned(),
            many => format!("Mean over {many} repetitions ± standard deviation"),
        };
        let errors = if self.known {
            "Errors are those of the shaft itself, which the simulated rig knows. The plant's \
             friction is one of the models: a ranking among observers says which is nearest to \
             that plant, no more."
        } else {
            "Errors are as measured, the sensor's noise included."
        };
        let torque = if self.known { "the true friction" } else { "what the torque sensor shows" };
        let mut caption = format!(
            "{of}. {errors} How much smaller is against the linear controller alone. Voltage: \
             root mean square. Torque: root mean square of the estimate minus {torque}."
        );
        if self.hunting {
            caption += " A limit cycle, amplitude and period, is read in the last three fifths of \
                        the run: half the distance of the extremes, and the mean time between \
                        rises through the middle.";
        }
        caption
    }

    /// A mean and its standard deviation; a single repetition has no scatter to show.
    fn spread(&self, value: f64, deviation: f64) -> String {
        let value = numbers::significant(value, 4);
        if self.repetitions > 1 && deviation > 0.0 {
            format!("{value} ± {}", numbers::plain(deviation, 1))
        } else {
            value
        }
    }

    fn cells(&self, row: &ArmFigures) -> Vec<String> {
        let percent = |value: f64| {
            if row.arm == Arm::None { "-".to_owned() } else { numbers::smaller_by(value) }
        };
        // Without compensation an observer runs too, but nobody listens to it.
        let torque = |rms: Option<f64>| match rms.filter(|_| row.arm != Arm::None) {
            Some(rms) => format!("{rms:.4}"),
            None => "-".to_owned(),
        };
        let mut cells = vec![
            row.arm.to_string(),
            self.spread(row.mse, row.mse_deviation),
            percent(row.mse_improvement),
            self.spread(row.max_error, row.max_error_deviation),
            percent(row.max_error_improvement),
            self.spread(row.effort, row.effort_deviation),
            torque(if self.known { row.torque_error } else { Some(row.torque_residual) }),
        ];
        if self.hunting {
            cells.push(row.limit_cycle.map_or("none".to_owned(), |cycle| {
                let of = if cycle.repetitions < self.repetitions as usize {
                    format!(", in {} of {}", cycle.repetitions, self.repetitions)
                } else {
                    String::new()
                };
                format!("{:.4} rad, {:.2} s{of}", cycle.amplitude, cycle.period)
            }));
        }
        cells
    }
}

/// Until when a task is worth a picture \[s\]: of a step, while the slowest response is more than a
/// twentieth of it away, and as long again; of any other motion to its end.
fn worth_showing(traces: &[(Arm, Trace)]) -> f64 {
    const SETTLED: f64 = 0.05;
    let Some((_, first)) = traces.first() else { return f64::INFINITY };
    // The reference may begin at zero.
    let level = first.reference.last().copied().unwrap_or(0.0);
    let is_step =
        level != 0.0 && first.reference.iter().skip(1).all(|&reference| reference == level);
    let moving = |trace: &Trace| {
        let away = trace.error.iter().rposition(|error| error.abs() > SETTLED * level.abs());
        away.and_then(|last| trace.t.get(last)).copied().unwrap_or(0.0)
    };
    let longest = traces.iter().map(|(_, trace)| moving(trace)).fold(0.0, f64::max);
    if is_step && longest > 0.0 { 2.0 * longest } else { f64::INFINITY }
}

/// Reference, response, error, friction and voltage over time.
pub(super) fn tracking_figure(title: &str, mode: ControlMode, traces: &[(Arm, Trace)]) -> Figure {
    let (quantity, unit) = match mode {
        ControlMode::Velocity => ("velocity", "rad/s"),
        ControlMode::Position => ("position", "rad"),
    };
    let until = worth_showing(traces);
    let line = |name: String, trace: &Trace, y: &[f64], style| {
        let shown = trace.t.partition_point(|&t| t <= until).min(y.len());
        Drawn::Line { name, x: trace.t[..shown].to_vec(), y: y[..shown].to_vec(), style }
    };
    let whole =
        traces.iter().filter_map(|(_, trace)| trace.t.last()).fold(0.0, |a: f64, t| a.max(*t));
    let part = if until < whole {
        format!(
            " Shown are the first {} of {} s; nothing but noise comes after.",
            numbers::plain(until, 2),
            numbers::plain(whole, 3)
        )
    } else {
        String::new()
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
        friction.push(line(
            format!("measured ({arm})"),
            last,
            &last.friction_measured,
            LineStyle::Faint,
        ));
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
        caption: format!(
            "First repetition of each compensation: reference and response, error of the shaft, friction as measured, as it truly is \
             and as each observer estimates it, and the voltage of the motor.{part}"
        ),
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

#[cfg(test)]
mod tests {
    use super::*;

    fn trace(response: impl Fn(f64) -> f64, reference: impl Fn(f64) -> f64) -> (Arm, Trace) {
        let t: Vec<f64> = (0..3000).map(|k| 0.01 * f64::from(k)).collect();
        let trace = Trace {
            reference: t.iter().map(|&t| reference(t)).collect(),
            response: t.iter().map(|&t| response(t)).collect(),
            error: t.iter().map(|&t| reference(t) - response(t)).collect(),
            friction_measured: vec![0.1; t.len()],
            friction_true: vec![0.1; t.len()],
            friction_estimated: vec![0.1; t.len()],
            voltage: vec![1.0; t.len()],
            t,
        };
        (Arm::None, trace)
    }

    #[test]
    fn of_a_step_that_settles_soon_the_beginning_is_shown() {
        let fast = trace(|t| 1.0 - (-t / 0.1).exp(), |_| 1.0);
        let figure = tracking_figure("Regulation", ControlMode::Velocity, &[fast]);
        let Some(Drawn::Line { x, y, .. }) = figure.panels[1].traces.first() else {
            panic!("no error")
        };
        assert!((0.3..1.0).contains(&x[x.len() - 1]), "{}", x[x.len() - 1]);
        assert_eq!(x.len(), y.len());
        assert!(figure.caption.contains("of 30 s"), "{}", figure.caption);
        // What hunts, and what follows a moving reference, is shown to its end.
        for whole in
            [trace(|t| 1.0 - 0.2 * t.sin(), |_| 1.0), trace(|t| t.sin(), |t| 1.01 * t.sin())]
        {
            let figure = tracking_figure("Tracking", ControlMode::Velocity, &[whole]);
            let Some(Drawn::Line { x, .. }) = figure.panels[1].traces.first() else {
                panic!("no error")
            };
            assert_eq!(x.len(), 3000);
        }
    }
}
