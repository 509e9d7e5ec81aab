//! What the hysteretic model must do: its two branches, its spring and its passivity.

use super::*;
use crate::presets::Presets;
use crate::{Stepper, rk4};

const DT: f64 = 1e-4;

fn with(change: impl FnOnce(&mut WojewodaParameters)) -> Wojewoda {
    let mut parameters = WojewodaParameters { f_v: 0.0, ..WojewodaParameters::test_bed() };
    change(&mut parameters);
    parameters.try_into().unwrap()
}

fn stepper(model: Wojewoda) -> Stepper<Wojewoda> {
    Stepper::new(model, TimeStep::new(DT).unwrap())
}

#[test]
fn it_is_a_spring_up_to_the_static_level() {
    let model = with(|_| ());
    let mut stepper = stepper(model);
    let (v, k_t) = (0.001, model.parameters().k_t);
    let mut last = 0.0;
    for k in 0..100_000 {
        let force = stepper.step(v);
        if stepper.internals(v).regime == Regime::Stick {
            assert!((force - k_t * v * DT * f64::from(k)).abs() < 1e-12, "step {k}");
            last = force;
        }
    }
    assert!(last < 0.0994 && last > 0.0994 - 2.01 * k_t * v * DT, "it broke away at {last}");
    assert_eq!(stepper.step(v), model.steady_state(v));
}

/// Faster and faster on the upper branch, slower and slower on the lower one, midway at a constant
/// velocity.
#[test]
fn the_sign_of_the_acceleration_chooses_the_branch() {
    for f_d in [None, Some(0.09), Some(0.08), Some(0.0994)] {
        let model = with(|p| p.f_d = f_d);
        let low = f_d.unwrap_or(0.0925);
        let at = |level: f64, v: f64| 0.0925 + (level - 0.0925) * (-v / 0.1407).exp();
        for direction in [1.0, -1.0] {
            let mut stepper = stepper(model);
            for k in 0..10_000 {
                let v = 1e-4 * f64::from(k);
                let force = direction * stepper.step(direction * v);
                if k > 1000 {
                    assert!((force - at(0.0994, v)).abs() < 1e-15, "up, v {v}: {force}");
                }
            }
            for k in (3000..9999).rev() {
                let v = 1e-4 * f64::from(k);
                let force = direction * stepper.step(direction * v);
                assert!((force - at(low, v)).abs() < 1e-15, "down, v {v}: {force}");
            }
            let v = 0.3;
            for _ in 0..1000 {
                stepper.step(direction * v);
            }
            let midway = 0.5 * (at(0.0994, v) + at(low, v));
            assert!((direction * stepper.step(direction * v) - midway).abs() < 1e-15);
            assert!((model.steady_state(direction * v) - direction * midway).abs() < 1e-15);
        }
    }
}

/// With `a_0` an acceleration of half of it lies halfway between the midway level and the branch.
#[test]
fn a_width_makes_the_change_of_the_branch_gradual() {
    let model = with(|p| p.a_0 = Some(2.0));
    for (acceleration, weight) in [(1.0, 0.5), (4.0, 1.0), (-1.0, -0.5)] {
        let mut stepper = stepper(model);
        for _ in 0..3000 {
            stepper.step(1.0);
        }
        let mut v = 1.0;
        let mut force = 0.0;
        for _ in 0..1000 {
            v += acceleration * DT;
            force = stepper.step(v);
        }
        let level = |f: f64| 0.0925 + (f - 0.0925) * (-v / 0.1407).exp();
        let expected = 0.5 * (level(0.0994) * (1.0 + weight) + level(0.0925) * (1.0 - weight));
        assert!((force - expected).abs() < 1e-12, "{acceleration}: {force} is not {expected}");
    }
}

/// A contact that has to carry more than the lower branch while it hardly moves is held by the
/// spring: static friction.
#[test]
fn a_stuck_contact_holds_up_to_the_static_level_whatever_the_acceleration() {
    let model = with(|p| p.f_d = Some(0.05));
    let mut stepper = stepper(model);
    let k_t = model.parameters().k_t;
    // Up to .9 F_s, then to and fro by a hundredth of it.
    let up = 0.9 * 0.0994 / k_t;
    for _ in 0..1000 {
        stepper.step(up / (1000.0 * DT));
    }
    let mut smallest = f64::INFINITY;
    for k in 0..20_000 {
        let phase = 0.01 * f64::from(k);
        smallest = smallest.min(stepper.step(0.01 * 0.0994 / k_t * 100.0 * phase.cos()));
    }
    assert!(smallest > 0.88 * 0.0994, "{smallest}");
    assert_eq!(stepper.internals(0.0).regime, Regime::Stick);
}

#[test]
fn nothing_exceeds_the_static_level_and_the_force_is_odd() {
    let model = with(|p| (p.f_v, p.f_d) = (0.0403, Some(0.07)));
    let (mut there, mut back) = (stepper(model), stepper(model));
    for k in 0..200_000 {
        let t = DT * f64::from(k);
        let v = 0.3 * (7.0 * t).sin() + 0.4 * (31.0 * t).sin() + 0.1 * (173.0 * t).sin();
        let force = there.step(v);
        assert_eq!(force, -back.step(-v));
        assert!((force - 0.0403 * v).abs() <= 0.0994 * (1.0 + 1e-12));
    }
}

#[test]
fn stores_no_more_than_was_put_in() {
    let model = Wojewoda::chapter_3();
    let dt = 1e-5;
    let mut stepper = Stepper::new(model, TimeStep::new(dt).unwrap());
    let (mut work, mut slips) = (0.0, 0);
    for k in 0..2_000_000 {
        let t = dt * f64::from(k);
        let v = 0.004 * (0.4 * t).sin() + 0.012 * (5.1 * t).sin() + 0.02 * (47.0 * t).sin();
        let stuck = stepper.internals(v).regime == Regime::Stick;
        let before = stepper.step(v);
        slips += u32::from(stuck && stepper.internals(v).regime == Regime::Slip);
        let State { continuous, memory } = stepper.state();
        work += 0.5 * (before + model.evaluate(continuous, memory, v).force) * v * dt;
        let stored = model.stored_energy(stepper.state()).unwrap();
        assert!(work >= stored - 1e-6, "step {k}: {work} put in, {stored} stored");
    }
    assert!(slips > 100, "{slips}");
}

/// The derivative form with small steps and the fixed-step form at 1 kHz follow each other but for
/// the samples at the changes.
#[test]
fn both_forms_agree() {
    let model = Wojewoda::test_bed();
    let velocity = |t: f64| 0.3 * (3.0 * t).sin() + 0.05 * (20.0 * t).sin();
    let difference = |dt: f64| {
        let fine = 1e-5;
        let per_step = (dt / fine).round() as u32;
        let mut stepper = Stepper::new(model, TimeStep::new(dt).unwrap());
        let mut state = model.rest();
        let (mut sum, mut exact) = (0.0, 0.0);
        let steps = (4.0 / dt) as u32;
        for k in 0..steps {
            sum += (stepper.step(velocity(dt * f64::from(k))) - exact).abs();
            for j in 0..per_step {
                let t = dt * f64::from(k) + fine * f64::from(j);
                exact = rk4::step(
                    &model,
                    &mut state,
                    [t, t + 0.5 * fine, t + fine].map(velocity),
                    fine,
                );
            }
        }
        sum / f64::from(steps)
    };
    let (coarse, finer) = (difference(1e-3), difference(1e-4));
    assert!(coarse < 0.005 * 0.0994, "mean difference at 1 ms: {coarse}");
    assert!(finer < 0.2 * coarse, "{finer} is not a tenth of {coarse}");
}

#[test]
fn refuses_levels_in_the_wrong_order() {
    let set = WojewodaParameters::test_bed();
    let message = |p: WojewodaParameters| Wojewoda::try_from(p).unwrap_err().to_string();
    assert!(
        message(WojewodaParameters { f_c: 0.2, ..set })
            .starts_with("wojewoda.f_c must be at most f_s")
    );
    assert!(
        message(WojewodaParameters { f_d: Some(0.2), ..set })
            .starts_with("wojewoda.f_d must be at most f_s")
    );
}
