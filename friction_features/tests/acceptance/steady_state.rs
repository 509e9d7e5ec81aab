//! Section 5.6.

use friction_features::{SteadyStateSettings, steady_state};
use friction_model::ModelName;

use crate::{assert_close, chapter_3};

#[test]
fn every_model_settles_at_the_force_it_promises_in_both_forms() {
    for name in ModelName::ALL.into_iter().filter(|&name| name != ModelName::Bristle) {
        let result = steady_state(&chapter_3(name), &SteadyStateSettings::default());
        assert_eq!(result.velocity.len(), 14, "{name}");
        assert!(result.error < 1e-9, "{name}, derivative form: {:e}", result.error);
        assert!(
            result.fixed_step_error < 1e-9,
            "{name}, fixed-step form: {:e}",
            result.fixed_step_error
        );
    }
}

/// The bonds of the bristle model snap at random: its force has the standard deviation
/// `sqrt(2 / N)` of the mean, here .14, for ever.
#[test]
fn the_bristle_model_never_settles() {
    let result = steady_state(&chapter_3(ModelName::Bristle), &SteadyStateSettings::default());
    let deviations: Vec<f64> = [&result.derivative_form, &result.fixed_step_form]
        .into_iter()
        .flat_map(|reached| {
            reached.iter().zip(&result.promised).map(|(reached, promised)| reached - promised)
        })
        .collect();
    let rms = (deviations.iter().map(|d| d * d).sum::<f64>() / deviations.len() as f64).sqrt();
    // The rms of 28 draws has a standard deviation of .019.
    assert_close("rms deviation", rms, 2.0f64.sqrt() / 10.0, 0.06);
}

/// Models with a Stribeck curve all promise the same one.
#[test]
fn the_promise_is_the_stribeck_curve() {
    for name in [
        ModelName::Stribeck,
        ModelName::LuGre,
        ModelName::Proposed,
        ModelName::Gms,
        ModelName::Xiong,
    ] {
        let result = steady_state(&chapter_3(name), &SteadyStateSettings::default());
        for (&v, &force) in result.velocity.iter().zip(&result.promised) {
            let g = 1.0 + 0.5 * (-(v / 0.01) * (v / 0.01)).exp();
            assert_close(&format!("{name} at {v} m/s"), force, v.signum() * g, 1e-14);
        }
        let curve = &result.curve;
        assert_eq!((curve.velocity[0], curve.velocity[600]), (-0.5, 0.5));
        assert!(
            curve.friction.iter().zip(curve.friction.iter().rev()).all(|(f, r)| *f == -*r),
            "{name}"
        );
    }
}
