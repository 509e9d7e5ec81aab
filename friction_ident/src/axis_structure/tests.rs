use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use super::*;
use crate::adequacy::FitDoubt;
use crate::{Conditioned, Conditioning, Doubt, IntervalMethod, Signals, Verdict, condition};

const INERTIA: f64 = 5.0;
const DELAY: f64 = 0.7e-3;
const V_S: f64 = 0.05;

fn position(t: f64) -> f64 {
    0.15 * (1.1 * t).sin() + 0.05 * (3.7 * t).sin() + 0.004 * (23.0 * t).sin()
}

fn velocity(t: f64) -> f64 {
    0.165 * (1.1 * t).cos() + 0.185 * (3.7 * t).cos() + 0.092 * (23.0 * t).cos()
}

fn acceleration(t: f64) -> f64 {
    -0.1815 * (1.1 * t).sin() - 0.6845 * (3.7 * t).sin() - 2.116 * (23.0 * t).sin()
}

/// 12 s of an axis at 1 kHz whose force is known: Stribeck friction of each direction, delayed,
/// with white noise.
fn axis(friction: impl Fn(f64) -> f64, delay: f64, noise: f64) -> Conditioned {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(7);
    let time: Vec<f64> = (0..12_000).map(|i| f64::from(i) * 1e-3).collect();
    let place: Vec<f64> = time.iter().map(|&t| position(t)).collect();
    let force: Vec<f64> = time
        .iter()
        .map(|&t| {
            let t = t + delay;
            INERTIA * acceleration(t)
                + friction(velocity(t))
                + noise * rng.sample::<f64, _>(StandardNormal)
        })
        .collect();
    let signals = Signals {
        time_step: 1e-3,
        position: Some(&place),
        readings: None,
        velocity: None,
        force: &force,
    };
    condition(&signals, &Conditioning::for_time_step(1e-3)).unwrap()
}

/// A rotary axis that moves in three tones at 1 kHz under the force of a sample, a velocity and an
/// acceleration.
pub(super) fn three_tones(
    samples: u32,
    mut force_at: impl FnMut(u32, f64, f64) -> f64,
) -> Conditioned {
    let (mut position, mut force) = (Vec::new(), Vec::new());
    for k in 0..samples {
        let t = 1e-3 * f64::from(k);
        let [mut q, mut v, mut a] = [0.0; 3];
        for (size, w) in [(0.8, 1.1), (0.5, 2.3), (0.2, 3.7)] {
            let (sin, cos) = f64::sin_cos(w * t);
            q += size * sin;
            v += size * w * cos;
            a -= size * w * w * sin;
        }
        position.push(q);
        force.push(force_at(k, v, a));
    }
    let signals = Signals {
        time_step: 1e-3,
        position: Some(&position),
        readings: None,
        velocity: None,
        force: &force,
    };
    condition(&signals, &Conditioning::for_time_step(1e-3)).unwrap()
}

fn stribeck(v: f64) -> f64 {
    let near = (-(v / V_S).powi(2)).exp();
    if v > 0.0 { 6.0 + 2.0 * near + 9.0 * v } else { -(7.0 + 3.0 * near) + 12.0 * v }
}

/// The axis with all that it has, in a little noise.
pub(super) fn stribeck_axis() -> Conditioned {
    axis(stribeck, DELAY, 0.2)
}

fn coulomb(v: f64) -> f64 {
    5.0 * v.signum() + 8.0 * v
}

fn structure(name: &str) -> AxisStructure {
    name.parse().unwrap()
}

#[test]
fn the_true_parameters_lie_in_the_intervals() {
    let recording = axis(stribeck, DELAY, 0.2);
    let fit = fit_structure(&recording, structure("asymmetric+stribeck+delay"), &AxisUnits::LINEAR)
        .unwrap();
    for (name, truth) in [
        ("inertia", INERTIA),
        ("f_v.forward", 9.0),
        ("f_v.backward", 12.0),
        ("f_c.forward", 6.0),
        ("f_c.backward", 7.0),
        ("f_s.forward", 8.0),
        ("f_s.backward", 10.0),
        ("delay", DELAY),
        ("v_s", V_S),
    ] {
        let estimate = fit.estimates.get(name).unwrap();
        assert!(estimate.is_identified(), "{estimate:?}");
        assert!(estimate.interval.unwrap().contains(truth), "{truth}: {estimate:?}");
        assert!((estimate.value / truth - 1.0).abs() < 0.2, "{truth}: {estimate:?}");
    }
    assert_eq!(
        fit.estimates.get("delay").unwrap().interval.unwrap().method,
        IntervalMethod::Profile
    );
    assert!((fit.steady_friction(0.3) - stribeck(0.3)).abs() < 0.1);
    assert!((fit.steady_friction(-0.01) - stribeck(-0.01)).abs() < 0.4);
    assert!(fit.effective_share > 0.5, "white noise is worth its samples: {}", fit.effective_share);
}

/// What is tried beside the cross-validation is what the chosen structure says in the end; of the
/// recording itself it is the error of the fit.
#[test]
fn another_recording_is_predicted_as_by_the_whole_fit() {
    let (recording, other) = (stribeck_axis(), axis(coulomb, 2e-3, 0.5));
    for name in ["symmetric", "asymmetric+stribeck+delay", "symmetric+presliding"] {
        let score = cross_validate(&recording, structure(name), 8).unwrap();
        let fit = fit_structure(&recording, structure(name), &AxisUnits::LINEAR).unwrap();
        let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-3, "{name}: {a} {b}");
        let there = score.tried_on(&recording, &other).unwrap();
        near(there.relative_error, fit.predict(&other).unwrap().relative_error);
        assert_eq!(there.blocks.len(), 8);
        let here = score.tried_on(&recording, &recording).unwrap();
        near(here.relative_error, fit.relative_error);
        near(here.force_power, score.force_power);
    }
    let along = cross_validate(&recording, structure("symmetric+position"), 8).unwrap();
    let blind = Conditioned { position: None, ..other };
    let refused = along.tried_on(&recording, &blind);
    assert!(matches!(refused, Err(crate::IdentError::NoPosition { .. })), "{refused:?}");
}

#[test]
fn what_friction_does_over_the_first_speeds_is_told() {
    let told = |f_s: f64, v_s: f64| {
        let near = move |v: f64| (-(v / v_s).powi(2)).exp();
        let friction = move |v: f64| v.signum() * (6.0 + (f_s - 6.0) * near(v)) + 9.0 * v;
        let recording = axis(friction, 0.0, 0.2);
        cross_validate(&recording, structure("symmetric+stribeck"), 8).unwrap().first_speeds
    };
    assert_eq!(told(8.0, V_S), FirstSpeeds::Plausible);
    // Of this motion a fifth is slower than V_S, and little is slower than 0.01 m/s.
    assert_eq!(told(4.0, V_S), FirstSpeeds::Plausible, "the recording looks on");
    assert_eq!(told(4.0, 0.01), FirstSpeeds::Rises, "it passes through");
    let recording = axis(coulomb, 0.0, 0.2);
    let plain = cross_validate(&recording, AxisStructure::SYMMETRIC, 8).unwrap();
    assert_eq!(plain.first_speeds, FirstSpeeds::Plausible);
}

/// Friction that a fit put below zero at rest, -3 N here, would drive the axis. It was fitted so, and
/// such structures were then passed over, however well they predict.
#[test]
fn friction_at_rest_is_not_below_zero() {
    let near = |v: f64| (-(v / V_S).powi(2)).exp();
    let recording = axis(|v| v.signum() * (6.0 - 9.0 * near(v)) + 9.0 * v, 0.0, 0.2);
    for name in ["symmetric+stribeck", "asymmetric+stribeck+delay"] {
        let fit = fit_structure(&recording, structure(name), &AxisUnits::LINEAR).unwrap();
        let levels = || fit.estimates.parameters.iter().filter(|level| level.id.name == "f_s");
        assert!(levels().count() > 0 && levels().all(|level| level.value == 0.0), "{fit:?}");
        let held = |verdict: &Verdict| {
            let at_zero = Doubt::AtBound { bound: 0.0 };
            matches!(verdict, Verdict::NotIdentifiable { doubt, .. } if *doubt == at_zero)
        };
        assert!(levels().all(|level| held(&level.verdict)), "{fit:?}");
        let score = cross_validate(&recording, structure(name), 8).unwrap();
        assert!((score.relative_error / fit.relative_error - 1.0).abs() < 0.05, "{score:?}");
    }
}

/// A force that was recorded 3 ms late lies below zero; at once is no delay below zero in noise.
#[test]
fn a_force_is_late_only_where_that_explains_much() {
    let delay = |late: f64| {
        let recording = axis(coulomb, -late, 0.2);
        let fit = fit_structure(&recording, structure("symmetric+delay"), &AxisUnits::LINEAR);
        fit.unwrap().shape.delay
    };
    let late = delay(3e-3);
    assert!((late + 3e-3).abs() < 2e-4, "{late}");
    assert!(delay(0.0) >= 0.0, "{}", delay(0.0));
}

/// The symmetric and the asymmetric structure are the models of `rigid_axis`.
#[test]
fn the_simple_structures_agree_with_the_rigid_axis() {
    let recording = axis(stribeck, 0.0, 0.2);
    for (name, model) in
        [("symmetric", crate::AxisModel::SYMMETRIC), ("asymmetric", crate::AxisModel::ASYMMETRIC)]
    {
        let fit = fit_structure(&recording, structure(name), &AxisUnits::LINEAR).unwrap();
        let reference = crate::fit_axis(&recording, model).unwrap();
        assert!((fit.relative_error / reference.relative_error - 1.0).abs() < 5e-3);
        assert!(
            (fit.estimates.value("inertia").unwrap() / reference.terms[0].value - 1.0).abs() < 1e-3
        );
        let again = fit.predict(&recording).unwrap();
        assert!((again.relative_error - fit.relative_error).abs() < 1e-9);
    }
}

#[test]
fn cross_validation_finds_the_structure_that_made_the_data() {
    let names = ["symmetric", "symmetric+delay", "asymmetric+delay", "asymmetric+stribeck+delay"];
    let chosen = |recording: &Conditioned| {
        let scores: Vec<_> = names
            .iter()
            .map(|name| cross_validate(recording, structure(name), 6).unwrap())
            .collect();
        scores[choose(&scores).unwrap().chosen].structure.to_string()
    };
    assert_eq!(chosen(&axis(stribeck, DELAY, 0.2)), "asymmetric+stribeck+delay");
    // Whole samples: between them the sampled sign of a step is early or late by part of one, which
    // a curve near rest can follow.
    assert_eq!(chosen(&axis(coulomb, 1e-3, 0.2)), "symmetric+delay");
    assert_eq!(chosen(&axis(coulomb, 0.0, 0.2)), "symmetric");
}

#[test]
fn a_stribeck_velocity_without_a_stribeck_effect_is_not_identified() {
    let recording = axis(coulomb, 0.0, 0.5);
    let fit =
        fit_structure(&recording, structure("asymmetric+stribeck"), &AxisUnits::LINEAR).unwrap();
    let v_s = fit.estimates.get("v_s").unwrap();
    assert!(matches!(v_s.verdict, Verdict::NotIdentifiable { .. }), "{v_s:?}");
    // A delay of zero is at its bound, or its interval has no end below.
    let fit = fit_structure(&recording, structure("symmetric+delay"), &AxisUnits::LINEAR).unwrap();
    let delay = fit.estimates.get("delay").unwrap();
    assert!(
        matches!(
            delay.verdict,
            Verdict::NotIdentifiable {
                doubt: Doubt::OpenInterval | Doubt::AtBound { .. } | Doubt::LargeError { .. },
                ..
            }
        ),
        "{delay:?}"
    );
}

#[test]
fn a_force_that_repeats_along_the_axis_is_found_with_its_period() {
    let mut recording = axis(coulomb, 0.0, 0.2);
    let place = recording.position.clone().unwrap();
    for (force, x) in recording.force.iter_mut().zip(place) {
        *force += 0.8 * (std::f64::consts::TAU * x / 0.016).sin();
    }
    let fit =
        fit_structure(&recording, structure("symmetric+harmonic"), &AxisUnits::LINEAR).unwrap();
    assert!(
        fit.estimates.get("period").unwrap().interval.unwrap().contains(0.016),
        "{:?}",
        fit.estimates
    );
    assert!(fit.estimates.get("harmonic_sin").unwrap().interval.unwrap().contains(0.8));
    assert!(fit.estimates.get("harmonic_cos").unwrap().interval.unwrap().contains(0.0));
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    let recording = axis(coulomb, 0.0, 0.2);
    let blind = Conditioned { position: None, ..recording.clone() };
    let error =
        fit_structure(&blind, structure("symmetric+position"), &AxisUnits::LINEAR).unwrap_err();
    assert!(error.to_string().contains("position"), "{error}");
    let error = cross_validate(&recording, AxisStructure::SYMMETRIC, 1).unwrap_err();
    assert!(error.to_string().contains("between 2 and"), "{error}");
    let forward = Conditioned { velocity: vec![0.1; recording.velocity.len()], ..recording };
    let error = fit_structure(&forward, structure("asymmetric"), &AxisUnits::LINEAR).unwrap_err();
    assert!(error.to_string().contains("cannot tell"), "{error}");
}

/// A wave of one period in the first half of the time and of another in the second: whatever the
/// fit of the whole makes of it, it is no property of the axis.
#[test]
fn a_period_that_both_halves_do_not_share_is_not_identified() {
    let mut recording = axis(coulomb, 0.0, 0.2);
    let place = recording.position.clone().unwrap();
    let middle = place.len() / 2;
    for (k, (force, x)) in recording.force.iter_mut().zip(place).enumerate() {
        let period = if k < middle { 0.016 } else { 0.0231 };
        *force += 0.8 * (std::f64::consts::TAU * x / period).sin();
    }
    let fit =
        fit_structure(&recording, structure("symmetric+harmonic"), &AxisUnits::LINEAR).unwrap();
    let period = fit.estimates.get("period").unwrap();
    let unsteady =
        matches!(period.verdict, Verdict::NotIdentifiable { doubt: Doubt::Unsteady { .. }, .. });
    assert!(unsteady, "{period:?}");
    assert!(fit.notes().iter().any(|note| note.contains("period")), "{:?}", fit.notes());
}

/// An inertia that is larger in the last eighth: the fit of the whole lies at a value that holds
/// nowhere, about which the interval must not be narrow.
#[test]
fn a_parameter_that_moves_between_parts_is_not_identified_or_its_interval_reaches_both() {
    let mut recording = axis(coulomb, 0.0, 0.05);
    let last = recording.force.len() * 7 / 8;
    for (force, a) in recording.force.iter_mut().zip(&recording.acceleration).skip(last) {
        *force += 2.0 * a;
    }
    let fit = fit_structure(&recording, structure("symmetric"), &AxisUnits::LINEAR).unwrap();
    let inertia = fit.estimates.get("inertia").unwrap();
    assert!((inertia.value - INERTIA).abs() > 0.2, "{inertia:?}");
    let reaches = inertia.interval.is_some_and(|interval| interval.contains(INERTIA));
    assert!(!inertia.is_identified() || reaches, "{inertia:?}");
}

#[test]
fn friction_below_zero_is_never_identified() {
    let recording = axis(|v| 5.0 * v.signum() - 8.0 * v, 0.0, 0.2);
    let fit = fit_structure(&recording, structure("symmetric"), &AxisUnits::LINEAR).unwrap();
    let viscous = fit.estimates.get("f_v").unwrap();
    let negative =
        matches!(viscous.verdict, Verdict::NotIdentifiable { doubt: Doubt::Negative { .. }, .. });
    assert!(viscous.value < -7.0 && negative, "{viscous:?}");
    let impossible = fit.impossible();
    assert_eq!(impossible, Some(FitDoubt::Impossible { id: "f_v".into() }));
    let other = axis(coulomb, 0.0, 0.2);
    let other = fit_structure(&other, structure("symmetric"), &AxisUnits::LINEAR).unwrap();
    assert_eq!(other.impossible(), None);
}

/// A joint that carries a weight: without gravity in the model its inertia was several times too
/// large, with a narrow error.
#[test]
fn a_weight_that_turns_with_the_axis_is_chosen_and_leaves_the_inertia_right() {
    let mut recording = axis(coulomb, 0.0, 0.2);
    let angles: Vec<f64> = recording.position.iter().flatten().map(|x| 6.0 * x).collect();
    for (force, q) in recording.force.iter_mut().zip(&angles) {
        *force += 1.0 + 30.0 * (q + 0.4).sin();
    }
    recording.position = Some(angles);
    for column in [&mut recording.velocity, &mut recording.acceleration] {
        column.iter_mut().for_each(|value| *value *= 6.0);
    }
    let names = ["symmetric", "symmetric+delay", "asymmetric", "symmetric+gravity"];
    let scores: Vec<_> =
        names.iter().map(|name| cross_validate(&recording, structure(name), 6).unwrap()).collect();
    let chosen = scores[choose(&scores).unwrap().chosen].structure;
    assert_eq!(chosen.to_string(), "symmetric+gravity");
    let fit = fit_structure(&recording, chosen, &AxisUnits::ROTARY).unwrap();
    for (name, truth) in [
        ("inertia", INERTIA / 6.0),
        ("offset", 1.0),
        ("gravity_sin", 30.0 * 0.4f64.cos()),
        ("gravity_cos", 30.0 * 0.4f64.sin()),
    ] {
        let estimate = fit.estimates.get(name).unwrap();
        assert!(estimate.is_identified(), "{estimate:?}");
        assert!((estimate.value / truth - 1.0).abs() < 0.1, "{truth}: {estimate:?}");
    }
    let without = fit_structure(&recording, structure("symmetric"), &AxisUnits::ROTARY).unwrap();
    assert!((without.estimates.value("inertia").unwrap() * 6.0 / INERTIA - 1.0).abs() > 0.3);
}

/// A stranger's axis with rests: it stops while it is pushed one way, and goes on the same way or the
/// other. Bristles began anew behind each rest.
#[test]
fn a_bristle_keeps_its_deflection_while_the_axis_rests() {
    const REACH: f64 = 0.01;
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(11);
    let dt = 1e-3;
    // Moves for a second, one way or the other by turns of two and three, and rests for a second.
    let velocity = |k: usize| {
        let (second, part) = (k / 1000, (k % 1000) as f64 * dt);
        let way = if [0, 1, 3, 4, 6, 9].contains(&(second / 2 % 10)) { 1.0 } else { -1.0 };
        if second % 2 == 0 { 0.3 * way * (std::f64::consts::PI * part).sin().powi(2) } else { 0.0 }
    };
    let n = 40_000;
    let (mut place, mut force) = (Vec::with_capacity(n), Vec::with_capacity(n));
    let (mut q, mut z) = (0.0, 1.0f64);
    for k in 0..n {
        let v = velocity(k);
        let acceleration = (velocity(k + 1) - velocity(k.saturating_sub(1))) / (2.0 * dt);
        z += (v - v.abs() * z) * dt / REACH;
        place.push(q);
        force.push(
            2.0 * acceleration + 5.0 * z + 3.0 * v + 0.05 * rng.sample::<f64, _>(StandardNormal),
        );
        q += v * dt;
    }
    let signals = Signals {
        time_step: dt,
        position: Some(&place),
        readings: None,
        velocity: None,
        force: &force,
    };
    let recording = condition(&signals, &Conditioning::for_time_step(dt)).unwrap();
    let (moving, rest) = recording.moving().unwrap();
    assert!(rest.out > 10.0, "{rest:?}");
    let fit =
        fit_structure(&moving, structure("symmetric+presliding"), &AxisUnits::LINEAR).unwrap();
    assert!(fit.relative_error < 2.0, "{}", fit.relative_error);
    assert!((fit.estimates.value("f_c").unwrap() - 5.0).abs() < 0.1, "{:?}", fit.estimates);
    assert!((fit.shape.displacement / REACH - 1.0).abs() < 0.05, "{:?}", fit.shape);
}

/// A force that runs through a low-pass of 25 ms, at 1 kHz: the longest delay is ten samples, and
/// inertia and friction took the rest, with narrow intervals.
#[test]
fn a_force_that_lags_beyond_the_search_leaves_no_inertia() {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(8);
    let (dt, lag) = (1e-3, 0.025);
    let (mut place, mut force, mut recorded) = (vec![], vec![], 0.0f64);
    for k in 0..20_000 {
        let t = f64::from(k) * dt;
        let acting = INERTIA * acceleration(t) + 8.0 * velocity(t) + 5.0 * velocity(t).signum();
        recorded += (acting - recorded) * dt / lag;
        place.push(position(t));
        force.push(recorded + 0.02 * rng.sample::<f64, _>(StandardNormal));
    }
    let signals = Signals {
        time_step: dt,
        position: Some(&place),
        readings: None,
        velocity: None,
        force: &force,
    };
    let recording = condition(&signals, &Conditioning::for_time_step(dt)).unwrap();
    let fit = fit_structure(&recording, structure("symmetric+delay"), &AxisUnits::LINEAR).unwrap();
    for name in ["inertia", "f_c", "f_v"] {
        let estimate = fit.estimates.get(name).unwrap();
        assert!(!estimate.is_identified(), "{estimate:?}");
    }
    let told = fit.estimates.get("inertia").unwrap().verdict.clone();
    assert!(
        matches!(&told, Verdict::NotIdentifiable { doubt: Doubt::NotToBeTrusted { why }, .. } if why.contains("ten samples")),
        "{told:?}"
    );
    assert!(fit.estimates.get("offset").unwrap().is_identified());
}

/// A wave in noise: each half finds another one.
#[test]
fn a_wave_of_one_half_alone_is_told() {
    let recording = axis(coulomb, 0.0, 0.5);
    let fit =
        fit_structure(&recording, structure("symmetric+harmonic"), &AxisUnits::LINEAR).unwrap();
    let (low, high) = fit.other_waves().unwrap();
    assert!(low < high, "{low} {high}");
    let without = fit_structure(&recording, structure("symmetric"), &AxisUnits::LINEAR).unwrap();
    assert_eq!(without.other_waves(), None);
}

/// Displacement and damping of [`damped_bristle`].
pub(super) const DAMPED: [f64; 2] = [2e-3, 120.0];

/// An axis with a bristle that damps itself, as LuGre's does.
pub(super) fn damped_bristle() -> Conditioned {
    let [reach, sigma1] = DAMPED;
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(3);
    let dt = 1e-3;
    let (mut place, mut force, mut z) = (vec![], vec![], 0.0f64);
    for k in 0..20_000 {
        let t = f64::from(k) * dt;
        let v = velocity(t + 0.5 * dt);
        let limit = reach * v.signum();
        let after = limit + (z - limit) * (-v.abs() * dt / reach).exp();
        let (rate, middle) = ((after - z) / dt, 0.5 * (after + z));
        z = after;
        place.push(position(t + 0.5 * dt));
        force.push(
            INERTIA * acceleration(t + 0.5 * dt)
                + 5.0 * middle / reach
                + sigma1 * rate
                + 8.0 * v
                + 0.05 * rng.sample::<f64, _>(StandardNormal),
        );
    }
    let signals = Signals {
        time_step: dt,
        position: Some(&place),
        readings: None,
        velocity: None,
        force: &force,
    };
    condition(&signals, &Conditioning::for_time_step(dt)).unwrap()
}

/// Without its damping the bristle is too stiff or too soft, with it all are found.
#[test]
fn the_damping_of_a_bristle_is_found() {
    let [reach, sigma1] = DAMPED;
    let recording = damped_bristle();
    let of = |name| fit_structure(&recording, structure(name), &AxisUnits::LINEAR).unwrap();
    let (with, without) = (of("symmetric+damping"), of("symmetric+presliding"));
    assert!(with.relative_error < 0.7 * without.relative_error, "{with:?} {without:?}");
    let near = |name: &'static str, truth: f64, share: f64| {
        let found = with.estimates.get(name).unwrap().value;
        assert!((found / truth - 1.0).abs() < share, "{name}: {found}");
    };
    near("sigma1", sigma1, 0.02);
    near("presliding", reach, 0.02);
    near("f_c", 5.0, 0.02);
}

const F_C: f64 = 5.0;
const F_V: f64 = 8.0;
const SIGMA0: f64 = 2500.0;
const SIGMA1: f64 = 60.0;

/// 20 s of LuGre (Canudas de Wit et al. 1995), integrated finely.
fn lugre(f_s: f64) -> Conditioned {
    sampled_lugre(f_s, 1)
}

/// The same at 1000 Hz, or that many times more slowly.
fn sampled_lugre(f_s: f64, slower: u32) -> Conditioned {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(4);
    let (fine, inner) = (5e-5, 20 * slower);
    let dt = fine * f64::from(inner);
    let (mut place, mut force, mut z) = (vec![], vec![], 0.0f64);
    for k in 0..400_000 {
        let t = f64::from(k) * fine;
        let v = velocity(t + 0.5 * fine);
        let level = F_C + (f_s - F_C) * (-(v / V_S).powi(2)).exp();
        let end = level / SIGMA0 * v.signum();
        let after = end + (z - end) * (-SIGMA0 * v.abs() * fine / level).exp();
        let (rate, middle) = ((after - z) / fine, 0.5 * (after + z));
        z = after;
        if k % inner == 0 {
            let noise = 0.02 * rng.sample::<f64, _>(StandardNormal);
            let friction = SIGMA0 * middle + SIGMA1 * rate + F_V * v;
            place.push(position(t + 0.5 * fine));
            force.push(INERTIA * acceleration(t + 0.5 * fine) + friction + noise);
        }
    }
    let signals = Signals {
        time_step: dt,
        position: Some(&place),
        readings: None,
        velocity: None,
        force: &force,
    };
    condition(&signals, &Conditioning::for_time_step(dt)).unwrap()
}

/// Its level follows the velocity as far as the bristle moves. A dip that follows at once leaves
/// twice as much over.
#[test]
fn the_friction_of_lugre_is_found() {
    const F_S: f64 = 9.0;
    let recording = lugre(F_S);
    let of = |name| fit_structure(&recording, structure(name), &AxisUnits::LINEAR).unwrap();
    let (follows, at_once) =
        (of("symmetric+damping+lag"), of("symmetric+stribeck+presliding+damping"));
    assert!(
        follows.relative_error < 0.5 * at_once.relative_error,
        "{} {}",
        follows.relative_error,
        at_once.relative_error
    );
    let near = |name: &'static str, truth: f64, share: f64| {
        let found = follows.estimates.get(name).unwrap().value;
        assert!((found / truth - 1.0).abs() < share, "{name}: {found}");
    };
    near("inertia", INERTIA, 0.01);
    near("f_v", F_V, 0.05);
    near("f_c", F_C, 0.01);
    near("f_s", F_S, 0.03);
    near("v_s", V_S, 0.05);
    near("presliding", F_C / SIGMA0, 0.05);
    near("sigma1", SIGMA1, 0.1);
    let levels = follows.estimates.value("f_s").unwrap() / follows.estimates.value("f_c").unwrap();
    assert!((follows.shape.ratio / levels - 1.0).abs() < 2e-3, "{levels}");
}

/// At 125 Hz the axis goes half the bristle's reach within a sample, and turns between two. A bristle
/// that followed each sample's own velocity was half a sample early; one whose rate is that of the
/// way to each sample is damped half a sample late, and a delay and the damping take that up.
#[test]
fn a_bristle_is_found_where_a_sample_is_half_its_reach() {
    const PERIOD: f64 = 8e-3;
    let recording = sampled_lugre(9.0, 8);
    for name in ["symmetric+damping+lag", "symmetric+damping+lag+delay"] {
        let fit = fit_structure(&recording, structure(name), &AxisUnits::LINEAR).unwrap();
        let near = |name: &'static str, truth: f64, share: f64| {
            let found = fit.estimates.get(name).unwrap().value;
            assert!((found / truth - 1.0).abs() < share, "{name}: {found}");
        };
        near("inertia", INERTIA, 0.02);
        near("f_c", F_C, 0.02);
        near("f_s", 9.0, 0.08);
        near("v_s", V_S, 0.06);
        // It was 0.70 %; a ratio of the levels that only followed the fit ended at 0.73 %.
        assert!(fit.relative_error < 0.35, "{}", fit.relative_error);
        near("presliding", F_C / SIGMA0, 0.05);
        near("sigma1", SIGMA1, 0.02);
        let delay = fit.estimates.value("delay").unwrap_or(0.0);
        assert!(delay.abs() < 0.1 * PERIOD, "{delay}");
    }
}

/// An axis that begins at rest, its bristle deflected by `begin` of its limit.
fn from_rest(begin: f64, seed: u64) -> Conditioned {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    let (dt, inner) = (1e-3, 10);
    let fine = dt / f64::from(inner);
    let (mut place, mut force, mut z) = (vec![], vec![], begin);
    for k in 0..15_000 * inner {
        let t = f64::from(k) * fine;
        // It stands for half a second.
        let moving = (t - 0.5).max(0.0);
        let rate = 2.0 + 0.1 * seed as f64;
        let (s, c) = (rate * moving).sin_cos();
        if k % inner == 0 {
            let noise = 0.02 * rng.sample::<f64, _>(StandardNormal);
            place.push(0.2 * (1.0 - c));
            let acceleration = if t > 0.5 { 0.2 * rate * rate * c } else { 0.0 };
            force.push(INERTIA * acceleration + 5.0 * z + 8.0 * 0.2 * rate * s + noise);
        }
        let v = 0.2 * rate * s;
        z = v.signum() + (z - v.signum()) * (-v.abs() * fine / 0.02).exp();
    }
    let signals = Signals {
        time_step: dt,
        position: Some(&place),
        readings: None,
        velocity: None,
        force: &force,
    };
    let conditioned = condition(&signals, &Conditioning::for_time_step(dt)).unwrap();
    conditioned.moving().unwrap().0
}

/// Most recordings begin at rest, and nobody recorded how far the bristle is deflected there. It was
/// taken to be at its limit, and its whole first bend was wrong, here and in what was predicted.
#[test]
fn a_recording_may_begin_with_the_bristle_anywhere() {
    let recording = from_rest(0.0, 1);
    let score = cross_validate(&recording, structure("symmetric+presliding"), 6).unwrap();
    let fit = fit_structure(&recording, score.structure, &AxisUnits::LINEAR).unwrap();
    let near = |name: &'static str, truth: f64, share: f64| {
        let found = fit.estimates.get(name).unwrap().value;
        assert!((found / truth - 1.0).abs() < share, "{name}: {found}");
    };
    near("inertia", INERTIA, 0.005);
    near("f_c", 5.0, 0.005);
    near("f_v", 8.0, 0.01);
    near("presliding", 0.02, 0.01);
    assert!(fit.relative_error < 0.6 && score.relative_error < 0.6, "{fit:?} {score:?}");
    let other = from_rest(-0.7, 3);
    let there = score.tried_on(&recording, &other).unwrap().relative_error;
    let predicted = fit.predict(&other).unwrap();
    assert!((there - predicted.relative_error).abs() < 0.1, "{there} {}", predicted.relative_error);
    assert!(there < 0.6, "{there}");
    let farthest = predicted.measured.iter().zip(&predicted.predicted).map(|(a, b)| (a - b).abs());
    assert!(farthest.fold(0.0, f64::max) < 0.4);
}

/// Of an axis whose dip follows at once the one that lags is not cross-validated, nor is one of an axis
/// whose friction rises over the first speeds: on EMPS each of these took a quarter of the time.
#[test]
fn a_lag_that_fits_no_better_or_has_no_dip_is_told_before_it_is_validated() {
    let at_once = structure("symmetric+stribeck+presliding");
    let lagging = AxisStructure { lag: true, ..at_once };
    let recording = prompt();
    let known = [cross_validate(&recording, at_once, 6).unwrap()];
    let idle = cross_validate_beside(&recording, lagging, 6, &known);
    assert!(matches!(idle, Err(crate::IdentError::IdleLag)), "{idle:?}");
    let damped = AxisStructure { damping: true, ..at_once };
    let lagging = AxisStructure { damping: true, ..lagging };
    let tried = |recording: &Conditioned| {
        let known = [cross_validate(recording, damped, 6).unwrap()];
        (cross_validate_beside(recording, lagging, 6, &known), known)
    };
    let (score, known) = tried(&lugre(9.0));
    let score = score.unwrap();
    assert!(score.relative_error < 0.5 * known[0].relative_error, "{score:?}");
    let (rising, _) = tried(&lugre(3.0));
    assert!(
        matches!(rising, Err(crate::IdentError::NoDipToLag { ratio }) if (ratio - 0.6).abs() < 0.1),
        "{rising:?}"
    );
}

/// An axis with a bristle whose level follows the velocity at once.
fn prompt() -> Conditioned {
    const REACH: f64 = 0.02;
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(9);
    let dt = 1e-3;
    let (mut place, mut force, mut z) = (vec![], vec![], 1.0f64);
    for k in 0..20_000 {
        let t = f64::from(k) * dt;
        let v = velocity(t);
        let level = F_C + 4.0 * (-(v / V_S).powi(2)).exp();
        let noise = 0.02 * rng.sample::<f64, _>(StandardNormal);
        place.push(position(t));
        force.push(INERTIA * acceleration(t) + z * level + 8.0 * v + noise);
        let way = velocity(t + 0.5 * dt);
        z = way.signum() + (z - way.signum()) * (-way.abs() * dt / REACH).exp();
    }
    let signals = Signals {
        time_step: dt,
        position: Some(&place),
        readings: None,
        velocity: None,
        force: &force,
    };
    condition(&signals, &Conditioning::for_time_step(dt)).unwrap()
}

/// Twelve times the kinetic level: further than a lag is followed. Its columns would be those of
/// another ratio, and what is fitted with them no bristle's force.
#[test]
fn a_lag_that_is_not_that_of_the_levels_is_refused() {
    let recording = lugre(60.0);
    let lagging = structure("symmetric+damping+lag");
    let validated = cross_validate(&recording, lagging, 8).map(|score| score.shape.ratio);
    let fitted = fit_structure(&recording, lagging, &AxisUnits::LINEAR).map(|fit| fit.shape.ratio);
    for refused in [validated, fitted] {
        assert!(
            matches!(refused, Err(crate::IdentError::UnsettledLag { found, .. }) if found > 5.0),
            "{refused:?}"
        );
    }
}

/// The search without a starting point lets the ratio of the levels run away here; from where the dip
/// follows at once it settles. Such a structure was chosen among others, and refused by name.
#[test]
fn a_lag_that_runs_away_is_sought_from_where_the_dip_follows_at_once() {
    let recording = lugre(5.5);
    let lagging = structure("symmetric+lag");
    let fit = fit_structure(&recording, lagging, &AxisUnits::LINEAR).unwrap();
    let levels = fit.estimates.value("f_s").unwrap() / fit.estimates.value("f_c").unwrap();
    assert!((fit.shape.ratio / levels - 1.0).abs() < 0.05, "{} {levels}", fit.shape.ratio);
    assert!(cross_validate(&recording, lagging, 8).is_ok());
}

/// Clean moves from place to place ended in an f_s of 1e100 times the force: the column of the dip was
/// next to nothing at the slowest sample.
#[test]
fn a_level_that_no_force_comes_near_is_none() {
    let recording = three_tones(5000, |_, v, a| 0.3 * a + 0.2 * v + 2.0 * v.signum());
    let structure: AxisStructure = "symmetric+stribeck".parse().unwrap();
    let scale = PositionScale::of(&recording);
    let regressors = super::regressors::Regressors::new(&recording, structure, scale).unwrap();
    let force = recording.force.iter().fold(0.0f64, |most, force| most.max(force.abs()));
    // Inertia, viscous friction, offset, the level in motion, and that at rest.
    let beyond = |level: f64| {
        let linear = nalgebra::DVector::from_vec(vec![0.3, 0.2, 0.0, 2.0, level]);
        regressors.level_beyond(&linear).map(|(level, _)| level)
    };
    assert_eq!(beyond(1.5 * force), None);
    assert_eq!(beyond(3.0 * force), Some(3.0 * force));
    assert_eq!(beyond(1e160), Some(1e160));
}

/// Of a motion of one speed the level and viscous friction cancel, and both may come out at any size.
/// That is told in other ways: it was refused, where gravity and friction at that speed are good.
#[test]
fn a_level_in_motion_may_be_far_beyond_the_force() {
    let recording = three_tones(5000, |_, v, a| 0.3 * a + 0.2 * v + 2.0 * v.signum());
    let scale = PositionScale::of(&recording);
    let structure = AxisStructure::SYMMETRIC;
    let regressors = super::regressors::Regressors::new(&recording, structure, scale).unwrap();
    let linear = nalgebra::DVector::from_vec(vec![0.3, -50.0, 0.0, 100.0]);
    assert_eq!(regressors.level_beyond(&linear), None);
}
