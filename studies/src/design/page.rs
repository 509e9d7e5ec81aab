//! `report.html` as data.

use super::Assessment;
use super::terminal::{gains, law_name, margin_rows, step_rows, verdicts, worth_rows};
use super::worth::sentences;
use report::figure::{Block, Figure, LineStyle, Page, Panel, Table, Trace};
use report::numbers::plain;

/// The page.
#[must_use]
pub fn page(found: &Assessment) -> Page {
    let options = &found.options;
    let drive = &options.linear.drive;
    let text = |text: String| Block::Text(text);
    let table = |title: &str, caption: &str, columns: &[&str], rows: Vec<Vec<String>>| {
        Block::Table(Table {
            title: title.to_owned(),
            caption: caption.to_owned(),
            columns: columns.iter().map(|&column| column.to_owned()).collect(),
            rows,
            highlight: None,
        })
    };
    let mut blocks = vec![
        Block::Heading("Gains and step response".to_owned()),
        table(
            "Gains",
            "As they stand in controller.yaml.",
            &["gain", "value"],
            gains(&options.linear.law).iter().map(|row| row.to_vec()).collect(),
        ),
        Block::Figure(step(found)),
        table(
            "Step response",
            "The discrete controller on the drive without friction and without a voltage limit.",
            &["figure", "value"],
            step_rows(found).iter().map(|row| row.to_vec()).collect(),
        ),
        Block::Heading("Margins".to_owned()),
        Block::Figure(bode(found)),
        table(
            "Margins",
            "Continuous in time, and as the loop runs: sampled, with the voltage held for a period.",
            &["margin", "continuous", "sampled"],
            margin_rows(found).iter().map(|row| row.to_vec()).collect(),
        ),
        Block::Heading("Under friction".to_owned()),
    ];
    blocks.extend(verdicts(found).into_iter().map(text));
    if let Some(worth) = &found.worth {
        blocks.push(Block::Heading("On the rig".to_owned()));
        blocks.push(table(
            "A sine followed under friction",
            "Simulated with this drive, the test bed's friction and the noise of its sensors, without compensation.",
            &["figure", "this design", "default gains"],
            worth_rows(worth).iter().map(|row| row.to_vec()).collect(),
        ));
        blocks.extend(sentences(found).into_iter().map(text));
    }
    Page {
        title: format!("Design: {}", law_name(&options.linear.law)),
        subtitle: format!(
            "K = {} rad/s per V, T = {} s, {} V per N m, period {} s; from {}; frictionlab {}",
            plain(drive.gain, 6),
            plain(drive.time_constant, 6),
            plain(options.volts_per_newton_metre, 6),
            plain(options.period, 6),
            options.asked,
            env!("CARGO_PKG_VERSION")
        ),
        blocks,
    }
}

fn line(name: &str, x: &[f64], y: &[f64], style: LineStyle) -> Trace {
    Trace::Line { name: name.to_owned(), x: x.to_vec(), y: y.to_vec(), style }
}

/// How much of the response is worth a picture \[s\]: what moves. The slow end, in which a lag or
/// an integral creeps into the last two per cent, is in the table.
fn shown(found: &Assessment) -> f64 {
    const RISES: f64 = 8.0;
    let first = found.figures.first().map(|(_, figures)| figures);
    let settled = first.and_then(|figures| figures.settling_time).unwrap_or(f64::INFINITY);
    let rise = first.and_then(|figures| figures.rise_time).unwrap_or(f64::INFINITY);
    (1.2 * settled).min(RISES * rise).max(0.0)
}

fn step(found: &Assessment) -> Figure {
    let response = &found.response;
    let samples = (shown(found) / response.period).ceil() as usize + 2;
    let time: Vec<f64> =
        (0..response.output.len().min(samples)).map(|k| k as f64 * response.period).collect();
    let n = time.len();
    let final_value = vec![response.final_value; n];
    let edges = |sign: f64| vec![response.final_value * (1.0 + sign * 0.02); n];
    Figure {
        title: "Response to a step of the reference of 1".to_owned(),
        caption: "The band is 2 % around the final value.".to_owned(),
        x_label: "time [s]".to_owned(),
        log_x: false,
        panels: vec![
            Panel {
                y_label: "response [-]".to_owned(),
                traces: vec![
                    Trace::Band {
                        name: "2 %".to_owned(),
                        x: time.clone(),
                        lower: edges(-1.0),
                        upper: edges(1.0),
                    },
                    line("final value", &time, &final_value, LineStyle::Dashed),
                    line("response", &time, &response.output[..n], LineStyle::Solid),
                ],
            },
            Panel {
                y_label: "voltage [V]".to_owned(),
                traces: vec![line(
                    "voltage",
                    &time,
                    &response.voltage[..n.min(response.voltage.len())],
                    LineStyle::Solid,
                )],
            },
        ],
    }
}

fn bode(found: &Assessment) -> Figure {
    let bode = &found.bode;
    let panel = |y_label: &str, continuous: &[f64], sampled: &[f64], limit: f64| Panel {
        y_label: y_label.to_owned(),
        traces: vec![
            line(
                "crossing",
                &bode.frequency,
                &vec![limit; bode.frequency.len()],
                LineStyle::Dotted,
            ),
            line("continuous", &bode.frequency, continuous, LineStyle::Dashed),
            line("sampled", &bode.frequency, sampled, LineStyle::Solid),
        ],
    };
    Figure {
        title: "Open loop".to_owned(),
        caption: "Crossover is where the gain passes 0 dB; the phase margin is the phase's distance from -180 degrees there.".to_owned(),
        x_label: "frequency [rad/s]".to_owned(),
        log_x: true,
        panels: vec![
            panel("gain [dB]", &bode.continuous.0, &bode.sampled.0, 0.0),
            panel("phase [degrees]", &bode.continuous.1, &bode.sampled.1, -180.0),
        ],
    }
}
