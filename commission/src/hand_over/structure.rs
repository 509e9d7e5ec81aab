//! What depends on place and direction, and what moves came to, in words and tables.

use report::figure::{Block, Table};
use report::numbers::{percent, significant};

use super::Found;
use crate::Ranged;
use crate::structure::{Finding, Structure};

/// What was found, row by row: what, and in words.
fn rows(structure: &Structure) -> Vec<(&'static str, String)> {
    vec![
        ("one direction is stickier", said(&structure.direction, "V")),
        ("load that hangs", said(&structure.gravity, "V")),
        ("spring", said(&structure.spring, "V/rad")),
        ("ripple", ripple(structure)),
        ("play", said(&structure.play, "")),
    ]
}

fn said(finding: &Finding, unit: &str) -> String {
    match finding {
        Finding::There { size } => {
            let end = |end: Option<f64>| end.map_or("?".to_owned(), |end| significant(end, 3));
            format!(
                "{} {unit} (95 % interval {} to {})",
                significant(size.value, 3),
                end(size.low),
                end(size.high)
            )
        }
        Finding::Likely { why } => format!("likely: {why}"),
        Finding::NotThere { below } => format!("not there: below {} V", significant(*below, 2)),
        Finding::Unknown { why } => format!("cannot be told: {why}"),
    }
}

fn ripple(structure: &Structure) -> String {
    let wave = |wave: &crate::structure::Wave| {
        format!(
            "{} waves a turn of {} V",
            significant(wave.per_turn, 4),
            significant(wave.size.value, 2)
        )
    };
    let waves: Vec<String> = structure.ripple.iter().map(wave).collect();
    match structure.ripple_looked_for {
        Some(_) if !waves.is_empty() => waves.join(", "),
        Some((from, to)) => format!(
            "nothing stands out from {} to {} waves a turn",
            significant(from, 2),
            significant(to, 2)
        ),
        None => {
            "cannot be told: the blocks are too few, or the encoder too coarse for them".to_owned()
        }
    }
}

/// In a line, for the terminal: what is there.
pub(super) fn summary(found: &Found) -> String {
    let Some(structure) = &found.chosen.structure else { return "not looked at".to_owned() };
    let there: Vec<String> = rows(structure)
        .into_iter()
        .filter(|(_, said)| !said.starts_with("not") && !said.starts_with("cannot"))
        .map(|(what, said)| format!("{what}: {said}"))
        .collect();
    if there.is_empty() {
        return "nothing that depends on place or direction was found; the report says what cannot be told".to_owned();
    }
    there.join("; ")
}

/// What moves came to, in a sentence; nothing where no time was left for them.
pub(super) fn moves(found: &Found) -> Option<String> {
    let moves = found.proof.moves.as_ref()?;
    let share = |ratio: Option<Ranged>| {
        let end = |end: Option<f64>| end.map_or("?".to_owned(), |end| percent(100.0 * end, 0));
        ratio.map_or("not compared".to_owned(), |ratio| {
            format!(
                "{} (95 % interval {} to {})",
                percent(100.0 * ratio.value, 0),
                end(ratio.low),
                end(ratio.high)
            )
        })
    };
    let mrad = |angle: f64| significant(1e3 * angle, 3);
    Some(format!(
        "steps of {} mrad leave {} of the error, small moves of {} mrad {}; held, the shaft hunted {} of {} times, with the gains alone {}",
        mrad(moves.sizes.0),
        share(moves.step_ratio),
        mrad(moves.sizes.1),
        share(moves.small_ratio),
        moves.hunted.1,
        moves.hunted.2,
        moves.hunted.0
    ))
}

/// The table of the report.
pub(super) fn blocks(found: &Found) -> Vec<Block> {
    let mut blocks = Vec::new();
    if let Some(structure) = &found.chosen.structure {
        blocks.push(Block::Table(Table {
            title: "What depends on place and direction".to_owned(),
            caption: format!(
                "The blocks went over {} rad. What is the same on both ways over a place is its load, half their difference friction. Each is believed where it predicts the blocks that were kept back better. Places are by the rig's own count.",
                significant(structure.covered, 3)
            ),
            columns: ["what", "found"].map(str::to_owned).to_vec(),
            rows: rows(structure).into_iter().map(|(what, said)| vec![what.to_owned(), said]).collect(),
            highlight: None,
        }));
    }
    blocks.extend(moves(found).map(|said| Block::Text(format!("Moves: {said}."))));
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_there_what_is_not_and_what_cannot_be_told_differ_in_words() {
        let there = Finding::There { size: Ranged::new(0.2, 0.19, 0.21) };
        assert_eq!(said(&there, "V"), "0.200 V (95 % interval 0.190 to 0.210)");
        assert!(said(&Finding::NotThere { below: 0.01 }, "V").starts_with("not there: below 0.01"));
        let unknown = Finding::Unknown { why: "the way is short".to_owned() };
        assert_eq!(said(&unknown, "V"), "cannot be told: the way is short");
    }
}
