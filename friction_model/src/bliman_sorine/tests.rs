//! What Bliman and Sorine's model must do: its closed forms, its passivity and its bound.

use proptest::prelude::*;

use super::*;
use crate::Stepper;
use crate::presets::Presets;

prop_compose! {
    fn any_model()(f_1 in 0.1..10.0f64, ratio in 0.0..0.99f64, eta in 0.02..0.98f64, log_eps in -4.0..0.0f64) -> BlimanSorine {
        let parameters = BlimanSorineParameters { f_1, f_2: ratio * f_1, eta, eps_f: 10f64.powf(log_eps), f_v: 0.0 };
        parameters.try_into().unwrap()
    }
}

/// The state after sliding `distance` from `state`, in one step.
fn slide(
    model: &BlimanSorine,
    mut state: State<[f64; 2], ()>,
    distance: f64,
) -> State<[f64; 2], ()> {
    let dt = 1e-3;
    model.step(&dt, &mut state, distance / dt);
    state
}

fn force(state: &State<[f64; 2], ()>) -> f64 {
    state.continuous[0] + state.continuous[1]
}

#[test]
fn the_presets_have_the_levels_and_the_stiffness_asked_for() {
    for (model, f_s, f_c, stiffness) in [
        (BlimanSorine::test_bed(), 0.0994, 0.0925, 26.0229),
        (BlimanSorine::chapter_3(), 1.5, 1.0, 2356.19),
    ] {
        assert!((model.peak().unwrap().1 - f_s).abs() < 1e-12);
        assert!((model.steady_state(1e-9) - f_c).abs() < 1e-9);
        assert!((model.stiffness() / stiffness - 1.0).abs() < 1e-4, "{}", model.stiffness());
        let little = 1e-9;
        assert!(
            (force(&slide(&model, model.rest(), little)) / little / stiffness - 1.0).abs() < 1e-4
        );
    }
}

/// The force rises to the stiction of the closed form, exactly where that says, and not above.
#[test]
fn the_peak_from_rest_is_where_the_closed_form_says() {
    for (eta, f_2) in [(0.5, 1.0), (0.1, 0.5), (0.9, 1.9), (0.3, 1e-3)] {
        let parameters = BlimanSorineParameters { f_1: 2.0, f_2, eta, eps_f: 0.01, f_v: 0.0 };
        let model = BlimanSorine::try_from(parameters).unwrap();
        let (distance, peak) = model.peak().unwrap();
        let at = |s: f64| force(&slide(&model, model.rest(), s));
        assert!((at(distance) - peak).abs() < 1e-13, "eta {eta}: {} is not {peak}", at(distance));
        for factor in [0.5, 0.9, 0.99, 1.01, 1.1, 2.0, 5.0] {
            assert!(at(factor * distance) < peak, "eta {eta}, f_2 {f_2}, {factor} of the distance");
        }
    }
    let dahl = BlimanSorineParameters { f_2: 0.0, ..BlimanSorineParameters::chapter_3() };
    assert_eq!(BlimanSorine::try_from(dahl).unwrap().peak(), None);
}

#[test]
fn the_peak_after_a_reversal_is_twice_as_far_above_the_kinetic_level() {
    let model = BlimanSorine::chapter_3();
    let sliding = slide(&model, model.rest(), 1.0);
    assert!((force(&sliding) - 1.0).abs() < 1e-12);
    let (distance, _) = model.peak().unwrap();
    assert!((force(&slide(&model, sliding.clone(), -distance)) + 2.0).abs() < 1e-12);
    for factor in [0.9, 1.1] {
        assert!(force(&slide(&model, sliding.clone(), -factor * distance)) > -2.0);
    }
}

#[test]
fn without_the_slow_part_it_is_dahls_model() {
    let (f_c, sigma0) = (1.0, 2000.0);
    let eps_f = f_c / sigma0 / 0.4;
    let parameters = BlimanSorineParameters { f_1: f_c, f_2: 0.0, eta: 0.4, eps_f, f_v: 0.0 };
    let model = BlimanSorine::try_from(parameters).unwrap();
    let mut stepper = Stepper::new(model, TimeStep::new(1e-3).unwrap());
    let mut z = 0.0;
    for k in 0..2000 {
        let v = 0.1 * (0.02 * f64::from(k)).sin();
        let end = f_c / sigma0 * sign(v);
        assert!((stepper.step(v) - sigma0 * z).abs() < 1e-13, "step {k}");
        z = end + (z - end) * (-sigma0 * v.abs() * 1e-3 / f_c).exp();
        let stored = model.stored_energy(stepper.state()).unwrap();
        assert!(
            (stored - 0.5 * sigma0 * z * z).abs() < 1e-16,
            "step {k}: Dahl stores sigma0 z^2 / 2"
        );
    }
}

#[test]
fn the_fixed_step_is_exact_for_a_held_velocity() {
    let model = BlimanSorine::test_bed();
    let mut fine = model.rest();
    for _ in 0..10 {
        fine = slide(&model, fine, 0.001);
    }
    let coarse = slide(&model, model.rest(), 0.01);
    assert!((force(&coarse) - force(&fine)).abs() < 1e-15);
}

#[test]
fn kinetic_friction_that_would_drive_the_motion_is_refused() {
    let wrong =
        BlimanSorineParameters { f_2: 1.1, f_1: 1.0, ..BlimanSorineParameters::chapter_3() };
    let message = BlimanSorine::try_from(wrong).unwrap_err().to_string();
    assert!(message.starts_with("bliman_sorine.f_1 must be above f_2"), "{message}");
    let equal = BlimanSorineParameters { eta: 1.0, ..BlimanSorineParameters::chapter_3() };
    assert!(BlimanSorine::try_from(equal).is_err());
}

proptest! {
    /// `P B = C^T`, and the dissipation matrix `-(P A + A^T P)` is singular and not negative: the
    /// smallest storage.
    #[test]
    fn the_stored_energy_solves_the_riccati_equation(model in any_model()) {
        let BlimanSorineParameters { f_1, f_2, .. } = model.parameters;
        let ([decay_1, decay_2], [a, b, c]) = (model.decay, model.storage);
        prop_assert!((a * f_1 * decay_1 - b * f_2 * decay_2 - 1.0).abs() < 1e-9);
        prop_assert!((b * f_1 * decay_1 - c * f_2 * decay_2 - 1.0).abs() < 1e-9);
        let (fast, beside, slow) = (2.0 * decay_1 * a, (decay_1 + decay_2) * b, 2.0 * decay_2 * c);
        prop_assert!(fast > 0.0 && slow > 0.0);
        prop_assert!((fast * slow - beside * beside).abs() < 1e-6 * fast * slow);
    }

    /// What goes in is at least what is stored, with the work of each slide in closed form, for
    /// every parameter set.
    #[test]
    fn stores_no_more_than_was_put_in(model in any_model(),
                                      path in prop::collection::vec((-3.0..1.0f64, any::<bool>()), 1..200)) {
        let BlimanSorineParameters { f_1, f_2, eps_f, .. } = model.parameters;
        let mut state = model.rest();
        let mut stored = 0.0;
        for (log_length, back) in path {
            let length = eps_f * 10f64.powf(log_length);
            let sgn = if back { -1.0 } else { 1.0 };
            // int F sgn v ds, each exponential by itself.
            let part = |x: f64, end: f64, decay: f64| {
                sgn * (end * length - (x - end) * (-decay * length).exp_m1() / decay)
            };
            let work = part(state.continuous[0], sgn * f_1, model.decay[0])
                + part(state.continuous[1], -sgn * f_2, model.decay[1]);
            state = slide(&model, state, sgn * length);
            let now = model.stored_energy(&state).unwrap();
            let scale = f_1 * (length + eps_f);
            prop_assert!(now >= 0.0 && work - (now - stored) >= -1e-10 * scale, "{work} for {}", now - stored);
            stored = now;
        }
    }

    /// No path from rest leaves `+-(F_c + 2 D)`.
    #[test]
    fn no_path_exceeds_the_peak_after_a_reversal(model in any_model(),
                                                 path in prop::collection::vec(-3.0..3.0f64, 1..200)) {
        let f_c = model.parameters.f_1 - model.parameters.f_2;
        let most = model.peak().map_or(f_c, |(_, peak)| 2.0 * peak - f_c);
        let mut state = model.rest();
        for length in path {
            state = slide(&model, state, length * model.parameters.eps_f);
            prop_assert!(force(&state).abs() <= most * (1.0 + 1e-12));
        }
    }
}
