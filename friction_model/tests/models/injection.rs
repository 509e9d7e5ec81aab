//! Error injection: an extra rate in the derivative of every continuous state, as a state observer
//! needs it.

use friction_model::{
    AnyModel, ContinuousState, Dahl, ElastoPlastic, FrictionModel, Gms, Leuven, LuGre, ModelName,
    Proposed, Stepper, TimeStep, Xiong,
};
use proptest::prelude::*;

fn velocity(t: f64) -> f64 {
    0.3 * (1.5 * t).sin() + 0.05 * (9.0 * t).sin()
}

/// Extra rate of the states [1/s], small beside the velocity, as the error of a working loop is.
fn rate(t: f64) -> f64 {
    0.02 * (3.7 * t).sin()
}

/// Classical Runge-Kutta of `x' = f(x, v) + r` with fine steps, force included: independent of the
/// fixed-step form. `spread` writes a rate into every state, `damping` says what the force gains
/// per rate, `bound` cuts states where the model alone would never go.
fn fine<M: FrictionModel>(
    model: &M,
    spread: impl Fn(f64) -> M::Continuous,
    damping: f64,
    bound: impl Fn(&mut M::Continuous),
    seconds: f64,
) -> Vec<f64> {
    let (h, each) = (2e-5, 50u32);
    let mut state = model.rest();
    let mut forces = Vec::new();
    for k in 0..(seconds / h).round() as u32 {
        let t = f64::from(k) * h;
        let slope = |x: &M::Continuous, t: f64| {
            model.evaluate(x, &state.memory, velocity(t)).rates.plus_scaled(&spread(rate(t)), 1.0)
        };
        let x = state.continuous;
        if k % each == 0 {
            forces.push(model.evaluate(&x, &state.memory, velocity(t)).force + damping * rate(t));
        }
        let k1 = slope(&x, t);
        let k2 = slope(&x.plus_scaled(&k1, 0.5 * h), t + 0.5 * h);
        let k3 = slope(&x.plus_scaled(&k2, 0.5 * h), t + 0.5 * h);
        let k4 = slope(&x.plus_scaled(&k3, h), t + h);
        state.continuous = [(k1, 1.0), (k2, 2.0), (k3, 2.0), (k4, 1.0)]
            .iter()
            .fold(x, |sum, (slope, weight)| sum.plus_scaled(slope, weight * h / 6.0));
        bound(&mut state.continuous);
        model.commit(&mut state, velocity(t + h), h);
    }
    forces
}

/// Root mean square difference of the fixed-step form at the period `dt` from the fine solution,
/// over the force's. A regime that switches a sample sooner or later weighs little in it.
fn difference<M: FrictionModel>(model: &M, truth: &[f64], dt: f64) -> f64 {
    let mut stepper = Stepper::new(model.clone(), TimeStep::new(dt).unwrap());
    let every = (1e-3 / dt).round() as u32;
    let mut sum = 0.0;
    for (k, expected) in (0u32..).zip(truth) {
        for j in 0..every {
            let t = 1e-3 * f64::from(k) + dt * f64::from(j);
            let force = stepper.step_injected(velocity(t), rate(t));
            if j == 0 {
                sum += (force - expected).powi(2);
            }
        }
    }
    (sum / truth.iter().map(|f| f * f).sum::<f64>()).sqrt()
}

fn cut(z: &mut f64, most: f64) {
    *z = z.clamp(-most, most);
}

fn agrees<M: FrictionModel>(
    model: M,
    spread: impl Fn(f64) -> M::Continuous,
    damping: f64,
    bound: impl Fn(&mut M::Continuous),
) {
    let truth = fine(&model, spread, damping, bound, 6.0);
    let (coarse, middle) = (difference(&model, &truth, 1e-3), difference(&model, &truth, 1e-4));
    assert!(coarse < 0.006, "{}: {coarse} at 1 ms", M::NAME);
    assert!(middle < 0.0006, "{}: {middle} at .1 ms", M::NAME);
    // The injection matters: without it the forces differ by much more.
    let mut plain = Stepper::new(model, TimeStep::new(1e-3).unwrap());
    let apart =
        (0u32..).zip(&truth).map(|(k, force)| plain.step(velocity(1e-3 * f64::from(k))) - force);
    let apart =
        (apart.map(|d| d * d).sum::<f64>() / truth.iter().map(|f| f * f).sum::<f64>()).sqrt();
    assert!(apart > 10.0 * coarse, "{}: {apart} without, {coarse} with", M::NAME);
}

#[test]
fn the_fixed_step_form_follows_a_fine_integration_of_the_same_equations() {
    agrees(Dahl::test_bed(), |r| [r], 0.0, |_| ());
    let lugre = LuGre::test_bed();
    let p = *lugre.parameters();
    agrees(lugre, |r| [r], p.sigma1, |[z]| cut(z, p.f_s / p.sigma0));
    let elasto_plastic = ElastoPlastic::test_bed();
    let p = *elasto_plastic.parameters();
    agrees(elasto_plastic, |r| [r], p.sigma1, |[z]| cut(z, p.f_s / p.sigma0));
    let leuven = Leuven::test_bed();
    agrees(leuven, |r| [r], leuven.parameters().sigma1, |_| ());
    let proposed = Proposed::test_bed();
    agrees(proposed, |r| [r, r], proposed.parameters().sigma, |_| ());
    let gms = Gms::<4>::test_bed();
    let p = *gms.parameters();
    let widths: Vec<f64> =
        p.alpha.iter().zip(p.sigma0.iter()).map(|(alpha, k)| alpha * p.f_s / k).collect();
    agrees(
        gms,
        |r| [r; 4],
        p.sigma1.iter().sum(),
        |z| z.iter_mut().zip(&widths).for_each(|(z, w)| cut(z, *w)),
    );
    let xiong = Xiong::<4>::test_bed();
    let p = *xiong.parameters();
    let widths: Vec<f64> =
        p.lambda.iter().zip(p.k.iter()).map(|(lambda, k)| lambda * p.f_s / k).collect();
    agrees(
        xiong,
        |r| ([r], [r; 4]),
        p.sigma.iter().sum(),
        |(_, z)| {
            z.iter_mut().zip(&widths).for_each(|(z, w)| cut(z, *w));
        },
    );
}

/// `z' = v + r - sigma0 |v| z / g` rests at `z = (v + r) g / (sigma0 |v|)`, where
/// `F = g (1 + r / v) + f_v v`.
#[test]
fn lugre_settles_where_the_closed_form_says() {
    let model = LuGre::test_bed();
    let p = *model.parameters();
    for (v, r) in [(0.3, -0.01), (-0.3, 0.02), (2.0, -0.3)] {
        let mut stepper = Stepper::new(model, TimeStep::new(1e-3).unwrap());
        let force = (0..5000).map(|_| stepper.step_injected(v, r)).last().unwrap();
        let level = model.steady_state(v) - p.f_v * v;
        let expected = level * (1.0 + r / v) + p.f_v * v;
        assert!((force - expected).abs() < 1e-12, "{v}, {r}: {force} is not {expected}");
    }
}

#[test]
fn at_rest_the_states_stay_within_their_bounds_whatever_is_injected() {
    for name in ModelName::ALL {
        let model = AnyModel::test_bed(name);
        let mut stepper = model.start(TimeStep::new(1e-3).unwrap());
        for _ in 0..20_000 {
            stepper.step_injected(0.0, 5.0);
        }
        let held = stepper.step(0.0);
        assert!(held.abs() < 0.25, "{name} holds {held} N m, more than its breakaway level");
    }
}

#[test]
fn equal_sides_take_the_injection_as_the_symmetric_model() {
    for name in ModelName::ALL {
        let model = AnyModel::test_bed(name);
        let both = AnyModel::asymmetric(&model, &model).unwrap();
        let dt = TimeStep::new(1e-3).unwrap();
        let (mut one, mut two) = (model.start(dt), both.start(dt));
        for k in 0..4000 {
            let t = 1e-3 * f64::from(k);
            let (v, r) = (velocity(t), rate(t));
            assert_eq!(one.step_injected(v, r), two.step_injected(v, r), "{name} at {t} s");
        }
    }
}

proptest! {
    #![proptest_config(crate::arbitrary::config())]

    #[test]
    fn no_rate_is_no_injection_and_no_rate_whatever_spoils_the_state(
        model in crate::arbitrary::any_model(),
        motion in prop::collection::vec((-3.0..3.0f64, prop_oneof![
            -10.0..10.0f64,
            prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300]),
        ]), 1..60),
    ) {
        let dt = TimeStep::new(1e-3).unwrap();
        let (mut plain, mut injected) = (model.start(dt), model.start(dt));
        for (v, _) in &motion {
            prop_assert_eq!(plain.step(*v), injected.step_injected(*v, 0.0));
        }
        for (v, r) in &motion {
            let force = injected.step_injected(*v, *r);
            prop_assert!(force.is_finite(), "{} from {v}, {r}", force);
        }
        prop_assert!(injected.step(0.1).is_finite());
    }
}
