//! How often the 95 % intervals of a friction model hold the truth where the residual is coloured
//! or the joint has what the model lacks: a ripple, a dip near rest, lost motion. The truth is then
//! what the same model finds over very long recordings of the same kind.
//!
//! `FRICTION_COVERAGE` sets the number of seeded repetitions, 40 if unset;
//! `cargo xtask test --full` sets 2000.

use std::ops::ControlFlow;

use friction_ident::output_error::{OutputErrorFit, OutputErrorOptions, predict};
use friction_ident::position_load::LoadShape;
use friction_ident::{
    Estimate, Estimates, FreeParameters, Load, Measured, Stretch, fit_output_error,
};
use friction_model::{AnyModel, AnyParameters, ModelName};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

const DT: f64 = 4e-3;

/// What a joint has besides the friction that is fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Beside {
    Colour(f64),
    Ripple,
    Stribeck,
    Backlash,
}

fn model(name: ModelName, values: &[(&'static str, f64)]) -> AnyModel {
    let mut parameters = AnyParameters::test_bed(name);
    values.iter().for_each(|&(name, value)| _ = parameters.set(name, value));
    parameters.try_into().unwrap()
}

fn truth_model() -> AnyModel {
    model(
        ModelName::LuGre,
        &[("f_s", 4.0), ("f_c", 3.0), ("v_s", 0.2), ("f_v", 1.5), ("sigma0", 300.0)],
    )
}

/// Motion on six sines of the same frequencies with other phases, whose sum repeats nothing.
fn recorded(seed: u64, seconds: f64, beside: Beside) -> Stretch {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let ratios = [1.081, 1.197, 2.218, 2.511, 2.714, 3.128];
    let amplitudes = [0.5, 0.4, 0.3, 0.2, 0.14, 0.1];
    let phases: [f64; 6] = std::array::from_fn(|_| std::f64::consts::TAU * rng.random::<f64>());
    let n = (seconds / DT) as usize;
    let (mut place, mut velocity) = (Vec::with_capacity(n), Vec::with_capacity(n));
    for k in 0..n {
        let (mut q, mut v) = (0.0, 0.0);
        for i in 0..6 {
            let w = 1.3 * ratios[i];
            let (sin, cos) = (w * k as f64 * DT + phases[i]).sin_cos();
            q += amplitudes[i] * sin;
            v += amplitudes[i] * w * cos;
        }
        place.push(q);
        velocity.push(v);
    }
    let mut stretch = Stretch::new(DT, velocity, Some(place), vec![0.0; n]).unwrap();
    stretch.friction = predict(&truth_model(), &stretch);
    let (mut colour, mut side) = (0.0, 0.0);
    let places = stretch.position.iter().flatten().zip(&stretch.velocity);
    for (friction, (q, v)) in stretch.friction.iter_mut().zip(places) {
        let noise = rng.sample::<f64, _>(StandardNormal);
        *friction += 0.5
            * match beside {
                Beside::Colour(c) => {
                    colour = c * colour + (1.0 - c * c).sqrt() * noise;
                    colour + 1.0
                }
                Beside::Ripple => 0.8 * (40.0 * q).sin() + 0.2 * noise,
                Beside::Stribeck => 1.2 * v.signum() * (-(v / 0.05).powi(2)).exp() + 0.2 * noise,
                Beside::Backlash => {
                    side += (0.25 * v * DT / 0.01) - 0.25 * v.abs() * DT / 0.01 * side;
                    1.5 * (side - v.signum()) + 0.2 * noise
                }
            };
    }
    stretch
}

fn fitted(seed: u64, seconds: f64, beside: Beside) -> OutputErrorFit {
    let stretch = recorded(seed, seconds, beside);
    let free = FreeParameters::new(&truth_model(), |row| {
        ["f_s", "f_c", "v_s", "f_v", "sigma0"].contains(&row.name)
    });
    let measured = Measured {
        stretches: std::slice::from_ref(&stretch),
        beside: LoadShape { offset: true, position: Load::None },
        ..Measured::default()
    };
    let go = &mut |_: &_| ControlFlow::Continue(());
    let options = OutputErrorOptions::default();
    fit_output_error(&free, &measured, &[], &options, go).unwrap()
}

/// Long recordings, of which the mean is the truth.
fn truth(beside: Beside) -> Vec<f64> {
    if matches!(beside, Beside::Colour(_)) {
        return vec![4.0, 3.0, 0.2, 300.0, 1.5, 0.5];
    }
    let fit = |seed: u64| fitted(1_000_000 + seed, 600.0, beside).estimates;
    let fits: Vec<Estimates> = (0..4).map(fit).collect();
    (0..fits[0].parameters.len())
        .map(|j| fits.iter().map(|fit| fit.parameters[j].value).sum::<f64>() / fits.len() as f64)
        .collect()
}

/// Least shares of intervals that hold the truth.
struct Reached {
    all: f64,
    /// Of any parameter.
    each: f64,
}

/// What is reached of those that are said to be identified. Where the model lacks a dip or lost
/// motion, its own static level, Stribeck velocity and stiffness stand in for them; that is told, and
/// they are not. Before, 0.62 to 0.79 of their intervals held the truth.
const REACHED: Reached = Reached { all: 0.92, each: 0.87 };

/// Both lengths of recording against one truth, which the long recordings tell.
fn intervals_hold_the_truth(beside: Beside) {
    let text = std::env::var("FRICTION_COVERAGE").ok();
    let repetitions: u64 = text.and_then(|text| text.parse().ok()).unwrap_or(40);
    let truth = truth(beside);
    for seconds in [15.0, 60.0] {
        let mut inside = vec![0.0; truth.len()];
        let mut claimed = vec![0.0; truth.len()];
        let mut told = 0;
        for seed in 0..repetitions {
            let fit = fitted(seed, seconds, beside);
            told += usize::from(fit.left.is_some());
            let found = fit.estimates;
            for (j, (estimate, truth)) in found.parameters.iter().zip(&truth).enumerate() {
                if estimate.is_identified() {
                    claimed[j] += 1.0;
                    let holds = |estimate: &Estimate| {
                        estimate.interval.is_some_and(|interval| interval.contains(*truth))
                    };
                    inside[j] += f64::from(u8::from(holds(estimate)));
                }
            }
        }
        let shares: Vec<f64> = inside.iter().zip(&claimed).map(|(a, b)| a / b).collect();
        println!("{beside:?} {seconds} s: {shares:.3?} of {claimed:.0?} identified");
        // Four standard deviations of chance beside what is reached: the static level is what the
        // few slowest samples say, and its errors are not normal.
        let chance = |n: f64| 4.0 * (0.05 * 0.95 / n).sqrt();
        let all = inside.iter().sum::<f64>() / claimed.iter().sum::<f64>();
        let some = claimed.iter().sum::<f64>() / 5.0;
        let Reached { all: of_all, each } = REACHED;
        let told = told as f64 / repetitions as f64;
        println!("{beside:?} {seconds} s: {all:.3} of all; told in {told:.3}");
        // Three standard deviations of chance beside 5 %.
        let luck = 3.0 * (0.05 * 0.95 / repetitions as f64).sqrt();
        match beside {
            Beside::Colour(_) => assert!(told <= 0.05 + luck, "{beside:?} {seconds} s: {told}"),
            Beside::Stribeck | Beside::Backlash => {
                assert!(told >= 0.95 - luck, "{beside:?} {seconds} s: {told}");
            }
            Beside::Ripple => {}
        }
        assert!(all > of_all - chance(some), "{beside:?} {seconds} s: {all}");
        // Where the model is right, wider than they say is wrong too.
        let wide = matches!(beside, Beside::Colour(_)) && repetitions >= 200 && all > 0.99;
        assert!(!wide, "{beside:?} {seconds} s: {all}");
        for (share, claimed) in shares.iter().zip(&claimed) {
            let enough = *claimed >= 0.3 * repetitions as f64;
            assert!(
                !enough || *share > each - chance(*claimed),
                "{beside:?} {seconds} s: {shares:?}"
            );
        }
    }
}

#[test]
fn intervals_hold_the_truth_under_white_noise() {
    intervals_hold_the_truth(Beside::Colour(0.0));
}

#[test]
fn intervals_hold_the_truth_under_colour() {
    intervals_hold_the_truth(Beside::Colour(0.9));
}

#[test]
fn intervals_hold_the_truth_of_a_joint_with_a_ripple() {
    intervals_hold_the_truth(Beside::Ripple);
}

#[test]
fn intervals_hold_the_truth_of_a_joint_with_a_second_dip() {
    intervals_hold_the_truth(Beside::Stribeck);
}

#[test]
fn intervals_hold_the_truth_of_a_joint_with_lost_motion() {
    intervals_hold_the_truth(Beside::Backlash);
}
