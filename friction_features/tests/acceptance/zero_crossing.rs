//! Reversal: closed forms, and what static models cannot show.

use friction_features::{ZeroCrossingSettings, zero_crossing};
use friction_model::ModelName;

use crate::{assert_close, assert_relative, chapter_3, chapter_3_with};

/// Dahl's force depends on the way alone: `F = F_c (1 - 2 exp(-sigma0 x / F_c))` from the turn on.
/// Its rate is steepest somewhere after the turn: of `2 sigma0 a t exp(-sigma0 a t^2 / (2 F_c))`
/// the largest value is at `t = sqrt(F_c / (sigma0 a))`.
#[test]
fn dahl_reverses_over_the_same_way_at_every_acceleration() {
    let (f_c, sigma0) = (1.0f64, 1e5f64);
    for result in zero_crossing(&chapter_3(ModelName::Dahl), &ZeroCrossingSettings::default()) {
        let a = result.acceleration;
        assert_relative("at the turn", result.friction_at_turn, -f_c, 1e-9);
        let way = |value: Option<f64>| value.unwrap() * sigma0 / f_c;
        assert_relative("to zero", way(result.displacement_to_zero), 2.0f64.ln(), 1e-3);
        assert_relative("to 90 %", way(result.displacement_to_sliding), 20.0f64.ln(), 1e-3);
        let expected = (2.0 * 20.0f64.ln() * f_c / (sigma0 * a)).sqrt();
        assert_relative("time", result.time_to_sliding.unwrap(), expected, 1e-3);
        let steepest = 2.0 * (sigma0 * a * f_c).sqrt() * (-0.5f64).exp();
        assert_relative("steepest", result.steepest.unwrap(), steepest, 1e-3);
    }
}

#[test]
fn static_models_jump_at_the_turn() {
    for (name, highest) in [(ModelName::Coulomb, 1.0), (ModelName::Stribeck, 1.5)] {
        for result in zero_crossing(&chapter_3(name), &ZeroCrossingSettings::default()) {
            assert_eq!(
                (result.displacement_to_zero, result.displacement_to_sliding),
                (Some(0.0), Some(0.0))
            );
            assert_eq!(result.steepest, None, "{name}: a jump has no slope");
            assert_close(&format!("{name}, largest"), result.friction_max, highest, 1e-4);
        }
    }
}

#[test]
fn viscous_friction_passes_through_zero_with_the_velocity() {
    let contact = chapter_3_with(ModelName::Viscous, &[("f_v", 2.0)]);
    for result in zero_crossing(&contact, &ZeroCrossingSettings::default()) {
        assert_close("to zero", result.displacement_to_zero.unwrap(), 0.0, 1e-12);
        assert_eq!(result.displacement_to_sliding, None, "there is no sliding level");
        assert_relative("steepest", result.steepest.unwrap(), 2.0 * result.acceleration, 1e-6);
        assert_relative("largest", result.friction_max, 0.1, 1e-9);
    }
}

/// In gross sliding the level follows the Stribeck curve late: the faster the reversal, the less of
/// the static level is seen. In the proposed and in Xiong's model the contact force never exceeds
/// it. GMS's jumps do, and have no slope.
#[test]
fn the_lag_hides_the_static_level_in_a_fast_reversal() {
    for name in [ModelName::Proposed, ModelName::Xiong] {
        let results = zero_crossing(&chapter_3(name), &ZeroCrossingSettings::default());
        assert!(results.iter().all(|result| result.friction_max < 1.5), "{name}");
        let [slow, fast] = [&results[0], &results[1]];
        assert!(slow.friction_at_turn < fast.friction_at_turn - 0.1, "{name}");
        assert!(results.iter().all(|result| result.steepest.is_some()), "{name}");
    }
    let gms = zero_crossing(&chapter_3(ModelName::Gms), &ZeroCrossingSettings::default());
    assert!(gms.iter().all(|result| result.friction_max > 2.0 && result.steepest.is_none()));
}
