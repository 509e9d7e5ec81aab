//! What the errors of the drive's constants add to the parameters, where the friction is worked out of voltage, current or driving force.
//!
//! The parameters' standard errors come from residuals, and an error that is the same in every sample leaves no residual. So each stage of the
//! identification is done again with each constant higher by one standard error; how far a parameter moves is its standard deviation by that
//! constant. The joint refinement is left out on both sides of the comparison.

use std::collections::BTreeMap;

use friction_ident::{DriveConstant, FrictionData, IdentError, Identified, Stage};

/// How far the parameters of a model move with the constants.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FromDrive {
    /// Parameter -> how far one standard error of each constant moves it, with its sign.
    moves: BTreeMap<String, Vec<(DriveConstant, f64)>>,
}

impl FromDrive {
    /// Compares `found` with what `refit` finds in the `moved` recordings of each constant. None where there is nothing to move, or a refit was
    /// stopped.
    ///
    /// # Errors
    /// Those of the refit.
    pub(super) fn work_out(
        found: &Identified,
        moved: &[(DriveConstant, FrictionData)],
        mut refit: impl FnMut(&FrictionData) -> Result<Identified, IdentError>,
    ) -> Result<Option<Self>, IdentError> {
        let mut moves: BTreeMap<String, Vec<(DriveConstant, f64)>> = BTreeMap::new();
        for (constant, data) in moved {
            let other = refit(data)?;
            if other.stopped || found.stopped {
                return Ok(None);
            }
            let before = of_stages(found);
            for (name, value) in of_stages(&other) {
                if let Some(own) = before.get(name) {
                    moves.entry(name.to_owned()).or_default().push((*constant, value - own));
                }
            }
        }
        // What the data do not determine moves by chance.
        let doubtful = |name: &str| {
            found
                .estimates
                .get(name)
                .is_none_or(|e| matches!(e.verdict, friction_ident::Verdict::NotIdentifiable { .. }))
        };
        moves.retain(|name, _| !doubtful(name));
        Ok((!moved.is_empty()).then_some(Self { moves }))
    }

    /// Standard deviation of a parameter by all constants together, in its unit.
    #[must_use]
    pub fn of(&self, parameter: &str) -> Option<f64> {
        let moves = self.moves.get(parameter)?;
        Some(moves.iter().map(|(_, by)| by * by).sum::<f64>().sqrt())
    }

    /// How far one standard error of each constant moves a parameter, with its sign.
    #[must_use]
    pub fn by_constant(&self, parameter: &str) -> &[(DriveConstant, f64)] {
        self.moves.get(parameter).map_or(&[], Vec::as_slice)
    }
}

/// What the stages before the joint refinement say of each parameter, the last one's word.
fn of_stages(found: &Identified) -> BTreeMap<&str, f64> {
    found
        .stages
        .iter()
        .filter(|stage| stage.stage != Stage::Joint)
        .flat_map(|stage| &stage.estimates.parameters)
        .map(|estimate| (estimate.name.as_str(), estimate.value))
        .collect()
}
