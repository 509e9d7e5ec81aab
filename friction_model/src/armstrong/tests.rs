//! What Armstrong-Helouvry's model must do: its two branches, the rules between them, lag, dwell
//! and passivity.

use super::*;
use crate::presets::Presets;
use crate::{Stepper, rk4};

const DT: f64 = 1e-4;

fn stepper(model: Armstrong) -> Stepper<Armstrong> {
    Stepper::new(model, TimeStep::new(DT).unwrap())
}

#[test]
fn it_is_a_spring_up_to_the_static_level_and_then_slides() {
    let model = Armstrong::test_bed();
    let p = *model.parameters();
    let v = 0.01;
    let mut stepper = stepper(model);
    let mut last = 0.0f64;
    for k in 0..20_000 {
        let stuck = stepper.internals(v).regime == Regime::Stick;
        let force = stepper.step(v);
        if stuck && stepper.internals(v).regime == Regime::Stick {
            assert!((force - p.k_t * v * DT * f64::from(k)).abs() < 1e-12, "step {k}");
            last = force;
        }
    }
    assert!(last <= p.f_s && last > p.f_s - 1.01 * p.k_t * v * DT, "it broke away at {last}");
    assert_eq!(stepper.step(v), model.steady_state(v));
}

#[test]
fn after_a_long_rest_it_slides_on_the_lorentz_curve() {
    let model = Armstrong::test_bed();
    for v in [0.01, 0.1407, -0.1407, 1.0, -4.0] {
        let mut stepper = stepper(model);
        for _ in 0..20_000 {
            stepper.step(v);
        }
        let r: f64 = v / 0.1407;
        let expected = v.signum() * (0.0925 + 0.0069 / (1.0 + r * r)) + 0.0403 * v;
        assert!((stepper.step(v) - expected).abs() < 1e-15, "v {v}");
        assert!((model.steady_state(v) - expected).abs() < 1e-15, "v {v}");
    }
}

/// Friction follows the Stribeck curve of the velocity `tau_l` ago.
#[test]
fn sliding_friction_lags_by_the_delay() {
    let model = Armstrong::test_bed();
    let velocity = |t: f64| 0.2 + 0.15 * (30.0 * t).sin();
    for tau_l in [0.0, 0.0023, 0.0111, 0.04] {
        let model =
            Armstrong::try_from(ArmstrongParameters { tau_l, ..*model.parameters() }).unwrap();
        let mut stepper = stepper(model);
        for k in 0..10_000 {
            let t = DT * f64::from(k);
            let force = stepper.step(velocity(t)) - 0.0403 * velocity(t);
            if t > 0.2 {
                let r = velocity(t - tau_l) / 0.1407;
                let expected = 0.0925 + 0.0069 / (1.0 + r * r);
                assert!(
                    (force - expected).abs() < 3e-6,
                    "tau_l {tau_l}, t {t}: {force} is not {expected}"
                );
            }
        }
    }
}

/// Stopped out of a fast slip the Stribeck friction is almost gone; it comes back as
/// `t_2 / (t_2 + gamma)`.
#[test]
fn static_friction_rises_with_the_dwell() {
    let model = Armstrong::test_bed();
    let p = *model.parameters();
    for rest in [0.1, 0.5, 1.0, 3.0] {
        let mut stepper = stepper(model);
        for _ in 0..5000 {
            stepper.step(10.0 * p.v_s);
        }
        for _ in 0..(rest / DT) as u32 {
            stepper.step(0.0);
        }
        let v = 1e-4;
        let (mut dwell, mut force, mut before) = (rest, 0.0, 0.0);
        while stepper.internals(v).regime == Regime::Stick {
            before = force;
            force = stepper.step(v);
            dwell += DT;
        }
        let at_the_end = 0.0069 / 101.0;
        let expected = 0.0925 + at_the_end + (0.0069 - at_the_end) * dwell / (dwell + p.gamma);
        assert!((before - expected).abs() < 2e-6, "after {dwell} s: {before} is not {expected}");
        // The slip that follows has only this much Stribeck friction.
        for _ in 0..5000 {
            force = stepper.step(v);
        }
        assert!(
            (force - expected).abs() < 2e-6 + p.f_v * v && force < model.steady_state(v) - 1e-4
        );
    }
}

/// At a reversal the spring takes over with the force of the moment and gives it back at the
/// stiffness `k_t`.
#[test]
fn the_force_is_continuous_where_a_slip_ends() {
    let model = Armstrong::chapter_3();
    let mut stepper = stepper(model);
    let (mut before, mut largest) = (0.0f64, 0.0f64);
    let mut turns = 0;
    for k in 0..200_000 {
        let t = DT * f64::from(k);
        let v = 0.02 * (2.0 * t).sin();
        let was = stepper.internals(v).regime;
        let force = stepper.step(v);
        if was == Regime::Slip && stepper.internals(v).regime == Regime::Stick {
            turns += 1;
            largest = largest.max((force - before).abs());
        }
        before = force;
    }
    // Between two samples the level itself moves: by at most its steepest slope times the
    // acceleration's step.
    let steepest = 0.65 * 0.5 / 0.01 * 0.04 * DT;
    assert!(turns >= 12 && largest < steepest, "{turns} turns, {largest}, {steepest}");
}

#[test]
fn nothing_exceeds_the_static_level() {
    let model = Armstrong::test_bed();
    let p = *model.parameters();
    let mut stepper = stepper(model);
    for k in 0..400_000 {
        let t = DT * f64::from(k);
        let v = 0.3 * (7.0 * t).sin() + 0.4 * (31.0 * t).sin() + 0.1 * (173.0 * t).sin();
        let force = stepper.step(v);
        assert!(force.abs() <= (p.f_s + p.f_v * v.abs()) * (1.0 + 1e-12));
    }
}

/// What goes in is at least what is stored, along a path of slips, stops and strokes within the
/// spring.
#[test]
fn stores_no_more_than_was_put_in() {
    let model = Armstrong::chapter_3();
    let dt = 1e-5;
    let mut stepper = Stepper::new(model, TimeStep::new(dt).unwrap());
    let (mut work, mut slips) = (0.0, 0);
    for k in 0..3_000_000 {
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

#[test]
fn a_load_below_breakaway_leaves_it_where_it_was() {
    let model = Armstrong::chapter_3();
    let mut stepper = stepper(model);
    for k in 0..100_000 {
        // To and fro by half of the breakaway deflection, a thousand times.
        stepper.step(0.5 * 1.5 / model.parameters().k_t * 62.8 * (62.8 * DT * f64::from(k)).cos());
    }
    assert!(stepper.state().memory.slip == 0.0);
    assert!(stepper.internals(0.0).deflection.abs() <= 0.51 * 1.5 / model.parameters().k_t);
}

/// The derivative form with small steps and the fixed-step form at 1 kHz follow each other but for
/// the samples at the changes.
#[test]
fn both_forms_agree() {
    let model = Armstrong::test_bed();
    let velocity = |t: f64| 0.3 * (3.0 * t).sin() + 0.05 * (20.0 * t).sin();
    let difference = |dt: f64| {
        let fine = 1e-5;
        let per_step = (dt / fine).round() as u32;
        let mut stepper = Stepper::new(model, TimeStep::new(dt).unwrap());
        let mut state = model.rest();
        let (mut sum, mut n) = (0.0, 0u32);
        let mut exact = 0.0;
        for k in 0..(4.0 / dt) as u32 {
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
            n += 1;
        }
        sum / f64::from(n)
    };
    let (coarse, finer) = (difference(1e-3), difference(1e-4));
    assert!(coarse < 0.003 * 0.0994, "mean difference at 1 ms: {coarse}");
    assert!(finer < 0.2 * coarse, "{finer} is not a tenth of {coarse}");
}

#[test]
fn refuses_a_kinetic_level_above_the_static_one() {
    let wrong = ArmstrongParameters { f_c: 0.2, ..ArmstrongParameters::test_bed() };
    let message = Armstrong::try_from(wrong).unwrap_err().to_string();
    assert!(message.starts_with("armstrong.f_c must be at most f_s"), "{message}");
}
