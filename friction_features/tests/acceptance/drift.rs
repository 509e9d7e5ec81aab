//! Section 5.2.

use friction_features::{NonDrift, NonDriftSettings, non_drift};
use friction_model::ModelName;

use crate::{assert_close, assert_relative, chapter_3};

fn drift(name: ModelName) -> NonDrift {
    non_drift(&chapter_3(name), &NonDriftSettings::default())
}

#[test]
fn the_load_goes_up_falls_rests_and_oscillates() {
    let load = NonDriftSettings::default();
    for (time, force) in [
        (0.0, 0.0),
        (0.5, 1.0),
        (1.0, 2.0),
        (1.005, 1.2),
        (1.01, 0.4),
        (3.0, 0.4),
        (6.0, 0.4),
        (6.125, 0.6),
        (6.25, 0.4),
        (6.375, 0.2),
        (25.75, 0.4),
        (25.875, 0.2),
    ] {
        assert_close(&format!("force at {time} s"), load.force(time), force, 1e-9);
    }
}

/// LuGre's bristles yield a little in each direction, but more forward, where the mean load pushes.
#[test]
fn lugre_drifts() {
    let result = drift(ModelName::LuGre);
    assert_relative("drift over 39 cycles", result.drift, 9.13e-5, 0.02);
    assert_relative("drift per cycle", result.drift_per_cycle, 2.34e-6, 0.02);
    assert!(result.drift_per_cycle > 2e-6 && result.evidence.holds_to(1e-4));
    let steps: Vec<f64> = result.cycle_ends.windows(2).map(|ends| ends[1] - ends[0]).collect();
    assert_eq!(steps.len(), 39);
    assert!(
        steps.iter().all(|step| (step / 2.342e-6 - 1.0).abs() < 1e-3),
        "every cycle alike: {steps:?}"
    );
}

#[test]
fn models_with_true_pre_sliding_do_not_drift() {
    for name in [ModelName::ElastoPlastic, ModelName::Proposed, ModelName::Gms, ModelName::Xiong] {
        let result = drift(name);
        assert!(result.drift_per_cycle.abs() < 1e-9, "{name}: {}", result.drift_per_cycle);
        assert!(result.swing > 1e-6, "{name} gives way to the load: {}", result.swing);
    }
}

/// Damped bristles creep towards their closed loop for the first cycles: backwards, since they are
/// still unloading. The science gives two digits.
#[test]
fn damped_bristles_creep_for_the_first_cycles_only() {
    assert_close("proposed", drift(ModelName::Proposed).drift, -1.4e-6, 0.06e-6);
    assert_close("GMS", drift(ModelName::Gms).drift, -1.9e-5, 0.06e-5);
    assert_close("Xiong", drift(ModelName::Xiong).drift, 0.0, 1e-12);
    assert_close("elasto-plastic", drift(ModelName::ElastoPlastic).drift, 0.0, 1e-12);
}

/// The spring of a stuck contact without damping rings, and its position at any instant says
/// nothing about drift.
#[test]
fn ringing_is_not_taken_for_drift() {
    for name in [ModelName::Armstrong, ModelName::Wojewoda] {
        let result = drift(name);
        assert!(result.drift.abs() > 1e-4, "{name} rings: {}", result.drift);
        assert!(result.drift_per_cycle.abs() < 1e-7, "{name}: {}", result.drift_per_cycle);
    }
}

#[test]
fn static_models_rest_exactly() {
    for name in [ModelName::Coulomb, ModelName::Stribeck] {
        let result = drift(name);
        assert_eq!((result.drift, result.drift_per_cycle, result.swing), (0.0, 0.0, 0.0), "{name}");
    }
}

/// Nothing holds a body on viscous friction: the mean load carries it away at `hold / f_v`, in the
/// end.
#[test]
fn viscous_friction_holds_nothing() {
    let contact = crate::chapter_3_with(ModelName::Viscous, &[("f_v", 10.0)]);
    let result = non_drift(&contact, &NonDriftSettings::default());
    assert_relative("per cycle", result.drift_per_cycle, 0.4 / 10.0 * 0.5, 1e-6);
}
