//! The first page of the report: what the axis is, whether it was worth it, what to do, and when to
//! do it again. It is for whoever decides; no word of it needs control theory.

use friction_ident::statistics::root_mean_square;
use report::figure::{Block, Figure, Mark, Panel, Table, Trace};
use report::numbers::{percent, significant};

use super::summary::rest;
use super::{Found, PARAMETERS};
use crate::axis::Known;
use crate::bed::Arm;

/// A share of the friction that may change before the shaft hunts, below which it is looked at more
/// often.
const NARROW: f64 = 1.3;

/// Its blocks; results are in `folder`.
pub(super) fn blocks(found: &Found, known: &Known, folder: &str) -> Vec<Block> {
    let mut blocks = vec![
        Block::Heading("Was it worth it?".to_owned()),
        Block::Text(worth(found)),
        Block::Figure(before_and_after(found)),
        Block::Heading("What this axis is".to_owned()),
        Block::Table(axis(found, known)),
    ];
    blocks
        .extend(found.met.noticed.iter().map(|said| Block::Note(format!("Look at this: {said}."))));
    blocks
        .extend(found.met.corrected.iter().map(|said| Block::Note(format!("Put right: {said}."))));
    blocks.extend([
        Block::Heading("What to do".to_owned()),
        Block::Text(format!(
            "Start the axis with the file that lies beside this page: `frictionlab live --rig {} --parameters {folder}/{PARAMETERS} --calibration {folder}/{PARAMETERS}`. It says all that was proven. ROS 2 nodes take the same file.",
            found.rig,
        )),
        Block::Text(format!("Then look whether it stands still after a move: {}.", rest(found))),
        Block::Heading("What to repeat, and when".to_owned()),
        Block::Table(again(found, folder)),
    ]);
    blocks
}

/// Whether what was added is worth it, in a sentence or two.
pub(crate) fn worth(found: &Found) -> String {
    let (before, after) = errors(found);
    let mrad = |error: f64| format!("{} mrad", significant(1e3 * error, 3));
    let Some(ratio) = found.proof.ratio else {
        return format!(
            "The gains that were found here are enough. Nothing that was tried on top of them made the axis clearly better, so nothing was added: it misses a slow path with reversals by {} in the mean.",
            mrad(before)
        );
    };
    let missed = format!(
        "Along a slow path with reversals the axis misses its place by {} in the mean. With the same gains alone it was {}",
        mrad(after),
        mrad(before)
    );
    match ratio.high {
        Some(high) if high < 1.0 => {
            let less = 1.0 / ratio.value;
            let at_least = 1.0 / high;
            format!(
                "Yes. {missed}: {} times as much. Repeated {} times in turns, it was at least {} times with 95 % confidence.",
                significant(less, 2),
                found.proof.pairs.len(),
                significant(at_least, 2)
            )
        }
        _ => format!(
            "Not clearly. {missed}; that is no difference that {} repetitions could tell from chance.",
            found.proof.pairs.len()
        ),
    }
}

/// Mean errors before and after \[rad\]: of the proof, else of the arms as they were tried.
fn errors(found: &Found) -> (f64, f64) {
    let pairs = &found.proof.pairs;
    if !pairs.is_empty() {
        let of = |side: fn(&(f64, f64)) -> f64| {
            root_mean_square(&pairs.iter().map(side).collect::<Vec<_>>())
        };
        return (of(|pair| pair.0), of(|pair| pair.1));
    }
    let of = |arm: Arm| {
        let of_arm = found.control.errors.iter().find(|(one, _)| *one == arm);
        of_arm.map_or(f64::NAN, |(_, errors)| root_mean_square(errors))
    };
    (of(Arm::Linear), of(found.control.arm))
}

fn before_and_after(found: &Found) -> Figure {
    let (before, after) = errors(found);
    let bar = |name: &str, error: f64| Trace::Categories {
        name: name.to_owned(),
        x: vec![name.to_owned()],
        y: vec![1e3 * error],
        mark: Mark::Bar,
    };
    let mut traces = vec![bar("the gains alone", before)];
    if found.proof.ratio.is_some() {
        traces.push(bar("as handed over", after));
    }
    Figure {
        title: "What the axis misses".to_owned(),
        caption:
            "Mean distance from a slow path with reversals, by the encoder. Shorter is better."
                .to_owned(),
        x_label: "what drives the axis".to_owned(),
        log_x: false,
        panels: vec![Panel { y_label: "error [mrad]".to_owned(), traces }],
    }
}

fn axis(found: &Found, known: &Known) -> Table {
    let Found { met, drive, friction, chosen, .. } = found;
    let curve = &chosen.curve;
    let mut rows = Vec::new();
    let mut row = |what: &str, value: String, means: String| {
        rows.push(vec![what.to_owned(), value, means]);
    };
    let share = |volts: f64| percent(100.0 * volts / known.voltage, 0);
    row(
        "starts to move",
        format!("at {} V", significant(met.deadband, 3)),
        format!(
            "{} of the {} V that are allowed",
            share(met.deadband),
            significant(known.voltage, 3)
        ),
    );
    row(
        "friction while it turns",
        curve.f_c.said("V"),
        if curve.dips {
            "less than it takes to start: a slow axis sticks and jumps if nothing is done"
                .to_owned()
        } else {
            "no more is needed to start, as far as could be seen".to_owned()
        },
    );
    let fastest = (known.voltage - curve.f_c.value).max(0.0) * drive.gain.value;
    row(
        "speed",
        drive.gain.said("rad/s per V"),
        format!(
            "about {} rad/s with the voltage that is allowed; the speed limit is {} rad/s",
            significant(fastest, 3),
            significant(known.velocity, 3)
        ),
    );
    let answer = drive.time_constant.value + drive.delay.value.max(0.0);
    row(
        "answers within",
        format!("{} ms", significant(1e3 * answer, 3)),
        "two thirds of a change of speed are done then".to_owned(),
    );
    let travel = match (&met.sought, known.travel) {
        (Some(sought), _) => sought.to_string(),
        (None, Some(travel)) => format!(
            "from {} to {} rad by its encoder, as it was told",
            significant(travel.min, 3),
            significant(travel.max, 3)
        ),
        (None, None) => "taken to turn for ever, as nothing else was said".to_owned(),
    };
    row("travel", known.travel.map_or("free".to_owned(), |_| "limited".to_owned()), travel);
    let change = match friction.change {
        Some(change) => (
            percent(100.0 * change, 1),
            "as a drive does that warms up; what is handed over is as it was at the end".to_owned(),
        ),
        None => ("none seen".to_owned(), "friction stayed what it was".to_owned()),
    };
    row("change while measured", change.0, change.1);
    Table {
        title: "The axis in plain numbers".to_owned(),
        caption: "± is the 95 % interval. Friction is told as the voltage that overcomes it."
            .to_owned(),
        columns: ["what", "value", "what it means"].map(str::to_owned).to_vec(),
        rows,
        highlight: None,
    }
}

/// What is to be repeated, on which occasion.
fn again(found: &Found, folder: &str) -> Table {
    let resume = |stage: &str| format!("frictionlab commission --resume {folder} --from {stage}");
    let narrow = found.proof.drift.is_some_and(|drift| {
        drift.friction_rises < NARROW || 1.0 / drift.friction_falls.max(0.01) < NARROW
    });
    let often = if narrow {
        "every week: a small change of friction makes it hunt, in simulation"
    } else {
        "every three months, and when it seems to miss more"
    };
    let warm = if found.friction.change.is_some() {
        "once it is as warm as at work: it changed while it was measured"
    } else {
        "when it runs much warmer or colder than today, and after new grease"
    };
    let rows = vec![
        vec![
            often.to_owned(),
            "whether it is still worth as much".to_owned(),
            resume("proof"),
            "2 min".to_owned(),
        ],
        vec![
            warm.to_owned(),
            "the friction, and all behind it".to_owned(),
            resume("friction"),
            "7 min".to_owned(),
        ],
        vec![
            "after work on bearings, gear or load".to_owned(),
            "all but signs and zeros".to_owned(),
            resume("drive"),
            "8 min".to_owned(),
        ],
        vec![
            "after another motor, encoder, amplifier or cable".to_owned(),
            "everything, in a new folder".to_owned(),
            format!("frictionlab commission --rig {}", found.rig),
            "10 min".to_owned(),
        ],
    ];
    Table {
        title: "When to measure again".to_owned(),
        caption: "The shaft turns each time; somebody stands by.".to_owned(),
        columns: ["when", "what is measured", "command", "rig time, about"]
            .map(str::to_owned)
            .to_vec(),
        rows,
        highlight: None,
    }
}
