//! What the page, the terminal and the document say alike.

use friction_ident::information::Standing;
use friction_ident::position_load::LoadShape;
use friction_ident::staged::PositionLoadChoice;
use friction_ident::{Doubt, Estimate, FrictionData, Stage, Verdict};
use friction_model::ModelName;

use super::{Criterion, FrictionIdentification, KINDS, ModelResult, Settings};
use crate::verdict::why;
use recording::drive_error::AddedUncertainty;
use recording::stretches::FrictionRecording;
use report::numbers::{self, value_and_error as with_error};

/// One line for the progress bar.
pub(super) fn progress(name: ModelName, stage: Stage, sum: f64) -> String {
    let stage = match stage {
        Stage::Static => "static",
        Stage::PreSliding => "pre-sliding",
        Stage::MicroDamping => "damping",
        Stage::Lag => "lag",
        Stage::Joint => "joint",
    };
    format!("{name} {stage} {sum:.2e}")
}

/// What the levels of two directions hold.
pub(super) const TWO_DIRECTIONS: &str = "The levels of the two directions hold any constant force that acts beside friction, such as a sensor's zero: \
     half the difference of the two may be that.";

/// What is estimated beside friction, and why.
pub(super) fn beside(choice: &PositionLoadChoice) -> Option<String> {
    let left = |wanted: LoadShape| {
        let found = choice.compared.iter().find(|(shape, _)| *shape == wanted);
        found.map(|(_, percent)| significant(*percent))
    };
    if choice.chosen == LoadShape::NONE {
        return None;
    }
    let (with, without) = (left(choice.chosen)?, left(LoadShape::NONE)?);
    let offset = if choice.chosen.offset {
        " Where the axis slides, an offset and a Coulomb friction that differs by direction look alike; --asymmetric gives each direction its own \
         friction instead."
    } else {
        ""
    };
    Some(format!(
        "{} is estimated beside every model: what predicts the other blocks of the recordings leaves {with} % of the force with it \
         and {without} % without. It is part of what drives the axis, not of friction; parameters.yaml holds friction alone.{offset}",
        capitalised(&choice.chosen.describe()),
    ))
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Value and standard error with as many digits as the error allows; the error is empty where there
/// is none.
pub fn value(estimate: &Estimate) -> (String, String) {
    match estimate.standard_error.filter(|error| *error > 1e-14 * estimate.value.abs()) {
        Some(error) => with_error(estimate.value, error),
        None => (significant(estimate.value), String::new()),
    }
}

/// What the drive's constants add to a parameter's uncertainty; empty where nothing does.
pub(super) fn from_drive(result: &ModelResult, estimate: &Estimate) -> String {
    let added = result.from_drive.as_ref().and_then(|from| from.of(estimate.id));
    added.map_or(
        String::new(),
        |added| if added == 0.0 { "0".to_owned() } else { format!("{added:.1e}") },
    )
}

/// The 95 % interval, open ends as such.
pub(super) fn interval(estimate: &Estimate) -> String {
    let Some(interval) = estimate.interval else { return String::new() };
    let error = estimate.standard_error.filter(|error| *error > 1e-14 * estimate.value.abs());
    let end = |value: f64| match error {
        _ if value == f64::NEG_INFINITY => "-inf".to_owned(),
        _ if value == f64::INFINITY => "inf".to_owned(),
        Some(error) => with_error(value, error).0,
        None => significant(value),
    };
    format!("{} to {}", end(interval.low), end(interval.high))
}

/// Whether the data determine the parameter, and if not what to measure.
pub(super) fn verdict(estimate: &Estimate) -> String {
    match &estimate.verdict {
        Verdict::Identified => "identified".to_owned(),
        Verdict::NotIdentifiable { doubt: doubt @ Doubt::NotToBeTrusted { .. }, remedy } => {
            format!("{doubt}. Measure {remedy}.")
        }
        Verdict::NotIdentifiable { doubt, remedy } => {
            format!("not identifiable from this data: {}. Measure {remedy}.", why(estimate, doubt))
        }
        Verdict::Given { source } => format!("not estimated: {source}"),
    }
}

/// Four significant digits.
pub fn significant(value: f64) -> String {
    numbers::significant(value, 4)
}

/// What a model's place is worth.
pub(super) fn place(found: &FrictionIdentification, place: usize, result: &ModelResult) -> String {
    if let Some(why) = &result.cannot_be_chosen {
        return format!("cannot be chosen: {why}");
    }
    if place == 0 {
        return "first".to_owned();
    }
    let first = found.models.first().map_or(f64::NAN, ModelResult::error);
    let times = format!("{} times its error", significant(result.error() / first));
    match (result.standing, found.criterion) {
        (Standing::Alike, _) => format!("cannot be told from the first ({times})"),
        (Standing::Undecided, criterion) => {
            undecided(&significant(result.error() / first), criterion, found.recordings_held_out())
        }
        (Standing::Worse, Criterion::HeldOut) => {
            let times = |errors: f64| {
                significant((result.ratio.mean + errors * result.ratio.standard_error).exp())
            };
            format!(
                "worse: {} times the mean square in the usual block ({} to {})",
                times(0.0),
                times(-2.0),
                times(2.0)
            )
        }
        (Standing::Worse, Criterion::Bic) => {
            let first = found.models.first().map_or(0.0, |first| first.found.information.bic);
            format!("BIC higher by {}", significant(result.found.information.bic - first))
        }
    }
}

/// Recordings below which nothing is to be told from their scatter.
const FEW: usize = 3;

/// Why a model with a clearly larger error is not called worse.
fn undecided(times: &str, criterion: Criterion, held_out: usize) -> String {
    let error = format!("{times} times the error of the first");
    match (criterion, held_out) {
        (Criterion::Bic, _) => format!("{error}, but too few independent samples to tell"),
        (Criterion::HeldOut, 1) => format!("{error}, but too few recordings to tell: 1 held out"),
        (Criterion::HeldOut, n) if n < FEW => {
            format!("{error}, but too few recordings to tell: {n} held out")
        }
        (Criterion::HeldOut, _) => {
            format!("{error}, but better in parts: the recordings held out do not decide")
        }
    }
}

/// By what the models stand in order, in a sentence.
pub(super) fn criterion(found: &FrictionIdentification) -> &'static str {
    match found.criterion {
        Criterion::HeldOut => {
            "In order of the error on the recordings held out. Models are compared over 20 blocks of the same samples: one is told from the first where \
             the mean of the blocks' mean squares, or of their logarithms, is worse by more than two of its standard errors. One that is not, and whose error is at most a fifth \
             larger, cannot be told from the first; with a larger error the recordings do not decide. Chosen is the model with the fewest free parameters of those \
             whose mean square is within one standard error of the best one's own, and whose error is at most a fifth larger, in the usual block too. A fit that did \
             not converge, ran away or ended at a bound cannot be chosen."
        }
        Criterion::Bic => {
            "In order of Schwarz's criterion (BIC), which charges for every parameter; the samples are counted by how many of them are independent, as the \
             residuals of the best fit tell. A \
             difference below 2 is no difference where the error is at most a fifth larger. A fit that did not converge, ran away or ended at a bound cannot be \
             chosen. The errors are those of the fit."
        }
    }
}

/// What is said where no fit can be trusted.
pub(super) const NONE_CHOSEN: &str = "No model can be chosen: no fit converged within its bounds. The reason stands beside each model; its numbers are not to be \
    used.";

/// Which model is chosen, where it is not the first.
pub(super) fn simpler(found: &FrictionIdentification) -> Option<String> {
    let (first, chosen) = (found.models.first()?, found.chosen()?);
    if let Some(told) = &found.at_rest_too {
        let unit = found.settings.axis.force_unit();
        let left = told.errors.iter().map(|(name, e)| format!("{name} {} {unit}", significant(*e)));
        return Some(format!(
            "Chosen: {}. A static model predicts a range at rest, so that the table leaves those samples out. Over all samples the models that predict there \
             too leave: {}. That decides between them.",
            chosen.found.name,
            left.collect::<Vec<_>>().join(", ")
        ));
    }
    (chosen.found.name != first.found.name).then(|| {
        format!(
            "Chosen: {}, which has the fewest free parameters of those {}.",
            chosen.found.name,
            match found.criterion {
                Criterion::HeldOut => "within one standard error of the first",
                Criterion::Bic => "that cannot be told from the first",
            }
        )
    })
}

/// Kinds that were fitted but are not among the recordings held out: the ranking knows nothing of
/// them.
pub(super) fn unseen_kinds(data: &FrictionData, held_out: &FrictionData) -> Option<String> {
    let count = FrictionIdentification::count;
    let unseen: Vec<&str> = KINDS
        .iter()
        .filter(|&&kind| count(data, kind) > 0 && count(held_out, kind) == 0)
        .map(|kind| kind.describe())
        .collect();
    (!unseen.is_empty()).then(|| {
        format!(
            "The recordings held out do not show {}: the order of the models says nothing about it. Add such a recording to --validate.",
            unseen.join(", ")
        )
    })
}

/// What is to be said about the files.
pub(super) fn source_notes<'a>(
    files: impl Iterator<Item = &'a FrictionRecording>,
    settings: &Settings,
) -> Vec<String> {
    let mut notes = Vec::new();
    let unit = settings.axis.force_unit();
    for file in files {
        let path = file.path.display();
        if !file.outliers.is_empty() {
            notes.push(format!(
                "{}: {} samples were not believed and were replaced by the median of their neighbours; identification.json lists every one.",
                path,
                file.outliers.len()
            ));
        }
        notes.extend(file.irregularities.describe().map(|said| format!("{path}: {said}")));
        if let Some(added) = AddedUncertainty::of(&file.drive_errors) {
            notes.push(format!(
                "{path}: the friction is {}; the standard errors of the drive's constants add {} {unit} (root mean square) to it, {} {unit} at \
                 most. It is the same error in every sample and is not in the standard errors of the parameters; `from the drive` says what it adds to each.",
                settings.preparation.torque.describe(),
                significant(added.rms),
                significant(added.largest)
            ));
        }
    }
    notes
}

/// Where a constant force was found by what the models had left.
pub(super) const CONSTANT_LEFT: &str = "The models had left a constant force over, so an offset is estimated beside them. It is part of what drives the axis, not of friction; \
    parameters.yaml holds friction alone.";

/// What in the recordings puts every number in doubt.
pub(super) fn in_doubt<'a>(files: impl Iterator<Item = &'a FrictionRecording>) -> Vec<String> {
    let of = |file: &FrictionRecording| {
        let path = file.path.display().to_string();
        file.irregularities.doubts().into_iter().map(move |said| format!("{path}: {said}"))
    };
    files.flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_error_is_said_with_the_reason_why_nothing_is_told_from_it() {
        for times in ["2.400", "15.00"] {
            let one = undecided(times, Criterion::HeldOut, 1);
            assert!(
                one.contains("too few recordings to tell: 1 held out") && one.contains(times),
                "{one}"
            );
            assert!(undecided(times, Criterion::HeldOut, 2).contains("2 held out"));
            assert!(undecided(times, Criterion::HeldOut, 40).contains("do not decide"));
            assert!(undecided(times, Criterion::Bic, 0).contains("too few independent samples"));
            assert!(!one.contains("cannot be told"));
        }
    }
}
