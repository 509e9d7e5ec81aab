//! The models in order, and which of them to use.

use std::cmp::Ordering;

use friction_ident::information::{
    Difference, Information, Standing, paired_difference, paired_ratio,
};
use friction_ident::model_choice::{self, Candidate, Unfit, unfit};
use friction_ident::residual_whiteness::effective_share;
use friction_ident::staged::{all_predict, residuals_of_kind};
use friction_ident::{FrictionData, Identified, Predictor, Stretch};

use super::from_drive::FromDrive;
use super::{Criterion, Errors, KINDS, ModelResult};
use friction_model::AnyModel;

/// Blocks over which two models are compared.
const BLOCKS: usize = 20;
/// A difference of BIC that is worth mentioning (Kass and Raftery 1995).
const BIC_NOTICEABLE: f64 = 2.0;

/// A model as it was found, and what of it moves with the drive's constants.
pub(super) type Model = (Identified, Option<FromDrive>);

/// What of recordings counts in the comparison of some models: the points and samples that all of
/// them predict.
struct Ground<'a> {
    data: &'a FrictionData,
    counts: Vec<Vec<bool>>,
}

impl<'a> Ground<'a> {
    fn new(models: &[Model], data: &'a FrictionData) -> Self {
        let models: Vec<AnyModel> = models.iter().map(|(found, _)| found.model).collect();
        let counts = KINDS.map(|kind| all_predict(&models, data, kind)).to_vec();
        Self { data, counts }
    }

    /// What the model leaves, of each kind.
    fn residuals(&self, by: &Predictor) -> Vec<Vec<f64>> {
        let of = |(kind, counts): (_, &Vec<bool>)| {
            let residuals = residuals_of_kind(by, self.data, kind).into_iter().zip(counts);
            residuals.filter(|(_, counts)| **counts).map(|(residual, _)| residual).collect()
        };
        KINDS.into_iter().zip(&self.counts).map(of).collect()
    }
}

/// Information criteria over one and the same number of independent samples: that of the model that
/// leaves least. Its own for each would compare models by how much of a pattern they leave. Models
/// that cannot be chosen do not set the measure.
pub(super) fn on_common_ground(models: &mut [Model], data: &FrictionData) {
    let (largest, ground) = (largest(data), Ground::new(models, data));
    let mean_square = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>() / r.len().max(1) as f64;
    let left: Vec<Vec<f64>> =
        models.iter().map(|(found, _)| ground.residuals(&found.predictor()).concat()).collect();
    let least = |with_unfit: bool| {
        let all = models.iter().zip(&left);
        let counted = all.filter(|((model, _), _)| with_unfit || unfit(model, largest).is_none());
        counted.map(|(_, left)| left).min_by(|a, b| mean_square(a).total_cmp(&mean_square(b)))
    };
    let Some(share) = least(false).or_else(|| least(true)).map(|least| effective_share(least))
    else {
        return;
    };
    for ((model, _), left) in models.iter_mut().zip(&left) {
        let parameters = model.information.parameters;
        model.information = Information::new(mean_square(left), left.len(), share, parameters);
    }
}

/// Largest magnitude of the friction in recordings \[N or N m\].
fn largest(data: &FrictionData) -> f64 {
    let stretches = [&data.pre_sliding, &data.lag, &data.mixed];
    let points = data.points.iter().map(|point| point.torque);
    let samples = stretches.into_iter().flatten().flat_map(|stretch: &Stretch| &stretch.friction);
    points.chain(samples.copied()).fold(0.0, |largest: f64, f| largest.max(f.abs()))
}

/// One model with what places it.
struct Scored {
    score: f64,
    unfit: Option<Unfit>,
    /// Residuals on what it is judged by, of each kind.
    residuals: Vec<Vec<f64>>,
    result: ModelResult,
}

impl Scored {
    fn new((found, from_drive): Model, fitted: &Ground, held_out: Option<&Ground>) -> Self {
        let here = fitted.residuals(&found.predictor());
        let there = held_out.map(|ground| ground.residuals(&found.predictor()));
        let fit = Errors::of(&here);
        let tried = there.as_deref().map(Errors::of);
        let score = tried.map_or(found.information.bic, |tried| tried.all);
        let none = Difference { mean: 0.0, standard_error: 0.0 };
        let unfit = unfit(&found, largest(fitted.data));
        let result = ModelResult {
            cannot_be_chosen: unfit.as_ref().map(ToString::to_string),
            found,
            fit,
            held_out: tried,
            difference: none,
            ratio: none,
            standing: Standing::Alike,
            from_drive,
        };
        // What is not a number is worse than all.
        let score = if score.is_nan() { f64::INFINITY } else { score };
        Self { score, unfit, residuals: there.unwrap_or(here), result }
    }

    /// Those that cannot be chosen come last.
    fn before(&self, other: &Self) -> Ordering {
        let last = self.unfit.is_some().cmp(&other.unfit.is_some());
        last.then(self.score.total_cmp(&other.score))
    }

    /// As a candidate, once it has been compared with the best.
    fn candidate(&self) -> Candidate {
        Candidate {
            mean_square: self.result.error().powi(2),
            standard_error: model_choice::standard_error(&self.residuals, BLOCKS),
            free_parameters: self.result.found.free_parameters,
            ln_ratio: self.result.ratio,
            fit: self.unfit.is_none(),
        }
    }
}

/// The models in order, and the place of the one to use.
pub(super) fn ranked(
    models: Vec<Model>,
    data: &FrictionData,
    held_out: Option<&FrictionData>,
    criterion: Criterion,
) -> (Vec<ModelResult>, Option<usize>) {
    let fitted = Ground::new(&models, data);
    let tried = held_out.map(|data| Ground::new(&models, data));
    let score = |model| Scored::new(model, &fitted, tried.as_ref());
    let mut scored: Vec<Scored> = models.into_iter().map(score).collect();
    // The sort is stable: equals keep the order in which they were asked for.
    scored.sort_by(Scored::before);
    let Some((first, others)) = scored.split_first_mut() else { return (Vec::new(), None) };
    let (best_score, best_error) = (first.score, first.result.error());
    let best = first.residuals.concat();
    for Scored { score, residuals, result, .. } in others {
        let residuals = residuals.concat();
        result.difference = paired_difference(&residuals, &best, BLOCKS);
        result.ratio = paired_ratio(&residuals, &best, BLOCKS);
        let within = match criterion {
            Criterion::HeldOut => {
                result.difference.is_tie() && (result.ratio.is_tie() || result.ratio.mean < 0.0)
            }
            Criterion::Bic => *score - best_score < BIC_NOTICEABLE,
        };
        result.standing = Standing::of(result.error(), best_error, within);
    }
    let chosen = match criterion {
        Criterion::HeldOut => {
            model_choice::choose(&scored.iter().map(Scored::candidate).collect::<Vec<_>>())
        }
        Criterion::Bic => simplest(&scored),
    };
    (scored.into_iter().map(|scored| scored.result).collect(), chosen)
}

/// Of the models that Schwarz's criterion does not tell from the best one, and whose error is about
/// as small, the one with the fewest free parameters; the better one of two alike.
fn simplest(scored: &[Scored]) -> Option<usize> {
    let fit = || scored.iter().enumerate().filter(|(_, scored)| scored.unfit.is_none());
    let (_, best) = fit().next()?;
    let within = fit().filter(|(_, other)| {
        let near = other.score - best.score < BIC_NOTICEABLE;
        let alike = Standing::of(other.result.error(), best.result.error(), near);
        alike == Standing::Alike
    });
    within.min_by_key(|(_, scored)| scored.result.found.free_parameters).map(|(place, _)| place)
}

#[cfg(test)]
mod tests {
    use friction_ident::{Doubt, Estimate, Estimates, PositionLoad, SteadyPoint, Verdict};
    use friction_model::{AnyModel, AnyParameters, ModelName};

    use super::*;

    fn points() -> FrictionData {
        let noise = |k: i32| 0.01 * (f64::from(k * 7919 % 101) / 50.0 - 1.0);
        let point = |k: i32| {
            let v = 0.02 * f64::from(k - 50);
            SteadyPoint::new(v, v.signum() * 0.5 + 0.2 * v + noise(k))
        };
        FrictionData { points: (0..101).map(point).collect(), ..FrictionData::default() }
    }

    fn model(name: ModelName, values: &[(&'static str, f64)], data: &FrictionData) -> Identified {
        let mut parameters = AnyParameters::test_bed(name);
        values.iter().for_each(|&(name, value)| _ = parameters.set(name, value));
        let model: AnyModel = parameters.try_into().unwrap();
        let residuals = residuals_of_kind(&model.into(), data, KINDS[0]);
        let mse = residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len() as f64;
        let estimate = |&(name, value): &(&'static str, f64)| Estimate {
            id: name.into(),
            unit: "N m",
            value,
            standard_error: Some(0.01),
            interval: None,
            verdict: Verdict::Identified,
        };
        let parameters: Vec<_> = values.iter().map(estimate).collect();
        Identified {
            name,
            model,
            load: PositionLoad::default(),
            stages: Vec::new(),
            information: Information::new(mse, residuals.len(), 1.0, parameters.len()),
            free_parameters: parameters.len(),
            estimates: Estimates { parameters, ..Estimates::default() },
            stopped: false,
            converged: true,
            notes: Vec::new(),
        }
    }

    /// The better error and not one identified parameter: it won because there was nothing to
    /// count.
    #[test]
    fn a_diverged_fit_is_never_chosen_and_its_row_says_why() {
        let data = points();
        let plain = model(ModelName::CoulombViscous, &[("f_c", 0.49), ("f_v", 0.2)], &data);
        let values = [("f_s", 1166.0), ("f_c", 0.5), ("v_s", 1e-4), ("f_v", 0.2)];
        let mut diverged = model(ModelName::Stribeck, &values, &data);
        for estimate in &mut diverged.estimates.parameters {
            estimate.standard_error = None;
            let doubt = Doubt::LargeError { relative_error: f64::INFINITY };
            estimate.verdict = Verdict::NotIdentifiable { doubt, remedy: "more" };
        }
        assert!(diverged.information.mse < plain.information.mse);
        for criterion in [Criterion::HeldOut, Criterion::Bic] {
            let held_out = (criterion == Criterion::HeldOut).then_some(&data);
            let mut both = vec![(diverged.clone(), None), (plain.clone(), None)];
            on_common_ground(&mut both, &data);
            let (models, chosen) = ranked(both, &data, held_out, criterion);
            let chosen = models.get(chosen.unwrap()).unwrap();
            assert_eq!(chosen.found.name, ModelName::CoulombViscous, "{criterion:?}");
            let other = models.last().unwrap();
            let why = other.cannot_be_chosen.as_deref().unwrap();
            assert!(why.contains("f_s is 1.166e3") && !other.tie(), "{why}");
            let alone = vec![(diverged.clone(), None)];
            assert_eq!(ranked(alone, &data, held_out, criterion).1, None);
        }
    }

    /// Both predict alike; the simpler one has fewer free parameters, though the other one has
    /// fewer identified ones.
    #[test]
    fn free_parameters_count_whether_or_not_the_data_determined_them() {
        let data = points();
        let plain = model(ModelName::CoulombViscous, &[("f_c", 0.5), ("f_v", 0.2)], &data);
        let values = [("f_s", 0.501), ("f_c", 0.5), ("v_s", 0.01), ("f_v", 0.2)];
        let mut rich = model(ModelName::Stribeck, &values, &data);
        for estimate in rich.estimates.parameters.iter_mut().filter(|e| e.id.name != "f_c") {
            let doubt = Doubt::LargeError { relative_error: 3.0 };
            estimate.verdict = Verdict::NotIdentifiable { doubt, remedy: "more" };
        }
        let both = vec![(rich, None), (plain, None)];
        let (models, chosen) = ranked(both, &data, Some(&data), Criterion::HeldOut);
        assert_eq!(models[chosen.unwrap()].found.name, ModelName::CoulombViscous);
    }
}
