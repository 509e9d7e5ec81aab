//! `report.html` as data: one part for whoever decides, one for whoever wants to know.

use friction_ident::statistics::root_mean_square;
use report::figure::{Block, Figure, LineStyle, Page, Panel, Table, Trace};
use report::numbers::significant;

use super::Found;
use super::summary::{arm, drift, ending, margin, proved, velocity};
use super::{first_page, structure, worth};
use crate::Ranged;
use crate::axis::Known;
use crate::friction::wanted::Wanted;

/// The page; results are in `folder`.
pub(super) fn page(found: &Found, known: &Known, wanted: &Wanted, folder: &str) -> Page {
    let text = |text: String| Block::Text(text);
    let friction = &found.friction;
    let mut blocks = first_page::blocks(found, known, folder);
    blocks.extend([
        Block::Heading("For the expert: what was found".to_owned()),
        text(format!("Proof: {}.", proved(&found.proof))),
        text(format!("Fed forward: {}.", arm(found.control.arm))),
        text(format!("Margin: {}.", margin(found))),
        text(format!("Friction: {}.", ending(friction, wanted))),
    ]);
    blocks.extend(friction.change.map(|change| Block::Note(format!("Drift: {}.", drift(change)))));
    blocks.extend([table(found), Block::Figure(curve(found))]);
    blocks.extend(structure::blocks(found));
    blocks.extend([
        Block::Heading("Control".to_owned()),
        arms(found),
        text(format!(
            "All arms have the same loop: K_p {}, K_i {}, K_d {}, sensitivity peak {}, {} V of noise from the encoder's steps. They differ in what the reference adds, so that robustness and noise are equal.",
            significant(found.control.design.gains.k_p, 4),
            significant(found.control.design.gains.k_i, 4),
            significant(found.control.design.gains.k_d, 4),
            significant(found.control.design.sensitivity_peak, 3),
            significant(found.control.design.noise, 2)
        )),
    ]);
    blocks.extend(worth::blocks(&found.control));
    blocks.extend([
        text(format!("Velocity loop: {}.", velocity(found))),
        text("Not measured: pre-sliding stiffness, frictional lag, the width of a play, torque in N m. `frictionlab run characterise` and `frictionlab identify` measure them.".to_owned()),
    ]);
    Page {
        title: "Commission".to_owned(),
        subtitle: format!(
            "{}, {:.0} s of rig time, voltage and encoder alone; frictionlab {}",
            found.rig,
            found.seconds,
            env!("CARGO_PKG_VERSION")
        ),
        blocks,
    }
}

fn of(title: &str, caption: &str, columns: &[&str], rows: Vec<Vec<String>>) -> Block {
    let columns = columns.iter().map(|&column| column.to_owned()).collect();
    let (title, caption) = (title.to_owned(), caption.to_owned());
    Block::Table(Table { title, caption, columns, rows, highlight: None })
}

fn table(found: &Found) -> Block {
    let curve = &found.chosen.curve;
    let end = |end: Option<f64>| end.map_or("open".to_owned(), |end| significant(end, 4));
    let row = |name: &str, unit: &str, ranged: &Ranged| {
        vec![
            name.to_owned(),
            significant(ranged.value, 4),
            unit.to_owned(),
            end(ranged.low),
            end(ranged.high),
        ]
    };
    let rows = vec![
        row("gain K, bearings included", "rad/s per V", &found.drive.gain),
        row("time constant T", "s", &found.drive.time_constant),
        row("delay", "s", &found.drive.delay),
        row("Coulomb friction f_c", "V", &curve.f_c),
        row("static friction f_s", "V", &curve.f_s),
        row("Stribeck velocity v_s", "rad/s", &curve.v_s),
        row("back-EMF and viscous friction, 1/K", "V s/rad", &curve.slope),
    ];
    of(
        "Parameters",
        "With 95 % intervals. Friction is told in volts at the motor.",
        &["parameter", "value", "unit", "low", "high"],
        rows,
    )
}

fn arms(found: &Found) -> Block {
    let row = |(arm, errors): &(crate::bed::Arm, Vec<f64>)| {
        vec![arm.to_string(), significant(1e3 * root_mean_square(errors), 3)]
    };
    of(
        "What is fed forward",
        "Root mean square error of a slow sine with reversals, by the encoder.",
        &["arm", "error [mrad]"],
        found.control.errors.iter().map(row).collect(),
    )
}

fn curve(found: &Found) -> Figure {
    let points = &found.friction.points;
    let fastest = points.iter().map(|point| point.velocity).fold(0.0, f64::max);
    let slowest = points.iter().map(|point| point.velocity).fold(fastest, f64::min);
    let velocities: Vec<f64> =
        (0..=100).map(|i| slowest * (fastest / slowest).powf(f64::from(i) / 100.0)).collect();
    let less = |velocity: f64| found.chosen.curve.slope.value * velocity;
    let held_back = &found.chosen.held_back;
    let of = |name: &str, points: &[crate::friction::Point]| Trace::Points {
        name: name.to_owned(),
        x: points.iter().map(|point| point.velocity).collect(),
        y: points.iter().map(|point| point.volts - less(point.velocity)).collect(),
        error: None,
    };
    let fitted = Trace::Line {
        name: "curve".to_owned(),
        y: velocities.iter().map(|&v| found.chosen.curve.volts(v) - less(v)).collect(),
        x: velocities,
        style: LineStyle::Solid,
    };
    Figure {
        title: "Friction over speed".to_owned(),
        caption: "Voltage less what the slope 1/K takes. The points that were held back had no part in the curve.".to_owned(),
        x_label: "speed [rad/s]".to_owned(),
        log_x: true,
        panels: vec![Panel {
            y_label: "friction [V]".to_owned(),
            traces: vec![of("measured", points), of("held back", held_back), fitted],
        }],
    }
}
