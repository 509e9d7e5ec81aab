//! The structure of an axis: compared by cross-validation, chosen, fitted.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use friction_ident::axis_structure::{
    AxisStructure, AxisUnits, Choice, CrossValidation, StructureFit, UnknownStructure, choose,
    cross_validate, fit_structure,
};
use friction_ident::{Conditioned, IdentError, Prediction};

use recording::AxisKind;
use work::progress::Progress;
use work::sequencer::{Completion, run_in_order};

/// Blocks of the cross-validation.
pub const BLOCKS: usize = 8;

/// Which structures are compared.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StructureChoice {
    /// The usual candidates.
    Auto,
    /// These.
    Named(Vec<AxisStructure>),
}

impl StructureChoice {
    /// The structures that are compared on a recording: of the usual ones those that it can show.
    #[must_use]
    pub fn candidates(&self, estimation: &Conditioned, axis: AxisKind) -> Vec<AxisStructure> {
        let mut usual = match self {
            Self::Named(named) => return named.clone(),
            Self::Auto => AxisStructure::candidates(),
        };
        if axis == AxisKind::Rotary {
            usual.extend(AxisStructure::candidates_under_gravity());
        }
        usual.retain(|structure| estimation.position.is_some() || !structure.needs_position());
        usual
    }
}

/// A text that chooses no structures.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}; or `auto`")]
pub struct ChoiceError(#[from] UnknownStructure);

impl std::str::FromStr for StructureChoice {
    type Err = ChoiceError;

    fn from_str(text: &str) -> Result<Self, ChoiceError> {
        if text.trim() == "auto" {
            return Ok(Self::Auto);
        }
        let names = text.split(',').map(|name| name.trim().parse::<AxisStructure>());
        Ok(Self::Named(names.collect::<Result<_, _>>()?))
    }
}

/// A structure that was chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Structured {
    /// The cross-validated structures, in the order of the candidates.
    pub scores: Vec<CrossValidation>,
    /// Their ranking.
    pub choice: Choice,
    /// The chosen one, fitted to the whole recording.
    pub fit: StructureFit,
    /// On the recording it was fitted to.
    pub estimation: Prediction,
    /// On the other recording, which nothing was chosen or fitted by.
    pub validation: Option<Prediction>,
}

impl Structured {
    /// The chosen structure's score.
    pub fn chosen(&self) -> Option<&CrossValidation> {
        self.scores.get(self.choice.chosen)
    }
}

/// Units of an axis.
pub fn units(axis: AxisKind) -> &'static AxisUnits {
    match axis {
        AxisKind::Linear => &AxisUnits::LINEAR,
        AxisKind::Rotary => &AxisUnits::ROTARY,
    }
}

/// Compares the structures on all cores, chooses one, fits it, and tries it on `validation`. None
/// where `cancel` ended it before the first result; a comparison that was cut short chooses among
/// what there is.
///
/// # Errors
/// The first [`IdentError`] in the order of the candidates. Candidates that need a position where
/// there is none are left out.
pub fn structured(
    estimation: &Conditioned,
    validation: Option<&Conditioned>,
    wanted: &StructureChoice,
    axis: AxisKind,
    progress: &Progress,
    cancel: &AtomicBool,
) -> Result<Option<Structured>, IdentError> {
    let candidates = wanted.candidates(estimation, axis);
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let mut scores = Vec::with_capacity(candidates.len());
    let work = |structure: &AxisStructure| cross_validate(estimation, *structure, BLOCKS);
    let completion = run_in_order(&candidates, workers, cancel, work, |structure, score| {
        progress.stage(format!("{structure}"));
        progress.advance(1.0);
        scores.push(score);
        Ok(())
    })?;
    if let Completion::Cancelled { delivered } = completion {
        // From here on the work is short; it is done, so that there is a result.
        cancel.store(false, Ordering::Relaxed);
        progress.line(&format!(
            "stopped: {delivered} of {} structures were compared",
            candidates.len()
        ));
    }
    let Some(choice) = choose(&scores) else { return Ok(None) };
    let Some(chosen) = scores.get(choice.chosen) else { return Ok(None) };
    let fit = fit_structure(estimation, chosen.structure, units(axis))?;
    let here = fit.predict(estimation)?;
    let there = validation.map(|other| fit.predict(other)).transpose()?;
    Ok(Some(Structured { scores, choice, fit, estimation: here, validation: there }))
}

#[cfg(test)]
mod tests {
    use super::StructureChoice;

    #[test]
    fn the_option_names_its_mistake() {
        assert_eq!("auto".parse(), Ok(StructureChoice::Auto));
        let named = "symmetric, asymmetric+delay".parse::<StructureChoice>().unwrap();
        assert!(matches!(named, StructureChoice::Named(list) if list.len() == 2));
        let message = "symmetric,stribeck".parse::<StructureChoice>().unwrap_err().to_string();
        assert!(message.contains("`stribeck`") && message.contains("auto"), "{message}");
    }
}
