//! `report.html` of a stiction limit cycle.

use friction_ident::{Estimate, IdentError};

use super::{Settings, StictionIdentification, UNKNOWN, voltages};
use crate::servo::terminal::{number, range, verdict};
use recording::stiction_table::StictionTable;
use report::figure::{Block, Figure, LineStyle, Page, Panel, Table, Trace};
use report::numbers;
use report::smooth::one_cycle;

/// The page.
pub fn page(found: &StictionIdentification, tables: &[StictionTable]) -> Page {
    let mut blocks = vec![
        Block::Text(
            "The axis is held at a fixed reference and does not come to rest: it sticks until the controller's voltage overcomes \
             static friction, slips, and sticks again. All friction is given in volts on the motor, the unit that was recorded."
                .to_owned(),
        ),
        Block::Table(parameters("Breakaway voltage", "Median over all recordings; the interval holds the median with 95 %, from the \
            ranks of the values alone.", &found.breakaway)),
        Block::Table(quartiles(found, tables)),
        Block::Figure(distribution(found)),
        Block::Heading("What these recordings cannot say".to_owned()),
    ];
    blocks.extend(UNKNOWN.map(|unknown| Block::Note(unknown.to_owned())));
    for (index, table) in tables.iter().enumerate() {
        let Some(episode) = found.episodes.get(index) else { continue };
        blocks.push(Block::Heading(name(table)));
        blocks.push(Block::Figure(cycle(table, &found.settings)));
        blocks.push(Block::Figure(over_time(table, &found.settings)));
        match &episode.slip {
            Ok(slip) => {
                blocks.push(Block::Table(parameters(
                    "Friction while it slides",
                    &format!(
                        "u(t - delay) = inertia a + speed v + coulomb sign(v) + offset + pendulum alpha over {} samples of the driven motion; \
                         {:.1} % of the voltage is unexplained (root mean square). Every interval runs over all delays that explain the voltage \
                         about as well, and counts neighbouring residuals as alike as they are.",
                        slip.samples,
                        100.0 * slip.unexplained
                    ),
                    slip.estimates.parameters.iter().chain([&slip.delay]),
                )));
                blocks.push(Block::Figure(friction(&slip.speed, &slip.friction)));
            }
            Err(error) => blocks.push(Block::Note(refused(error))),
        }
    }
    Page {
        title: "Friction from the stiction limit cycle".to_owned(),
        subtitle: format!(
            "{}; frictionlab {}",
            numbers::count(tables.len(), "recording"),
            env!("CARGO_PKG_VERSION")
        ),
        blocks,
    }
}

fn refused(error: &IdentError) -> String {
    format!("Friction while it slides was not found: {error}.")
}

fn name(table: &StictionTable) -> String {
    table.path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

fn parameters<'a>(
    title: &str,
    caption: &str,
    estimates: impl IntoIterator<Item = &'a Estimate>,
) -> Table {
    let row = |estimate: &Estimate| {
        vec![
            estimate.id.to_string(),
            number(estimate.value),
            estimate.unit.to_owned(),
            range(estimate),
            verdict(estimate),
        ]
    };
    Table {
        title: title.to_owned(),
        caption: caption.to_owned(),
        columns: ["parameter", "value", "unit", "95 % interval", "verdict"]
            .map(str::to_owned)
            .to_vec(),
        rows: estimates.into_iter().map(row).collect(),
        highlight: None,
    }
}

fn quartiles(found: &StictionIdentification, tables: &[StictionTable]) -> Table {
    let mut rows = Vec::new();
    for (table, episode) in tables.iter().zip(&found.episodes) {
        for ((direction, sign), quartiles) in
            [("forward", 1.0), ("backward", -1.0)].into_iter().zip(&episode.quartiles)
        {
            let count = voltages(&episode.breakaways, sign).len().to_string();
            let cells = quartiles.map_or([const { String::new() }; 3], |q| {
                [q.lower, q.median, q.upper].map(|v| format!("{v:.3}"))
            });
            rows.push(
                [name(table), direction.to_owned(), count].into_iter().chain(cells).collect(),
            );
        }
    }
    Table {
        title: "Breakaways of each recording".to_owned(),
        caption: "Quartiles of the voltage that stood when the axis let go. Recordings that disagree by more than their quartiles show \
                  that friction, or what shakes the axis, changed between them."
            .to_owned(),
        columns: ["recording", "direction", "breakaways", "lower quartile [V]", "median [V]", "upper quartile [V]"]
            .map(str::to_owned)
            .to_vec(),
        rows,
        highlight: None,
    }
}

/// Share of the breakaways below each voltage.
fn distribution(found: &StictionIdentification) -> Figure {
    let curve = |direction: f64,
                 name: &str,
                 of: fn(&friction_ident::stiction_cycle::Breakaway) -> f64,
                 style| {
        let mut x: Vec<f64> = found
            .episodes
            .iter()
            .flat_map(|episode| &episode.breakaways)
            .filter(|b| b.direction == direction)
            .map(of)
            .filter(|v| v.is_finite())
            .collect();
        x.sort_by(f64::total_cmp);
        let n = x.len().max(1) as f64;
        let y = (1..=x.len()).map(|k| k as f64 / n).collect();
        Trace::Line { name: name.to_owned(), x, y, style }
    };
    Figure {
        title: "Voltages withstood and voltages at breakaway".to_owned(),
        caption: "Share of the rests whose voltage lies below. Static friction lies between what was withstood earlier in a rest (dashed) and \
                  what stood when the axis let go."
            .to_owned(),
        x_label: "voltage towards the motion [V]".to_owned(),
        log_x: false,
        panels: vec![Panel {
            y_label: "share".to_owned(),
            traces: vec![
                curve(1.0, "breakaway forward", |b| b.voltage, LineStyle::Solid),
                curve(-1.0, "breakaway backward", |b| b.voltage, LineStyle::Solid),
                curve(1.0, "withstood forward", |b| b.withstood, LineStyle::Dashed),
                curve(-1.0, "withstood backward", |b| b.withstood, LineStyle::Dashed),
            ],
        }],
    }
}

fn range_of(table: &StictionTable, settings: &Settings) -> std::ops::Range<usize> {
    let sample = |time: f64| ((time / table.time_step).round() as usize).min(table.angle.len());
    let from = sample(settings.from);
    from..sample(settings.until).max(from)
}

fn cycle(table: &StictionTable, settings: &Settings) -> Figure {
    let all = range_of(table, settings);
    let one = one_cycle(table.angle.get(all.clone()).unwrap_or(&[]));
    let range = all.start + one.start..all.start + one.end;
    Figure {
        title: "Voltage against displacement in the limit cycle".to_owned(),
        caption:
            "One cycle, the last of the largest. Vertical strokes are rest: the voltage moves and the axis does not. Between them it slides."
                .to_owned(),
        x_label: "angle [rad]".to_owned(),
        log_x: false,
        panels: vec![Panel {
            y_label: "voltage [V]".to_owned(),
            traces: vec![Trace::Loop {
                name: "one cycle".to_owned(),
                x: table.angle.get(range.clone()).unwrap_or(&[]).to_vec(),
                y: table.voltage.get(range).unwrap_or(&[]).to_vec(),
            }],
        }],
    }
}

fn over_time(table: &StictionTable, settings: &Settings) -> Figure {
    let range = range_of(table, settings);
    let time: Vec<f64> = range.clone().map(|k| k as f64 * table.time_step).collect();
    let panel = |label: &str, name: &str, values: &[f64]| Panel {
        y_label: label.to_owned(),
        traces: vec![Trace::Line {
            name: name.to_owned(),
            x: time.clone(),
            y: values.get(range.clone()).unwrap_or(&[]).to_vec(),
            style: LineStyle::Solid,
        }],
    };
    Figure {
        title: "The limit cycle over time".to_owned(),
        caption: "Angle in steps of the encoder, and the voltage.".to_owned(),
        x_label: "time [s]".to_owned(),
        log_x: false,
        panels: vec![
            panel("angle [rad]", "angle", &table.angle),
            panel("voltage [V]", "voltage", &table.voltage),
        ],
    }
}

fn friction(speed: &[f64], friction: &[f64]) -> Figure {
    let every = speed.len().div_ceil(1500).max(1);
    let thin = |values: &[f64]| values.iter().copied().step_by(every).collect::<Vec<_>>();
    Figure {
        title: "Voltage against speed while it slides".to_owned(),
        caption:
            "The voltage less inertia, offset and pendulum: what is left is friction and back-EMF."
                .to_owned(),
        x_label: "speed [rad/s]".to_owned(),
        log_x: false,
        panels: vec![Panel {
            y_label: "voltage [V]".to_owned(),
            traces: vec![Trace::Points {
                name: "sliding".to_owned(),
                x: thin(speed),
                y: thin(friction),
                error: None,
            }],
        }],
    }
}
