//! Stick-slip: a mass pulled over a surface by a spring whose end moves at a constant speed.
//!
//! With Coulomb friction and stiction the motion has a closed form: the mass sticks until the
//! spring reaches `F_s`, then swings about the level `F_c` until its speed is zero again, which is
//! where the spring pulls with `2 F_c - F_s`.

use friction_model::{Body, Drive, FrictionModel, Karnopp, KarnoppParameters, Stiction};

const MASS: f64 = 1.0;
const SPRING: f64 = 2.0;
const PULL: f64 = 0.1;

/// What a run of 60 s shows after 18 s.
#[derive(Debug)]
struct StickSlip {
    /// From one breakaway to the next [s].
    period: f64,
    /// Longest and shortest spring force [N].
    spring: (f64, f64),
    /// Fastest slip [m/s].
    peak: f64,
    /// Largest friction [N].
    friction: f64,
}

fn stick_slip<M: FrictionModel>(model: M, dt: f64) -> StickSlip {
    let pull = |time: f64, position: f64| SPRING * (PULL * time - position);
    let mut body = Body::<M, 0>::new(model, MASS);
    let (mut first, mut last, mut breakaways) = (0.0, 0.0, 0u32);
    let mut seen =
        StickSlip { period: 0.0, spring: (0.0, f64::INFINITY), peak: 0.0, friction: 0.0 };
    let mut before = 0.0;
    for _ in 0..(60.0 / dt).round() as u64 {
        body.advance(dt, |at| Drive::from(pull(at.time, at.position)));
        let at = *body.moment();
        if at.time > 18.0 {
            let force = pull(at.time, at.position);
            seen.spring = (seen.spring.0.max(force), seen.spring.1.min(force));
            seen.peak = seen.peak.max(at.velocity);
            seen.friction = seen.friction.max(body.friction(force));
            if before == 0.0 && at.velocity > 0.0 {
                if breakaways == 0 {
                    first = at.time;
                }
                (last, breakaways) = (at.time, breakaways + 1);
            }
        }
        before = at.velocity;
    }
    seen.period = (last - first) / f64::from(breakaways - 1);
    seen
}

fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!((value / expected - 1.0).abs() < tolerance, "{value} instead of {expected}");
}

/// Chapter 3's levels with a Stribeck velocity below every speed of the simulation: Coulomb
/// friction and stiction.
fn karnopp_without_dip(d_v: f64) -> Karnopp {
    let chapter_3 = *Karnopp::chapter_3().parameters();
    Karnopp::try_from(KarnoppParameters { v_s: 1e-9, d_v, ..chapter_3 }).unwrap()
}

#[test]
fn coulomb_friction_and_stiction_stick_and_slip_as_known() {
    let karnopp = stick_slip(karnopp_without_dip(1e-4), 1e-4);
    let stiction = stick_slip(Stiction::chapter_3(), 1e-4);
    for seen in [karnopp, stiction] {
        assert_near(seen.period, 7.6117, 5e-4);
        assert_near(seen.spring.0, 1.51963, 5e-4);
        assert_near(seen.spring.1, 0.48031, 5e-4);
        assert_near(seen.peak, 0.46746, 5e-4);
        assert_near(seen.friction, 1.5, 5e-4);
    }
}

#[test]
fn a_falling_characteristic_makes_the_period_longer() {
    let seen = stick_slip(Karnopp::chapter_3(), 1e-4);
    assert_near(seen.period, 7.9236, 5e-4);
    assert_near(seen.spring.0, 1.5517, 5e-4);
    assert_near(seen.spring.1, 0.4483, 5e-4);
    assert_near(seen.peak, 0.4902, 5e-4);
    assert_near(seen.friction, 1.5, 5e-4);
}

/// Error of the period against the closed form at three steps: of the order of one step, at which
/// breakaway is seen.
#[test]
fn smaller_steps_lead_to_the_closed_form() {
    let (f_s, f_c): (f64, f64) = (1.5, 1.0);
    let omega = (SPRING / MASS).sqrt();
    let a = (f_s - f_c) / SPRING;
    let slip = (std::f64::consts::TAU - 2.0 * (a * omega / PULL).atan()) / omega;
    let stick = 2.0 * (f_s - f_c) / (SPRING * PULL);
    let period = slip + stick;
    assert!((period - 7.611259).abs() < 5e-7);
    let swing = (a * omega).hypot(PULL);
    for dt in [1e-3, 1e-4, 1e-5] {
        // The band falls with the step, as max|a| dt = .5 dt demands.
        for seen in [stick_slip(karnopp_without_dip(dt), dt), stick_slip(Stiction::chapter_3(), dt)]
        {
            assert!((seen.period - period).abs() < 4.0 * dt, "{dt} s: {seen:?}");
            assert!((seen.peak - PULL - swing).abs() < 0.5 * dt, "{dt} s: {seen:?}");
            assert!(
                (seen.spring.0 - f_c - SPRING * swing / omega).abs() < 0.5 * dt,
                "{dt} s: {seen:?}"
            );
            assert!(
                (seen.spring.1 - f_c + SPRING * swing / omega).abs() < 0.5 * dt,
                "{dt} s: {seen:?}"
            );
        }
    }
}
