//! Runge and Kutta over all that the models accept: whatever is written is finite, no larger than
//! the model can be, and what steps a tenth as long give; or it is an error.

use friction_model::{AnyParameters, ModelName, Range};
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg32;

use super::tests::{HELD, Trajectory, forces};
use super::*;

/// A set of parameters with every number some decades away from a preset's, up to all that is
/// accepted.
fn anywhere(name: ModelName, random: &mut Pcg32) -> Option<AnyModel> {
    let presets = [AnyParameters::test_bed, AnyParameters::chapter_3];
    let mut parameters = presets[random.random_range(0..2)](name);
    let decades = [0.0, 1.0, 4.0, 40.0][random.random_range(0..4)];
    for row in parameters.table() {
        if matches!(row.name, "alpha" | "lambda" | "bonds" | "seed") {
            continue;
        }
        for (index, value) in parameters.values(row.name).into_iter().enumerate() {
            let wanted = match row.range {
                Range::Within(low, high) | Range::FromTo(low, high) if decades > 0.0 => {
                    low + (high - low) * random.random::<f64>()
                }
                _ => value * 10f64.powf(decades * (2.0 * random.random::<f64>() - 1.0)),
            };
            parameters.set_at(row.name, index, wanted);
        }
    }
    let ratio = random.random_range(0.1..=1.0);
    for (low, high) in [("f_c", "f_s"), ("f_s", "f_h"), ("f_2", "f_1")] {
        if let (Some(_), Some(&high)) =
            (parameters.values(low).first(), parameters.values(high).first())
        {
            parameters.set(low, high * ratio);
        }
    }
    AnyModel::try_from(parameters).ok()
}

/// A wave, or a jagged line with velocities of any size.
fn any_motion(dt: f64, random: &mut Pcg32) -> Trajectory {
    let count = random.random_range(2..40);
    let spacing = dt * 10f64.powf(random.random_range(-0.5..1.3));
    let time: Vec<f64> = (0..count).map(|k| f64::from(k) * spacing).collect();
    let amplitude = 10f64.powf(random.random_range(-6.0..=6.0f64));
    let (waves, jagged) = (random.random_range(0.2..4.0), random.random_bool(0.5));
    let end = spacing * f64::from(count);
    let velocity = time.iter().map(|t| {
        if jagged {
            amplitude * (2.0 * random.random::<f64>() - 1.0)
        } else {
            amplitude * (std::f64::consts::TAU * waves * t / end).sin()
        }
    });
    let velocity = velocity.collect();
    Trajectory { time, velocity, load: None, axis: recording::AxisKind::Rotary }
}

/// Cases of each model: a few, and many in the long tier.
fn cases() -> usize {
    if std::env::var_os("FRICTION_FULL").is_some() { 300 } else { 12 }
}

const TOLERANCE: f64 = 1e-6;

/// Every step holds the tolerance by itself; over a motion that may grow, though not far.
#[test]
fn what_runge_and_kutta_write_does_not_depend_on_the_step() {
    let (mut compared, mut apart) = (0, Vec::new());
    for name in ModelName::ALL.into_iter().filter(|name| *name != ModelName::Bristle) {
        let mut random = Pcg32::seed_from_u64(17 + name as u64);
        for case in 0..cases() {
            let Some(model) = anywhere(name, &mut random) else { continue };
            let dt = 10f64.powf(random.random_range(-5.0..=-1.0));
            let motion = any_motion(dt, &mut random);
            let settings = Settings { scheme: Scheme::Rk4, dt, tolerance: TOLERANCE, ..HELD };
            let finer = Settings { dt: 0.1 * dt, ..settings };
            let both = [settings, finer].map(|settings| forces(&model, &motion, &settings));
            match both {
                [Ok(coarse), Ok(fine)] => {
                    compared += 1;
                    assert!(coarse.iter().chain(&fine).all(|force| force.is_finite()));
                    keeps_to_its_level(&model, &motion, &coarse);
                    let largest = fine.iter().fold(0.0f64, |most, force| most.max(force.abs()));
                    let differences = coarse.iter().zip(&fine).map(|(a, b)| (a - b).abs());
                    let most = differences.fold(0.0, f64::max);
                    assert!(most <= 1e-3 * largest, "{name}, case {case}: {most} of {largest}");
                    if most > 10.0 * TOLERANCE * largest {
                        apart.push((name, case, most / largest));
                    }
                }
                [coarse, fine] => {
                    for stopped in [coarse, fine].into_iter().filter_map(Result::err) {
                        let said = stopped.to_string();
                        assert!(said.contains("--scheme mean"), "{name}, case {case}: {said}");
                    }
                }
            }
        }
    }
    assert!(compared > 14 * cases(), "{compared} were compared");
    assert!(apart.len() * 100 <= compared, "of {compared}: {apart:?}");
}

/// Of models whose force has no more than the static level and the viscous part.
fn keeps_to_its_level(model: &AnyModel, motion: &Trajectory, forces: &[f64]) {
    let bounded =
        [ModelName::Dahl, ModelName::Xiong, ModelName::Proposed, ModelName::ProposedLinear];
    if !bounded.contains(&model.name()) {
        return;
    }
    let level = model.parameter("f_s").or(model.parameter("f_c")).unwrap_or(f64::INFINITY);
    let f_v = model.parameter("f_v").unwrap_or(0.0);
    for (v, force) in motion.velocity.iter().zip(forces) {
        let viscous = f_v * v;
        let most = level * (1.0 + 10.0 * TOLERANCE) + 1e-12 * viscous.abs();
        assert!((force - viscous).abs() <= most, "{model:?}: {force} at {v}");
    }
}

/// Steps of a millisecond and a tenth of it used to differ by 2 % of the force, and nothing was
/// said.
#[test]
fn switches_are_placed_where_they_are_thrown() {
    let time: Vec<f64> = (0..400).map(|k| f64::from(k) * 1e-3).collect();
    let velocity: Vec<f64> = time.iter().map(|t| 0.3 * (15.0 * t).sin()).collect();
    let motion = Trajectory { time, velocity, load: None, axis: recording::AxisKind::Rotary };
    for name in [ModelName::Gms, ModelName::Armstrong, ModelName::Wojewoda] {
        let model = AnyModel::test_bed(name);
        let with = |dt| {
            let settings = Settings { scheme: Scheme::Rk4, dt, ..HELD };
            forces(&model, &motion, &settings).unwrap()
        };
        for (a, b) in with(1e-3).iter().zip(with(1e-4)) {
            assert!((a - b).abs() < 1e-6, "{name}: {a} and {b}");
        }
    }
}
