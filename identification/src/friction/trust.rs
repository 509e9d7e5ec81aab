//! Whether the chosen model explains the recordings, or lacks something that acts in them.

use friction_ident::adequacy::{FitDoubt, Quantity, doubts_of};
use friction_ident::one_speed::one_speed;
use friction_ident::staged::residuals_of_kind;
use friction_ident::statistics::root_mean_square;
use friction_ident::{FrictionData, Stretch, StretchKind};

use recording::AxisKind;

use super::{ModelResult, wording};

/// How many times larger the share of the force that a model leaves may be on recordings held out
/// than on those it was fitted to, before that is said.
const FAR_WORSE: f64 = 2.0;
/// Share of the force from which there is anything to say.
const NOTHING: f64 = 0.02;

/// Whether the model errs far more on recordings it has not seen: those hold something that the
/// fitted ones do not.
pub(super) fn worse_elsewhere(
    chosen: &ModelResult,
    fitted: &FrictionData,
    held_out: &FrictionData,
) -> Option<String> {
    let share = |error: f64, data: &FrictionData| error / force(data).max(f64::MIN_POSITIVE);
    let here = share(chosen.fit.all, fitted);
    let there = share(chosen.held_out?.all, held_out);
    (there > FAR_WORSE * here && there > NOTHING).then(|| {
        format!(
            "{} leaves {} % of the force on the recordings held out and {} % on those it was fitted to: they hold something that these do not show, \
             such as other speeds, places or turns. Fit it to recordings like those that it is meant for.",
            chosen.found.name,
            wording::significant(100.0 * there),
            wording::significant(100.0 * here)
        )
    })
}

/// Root mean square of the friction in recordings \[N or N m\].
fn force(data: &FrictionData) -> f64 {
    let stretches = [&data.pre_sliding, &data.lag, &data.mixed].into_iter().flatten();
    let samples = stretches.flat_map(|stretch| stretch.friction.iter().copied());
    let all: Vec<f64> = data.points.iter().map(|point| point.torque).chain(samples).collect();
    root_mean_square(&all)
}

/// Why the fit of a model is not to be trusted as a whole. Takes the verdict `identified` from all its
/// parameters where it leaves too much of the motion that slides: what it lacks has gone into them.
pub(super) fn distrust(model: &mut ModelResult, data: &FrictionData) -> Vec<FitDoubt> {
    let doubts = whole(model, data);
    if doubts.iter().any(FitDoubt::condemns) {
        model.found.estimates.distrust();
    }
    doubts
}

/// Why the fit of a model is not to be trusted as a whole, from the motion that slides.
fn whole(model: &ModelResult, data: &FrictionData) -> Vec<FitDoubt> {
    let kinds = [StretchKind::Lag, StretchKind::Mixed];
    let by = model.found.predictor();
    let residual: Vec<f64> =
        kinds.iter().flat_map(|&kind| residuals_of_kind(&by, data, kind)).collect();
    if residual.is_empty() {
        return Vec::new();
    }
    let stretches = || data.lag.iter().chain(&data.mixed);
    let measured: Vec<f64> = stretches().flat_map(|stretch| &stretch.friction).copied().collect();
    let velocity = stretches().flat_map(|stretch| &stretch.velocity).copied().collect();
    let position: Option<Vec<&Vec<f64>>> =
        stretches().map(|stretch: &Stretch| stretch.position.as_ref()).collect();
    let position = position.map(|all| all.into_iter().flatten().copied().collect());
    let columns: Vec<(Quantity, Vec<f64>)> = position
        .map(|position| (Quantity::Position, position))
        .into_iter()
        .chain([(Quantity::Velocity, velocity)])
        .collect();
    doubts_of(&residual, &measured, &columns)
}

/// What is wrong with a model as a whole, in sentences: `whole` is what [`distrust`] found.
pub(super) fn doubts(
    chosen: &ModelResult,
    whole: &[FitDoubt],
    data: &FrictionData,
    axis: AxisKind,
) -> Vec<String> {
    let stretches = || data.lag.iter().chain(&data.mixed);
    let velocity: Vec<f64> = stretches().flat_map(|stretch| &stretch.velocity).copied().collect();
    if velocity.is_empty() {
        return Vec::new();
    }
    let one_speed = one_speed(&velocity).filter(|_| data.points.is_empty()).map(|speed| {
        format!(
            "The sliding has one speed, {} {}, and its turns: how friction changes with speed hangs on the turns alone. \
             Add steady points, or motion at other speeds.",
            wording::significant(speed), axis.velocity_unit()
        )
    });
    let name = chosen.found.name;
    let near_rest = chosen
        .found
        .stages
        .last()
        .and_then(|last| last.left)
        .map(|left| format!("{name}: {left}. Its parameters near rest are not to be trusted."));
    whole.iter().map(|doubt| format!("{name} {doubt}.")).chain(near_rest).chain(one_speed).collect()
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use friction_ident::{StagedOptions, identify_model};
    use friction_model::{AnyModel, ModelName};

    use super::*;
    use crate::friction::Criterion;
    use crate::friction::ranking::ranked;

    /// Held out, the friction is half as much again as where it was fitted, as on another day: that
    /// was told by two columns of numbers alone.
    #[test]
    fn a_model_that_errs_far_more_elsewhere_says_so() {
        let truth = AnyModel::test_bed(ModelName::CoulombViscous).scaled("f_v", 5.0).unwrap();
        let swing = |fastest: f64, noise: f64| {
            let velocity: Vec<f64> =
                (0..4000).map(|k| fastest * (3e-3 * f64::from(k)).sin()).collect();
            let friction = velocity
                .iter()
                .enumerate()
                .map(|(k, &v)| truth.steady_state(v) + noise * (1.7 * k as f64).sin())
                .collect();
            let stretch = Stretch::new(1e-3, velocity, None, friction).unwrap();
            FrictionData::sort(Vec::new(), vec![stretch], None)
        };
        let said = |held_out: &FrictionData| {
            let slow = swing(0.3, 3e-3);
            let mut watch = |_, _: &_| ControlFlow::Continue(());
            let name = ModelName::CoulombViscous;
            let found = identify_model(name, &slow, &StagedOptions::default(), &mut watch).unwrap();
            let (models, chosen) =
                ranked(vec![(found, None)], &slow, Some(held_out), Criterion::HeldOut);
            worse_elsewhere(&models[chosen.unwrap()], &slow, held_out)
        };
        assert_eq!(said(&swing(0.25, 3e-3)), None);
        let mut far = swing(0.25, 3e-3);
        far.mixed[0].friction.iter_mut().for_each(|f| *f *= 1.5);
        assert!(said(&far).unwrap().contains("held out"));
    }

    /// A wave that no model of friction has: "not to be trusted" stood above a table in which the
    /// Coulomb level was identified to 3 %.
    #[test]
    fn a_model_that_leaves_too_much_has_no_identified_parameter() {
        let truth = AnyModel::test_bed(ModelName::CoulombViscous);
        let level = truth.parameter("f_c").unwrap();
        let found = |wave: f64| {
            let velocity: Vec<f64> = (0..8000).map(|k| (3e-3 * f64::from(k)).sin()).collect();
            let noise = |k: usize| 0.01 * (12.9898 * k as f64 * k as f64).sin();
            let force = |(k, &v): (usize, &f64)| {
                truth.steady_state(v) + level * (noise(k) + wave * (0.0171 * k as f64).sin())
            };
            let friction = velocity.iter().enumerate().map(force).collect();
            let stretch = Stretch::new(1e-3, velocity, None, friction).unwrap();
            let data = FrictionData::sort(Vec::new(), vec![stretch], None);
            let mut watch = |_, _: &_| ControlFlow::Continue(());
            let name = ModelName::CoulombViscous;
            let found = identify_model(name, &data, &StagedOptions::default(), &mut watch).unwrap();
            let (mut models, _) = ranked(vec![(found, None)], &data, None, Criterion::Bic);
            distrust(&mut models[0], &data);
            models[0].found.estimates.get("f_c").unwrap().is_identified()
        };
        assert!(found(0.0) && !found(1.0));
    }
}
