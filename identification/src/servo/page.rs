//! `report.html` of a servo.

use friction_ident::servo::TIME_STEP;

use super::logs::NamedServoLog;
use super::terminal::{number, quartiles, range, verdict};
use super::{PEER_RATE, ServoIdentification};
use report::figure::{Block, Figure, LineStyle, Mark, Page, Panel, Table, Trace};
use report::numbers;

/// The page.
pub fn page(
    found: &ServoIdentification,
    train: &[NamedServoLog],
    held_out: &[NamedServoLog],
) -> Page {
    let best = &found.seeds[found.best];
    let mut blocks = vec![
        Block::Text(format!(
            "A servo with a pendulum was simulated again and again with other parameters until its position followed the logs. \
             Mean position error over {}, median (quartiles): {} mrad on the logs fitted{}.",
            numbers::searches(found.seeds.len()),
            quartiles(&found.train),
            found.held_out.as_ref().map_or_else(String::new, |held| format!(
                ", {} mrad on the logs held out, which no search saw",
                quartiles(held)
            ))
        )),
        Block::Text(format!(
            "{:.0} simulations of all fitted logs a second and thread in the search, which gives hopeless candidates up early; \
             {:.0} where every one goes to its end, {:.0} times the {PEER_RATE} of bam.",
            found.rate,
            found.whole_rate,
            found.whole_rate / PEER_RATE
        )),
    ];
    if let Some(failure) = found.failure() {
        blocks.insert(
            0,
            Block::Note(format!("The fit has failed: {failure}. No parameter is identified.")),
        );
    }
    for note in &found.settings.notes {
        blocks.push(Block::Note(format!("{note}.")));
    }
    if found.stopped {
        blocks.push(Block::Note("Stopped before the end: the searches did not finish.".to_owned()));
    }
    blocks.push(Block::Table(parameters(found)));
    blocks.push(Block::Table(logs(found, train, held_out)));
    blocks.push(Block::Figure(spread(found)));
    blocks.push(Block::Heading("Measured and simulated".to_owned()));
    let fitted = train.iter().zip(&found.train_positions).map(|(log, q)| (log, q, "fitted"));
    let others =
        held_out.iter().zip(&found.held_out_positions).map(|(log, q)| (log, q, "held out"));
    for (log, simulated, role) in others.chain(fitted) {
        blocks.push(Block::Figure(positions(log, simulated, role)));
    }
    Page {
        title: "Identified servo".to_owned(),
        subtitle: format!(
            "servo {}, level {}, {}, least training error at seed {}; frictionlab {}",
            found.settings.servo,
            found.settings.level.name(),
            match found.seeds.len() {
                0 | 1 => format!("seed {}", found.settings.first_seed),
                several => format!(
                    "seeds {} to {}",
                    found.settings.first_seed,
                    found.settings.first_seed + (several as u64 - 1)
                ),
            },
            best.seed,
            env!("CARGO_PKG_VERSION")
        ),
        blocks,
    }
}

fn parameters(found: &ServoIdentification) -> Table {
    let rows = found
        .estimates
        .parameters
        .iter()
        .map(|estimate| {
            vec![
                estimate.id.to_string(),
                number(estimate.value),
                estimate.unit.to_owned(),
                range(estimate),
                verdict(estimate),
            ]
        })
        .collect();
    Table {
        title: "Parameters".to_owned(),
        caption: "Of the search with the least error on the logs fitted. The 95 % interval comes from fits of disjoint halves \
                  of the logs, and holds all searches that fit within 10 % as well: a parameter that either disagree on is \
                  not determined by these logs."
            .to_owned(),
        columns: ["parameter", "value", "unit", "95 % interval", "verdict"].map(str::to_owned).to_vec(),
        rows,
        highlight: None,
    }
}

fn logs(found: &ServoIdentification, train: &[NamedServoLog], held_out: &[NamedServoLog]) -> Table {
    let row = |(log, error): (&NamedServoLog, &f64), role: &str| {
        vec![log.title(), role.to_owned(), format!("{:.1}", 1e3 * error)]
    };
    let mut rows: Vec<_> =
        train.iter().zip(&found.train_logs).map(|pair| row(pair, "fitted")).collect();
    rows.extend(held_out.iter().zip(&found.held_out_logs).map(|pair| row(pair, "held out")));
    Table {
        title: "Error of each log".to_owned(),
        caption: "Mean of |simulated - measured| position over the log, with the parameters above."
            .to_owned(),
        columns: ["log", "role", "error [mrad]"].map(str::to_owned).to_vec(),
        rows,
        highlight: None,
    }
}

fn spread(found: &ServoIdentification) -> Figure {
    let seeds: Vec<String> = found.seeds.iter().map(|result| result.seed.to_string()).collect();
    let points = |name: &str, y: Vec<f64>| Trace::Categories {
        name: name.to_owned(),
        x: seeds.clone(),
        y,
        mark: Mark::Marker,
    };
    let mut traces =
        vec![points("fitted", found.seeds.iter().map(|result| 1e3 * result.found.error).collect())];
    if found.held_out.is_some() {
        let held =
            found.seeds.iter().map(|result| result.held_out.map_or(f64::NAN, |error| 1e3 * error));
        traces.push(points("held out", held.collect()));
    }
    Figure {
        title: "Error of each search".to_owned(),
        caption: "Searches from other seeds end in other minima. Where the held-out errors scatter and the fitted ones do not, \
                  the logs fitted do not decide between these minima."
            .to_owned(),
        x_label: "seed".to_owned(),
        log_x: false,
        panels: vec![Panel { y_label: "mean position error [mrad]".to_owned(), traces }],
    }
}

fn positions(log: &NamedServoLog, simulated: &[f64], role: &str) -> Figure {
    let time: Vec<f64> = (0..log.log.samples()).map(|k| k as f64 * TIME_STEP).collect();
    let line = |name: &str, y: &[f64], style| Trace::Line {
        name: name.to_owned(),
        x: time.clone(),
        y: y.to_vec(),
        style,
    };
    Figure {
        title: format!("{} ({role})", log.title()),
        caption: "Position asked for, measured and simulated from the first sample on without correction."
            .to_owned(),
        x_label: "time [s]".to_owned(),
        log_x: false,
        panels: vec![Panel {
            y_label: "position [rad]".to_owned(),
            traces: vec![
                line("goal", log.log.goal(), LineStyle::Dashed),
                line("measured", log.log.position(), LineStyle::Solid),
                line("simulated", simulated, LineStyle::Solid),
            ],
        }],
    }
}
