//! Truth by model: which model fits the friction of which, on data it has not seen.
//!
//! The model that made the data wins: a ranking from one truth says nothing about models, the
//! matrix does. Each cell is the held-out error of a model identified from the experiments of a
//! truth, over several noise seeds.

use std::ops::ControlFlow;

use friction_model::{AnyModel, ModelName};
use serde::{Deserialize, Serialize};

use crate::IdentError;
use crate::information::{Difference, or_nan};
use crate::staged::{
    Identified, StagedOptions, difference, identify_model, residuals, rms_of_kind,
};
use crate::statistics::root_mean_square;
use crate::stretch::StretchKind;
use crate::synthetic::{Set, experiments};

/// The models of the staged identification.
pub const MODELS: [ModelName; 8] = [
    ModelName::CoulombViscous,
    ModelName::Stribeck,
    ModelName::Dahl,
    ModelName::ElastoPlastic,
    ModelName::LuGre,
    ModelName::Gms,
    ModelName::Xiong,
    ModelName::Proposed,
];

/// Kinds of recording, in the order of the figures.
pub const KINDS: [StretchKind; 4] =
    [StretchKind::Steady, StretchKind::PreSliding, StretchKind::Lag, StretchKind::Mixed];

/// One model identified from one truth's experiments under one seed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// The model.
    pub model: ModelName,
    /// Held-out root mean square error over everything \[N or N m\].
    #[serde(deserialize_with = "or_nan")]
    pub held_out: f64,
    /// The same of each kind of recording, in the order of [`StretchKind::ALL`].
    pub by_kind: [Option<f64>; 4],
    /// Akaike's criterion on the data it was fitted to.
    #[serde(deserialize_with = "or_nan")]
    pub aic: f64,
    /// Schwarz's criterion.
    #[serde(deserialize_with = "or_nan")]
    pub bic: f64,
    /// Held-out mean square beyond the best model's, paired over blocks; zero for the best itself.
    pub behind: Difference,
}

/// Identifies every model of `models` from the experiments of `truth` and tries each on the other
/// set. The best comes first.
///
/// # Errors
/// [`IdentError`] where a model cannot be identified at all.
pub fn try_models(
    truth: &AnyModel,
    reach: f64,
    models: &[ModelName],
    noise: f64,
    seed: u64,
    options: &StagedOptions,
) -> Result<Vec<Trial>, IdentError> {
    let estimation = experiments(truth, reach, noise, Set::Estimation, seed);
    let validation = experiments(truth, reach, noise, Set::Validation, seed);
    let mut found: Vec<(Identified, Vec<f64>)> = Vec::with_capacity(models.len());
    for &name in models {
        let go = &mut |_, _: &_| ControlFlow::Continue(());
        let identified = identify_model(name, &estimation, options, go)?;
        let off = residuals(&identified.predictor(), &validation);
        found.push((identified, off));
    }
    found.sort_by(|a, b| root_mean_square(&a.1).total_cmp(&root_mean_square(&b.1)));
    let best = found.first().map(|(identified, _)| identified.predictor());
    Ok(found
        .iter()
        .map(|(identified, off)| Trial {
            model: identified.name,
            held_out: root_mean_square(off),
            by_kind: StretchKind::ALL
                .map(|kind| rms_of_kind(&identified.predictor(), &validation, kind)),
            aic: identified.information.aic,
            bic: identified.information.bic,
            behind: difference(
                &identified.predictor(),
                &best.unwrap_or(identified.predictor()),
                &validation,
            ),
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_model_that_made_the_data_wins() {
        let models = [ModelName::Stribeck, ModelName::Dahl, ModelName::LuGre, ModelName::Proposed];
        for name in [ModelName::Dahl, ModelName::LuGre, ModelName::Proposed] {
            let truth = AnyModel::test_bed(name);
            let trials =
                try_models(&truth, 0.006, &models, 1e-3, 1, &StagedOptions::default()).unwrap();
            assert_eq!(trials[0].behind.mean, 0.0);
            let own = trials.iter().find(|trial| trial.model == name).unwrap();
            // Dahl is LuGre without a dip: the two may tie.
            assert!(trials[0].model == name || own.behind.is_tie(), "{name}: {trials:?}");
            assert!((own.held_out / 1e-3 - 1.0).abs() < 0.05, "{own:?}");
            let stribeck = trials.iter().find(|trial| trial.model == ModelName::Stribeck).unwrap();
            assert!(
                !stribeck.behind.is_tie() && stribeck.held_out > 2.0 * own.held_out,
                "{stribeck:?}"
            );
        }
    }
}
