//! Experiments 2 to 4 in the report.

use friction_ident::TorqueSource;

use super::characterisation::{BreakawayFigures, Characterisation, ClosureFigures, LagFigures};
use super::sequence_page::smoothed;
use crate::characterise::Measured;
use report::figure::{Block, Figure, Panel, Table, Trace};

/// Sections of the experiments that were run.
pub(super) fn blocks(found: &Characterisation, source: TorqueSource) -> Vec<Block> {
    let mut blocks = Vec::new();
    let heading = |text: &str| Block::Heading(text.to_owned());
    if !found.lag.is_empty() {
        blocks.push(heading("Friction at varying velocity"));
        blocks.push(Block::Table(lag_table(&found.lag, source)));
        blocks.push(Block::Figure(lag_figure(&found.lag)));
        if found.lag.iter().any(|figures| !figures.visible()) {
            blocks.push(Block::Note(
                "A loop whose area is not clear of its uncertainty is not visible in this run. The test bed's set with a lag of 0.0011 s has loops \
                 ten times smaller than the thesis's figures, which need 0.0111 s: `--plant-parameters` takes a file with it."
                    .to_owned(),
            ));
        }
    }
    if !found.ramps.is_empty() || !found.closures.is_empty() {
        blocks.push(heading("Friction before sliding"));
        blocks.push(Block::Table(breakaway_table("Breakaway by slow ramps", &found.ramps, source)));
        if !found.path.0.is_empty() {
            blocks.push(Block::Figure(path_figure(found)));
            blocks.push(Block::Table(closure_table(&found.closures)));
        }
    }
    if !found.rates.is_empty() {
        blocks.push(heading("Breakaway against the rate of the torque"));
        blocks.push(Block::Table(breakaway_table("Breakaway and rate", &found.rates, source)));
        blocks.push(Block::Figure(rate_figure(&found.rates)));
    }
    blocks.extend(found.notes.iter().cloned().map(Block::Note));
    blocks
}

/// What the columns of uncertainty mean.
fn caption(source: TorqueSource) -> String {
    let from = match source {
        TorqueSource::Sensor => {
            "The torque is the sensor's; nothing is added by the drive's constants.".to_owned()
        }
        _ => format!(
            "The torque is worked out of the motor's {}; \"by constants\" is the standard deviation that the errors of the drive's constants \
             add, the same in every repetition.",
            source.name()
        ),
    };
    format!(
        "Mean over the repetitions, its standard error, and the middle half of the repetitions, between their quartiles. {from}"
    )
}

fn columns(heads: &[&str]) -> Vec<String> {
    heads.iter().map(|&head| head.to_owned()).collect()
}

/// Mean, standard error, quartiles and systematic part as cells.
fn cells(figure: &Measured, digits: usize) -> [String; 4] {
    let number = |value: f64| match digits {
        0 => format!("{value:.3e}"),
        _ => format!("{value:.digits$}"),
    };
    let [lower, _, upper] = figure.quartiles.map(number);
    [
        number(figure.mean),
        figure.standard_error.map_or("-".to_owned(), |error| format!("{error:.1e}")),
        format!("{lower} to {upper}"),
        if figure.systematic == 0.0 {
            "-".to_owned()
        } else {
            format!("{:.1e}", figure.systematic)
        },
    ]
}

fn lag_table(lag: &[LagFigures], source: TorqueSource) -> Table {
    let rows = lag.iter().map(|figures| {
        let mut row = vec![format!("{}", figures.frequency)];
        row.extend(cells(&figures.area, 0));
        row.push(format!("{:.1e}", figures.area_noise));
        row.push(format!("{} x {}", figures.periods, figures.area.repetitions));
        row.push(if figures.visible() { "yes" } else { "no" }.to_owned());
        row
    });
    Table {
        title: "Loop area of friction over velocity".to_owned(),
        caption: format!(
            "Closed integral of F dw over a period, above zero where friction lags. {} \"By noise\" is the standard error that the stated noise of the torque leads to.",
            caption(source)
        ),
        columns: columns(&[
            "frequency [rad/s]",
            "area [N m rad/s]",
            "standard error",
            "middle half",
            "by constants",
            "by noise",
            "periods",
            "visible (3 deviations)",
        ]),
        rows: rows.collect(),
        highlight: None,
    }
}

/// The loops, and below how far the torque lies above that at the same velocity on the way back.
fn lag_figure(lag: &[LagFigures]) -> Figure {
    let name = |figures: &LagFigures| format!("{} rad/s", figures.frequency);
    let line = |name, x: &[f64], y| Trace::Loop { name, x: x.to_vec(), y };
    let loops =
        lag.iter().map(|figures| line(name(figures), &figures.velocity, figures.torque.clone()));
    let widths =
        lag.iter().map(|figures| line(name(figures), &figures.velocity, half_widths(figures)));
    Figure {
        title: "Frictional lag".to_owned(),
        caption: "Friction torque over velocity, Fourier series of eight harmonics, mean over periods and repetitions. Below: half the difference \
                  between the torque at rising and at falling velocity."
            .to_owned(),
        x_label: "velocity [rad/s]".to_owned(),
        log_x: false,
        panels: vec![
            Panel { y_label: "friction [N m]".to_owned(), traces: loops.collect() },
            Panel { y_label: "half width [N m]".to_owned(), traces: widths.collect() },
        ],
    }
}

/// Half the difference of the torque to that at the mirrored phase about the slowest point.
fn half_widths(figures: &LagFigures) -> Vec<f64> {
    // The last point repeats the first.
    let n = figures.torque.len().saturating_sub(1);
    let velocity = figures.velocity.get(..n).unwrap_or_default();
    let slowest = (0..n).min_by(|&a, &b| velocity[a].total_cmp(&velocity[b])).unwrap_or(0);
    let at = |i: usize| figures.torque[i % n];
    (0..figures.torque.len())
        .map(|i| if n == 0 { 0.0 } else { 0.5 * (at(i) - at(2 * n + 2 * slowest - i)) })
        .collect()
}

fn breakaway_table(title: &str, figures: &[BreakawayFigures], source: TorqueSource) -> Table {
    let rows = figures.iter().map(|figures| {
        let mut row = vec![figures.excitation.clone(), format!("{:.3}", figures.rate)];
        row.extend(cells(&figures.torque, 5));
        row.push(format!("{:.5}", figures.peak.mean));
        let [mean, error, quartiles, _] = cells(&figures.displacement, 5);
        row.extend([mean, error, quartiles]);
        row
    });
    Table {
        title: title.to_owned(),
        caption: format!(
            "Torque and displacement at the onset of sliding, and the highest smoothed torque before gross motion, which noise raises. {}",
            caption(source)
        ),
        columns: columns(&[
            "excitation",
            "rate [N m/s]",
            "torque [N m]",
            "standard error",
            "middle half",
            "by constants",
            "peak [N m]",
            "displacement [rad]",
            "standard error",
            "middle half",
        ]),
        rows: rows.collect(),
        highlight: None,
    }
}

fn path_figure(found: &Characterisation) -> Figure {
    let (x, y) = found.path.clone();
    let (x, y) = (smoothed(&x), smoothed(&y));
    let line = Trace::Loop { name: "nested path".to_owned(), x, y };
    Figure {
        title: "Hysteresis before sliding".to_owned(),
        caption: "Friction torque over displacement along the nested path, mean over the repetitions and over some \
                  hundredths of the way on each side of a point; arrows show the direction."
            .to_owned(),
        x_label: "displacement [rad]".to_owned(),
        log_x: false,
        panels: vec![Panel { y_label: "friction [N m]".to_owned(), traces: vec![line] }],
    }
}

fn closure_table(closures: &[ClosureFigures]) -> Table {
    let rows = closures.iter().map(|closure| {
        let mut row = vec![
            format!("{} to {}", closure.turns.0, closure.turns.1),
            format!("{:+.3}", closure.level),
        ];
        let [gap, error, quartiles, _] = cells(&closure.gap, 0);
        row.extend([gap, error, quartiles]);
        row.extend(cells(&closure.work, 0));
        row
    });
    Table {
        title: "Closed loops of the path".to_owned(),
        caption: "Each line is a pair of turns at one torque between which the path stayed inside. Hysteresis with non-local memory closes: the gap in \
                  displacement is zero within its standard error. The work is what the loop takes."
            .to_owned(),
        columns: columns(&[
            "turns",
            "level [N m]",
            "gap [rad]",
            "standard error",
            "middle half",
            "work [J]",
            "standard error",
            "middle half",
            "by constants",
        ]),
        rows: rows.collect(),
        highlight: None,
    }
}

fn rate_figure(rates: &[BreakawayFigures]) -> Figure {
    let points = |name: &str, kind: &str, value: fn(&BreakawayFigures) -> &Measured| {
        let of: Vec<&BreakawayFigures> =
            rates.iter().filter(|figures| figures.excitation.starts_with(kind)).collect();
        Trace::Points {
            name: name.to_owned(),
            x: of.iter().map(|figures| figures.rate).collect(),
            y: of.iter().map(|figures| value(figures).mean).collect(),
            error: Some(of.iter().map(|figures| value(figures).half_spread()).collect()),
        }
    };
    Figure {
        title: "Breakaway against rate".to_owned(),
        caption: "Friction torque at the onset of sliding, highest torque before gross motion, and displacement at the onset, against the rate of the \
                  driving torque at the onset; bars are half the distance of the quartiles of the repetitions."
            .to_owned(),
        x_label: "rate of the torque [N m/s]".to_owned(),
        log_x: true,
        panels: vec![
            Panel {
                y_label: "torque [N m]".to_owned(),
                traces: vec![
                    points("ramps, at the onset", "ramp", |figures| &figures.torque),
                    points("sines, at the onset", "sine", |figures| &figures.torque),
                    points("ramps, peak", "ramp", |figures| &figures.peak),
                ],
            },
            Panel {
                y_label: "displacement [rad]".to_owned(),
                traces: vec![
                    points("ramps, at the onset", "ramp", |figures| &figures.displacement),
                    points("sines, at the onset", "sine", |figures| &figures.displacement),
                ],
            },
        ],
    }
}
