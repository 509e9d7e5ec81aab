use friction_model::ModelName::{self, *};

use super::tests::{experiments, identify};
use super::*;
use crate::{Uncertain, Verdict};

fn test_bed(name: ModelName, scaled: &[(&str, f64)]) -> AnyModel {
    let start = AnyModel::test_bed(name);
    scaled.iter().fold(start, |model, (parameter, by)| model.scaled(parameter, *by).unwrap())
}

/// The inertia of the test bed, which friction from the driving force cannot do without.
fn with_inertia() -> StagedOptions {
    StagedOptions { inertia: Some(Uncertain::relative(0.0026, 0.01)), ..StagedOptions::default() }
}

/// The damping ratio of 0.7 is a choice. An axis whose bristles are damped by a fifth of it, or by
/// twice as much, gave a wrong stiffness with a narrow interval, and Dahl's model was preferred over
/// the right one.
#[test]
fn a_damping_that_the_recordings_show_is_not_computed() {
    for by in [0.2, 2.0] {
        let truth = test_bed(LuGre, &[("sigma1", by)]);
        let found = identify(LuGre, &experiments(&truth, 1e-3, 5), &with_inertia());
        for name in ["sigma0", "sigma1", "f_c"] {
            let (estimate, value) =
                (found.estimates.get(name).unwrap(), truth.parameter(name).unwrap());
            let errors = (estimate.value - value).abs() / estimate.standard_error.unwrap();
            assert!(errors < 4.0, "{by}: {estimate:?}, truth {value}");
            assert!(estimate.is_identified(), "{by}: {estimate:?}");
        }
        assert!((found.information.mse.sqrt() / 1e-3 - 1.0).abs() < 0.02, "{by}");
        assert!(found.notes.iter().any(|note| note.contains("sigma1")), "{:?}", found.notes);
        assert_eq!(found.free_parameters, 6);
    }
}

/// Viscous friction that damps more than was asked for leaves nothing to compute: the model was left
/// out, though the recordings show its damping.
#[test]
fn viscous_friction_that_leaves_nothing_to_compute_refuses_no_model() {
    for name in [LuGre, Proposed, ElastoPlastic] {
        let truth = test_bed(name, &[("f_v", 10.0)]);
        let found = identify(name, &experiments(&truth, 1e-3, 5), &with_inertia());
        assert!((found.information.mse.sqrt() / 1e-3 - 1.0).abs() < 0.02, "{name}");
        assert!(found.notes.iter().any(|note| note.contains("micro-damping")), "{:?}", found.notes);
    }
}

/// What no recording shows is still computed.
#[test]
fn a_damping_that_no_recording_contradicts_is_computed() {
    let truth = test_bed(LuGre, &[]);
    let whole = experiments(&truth, 1e-3, 5);
    for data in [
        FrictionData { points: whole.points.clone(), ..FrictionData::default() },
        FrictionData {
            points: whole.points.clone(),
            lag: whole.lag.clone(),
            ..FrictionData::default()
        },
    ] {
        let found = identify(LuGre, &data, &with_inertia());
        let damping = found.estimates.get("sigma1").unwrap();
        assert!(
            matches!(damping.verdict, Verdict::Given { source } if source.contains("computed")),
            "{damping:?}"
        );
    }
}

/// How the parameters answer to other constants of the drive is asked of the same fit.
#[test]
fn refining_again_keeps_what_was_decided() {
    for by in [0.2, 1.0] {
        let truth = test_bed(LuGre, &[("sigma1", by)]);
        let data = experiments(&truth, 0.0, 5);
        let found = identify(LuGre, &data, &with_inertia());
        let watch = &mut |_, _: &Step| ControlFlow::Continue(());
        let again = refine_jointly(&found, &found.model, &data, &with_inertia(), watch);
        let again = again.unwrap().unwrap();
        let ids = |stage: &StageResult| {
            stage.estimates.parameters.iter().map(|one| one.id).collect::<Vec<_>>()
        };
        assert_eq!(ids(&again), ids(found.stages.last().unwrap()), "{by}");
    }
}
