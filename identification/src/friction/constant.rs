//! A constant force that shows only beside a friction model.
//!
//! What acts beside friction is asked before any fit, with columns that stand for friction
//! ([`choose_position_load`](friction_ident::choose_position_load)). Where the contact bends for much of a recording they leave a
//! third of the force, and a constant force of a tenth of the friction is lost in that. A friction
//! model leaves it over, in every sample with the same sign.

use friction_ident::position_load::LoadShape;
use friction_ident::residual_whiteness::effective_share;
use friction_ident::staged::{PositionLoadChoice, residuals};
use friction_ident::statistics::root_mean_square;
use friction_ident::{FrictionData, Identified};

use super::from_drive::FromDrive;

/// Standard errors that the mean of what is left must be clear of zero by.
const CLEAR: f64 = 4.0;
/// Share of the mean square left that it must be, as for any constant force beside friction.
const WORTH: f64 = 0.01;

type Models = [(Identified, Option<FromDrive>)];

/// What the best of some models leaves over all samples; none where there is none.
fn best(models: &Models, data: &FrictionData) -> Option<Vec<f64>> {
    let left = models.iter().filter(|(found, _)| found.converged).map(|(found, _)| {
        let left = residuals(&found.predictor(), data);
        (root_mean_square(&left), left)
    });
    let left = left.filter(|(rms, _)| rms.is_finite());
    left.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, left)| left)
}

/// What to estimate beside friction in place of what was chosen, where the best of the models leaves
/// a constant. None where an offset was not among what was compared: recordings of one direction,
/// and friction of each direction, have it in their levels.
pub(super) fn left_over(
    models: &Models,
    data: &FrictionData,
    beside: &PositionLoadChoice,
) -> Option<LoadShape> {
    let offered = beside.compared.iter().any(|(shape, _)| shape.offset);
    if beside.chosen.offset || !offered {
        return None;
    }
    let left = best(models, data)?;
    let mean = left.iter().sum::<f64>() / left.len().max(1) as f64;
    let centred: Vec<f64> = left.iter().map(|left| left - mean).collect();
    let independent = left.len() as f64 * effective_share(&centred);
    let error = root_mean_square(&centred) / independent.sqrt();
    let told = mean.abs() > CLEAR * error && mean * mean > WORTH * root_mean_square(&left).powi(2);
    told.then_some(LoadShape { offset: true, ..beside.chosen })
}

/// Whether models with a constant force leave less than those `without`, by as much as it is worth.
pub(super) fn worth_it(with: &Models, without: &Models, data: &FrictionData) -> bool {
    match (best(with, data), best(without, data)) {
        (Some(with), Some(without)) => {
            let ratio = root_mean_square(&with) / root_mean_square(&without);
            ratio * ratio < 1.0 - WORTH
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use friction_ident::{Predictor, StagedOptions, Stretch, identify_model};
    use friction_model::{AnyModel, ModelName};

    use super::*;

    /// A contact that bends most of the time, with a constant force of a tenth of its friction beside
    /// it, and without.
    #[test]
    fn a_constant_that_every_model_leaves_over_is_estimated_in_a_second_pass() {
        let fitted = |constant: f64, beside: LoadShape| {
            let truth: Predictor = AnyModel::test_bed(ModelName::LuGre).into();
            let velocity: Vec<f64> = (0..12_000)
                .map(|k| 0.4 * (3e-3 * k as f64).sin() * (4e-4 * k as f64).cos())
                .collect();
            let mut stretch = Stretch::new(1e-3, velocity.clone(), None, velocity).unwrap();
            let noise = |k: usize| 2e-4 * (1.7 * (k * k) as f64).sin();
            let friction = truth.along(&stretch).into_iter().enumerate();
            stretch.friction = friction.map(|(k, f)| f + constant + noise(k)).collect();
            let data = FrictionData::sort(Vec::new(), vec![stretch], None);
            let options = StagedOptions { beside, ..StagedOptions::default() };
            let mut watch = |_, _: &_| ControlFlow::Continue(());
            let found = identify_model(ModelName::LuGre, &data, &options, &mut watch).unwrap();
            (vec![(found, None)], data)
        };
        let level = AnyModel::test_bed(ModelName::LuGre).parameter("f_c").unwrap();
        let (without, data) = fitted(0.1 * level, LoadShape::NONE);
        let offset = LoadShape { offset: true, ..LoadShape::NONE };
        let beside = |chosen| PositionLoadChoice {
            chosen,
            compared: vec![(LoadShape::NONE, 30.0), (offset, 29.9)],
        };
        let shape = left_over(&without, &data, &beside(LoadShape::NONE)).expect("a constant");
        let (with, _) = fitted(0.1 * level, shape);
        assert!(worth_it(&with, &without, &data));
        let offset = with[0].0.estimates.get("offset").unwrap().value;
        assert!((offset / (0.1 * level) - 1.0).abs() < 0.02, "{offset} of {level}");
        assert_eq!(left_over(&with, &data, &beside(shape)), None);
        // Friction of each direction has it in its levels.
        let sides = PositionLoadChoice { chosen: LoadShape::NONE, compared: Vec::new() };
        assert_eq!(left_over(&without, &data, &sides), None);
        let (nothing, data) = fitted(0.0, LoadShape::NONE);
        assert_eq!(left_over(&nothing, &data, &beside(LoadShape::NONE)), None);
    }
}
