//! Among models that predict friction at rest too, what they leave there decides.
//!
//! All models are compared where all of them predict: a static one predicts a range at rest, so that
//! those samples count for none. Most of a recording of a bending contact is at rest in that sense.
//! Once a model is chosen that predicts a value everywhere, the others that do are compared with it
//! over every sample.

use friction_ident::staged::all_predict;
use friction_ident::{FrictionData, Identified};
use friction_model::ModelName;

use super::ranking::{Model, on_common_ground, ranked};
use super::{Criterion, KINDS, ModelResult};

/// What the models that predict everywhere leave over all samples, those at rest too.
#[derive(Debug, Clone, PartialEq)]
pub struct AtRestToo {
    /// Each with its root mean square error [N or N m], on the recordings held out where there are
    /// any; best first.
    pub errors: Vec<(ModelName, f64)>,
}

/// The place of the model to use once samples at rest count too, and what they said. Nothing where
/// no sample was left out, or where the chosen model or all others do not predict there.
pub(super) fn decide(
    models: &[ModelResult],
    chosen: usize,
    (data, held_out): (&FrictionData, Option<&FrictionData>),
    criterion: Criterion,
) -> Option<(usize, AtRestToo)> {
    let judged = held_out.unwrap_or(data);
    let everywhere = |found: &Identified| {
        KINDS.iter().all(|&kind| all_predict(&[found.model], judged, kind).iter().all(|all| *all))
    };
    if models.iter().all(|model| everywhere(&model.found)) {
        return None;
    }
    let with = |model: &&ModelResult| model.cannot_be_chosen.is_none() && everywhere(&model.found);
    let mut contenders: Vec<Model> =
        models.iter().filter(with).map(|m| (m.found.clone(), m.from_drive.clone())).collect();
    let name = models.get(chosen)?.found.name;
    if contenders.len() < 2 || !contenders.iter().any(|(found, _)| found.name == name) {
        return None;
    }
    on_common_ground(&mut contenders, data);
    let (again, place) = ranked(contenders, data, held_out, criterion);
    let name = again.get(place?)?.found.name;
    let errors = again.iter().map(|model| (model.found.name, model.error())).collect();
    let place = models.iter().position(|model| model.found.name == name)?;
    Some((place, AtRestToo { errors }))
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use friction_ident::{Predictor, StagedOptions, Stretch, identify_model};
    use friction_model::AnyModel;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::*;

    /// Mostly small motion about a point, as in a test of pre-sliding, and a little sliding. With
    /// Coulomb friction beside them, LuGre and Dahl were told apart by the few samples that slide.
    #[test]
    fn a_bending_contact_is_judged_where_it_bends() {
        let truth: Predictor = AnyModel::test_bed(ModelName::LuGre).into();
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(5);
        let mut record = |seed: f64| {
            let motion = |k: usize| {
                let t = 1e-3 * k as f64;
                let small = 0.01 * (7.0 + seed) * ((7.0 + seed) * t).cos();
                if k % 5000 > 4500 { 2.0 * (20.0 * t).cos() } else { small * (0.3 * t).cos() }
            };
            let velocity: Vec<f64> = (0..20_000).map(motion).collect();
            let noise = |friction: f64| friction + 1e-3 * rng.sample::<f64, _>(StandardNormal);
            let silent = vec![0.0; velocity.len()];
            let mut stretch = Stretch::new(1e-3, velocity, None, silent).unwrap();
            stretch.friction = truth.along(&stretch).into_iter().map(noise).collect();
            FrictionData::sort(Vec::new(), vec![stretch], None)
        };
        let (data, held_out) = (record(0.0), record(1.0));
        let names = [ModelName::CoulombViscous, ModelName::Dahl, ModelName::LuGre];
        let mut watch = |_, _: &_| ControlFlow::Continue(());
        let options = StagedOptions::default();
        let mut fitted: Vec<Model> = names
            .iter()
            .map(|&name| (identify_model(name, &data, &options, &mut watch).unwrap(), None))
            .collect();
        on_common_ground(&mut fitted, &data);
        let (models, chosen) = ranked(fitted, &data, Some(&held_out), Criterion::HeldOut);
        let (of, by) = ((&data, Some(&held_out)), Criterion::HeldOut);
        let place = |name| models.iter().position(|model| model.found.name == name).unwrap();
        // Whatever the sliding alone said of the two, and it must not have been a static model.
        let (place_again, told) = decide(&models, place(ModelName::Dahl), of, by).unwrap();
        assert_eq!(models[place_again].found.name, ModelName::LuGre, "{told:?} {chosen:?}");
        assert!(told.errors.len() == 2 && told.errors[0].1 < told.errors[1].1, "{told:?}");
        assert_eq!(decide(&models, place(ModelName::CoulombViscous), of, by), None);
    }
}
