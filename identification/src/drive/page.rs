//! `identification-drive.html`.

use super::{Identified, rows};
use report::figure::{Block, Figure, LineStyle, Page, Panel, Table, Trace};
use report::numbers;

/// The page.
pub fn page(found: &Identified) -> Page {
    let mut blocks = vec![Block::Heading("What was found".to_owned())];
    blocks.extend(found.notes().into_iter().map(Block::Note));
    blocks.push(Block::Table(Table {
        title: "The drive".to_owned(),
        caption: "T w' + w = K (u(t - delay) - friction in volts). Intervals count the residual by the share of its samples that is independent."
            .to_owned(),
        columns: ["quantity", "value", "unit", "95 % interval", "verdict"].map(str::to_owned).to_vec(),
        rows: rows(&found.estimates).into_iter().map(|row| row.to_vec()).collect(),
        highlight: None,
    }));
    for (path, fit) in &found.fits {
        blocks.push(Block::Heading(
            path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
        ));
        let line = |name: &str, y: Vec<f64>, style| Trace::Line {
            name: name.to_owned(),
            x: fit.time.clone(),
            y,
            style,
        };
        let starts = match fit.breakaways.len() {
            0 => "The axis never started from rest.".to_owned(),
            1 => "Point: where the axis left its rest.".to_owned(),
            n => format!("Points: where the axis left its rest, {n} times."),
        };
        let residual = fit.measured.iter().zip(&fit.predicted).map(|(a, b)| a - b).collect();
        blocks.push(Block::Figure(Figure {
            title: "Voltage, measured and from the drive's equation".to_owned(),
            caption: format!(
                "Above, both; below, their difference ({:.2} % of the voltage). {starts}",
                fit.relative_error,
            ),
            x_label: "time [s]".to_owned(),
            log_x: false,
            panels: vec![
                Panel {
                    y_label: "voltage [V]".to_owned(),
                    traces: vec![
                        line("measured", fit.measured.clone(), LineStyle::Solid),
                        line("predicted", fit.predicted.clone(), LineStyle::Dashed),
                        Trace::Points {
                            name: "start out of rest".to_owned(),
                            x: fit.breakaways.iter().map(|b| b.time).collect(),
                            y: fit.breakaways.iter().map(|b| b.voltage).collect(),
                            error: None,
                        },
                    ],
                },
                Panel {
                    y_label: "difference [V]".to_owned(),
                    traces: vec![line("difference", residual, LineStyle::Solid)],
                },
            ],
        }));
    }
    Page {
        title: "Identified drive".to_owned(),
        subtitle: format!(
            "{}; frictionlab {}",
            numbers::count(found.fits.len(), "recording"),
            env!("CARGO_PKG_VERSION")
        ),
        blocks,
    }
}
