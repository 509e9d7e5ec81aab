//! A constant force that shows only beside a friction model.
//!
//! What acts beside friction is asked before any fit, with columns that stand for friction
//! ([`choose_position_load`](friction_ident::choose_position_load)). Where the contact bends for much of a recording they leave a
//! third of the force, and a constant force of a tenth of the friction is lost in that. A friction
//! model leaves it over, in every sample with the same sign.

use friction_ident::position_load::LoadShape;
use friction_ident::residual_whiteness::effective_share;
use friction_ident::staged::residuals;
use friction_ident::{FrictionData, Identified};

use super::from_drive::FromDrive;

/// Standard errors that the mean of what is left must be clear of zero by.
const CLEAR: f64 = 4.0;
/// Share of the mean square left that it must be, as for any constant force beside friction.
const WORTH: f64 = 0.01;
/// Share of the samples of either direction, at least: friction of one direction is a constant too.
const BOTH_WAYS: f64 = 0.1;

type Models = [(Identified, Option<FromDrive>)];

/// What the best of some models leaves over all samples; none where there is none.
fn best(models: &Models, data: &FrictionData) -> Option<Vec<f64>> {
    let left = models.iter().filter(|(found, _)| found.converged).map(|(found, _)| {
        let left = residuals(&found.predictor(), data);
        (mean_square(&left), left)
    });
    left.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, left)| left)
}

fn mean_square(values: &[f64]) -> f64 {
    let mean = values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64;
    if mean.is_finite() { mean } else { f64::INFINITY }
}

/// What to estimate beside friction in place of `beside`, where the best of the models leaves a
/// constant.
pub(super) fn left_over(
    models: &Models,
    data: &FrictionData,
    beside: LoadShape,
    asymmetric: bool,
) -> Option<LoadShape> {
    if asymmetric || beside.offset || !goes_both_ways(data) {
        return None;
    }
    let left = best(models, data)?;
    let mean = left.iter().sum::<f64>() / left.len().max(1) as f64;
    let centred: Vec<f64> = left.iter().map(|left| left - mean).collect();
    let independent = left.len() as f64 * effective_share(&centred);
    let error = (mean_square(&centred) / independent).sqrt();
    let told = mean.abs() > CLEAR * error && mean * mean > WORTH * mean_square(&left);
    told.then_some(LoadShape { offset: true, ..beside })
}

/// Whether models with a constant force leave less than those `without`, by as much as it is worth.
pub(super) fn worth_it(with: &Models, without: &Models, data: &FrictionData) -> bool {
    match (best(with, data), best(without, data)) {
        (Some(with), Some(without)) => mean_square(&with) < (1.0 - WORTH) * mean_square(&without),
        _ => false,
    }
}

fn goes_both_ways(data: &FrictionData) -> bool {
    let stretches = [&data.pre_sliding, &data.lag, &data.mixed].into_iter().flatten();
    let moving = stretches.flat_map(|stretch| stretch.velocity.iter().copied());
    let (mut forward, mut backward) = (0.0, 0.0);
    for velocity in moving.chain(data.points.iter().map(|point| point.velocity)) {
        if velocity > 0.0 { forward += 1.0 } else { backward += 1.0 }
    }
    f64::min(forward, backward) > BOTH_WAYS * (forward + backward)
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
        let shape = left_over(&without, &data, LoadShape::NONE, false).expect("a constant");
        let (with, _) = fitted(0.1 * level, shape);
        assert!(worth_it(&with, &without, &data));
        let offset = with[0].0.estimates.get("offset").unwrap().value;
        assert!((offset / (0.1 * level) - 1.0).abs() < 0.02, "{offset} of {level}");
        assert_eq!(left_over(&with, &data, shape, false), None);
        let (nothing, data) = fitted(0.0, LoadShape::NONE);
        assert_eq!(left_over(&nothing, &data, LoadShape::NONE, false), None);
    }
}
