//! Section 5.4.

use friction_features::{Breakaway, BreakawaySettings, Contact, breakaway};
use friction_model::ModelName;

use crate::{assert_close, chapter_3, chapter_3_with};

fn at_step(contact: &Contact, step: f64) -> Vec<Breakaway> {
    breakaway(contact, &BreakawaySettings { step: Some(step), ..BreakawaySettings::default() })
}

fn found(contact: &Contact) -> Vec<Breakaway> {
    breakaway(contact, &BreakawaySettings::default())
}

/// Largest friction [N] and applied force at 1 mm/s [N] for .05, .1 and .2 N/s.
#[track_caller]
fn assert_breaks_away(
    what: &str,
    results: &[Breakaway],
    friction: [f64; 3],
    applied: Option<[f64; 3]>,
) {
    assert_eq!(results.len(), 3);
    for (i, result) in results.iter().enumerate() {
        let rate = result.rate;
        assert_close(
            &format!("{what}, friction at {rate} N/s"),
            result.friction_max,
            friction[i],
            2e-4,
        );
        if let Some(applied) = applied {
            let value = result.applied_at_threshold.unwrap();
            assert_close(&format!("{what}, applied at {rate} N/s"), value, applied[i], 2e-4);
        }
    }
}

#[test]
fn the_largest_friction_and_the_load_at_a_velocity_are_those_of_the_independent_implementation() {
    let lugre = ([1.49902, 1.49844, 1.49753], [1.5073, 1.5100, 1.5132]);
    assert_breaks_away(
        "LuGre",
        &at_step(&chapter_3(ModelName::LuGre), 2e-5),
        lugre.0,
        Some(lugre.1),
    );
    let proposed = ([1.49996, 1.49991, 1.49976], [1.5087, 1.5121, 1.5166]);
    let contact = chapter_3(ModelName::Proposed);
    assert_breaks_away("proposed", &at_step(&contact, 1e-4), proposed.0, Some(proposed.1));
    let xiong = ([1.49999, 1.49996, 1.49962], [1.5089, 1.5126, 1.5158]);
    assert_breaks_away(
        "Xiong",
        &at_step(&chapter_3(ModelName::Xiong), 1e-4),
        xiong.0,
        Some(xiong.1),
    );
    let gms = [1.4070, 1.4365, 1.4348];
    assert_breaks_away("GMS", &at_step(&chapter_3(ModelName::Gms), 1e-4), gms, None);
}

#[test]
fn the_steps_found_by_halving_give_the_same() {
    assert_breaks_away(
        "LuGre",
        &found(&chapter_3(ModelName::LuGre)),
        [1.49902, 1.49844, 1.49753],
        None,
    );
    assert_breaks_away(
        "proposed",
        &found(&chapter_3(ModelName::Proposed)),
        [1.49996, 1.49991, 1.49976],
        None,
    );
    assert_breaks_away(
        "Xiong",
        &found(&chapter_3(ModelName::Xiong)),
        [1.49999, 1.49996, 1.49962],
        None,
    );
    assert_breaks_away("GMS", &found(&chapter_3(ModelName::Gms)), [1.4070, 1.4365, 1.4348], None);
}

/// With a small Stribeck velocity both measures fall with the rate, with a larger one they go
/// apart: the thesis's two statements.
#[test]
fn friction_falls_with_the_rate_and_the_load_at_a_velocity_may_do_either() {
    let steep = chapter_3_with(ModelName::Proposed, &[("v_s", 0.001), ("sigma", 1000.0)]);
    let steep = at_step(&steep, 1e-4);
    let expected = ([1.49826, 1.49560, 1.48886], [1.5010, 1.4998, 1.4952]);
    assert_breaks_away("proposed, v_s .001", &steep, expected.0, Some(expected.1));
    let lugre = at_step(&chapter_3_with(ModelName::LuGre, &[("v_s", 0.001)]), 2e-5);
    assert_breaks_away("LuGre, v_s .001", &lugre, [1.49061, 1.48512, 1.47644], None);
    let slow = found(&chapter_3(ModelName::Proposed));
    let rises = |results: &[Breakaway], f: fn(&Breakaway) -> f64| {
        results.windows(2).all(|pair| f(&pair[1]) > f(&pair[0]))
    };
    let falls = |results: &[Breakaway], f: fn(&Breakaway) -> f64| {
        results.windows(2).all(|pair| f(&pair[1]) < f(&pair[0]))
    };
    let applied = |result: &Breakaway| result.applied_at_threshold.unwrap();
    for results in [&slow, &steep, &lugre] {
        assert!(falls(results, |result| result.friction_max));
    }
    assert!(rises(&slow, applied) && falls(&steep, applied));
}

#[test]
fn the_proposed_model_breaks_away_short_of_its_breakaway_deflection() {
    for results in
        [found(&chapter_3(ModelName::Proposed)), at_step(&chapter_3(ModelName::Proposed), 1e-4)]
    {
        assert_close("displacement", results[1].displacement.unwrap(), 8.46e-4, 0.6e-6);
    }
}

#[test]
fn static_models_break_away_at_their_level_without_moving_first() {
    let stribeck = found(&chapter_3(ModelName::Stribeck));
    assert_breaks_away("Stribeck", &stribeck, [1.5; 3], None);
    assert!(stribeck.iter().all(|result| result.displacement == Some(0.0)));
    // Friction that never falls has no peak.
    let coulomb = found(&chapter_3(ModelName::Coulomb));
    assert_breaks_away("Coulomb", &coulomb, [1.0; 3], None);
    assert!(coulomb.iter().all(|result| result.displacement.is_none()));
    let dahl = found(&chapter_3(ModelName::Dahl));
    assert_breaks_away("Dahl", &dahl, [1.0; 3], None);
    assert!(dahl.iter().all(|result| result.displacement.is_none()));
}

/// `F_c + (F_s - F_c) exp(-r / t_s)`: at .05, .1 and .2 N/s, with t_s = .1 N/s.
#[test]
fn rate_dependent_stiction_breaks_away_at_the_level_of_its_rate() {
    let results = found(&chapter_3(ModelName::RateDependentStiction));
    assert_breaks_away("rate-dependent stiction", &results, [1.30327, 1.18394, 1.06767], None);
}

/// Under Coulomb friction the body obeys `m x'' = r t`, t counted from breakaway: the velocity is
/// `r t^2 / 2`.
#[test]
fn the_load_at_a_velocity_is_that_of_the_closed_form() {
    for result in found(&chapter_3(ModelName::Coulomb)) {
        let expected = 1.0 + result.rate * (2.0 * 1e-3 / result.rate).sqrt();
        assert_close("applied", result.applied_at_threshold.unwrap(), expected, 1e-4);
    }
}

#[test]
fn a_load_that_does_not_reach_breakaway_moves_nothing() {
    let settings =
        BreakawaySettings { limit: 1.4, rates: vec![0.2], ..BreakawaySettings::default() };
    let result = breakaway(&chapter_3(ModelName::Stribeck), &settings).remove(0);
    assert_eq!((result.applied_at_threshold, result.displacement), (None, None));
    assert_close("friction balances the load", result.friction_max, 1.4, 1e-12);
}
