//! What a file holds as a page.

use recording::column::Channel;
use recording::overview::{Overview, Seen};
use report::figure::{Block, Figure, LineStyle, Page, Panel, Table, Trace};

use super::prospects::prospects;
use super::terminal::{channels, of_times, written};

/// Markers a cloud of points is thinned to.
const CLOUD: usize = 3000;

/// The page.
#[must_use]
pub fn page(seen: &Overview) -> Page {
    let name = seen.path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into());
    let mut blocks: Vec<Block> = seen.problems.iter().cloned().map(Block::Note).collect();
    blocks.extend(written(seen).into_iter().map(Block::Text));
    blocks.extend(seen.times.iter().flat_map(of_times).map(Block::Text));
    blocks.push(Block::Table(Table {
        title: "What was understood".to_owned(),
        caption: "Ranges and steps in SI units.".to_owned(),
        columns: ["channel", "column", "unit", "range", "step"].map(str::to_owned).to_vec(),
        rows: channels(seen).into_iter().map(|row| row.to_vec()).collect(),
        highlight: None,
    }));
    let found = prospects(seen);
    for (title, lines) in [("Can be identified", found.can), ("Is missing", found.missing)] {
        if !lines.is_empty() {
            blocks.push(Block::Heading(title.to_owned()));
            blocks.extend(lines.into_iter().map(Block::Text));
        }
    }
    blocks.extend(over_time(seen).map(Block::Figure));
    blocks.extend(over_velocity(seen).map(Block::Figure));
    Page {
        title: "What the recording holds".to_owned(),
        subtitle: format!(
            "{name}, {} samples; frictionlab {}",
            seen.samples,
            env!("CARGO_PKG_VERSION")
        ),
        blocks,
    }
}

fn label(seen: &Seen) -> String {
    format!("{} [{}]", seen.channel.describe(), seen.channel.unit())
}

fn over_time(seen: &Overview) -> Option<Figure> {
    let times = seen.times.as_ref()?;
    let panel = |seen: &Seen| Panel {
        y_label: label(seen),
        traces: vec![Trace::Line {
            name: seen.name.clone(),
            x: times.values.clone(),
            y: seen.values.clone(),
            style: LineStyle::Solid,
        }],
    };
    let steps: Vec<f64> = times.values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut panels: Vec<Panel> =
        seen.channels.iter().filter(|seen| seen.channel != Channel::Time).map(panel).collect();
    panels.push(Panel {
        y_label: "time step [s]".to_owned(),
        traces: vec![Trace::Line {
            name: "time step".to_owned(),
            x: times.values.iter().skip(1).copied().collect(),
            y: steps,
            style: LineStyle::Solid,
        }],
    });
    Some(Figure {
        title: "The recording over time".to_owned(),
        caption: "Each channel as it was understood, in SI units, and the steps of the time."
            .to_owned(),
        x_label: "time [s]".to_owned(),
        log_x: false,
        panels,
    })
}

fn over_velocity(seen: &Overview) -> Option<Figure> {
    let (velocity, force) = (seen.channel(Channel::Velocity)?, seen.channel(Channel::Force)?);
    let every = velocity.values.len().div_ceil(CLOUD).max(1);
    let thin = |values: &[f64]| values.iter().copied().step_by(every).collect::<Vec<_>>();
    Some(Figure {
        title: "Force against velocity".to_owned(),
        caption: "As recorded, inertia and load included.".to_owned(),
        x_label: label(velocity),
        log_x: false,
        panels: vec![Panel {
            y_label: label(force),
            traces: vec![Trace::Points {
                name: force.name.clone(),
                x: thin(&velocity.values),
                y: thin(&force.values),
                error: None,
            }],
        }],
    })
}
