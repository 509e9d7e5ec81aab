//! Section 5.3.

use std::f64::consts::{FRAC_PI_2, PI};

use friction_features::{NonLocalMemory, NonLocalMemorySettings, non_local_memory};
use friction_model::ModelName;

use crate::{assert_close, assert_relative, chapter_3, chapter_3_with};

fn memory(name: ModelName) -> NonLocalMemory {
    non_local_memory(&chapter_3(name), &NonLocalMemorySettings::chapter_3(name)).unwrap()
}

fn at_amplitude(name: ModelName, amplitude: f64) -> NonLocalMemory {
    let settings = NonLocalMemorySettings { amplitude: Some(amplitude), ..Default::default() };
    non_local_memory(&chapter_3(name), &settings).unwrap()
}

/// Turns of the path with the inner loop, in amplitudes.
const TURNS: [f64; 6] = [1.0, -0.5, 0.5, -0.1, 0.5, 0.8];

#[test]
fn loops_of_models_without_non_local_memory_do_not_close() {
    let lugre = memory(ModelName::LuGre);
    assert_relative("LuGre, closure gap", lugre.closure_gap, -0.1551, 5e-4);
    assert_relative("LuGre, wiping-out error", lugre.wiping_out_error, -0.1448, 5e-4);
    let elasto_plastic = memory(ModelName::ElastoPlastic);
    assert_close("elasto-plastic, closure gap", elasto_plastic.closure_gap, -0.0111, 0.7e-4);
    assert_close(
        "elasto-plastic, wiping-out error",
        elasto_plastic.wiping_out_error,
        -0.0044,
        0.7e-4,
    );
    for result in [lugre, elasto_plastic] {
        assert!(result.congruency_error > 0.03, "{}", result.congruency_error);
        assert!(result.evidence.holds_to(2e-4), "{:?}", result.evidence);
    }
}

#[test]
fn loops_of_models_with_non_local_memory_close_are_wiped_out_and_congruent() {
    for name in [ModelName::Proposed, ModelName::ProposedLinear, ModelName::Gms, ModelName::Xiong] {
        let result = memory(name);
        assert!(result.closure_gap.abs() < 1e-12, "{name}: gap {:e}", result.closure_gap);
        assert!(
            result.wiping_out_error.abs() < 1e-12,
            "{name}: wiping {:e}",
            result.wiping_out_error
        );
        assert!(
            result.congruency_error.abs() < 1e-10,
            "{name}: congruency {:e}",
            result.congruency_error
        );
    }
    for name in [ModelName::Proposed, ModelName::Gms, ModelName::Xiong] {
        // The congruent loops are two loops, and they are no lines.
        let result = memory(name);
        assert!(result.congruency_distance.abs() > 0.1, "{name}: {}", result.congruency_distance);
        assert!(
            result.loop_work > 1e-4 * result.loop_height * result.amplitude,
            "{name}: {}",
            result.loop_work
        );
    }
}

/// With small loops the elasto-plastic contact is elastic in the inner loop: no gap, but no test
/// either, and the opening tells.
#[test]
fn an_elastic_inner_loop_is_told_by_its_opening() {
    let result = at_amplitude(ModelName::ElastoPlastic, 1.3e-5);
    assert!(result.closure_gap.abs() < 1e-12, "{}", result.closure_gap);
    // What is left is the damping, sigma1 v both ways.
    let travel = 0.6 * 1.3e-5;
    let damping = 2.0 * 1e5f64.sqrt() * 1.3e-6 * travel;
    assert_relative("work", result.loop_work, damping, 1e-6);
    assert!(result.loop_opening < 1e-9, "{}", result.loop_opening);
    let opening = memory(ModelName::ElastoPlastic).loop_opening;
    assert!(opening > 0.01, "{opening}");
}

/// The proposed model's tips: the virgin sine, Masing's doubled branches, and `sigma v` on top. The
/// printed tips were sampled up to 1.2 ms before the turns, which at 60 um/s is up to 1.3e-4 N.
#[test]
fn the_proposed_model_turns_at_masings_tips() {
    let (f_s, z_b, a1) = (1.5, 1e-3, 6e-4);
    let virgin = |z: f64| f_s * (FRAC_PI_2 * z / z_b).sin();
    let branch = |(z_r, f_r): (f64, f64), z: f64| f_r + 2.0 * virgin(0.5 * (z - z_r));
    let a = (a1, virgin(a1));
    let b = (-0.5 * a1, branch(a, -0.5 * a1));
    let c = (0.5 * a1, branch(b, 0.5 * a1));
    let d = (-0.1 * a1, branch(c, -0.1 * a1));
    let damping = 1e5f64.sqrt() * a1 / 10.0;
    assert_close("sigma v", damping, 0.01897, 5e-6);
    let expected = [
        a.1 + damping,
        b.1 - damping,
        c.1 + damping,
        d.1 - damping,
        c.1 + damping,
        branch(b, 0.8 * a1) + damping,
    ];
    let result = memory(ModelName::Proposed);
    let printed = [1.23240, -0.75376, 0.64600, -0.22875, 0.64600, 1.00906];
    for ((tip, expected), printed) in result.tips.iter().zip(expected).zip(printed) {
        assert_close("tip", *tip, expected, 1e-9);
        assert_close("printed tip", *tip, printed, 1.4e-4);
    }
}

/// The work of a closed loop of half-width `a` is `8 F_s (2 Z_b / pi) (1 - cos(pi a / 2 Z_b)) - 4 a
/// F_s sin(pi a / 2 Z_b)`, and damping adds `sigma v` both ways.
#[test]
fn the_inner_loop_takes_up_masings_work() {
    let (f_s, z_b, a1, sigma) = (1.5, 1e-3, 6e-4, 1.0);
    let a = 0.3 * a1;
    let phase = FRAC_PI_2 * a / z_b;
    let masing = 8.0 * f_s * (2.0 * z_b / PI) * (1.0 - phase.cos()) - 4.0 * a * f_s * phase.sin();
    let damping = 2.0 * sigma * (a1 / 10.0) * 2.0 * a;
    assert!(damping < 0.1 * masing, "the test is about Masing's part: {masing} and {damping}");
    let contact = chapter_3_with(ModelName::Proposed, &[("sigma", sigma)]);
    let settings = NonLocalMemorySettings { amplitude: Some(a1), ..Default::default() };
    let result = non_local_memory(&contact, &settings).unwrap();
    assert_relative("work", result.loop_work, masing + damping, 1e-5);
}

/// At constant speed LuGre and Dahl have the closed form
/// `f <- s g + (f - s g) exp(-sigma0 |dx| / g)` for `f = sigma0 z` along a leg in direction `s`.
#[test]
fn lugre_and_dahl_follow_their_closed_form() {
    let sigma1 = 1e5f64.sqrt();
    for (name, a1, sigma1) in [(ModelName::LuGre, 2.4e-5, sigma1), (ModelName::Dahl, 1.6e-5, 0.0)] {
        let result = at_amplitude(name, a1);
        let contact = chapter_3(name);
        let v = a1 / 10.0;
        let g = contact.steady_state(v);
        let (mut f, mut at) = (0.0, 0.0);
        for (turn, tip) in TURNS.iter().zip(result.tips) {
            let s = f64::signum(turn - at);
            f = s * g + (f - s * g) * (-1e5 * a1 * (turn - at).abs() / g).exp();
            let rate = s * v - v * f / g;
            assert_close(&format!("{name} at {turn}"), tip, f + sigma1 * rate, 1e-9);
            at = *turn;
        }
    }
}

/// The reset integrator is a linear spring short of breakaway: its loops close because they are no
/// loops.
#[test]
fn the_reset_integrator_has_no_loops() {
    let result = memory(ModelName::ResetIntegrator);
    assert_eq!(
        (result.closure_gap, result.wiping_out_error, result.congruency_error),
        (0.0, 0.0, 0.0)
    );
    assert!(result.loop_opening < 1e-12, "{}", result.loop_opening);
}

#[test]
fn the_amplitude_of_the_rule_carries_the_level_asked_for() {
    for name in [ModelName::LuGre, ModelName::Proposed, ModelName::Gms, ModelName::Xiong] {
        for level in [0.5, 0.8, 0.95] {
            let settings = NonLocalMemorySettings { level, ..Default::default() };
            let result = non_local_memory(&chapter_3(name), &settings).unwrap();
            assert_relative(&format!("{name}, first tip"), result.tips[0], level * 1.5, 0.02);
        }
    }
}

#[test]
fn models_without_pre_sliding_have_no_memory() {
    for name in [
        ModelName::Coulomb,
        ModelName::Viscous,
        ModelName::Stiction,
        ModelName::Stribeck,
        ModelName::Karnopp,
    ] {
        assert_eq!(
            non_local_memory(&chapter_3(name), &NonLocalMemorySettings::chapter_3(name)),
            None,
            "{name}"
        );
    }
}
