//! Every valid parameter set, period and motion leaves a model within the bound that its file
//! states, and odd in the motion.

use friction_model::{
    Armstrong, ArmstrongParameters, BengisuAkay, BengisuAkayParameters, BlimanSorine,
    BlimanSorineParameters, FrictionModel, ResetIntegrator, ResetIntegratorParameters, Stepper,
    TimeStep, Wojewoda, WojewodaParameters,
};
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

/// Ten to a power in the range: parameters over many decades.
fn decades(from: f64, to: f64) -> impl Strategy<Value = f64> {
    (from..to).prop_map(|e| 10f64.powf(e))
}

prop_compose! {
    /// f_s and f_c.
    fn levels()(f_s in decades(-6.0, 6.0), ratio in 0.01..=1.0f64) -> (f64, f64) {
        (f_s, f_s * ratio)
    }
}

prop_compose! {
    fn any_reset_integrator()(sigma0 in decades(-6.0, 8.0), sigma1 in 0.0..100.0f64, a in 0.0..3.0f64, p_0 in decades(-9.0, 2.0), f_v in 0.0..1.0f64)
        -> ResetIntegrator {
        ResetIntegratorParameters { sigma0, sigma1, a, p_0, f_v }.try_into().unwrap()
    }
}

prop_compose! {
    fn any_armstrong()((f_s, f_c) in levels(), v_s in decades(-6.0, 2.0), k_t in decades(-6.0, 9.0),
                       tau_l in prop_oneof![Just(0.0), decades(-9.0, 1.0)], gamma in decades(-6.0, 4.0), f_v in 0.0..1.0f64) -> Armstrong {
        ArmstrongParameters { f_s, f_c, v_s, k_t, tau_l, gamma, f_v }.try_into().unwrap()
    }
}

prop_compose! {
    fn any_bengisu_akay()((f_s, f_c) in levels(), v_0 in decades(-9.0, 2.0), xi in decades(-6.0, 6.0), f_v in 0.0..1.0f64) -> BengisuAkay {
        BengisuAkayParameters { f_s, f_c, v_0, xi, f_v }.try_into().unwrap()
    }
}

prop_compose! {
    fn any_wojewoda()((f_s, f_c) in levels(), low in 0.01..=1.0f64, v_s in decades(-6.0, 2.0), k_t in decades(-6.0, 9.0),
                      a_0 in prop::option::of(decades(-3.0, 6.0)), f_v in 0.0..1.0f64) -> Wojewoda {
        WojewodaParameters { f_s, f_c, f_d: Some(low * f_s), v_s, k_t, a_0, f_v }.try_into().unwrap()
    }
}

prop_compose! {
    fn any_bliman_sorine()(f_1 in decades(-6.0, 6.0), ratio in 0.0..0.99f64, eta in 0.01..0.99f64, eps_f in decades(-9.0, 2.0),
                           f_v in 0.0..1.0f64) -> BlimanSorine {
        BlimanSorineParameters { f_1, f_2: ratio * f_1, eta, eps_f, f_v }.try_into().unwrap()
    }
}

/// Velocities over many decades, both signs, with stops between.
fn velocities() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec((-9.0..6.0f64, -1i8..=1), 1..300)
        .prop_map(|v| v.into_iter().map(|(e, sign)| f64::from(sign) * 10f64.powf(e)).collect())
}

fn period() -> impl Strategy<Value = TimeStep> {
    (-6.0..=-2.0f64).prop_map(|e| TimeStep::new(10f64.powf(e).min(0.01)).unwrap())
}

/// The force stays within `bound` of the speed; the opposite motion has the opposite force; energy
/// is never negative.
fn stays_within<M: FrictionModel>(
    model: M,
    dt: TimeStep,
    path: &[f64],
    bound: impl Fn(f64) -> f64,
) -> Result<(), TestCaseError> {
    let (mut there, mut back) = (Stepper::new(model.clone(), dt), Stepper::new(model.clone(), dt));
    for &v in path {
        let force = there.step(v);
        prop_assert_eq!(force, -back.step(-v));
        let most = bound(v.abs());
        prop_assert!(
            force.abs() <= most * (1.0 + 1e-12),
            "{:?}: {} exceeds {} at {}",
            model,
            force,
            most,
            v
        );
        prop_assert!(model.steady_state(v).abs() <= most * (1.0 + 1e-12));
        prop_assert!(
            model
                .stored_energy(there.state())
                .is_none_or(|energy| energy >= 0.0 && energy.is_finite())
        );
        prop_assert!(there.internals(v).deflection.is_finite());
    }
    Ok(())
}

proptest! {
    #[test]
    fn the_reset_integrator_is_bounded(model in any_reset_integrator(), dt in period(), path in velocities()) {
        let p = *model.parameters();
        stays_within(model, dt, &path, |v| (1.0 + p.a) * p.sigma0 * p.p_0 + (p.sigma1 + p.f_v) * v)?;
    }

    #[test]
    fn armstrongs_model_is_bounded(model in any_armstrong(), dt in period(), path in velocities()) {
        let p = *model.parameters();
        stays_within(model, dt, &path, |v| p.f_s + p.f_v * v)?;
    }

    #[test]
    fn bengisu_and_akays_law_is_bounded(model in any_bengisu_akay(), dt in period(), path in velocities()) {
        let p = *model.parameters();
        stays_within(model, dt, &path, |v| p.f_s + p.f_v * v)?;
    }

    #[test]
    fn the_hysteretic_model_is_bounded(model in any_wojewoda(), dt in period(), path in velocities()) {
        let p = *model.parameters();
        stays_within(model, dt, &path, |v| p.f_s + p.f_v * v)?;
    }

    #[test]
    fn bliman_and_sorines_model_is_bounded(model in any_bliman_sorine(), dt in period(), path in velocities()) {
        let p = *model.parameters();
        let f_c = p.f_1 - p.f_2;
        let most = model.peak().map_or(f_c, |(_, peak)| 2.0 * peak - f_c);
        stays_within(model, dt, &path, |v| most + p.f_v * v)?;
    }

    /// From rest each of them reaches its steady state, however coarse the period.
    #[test]
    fn the_steady_state_is_what_the_fixed_step_form_reaches(
        armstrong in any_armstrong(), wojewoda in any_wojewoda(), reset in any_reset_integrator(),
        bliman in any_bliman_sorine(), dt in period(), log_v in -1.0..6.0f64, back in any::<bool>(),
    ) {
        fn settles<M: FrictionModel>(model: M, dt: TimeStep, v: f64, travel: f64, time: f64) -> Result<(), TestCaseError> {
            let steps = (travel / (v.abs() * dt.seconds())).max(time / dt.seconds());
            // Not every drawn set settles in a time fit for a test; most do.
            if steps > 1e5 {
                return Ok(());
            }
            let mut stepper = Stepper::new(model.clone(), dt);
            for _ in 0..steps as u32 + 100 {
                stepper.step(v);
            }
            let (force, expected) = (stepper.step(v), model.steady_state(v));
            prop_assert!((force - expected).abs() <= 1e-9 * expected.abs(), "{:?}: {} is not {}", model, force, expected);
            Ok(())
        }
        let v = if back { -10f64.powf(log_v) } else { 10f64.powf(log_v) };
        let p = *armstrong.parameters();
        settles(armstrong, dt, v, p.f_s / p.k_t, 1.1 * p.tau_l)?;
        let p = *wojewoda.parameters();
        settles(wojewoda, dt, v, 2.0 * p.f_s / p.k_t, 0.0)?;
        settles(reset, dt, v, reset.parameters().p_0, 0.0)?;
        settles(bliman, dt, v, 40.0 * bliman.parameters().eps_f, 0.0)?;
    }
}
