//! The chosen structure on paper: blocks of the page, lines of the terminal, part of the document.

use std::fmt::Write;

use friction_ident::axis_structure::{AxisStructure, CrossValidation, FirstSpeeds, Ranked};
use friction_ident::robust_covariance::METHOD;
use friction_ident::{IdentError, Prediction};
use serde_json::{Value, json};

use super::along::Along;
use super::structure::Structured;
use crate::rows::rows;
use recording::AxisKind;
use report::figure::{Block, Figure, LineStyle, Panel, Table, Trace};

/// Markers a cloud of points is thinned to.
const CLOUD: usize = 1500;

/// What the page gets; `warned` are the structures that the page warns of.
pub fn blocks(found: &Structured, axis: AxisKind, warned: &[AxisStructure]) -> Vec<Block> {
    let mut blocks = vec![Block::Heading(format!("The structure: {}", found.fit.structure))];
    blocks.extend(found.notes().into_iter().chain(left_out(found)).map(Block::Note));
    blocks.push(Block::Text(format!(
        "Structures are compared by cross-validation inside the estimation recording: {} contiguous blocks, each predicted by a fit to the others. Alike are those \
         whose excess over the best is within chance (Student's 95 % quantile of the difference, paired block by block), within the best one's own standard error and \
         within a twentieth of its error. The one with the fewest parameters that is within a fortieth of it is chosen.{}",
        block_count(found),
        took_part(found)
    )));
    blocks.push(Block::Table(ranking(found, warned)));
    blocks.push(Block::Figure(bars(found)));
    blocks.push(Block::Table(Table {
        title: format!("Parameters of {}", found.fit.structure),
        caption: format!(
            "Standard errors: {METHOD}. Intervals of delay, v_s, presliding and period are those of the profile of the sum of squares, as wide as these errors ask.{}{}",
            harmonic(found),
            Along::of(&found.fit, axis).map_or(String::new(), |along| format!(" {}", along.travel()))
        ),
        columns: ["parameter", "value", "unit", "95 % interval", "verdict"].map(str::to_owned).to_vec(),
        rows: rows(&found.fit.estimates.parameters).into_iter().map(|row| row.to_vec()).collect(),
        highlight: None,
    }));
    blocks.push(Block::Figure(over_velocity(found, axis)));
    blocks.push(Block::Figure(residual("On the estimation recording", &found.estimation, axis)));
    if let Some(other) = &found.validation {
        blocks.push(Block::Figure(residual("On the validation recording", other, axis)));
    }
    blocks
}

/// The structures that the recording cannot show, those with the same reason together.
fn left_out(found: &Structured) -> Option<String> {
    let mut reasons: Vec<(String, Vec<String>)> = Vec::new();
    for (structure, why) in &found.refused {
        let why = match why {
            // What to do about it is for who has no other structure.
            IdentError::NegativeInertia { .. } => "its inertia comes out negative".to_owned(),
            why => why.to_string(),
        };
        match reasons.iter_mut().find(|(reason, _)| *reason == why) {
            Some((_, structures)) => structures.push(structure.to_string()),
            None => reasons.push((why, vec![structure.to_string()])),
        }
    }
    let one =
        |(why, structures): &(String, Vec<String>)| format!("{} ({why})", structures.join(", "));
    let all: Vec<String> = reasons.iter().map(one).collect();
    (!all.is_empty()).then(|| format!("Structures that were left out: {}.", all.join("; ")))
}

/// What the other recording had to do with the choice.
fn took_part(found: &Structured) -> &'static str {
    if tried_elsewhere(found) {
        " The other recording took part in the choice: its parts count as those kept back do. Nothing was fitted to it; but of structures that are alike the \
         luckier is chosen, so that the error there promises a little too much. A third recording tells: --validate it with --structure and the name alone."
    } else {
        ""
    }
}

fn tried_elsewhere(found: &Structured) -> bool {
    found.scores.iter().any(|score| score.elsewhere.is_some())
}

fn block_count(found: &Structured) -> usize {
    found.chosen().map_or(0, |score| score.blocks.len())
}

/// What to say of the two parts of a harmonic force; empty where the structure has none.
fn harmonic(found: &Structured) -> String {
    let part = |name| found.fit.estimates.get(name);
    let (Some(cos), Some(sin)) = (part("harmonic_cos"), part("harmonic_sin")) else {
        return String::new();
    };
    format!(
        " harmonic_cos and harmonic_sin are one wave of amplitude {:.2} {} and are judged by it: either of them may be near zero.",
        cos.value.hypot(sin.value),
        cos.unit
    )
}

/// The remark behind a row of what was compared.
pub fn remark(chosen: bool, warned: bool) -> String {
    match (chosen, warned) {
        (true, _) => "chosen".to_owned(),
        (false, true) => "warned of".to_owned(),
        (false, false) => String::new(),
    }
}

/// Why a structure that predicts better than the chosen one was passed over.
fn disbelieved(ranked: &Ranked, score: &CrossValidation) -> Option<&'static str> {
    match score.first_speeds {
        _ if ranked.excess >= 0.0 => None,
        FirstSpeeds::Plausible => None,
        FirstSpeeds::Rises => Some("passed over: friction rises over the first speeds"),
    }
}

/// A relative error \[%\] to three decimals; one that is past all use, as its size.
fn percent(value: f64) -> String {
    if value.abs() < 1e4 { format!("{value:.3}") } else { format!("{value:.0e}") }
}

fn ranking(found: &Structured, warned: &[AxisStructure]) -> Table {
    let is_chosen = |ranked: &Ranked| ranked.index == found.choice.chosen;
    let all = &found.choice.ranking;
    let ordered = all.iter().filter(|r| is_chosen(r)).chain(all.iter().filter(|r| !is_chosen(r)));
    let rows = ordered.filter_map(|ranked| {
        let score = found.scores.get(ranked.index)?;
        let mut row = vec![
            score.structure.to_string(),
            score.structure.parameters().to_string(),
            format!("{} ± {}", percent(score.relative_error), percent(score.standard_error)),
        ];
        row.extend(score.elsewhere.iter().map(|there| percent(there.relative_error)));
        row.push(format!("{} ± {}", percent(ranked.excess), percent(ranked.excess_error)));
        row.push(match disbelieved(ranked, score) {
            Some(why) => why.to_owned(),
            None => remark(is_chosen(ranked), warned.contains(&score.structure)),
        });
        Some(row)
    });
    let elsewhere = tried_elsewhere(found);
    let columns = ["structure", "parameters", "cross-validated error [%]"].into_iter();
    let columns = columns.chain(elsewhere.then_some("other recording [%]"));
    Table {
        title: "Structures, the chosen one first".to_owned(),
        caption: format!(
            "Then by the error. Relative error of the prediction of unseen blocks with its standard error, and the excess over the best{} with the standard error of the paired difference. What is passed over may predict better here: a rise of friction over speeds that the recording only passes through is believed where it takes off a quarter of the error{}.",
            if elsewhere { ", the blocks of the other recording among them," } else { "" },
            if elsewhere {
                ", or a twentieth of the error here and of that on the other recording"
            } else {
                ""
            }
        ),
        columns: columns.chain(["excess [%]", "remark"]).map(str::to_owned).collect(),
        rows: rows.collect(),
        highlight: Some(0),
    }
}

fn bars(found: &Structured) -> Figure {
    let score = |chosen: bool| {
        let of = found
            .scores
            .iter()
            .enumerate()
            .filter(move |(i, _)| (*i == found.choice.chosen) == chosen);
        let (x, (y, error)) = of
            .map(|(_, score)| {
                (score.structure.parameters() as f64, (score.relative_error, score.standard_error))
            })
            .collect::<(Vec<_>, (Vec<_>, Vec<_>))>();
        let name = if chosen { "chosen" } else { "other structures" }.to_owned();
        Trace::Points { name, x, y, error: Some(error) }
    };
    Figure {
        title: "Cross-validated error against the number of parameters".to_owned(),
        caption: "Each point a structure; bars: one standard error over the blocks.".to_owned(),
        x_label: "parameters".to_owned(),
        log_x: false,
        panels: vec![Panel {
            y_label: "cross-validated error [%]".to_owned(),
            traces: vec![score(false), score(true)],
        }],
    }
}

fn over_velocity(found: &Structured, axis: AxisKind) -> Figure {
    let Prediction { velocity, friction, .. } = &found.estimation;
    let every = velocity.len().div_ceil(CLOUD).max(1);
    let cloud = |name: &str, forward: bool| {
        let (x, y) = velocity
            .iter()
            .zip(friction)
            .step_by(every)
            .filter(|(v, _)| (**v > 0.0) == forward)
            .map(|(v, f)| (*v, *f))
            .collect::<(Vec<_>, Vec<_>)>();
        Trace::Points { name: name.to_owned(), x, y, error: None }
    };
    let fastest = velocity.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    let branch = |side: f64| {
        let x: Vec<f64> =
            (0..=200).map(|i| side * fastest * (f64::from(i) / 200.0).powi(2)).collect();
        let y = x.iter().map(|&v| found.fit.steady_friction(v)).collect();
        Trace::Line { name: "fitted".to_owned(), x, y, style: LineStyle::Solid }
    };
    Figure {
        title: format!("Friction {} against velocity, each direction", axis.force_word()),
        caption: "Points: the measured value less inertia times acceleration, at the time the force acts. Lines: the fitted curve.".to_owned(),
        x_label: format!("velocity [{}]", axis.velocity_unit()),
        log_x: false,
        panels: vec![Panel {
            y_label: format!("friction {} [{}]", axis.force_word(), axis.force_unit()),
            traces: vec![cloud("forward", true), cloud("backward", false), branch(-1.0), branch(1.0)],
        }],
    }
}

fn residual(title: &str, prediction: &Prediction, axis: AxisKind) -> Figure {
    let line = |y: Vec<f64>| Trace::Line {
        name: "residual".to_owned(),
        x: prediction.time.clone(),
        y,
        style: LineStyle::Solid,
    };
    Figure {
        title: title.to_owned(),
        caption: format!(
            "Measured less predicted {}: {:.3} % of it.",
            axis.force_word(),
            prediction.relative_error
        ),
        x_label: "time [s]".to_owned(),
        log_x: false,
        panels: vec![Panel {
            y_label: format!("residual [{}]", axis.force_unit()),
            traces: vec![line(prediction.residual())],
        }],
    }
}

/// What the terminal gets.
pub fn terminal(found: &Structured) -> String {
    let mut text = format!(
        "\nstructures, by cross-validation inside the estimation recording{}:\n",
        if tried_elsewhere(found) { " and by the other one" } else { "" }
    );
    let width =
        found.scores.iter().map(|score| score.structure.to_string().len()).max().unwrap_or(0);
    for ranked in &found.choice.ranking {
        let Some(score) = found.scores.get(ranked.index) else { continue };
        let mark = if ranked.index == found.choice.chosen { ">" } else { " " };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{mark} {:width$}  {:>2} parameters  {:>6} ± {} %{}  excess {} ± {}{}",
            score.structure.to_string(),
            score.structure.parameters(),
            percent(score.relative_error),
            percent(score.standard_error),
            score.elsewhere.as_ref().map_or_else(String::new, |there| format!(
                "  elsewhere {:>6} %",
                percent(there.relative_error)
            )),
            percent(ranked.excess),
            percent(ranked.excess_error),
            disbelieved(ranked, score).map_or_else(String::new, |why| format!("  {why}")),
        );
    }
    let _ = writeln!(text, "\n{}:", found.fit.structure);
    let rows = rows(&found.fit.estimates.parameters);
    let width = |i: usize| rows.iter().map(|row| row[i].chars().count()).max().unwrap_or(0);
    let (a, b, c, d) = (width(0), width(1), width(2), width(3));
    for [name, value, unit, interval, verdict] in &rows {
        let _ = writeln!(text, "  {name:a$}  {value:>b$}  {unit:c$}  {interval:d$}  {verdict}");
    }
    let _ = writeln!(text, "  standard errors: {METHOD}");
    let _ = writeln!(text, "  relative error {:.3} %", found.fit.relative_error);
    if let Some(other) = &found.validation {
        let _ = writeln!(text, "  cross-test     {:.3} %", other.relative_error);
    }
    for note in found.notes().into_iter().chain(left_out(found)) {
        let _ = writeln!(text, "note: {note}");
    }
    text
}

/// What the document gets under `structure`.
pub fn document(found: &Structured) -> Value {
    json!({
        "chosen": found.fit.structure,
        "blocks": block_count(found),
        "scores": found.scores,
        "refused": found.refused.iter().map(|(structure, why)| json!({
            "structure": structure,
            "why": why.to_string(),
        })).collect::<Vec<_>>(),
        "ranking": found.choice.ranking,
        "parameters": found.fit.estimates,
        "relative_error_percent": found.fit.relative_error,
        "effective_share": found.fit.effective_share,
        "travel": Along::of(&found.fit, found.axis).map(|along| along.document()),
        "standard_errors": METHOD,
        "cross_test_relative_error_percent": found.validation.as_ref().map(|other| other.relative_error),
        "cross_test_stretches_s": found.validation.as_ref().map(Prediction::stretches),
        "warnings": found.warnings,
        "notes": found.notes(),
        "interrupted": found.interrupted,
    })
}

#[cfg(test)]
mod tests {
    use friction_ident::axis_structure::Shape;

    use super::*;

    #[test]
    fn what_predicts_better_and_is_not_chosen_says_why() {
        let said = |first_speeds, excess| {
            let score = CrossValidation {
                structure: AxisStructure { stribeck: true, ..AxisStructure::SYMMETRIC },
                shape: Shape::UNUSED,
                blocks: vec![],
                force_power: 1.0,
                relative_error: 1.0,
                standard_error: 0.1,
                first_speeds,
                rows: 4,
                elsewhere: None,
            };
            let ranked = Ranked { index: 0, excess, excess_error: 0.1, within: true };
            disbelieved(&ranked, &score)
        };
        assert!(said(FirstSpeeds::Rises, -0.1).unwrap().contains("rises"));
        // It is chosen or worse for other reasons.
        assert_eq!(said(FirstSpeeds::Rises, 0.0), None);
        assert_eq!(said(FirstSpeeds::Plausible, 0.2), None);
    }
}
