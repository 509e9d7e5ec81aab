//! What the errors of the drive's constants add to the parameters, where the friction is worked out
//! of voltage, current or driving force.
//!
//! The parameters' standard errors come from residuals, and an error that is the same in every
//! sample leaves no residual. So each stage of the identification is done again with each constant
//! higher by one standard error; how far a parameter moves is its standard deviation by that
//! constant. The joint refinement begins at the model found, with the constants as they are and
//! with each of them moved: both then end in the same valley, and the difference is the constant's.

use std::collections::BTreeMap;

use friction_ident::staged::StageResult;
use friction_ident::{
    Doubt, DriveConstant, FrictionData, IdentError, Identified, ParameterId, Verdict,
};

/// How far the parameters of a model move with the constants.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FromDrive {
    /// Parameter -> how far one standard error of each constant moves it, with its sign.
    moves: BTreeMap<ParameterId, Vec<(DriveConstant, f64)>>,
}

impl FromDrive {
    /// Compares what `refit` finds in `data` with what it finds in the `moved` recordings of each
    /// constant; `found` is the whole identification. None where there is nothing to move, or a
    /// refit was stopped.
    ///
    /// # Errors
    /// Those of the refit.
    pub(super) fn work_out(
        found: &Identified,
        data: &FrictionData,
        moved: &[(DriveConstant, FrictionData)],
        mut refit: impl FnMut(&FrictionData) -> Result<Option<ByName>, IdentError>,
    ) -> Result<Option<Self>, IdentError> {
        if moved.is_empty() {
            return Ok(None);
        }
        let Some(before) = refit(data)? else { return Ok(None) };
        let mut moves: BTreeMap<ParameterId, Vec<(DriveConstant, f64)>> = BTreeMap::new();
        for (constant, data) in moved {
            let Some(after) = refit(data)? else { return Ok(None) };
            for (id, value) in after {
                if let Some(own) = before.get(&id) {
                    moves.entry(id).or_default().push((*constant, value - own));
                }
            }
        }
        // What the data do not determine moves by chance. A parameter whose interval is a guess is
        // still determined.
        let doubtful = |id: ParameterId| {
            found.estimates.get(id).is_none_or(|e| match &e.verdict {
                Verdict::NotIdentifiable { doubt, .. } => {
                    !matches!(doubt, Doubt::NotToBeTrusted { .. })
                }
                _ => false,
            })
        };
        moves.retain(|id, _| !doubtful(*id));
        Ok(Some(Self { moves }))
    }

    /// Standard deviation of a parameter by all constants together, in its unit.
    #[must_use]
    pub fn of(&self, parameter: ParameterId) -> Option<f64> {
        let moves = self.moves.get(&parameter)?;
        Some(moves.iter().map(|(_, by)| by * by).sum::<f64>().sqrt())
    }

    /// How far one standard error of each constant moves a parameter, with its sign.
    #[must_use]
    pub fn by_constant(&self, parameter: ParameterId) -> &[(DriveConstant, f64)] {
        self.moves.get(&parameter).map_or(&[], Vec::as_slice)
    }
}

/// Parameter -> value.
pub(super) type ByName = BTreeMap<ParameterId, f64>;

/// Every stage's word on each parameter, the last one's where several speak.
pub(super) fn by_name<'a>(stages: impl IntoIterator<Item = &'a StageResult>) -> ByName {
    stages
        .into_iter()
        .flat_map(|stage| &stage.estimates.parameters)
        .map(|estimate| (estimate.id, estimate.value))
        .collect()
}
