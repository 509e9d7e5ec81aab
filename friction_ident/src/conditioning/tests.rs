//! What conditioning keeps and what it leaves out.

use super::*;
use crate::IdentError;
use proptest::prelude::*;

fn signals<'a>(position: &'a [f64], force: &'a [f64]) -> Signals<'a> {
    Signals { time_step: 1e-3, position: Some(position), readings: None, velocity: None, force }
}

const HOW: Conditioning = Conditioning {
    cutoff: 100.0,
    acceleration_cutoff: 100.0,
    order: 4,
    differences: Differences::SecondOrder,
    trim: 50,
    decimate: 10,
    low_pass_force: false,
};

#[test]
fn differentiates_a_sine_without_delay() {
    let w = 2.0 * std::f64::consts::PI * 2.0;
    let time = |i: usize| i as f64 * 1e-3;
    let position: Vec<f64> = (0..2000).map(|i| (w * time(i)).sin()).collect();
    let out = condition(&signals(&position, &position), &HOW).unwrap();
    assert_eq!(out.first, 50);
    assert_eq!(out.velocity.len(), 1900);
    for (k, (v, a)) in out.velocity.iter().zip(&out.acceleration).enumerate() {
        let t = time(k + 50);
        // The central difference's own error is (w dt)^2 / 6, 2.6e-5.
        assert!((v - w * (w * t).cos()).abs() < 4e-5 * w, "velocity at {t}");
        assert!((a + w * w * (w * t).sin()).abs() < 8e-5 * w * w, "acceleration at {t}");
    }
}

/// An arm that is sampled slowly for its motion: the inertia of a tone at a twentieth of the rate
/// came out 3 % too large.
#[test]
fn fast_motion_keeps_its_size() {
    let lines: Vec<f64> = (0..200).map(|k| (0.314 * f64::from(k)).sin()).collect();
    let slopes = Differences::SixthOrder.of(&lines, 1.0);
    for (k, slope) in slopes.iter().enumerate().skip(3).take(194) {
        let truth = 0.314 * (0.314 * k as f64).cos();
        assert!((slope - truth).abs() < 1e-5 * 0.314, "{k}: {slope} {truth}");
    }
    for order in 0..=2 {
        let curve: Vec<f64> = (0..9).map(|k| f64::from(k).powi(order)).collect();
        for how in [Differences::SecondOrder, Differences::SixthOrder] {
            let slopes = how.of(&curve, 1.0);
            let truth = |k: usize| f64::from(order) * (k as f64).powi(order - 1);
            assert!((1..8).all(|k| (slopes[k] - truth(k)).abs() < 1e-12), "{slopes:?}");
        }
    }
}

#[test]
fn a_given_velocity_is_used() {
    let velocity: Vec<f64> = (0..500).map(|i| 0.5 + 1e-3 * i as f64).collect();
    let zeros = vec![0.0; 500];
    let given = Signals {
        time_step: 1e-3,
        position: Some(&zeros),
        readings: None,
        velocity: Some(&velocity),
        force: &zeros,
    };
    let out = condition(&given, &HOW).unwrap();
    assert!(out.acceleration.iter().all(|a| (a - 1.0).abs() < 1e-6));
}

#[test]
fn degenerate_recordings_are_refused() {
    let ok = vec![1.0; 300];
    let short = vec![1.0; 102];
    assert!(matches!(
        condition(&signals(&short, &short), &HOW),
        Err(IdentError::TooFewSamples { needed: 103, .. })
    ));
    assert!(matches!(condition(&signals(&[], &[]), &HOW), Err(IdentError::TooFewSamples { .. })));
    assert!(matches!(
        condition(&signals(&short, &ok), &HOW),
        Err(IdentError::UnequalLengths { .. })
    ));
    let mut broken = ok.clone();
    broken[7] = f64::NAN;
    assert!(matches!(
        condition(&signals(&broken, &ok), &HOW),
        Err(IdentError::NotFinite { channel: "the position", index: 7, .. })
    ));
    let no_motion =
        Signals { time_step: 1e-3, position: None, readings: None, velocity: None, force: &ok };
    assert!(matches!(condition(&no_motion, &HOW), Err(IdentError::NoMotion)));
    let no_time = Signals { time_step: 0.0, ..signals(&ok, &ok) };
    assert!(matches!(condition(&no_time, &HOW), Err(IdentError::TimeStep(_))));
    assert!(condition(&signals(&ok, &ok), &Conditioning { decimate: 0, ..HOW }).is_err());
}

/// Two seconds of a sine, two of rest with an encoder's noise, two of the sine.
#[test]
fn rest_is_left_out_and_motion_stays_with_its_times() {
    use rand::{RngExt, SeedableRng};
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(7);
    let place = |t: f64| match t {
        t if t < 2.0 => (std::f64::consts::PI * t).cos(),
        t if t < 4.0 => 1.0,
        t => (std::f64::consts::PI * (t - 4.0)).cos(),
    };
    let mut noisy = |i: u32| place(f64::from(i) * 1e-3) + 1e-4 * rng.random::<f64>();
    let position: Vec<f64> = (0..6000).map(&mut noisy).collect();
    let whole = condition(&signals(&position, &position), &HOW).unwrap();
    let (found, rest) = whole.clone().moving().unwrap();
    assert!((rest.out - 2.0).abs() < 0.2, "{rest:?}");
    assert_eq!((found.stretches(), found.pieces.len()), (1, 2));
    assert!((found.pieces[1].start - 4.0).abs() < 0.15, "{:?}", found.pieces);
    assert_eq!(found.pieces[1].kept.end, found.velocity.len());
    let offset = whole.velocity.len() - found.velocity.len();
    assert_eq!(found.velocity[..100], whole.velocity[..100]);
    let last = found.force.len() - 1;
    assert_eq!(found.force[last], whole.force[last + offset]);
    let sine: Vec<f64> = (0..6000).map(|i| (f64::from(i) * 3e-3).sin()).collect();
    let whole = condition(&signals(&sine, &sine), &HOW).unwrap();
    assert_eq!(whole.clone().moving().unwrap(), (whole, Rest::default()));
}

/// An axis that rested for most of a recording used to be fitted with its rest: Coulomb friction
/// of 0.5 N m came out as 0.007 +- 0.023.
#[test]
fn a_long_rest_is_left_out_however_long() {
    use rand::{RngExt, SeedableRng};
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(9);
    let w = 2.0 * std::f64::consts::PI;
    let mut recording = |motion: std::ops::Range<u32>| -> Vec<f64> {
        let place = |i: u32| (w * 1e-3 * f64::from(i.clamp(motion.start, motion.end))).cos();
        (0..40_000).map(|i| place(i) + 1e-4 * rng.random::<f64>()).collect()
    };
    let (long, short) = (recording(20_000..22_000), recording(20_000..20_060));
    let of = |position: &[f64]| condition(&signals(position, position), &HOW).unwrap().moving();
    let (found, rest) = of(&long).unwrap();
    assert!((rest.out - 37.9).abs() < 0.3, "{rest:?}");
    assert_eq!((rest.sticks, rest.kept), (0.0, 0.0));
    assert_eq!(found.pieces.len(), 1);
    let said = of(&short).unwrap_err().to_string();
    assert!(said.contains("the motion between two rests"), "{said}");
}

/// A stranger's axes stuck for ten samples at each turn, and that was fitted as motion: it gave a delay
/// of -32 ms, identified, where there was one of 1 ms.
#[test]
fn short_sticks_are_left_out_where_an_encoder_shows_them() {
    const STEP: f64 = 1e-4;
    let read = |stick: f64, stroke: f64| -> Vec<f64> {
        let place = |t: f64| {
            let (turn, within) = ((t / (stroke + stick)).floor(), t % (stroke + stick));
            let way = 0.25 * (1.0 - (within.min(stroke) * std::f64::consts::PI / stroke).cos());
            if turn % 2.0 == 0.0 { way } else { 0.5 - way }
        };
        (0..2400).map(|k| (place(f64::from(k) * 1e-2) / STEP).floor() * STEP).collect()
    };
    let moving = |position: &[f64]| {
        let signals = Signals { time_step: 1e-2, ..signals(position, position) };
        condition(&signals, &Conditioning::for_time_step(1e-2)).unwrap().moving().unwrap()
    };
    let (found, rest) = moving(&read(0.1, 0.7));
    // 30 of them, each with what the encoder does not see and the low-pass spreads.
    assert!((2.9..12.0).contains(&rest.out), "{rest:?}");
    assert_eq!((rest.sticks, rest.kept), (rest.out, 0.0));
    assert!((25..=30).contains(&found.pieces.len()), "{}", found.pieces.len());
    assert_eq!(moving(&read(0.0, 0.7)).1, Rest::default());
    // Behind a low-pass no reading stays, as where uneven samples were brought to an even rate.
    let readings = read(0.1, 0.7);
    let smooth: Vec<f64> = (0..readings.len())
        .map(|k| {
            let near = &readings[k.saturating_sub(1)..(k + 2).min(readings.len())];
            near.iter().sum::<f64>() / near.len() as f64 + 1e-7 * (0.3 * k as f64).sin()
        })
        .collect();
    let with = |readings| {
        let signals = Signals { time_step: 1e-2, readings, ..signals(&smooth, &smooth) };
        let how = Conditioning::for_time_step(1e-2);
        condition(&signals, &how).unwrap().moving().unwrap().1
    };
    assert_eq!(with(None).sticks, 0.0);
    assert_eq!(with(Some(&readings)).sticks, rest.sticks);
    // Thinned as usual at this rate no motion between them is long enough; thinned less it is.
    let short = read(0.1, 0.4);
    assert!(moving(&short).1.kept > 0.0);
    let signals = Signals { time_step: 1e-2, ..signals(&short, &short) };
    let how = Conditioning::for_motion(1e-2, &[signals]);
    let rest = condition(&signals, &how).unwrap().moving().unwrap().1;
    assert!(rest.kept == 0.0 && rest.sticks > 3.0, "{rest:?}, {how:?}");
    // Where too little is left between them they stay in, and their time is told.
    let (found, rest) = moving(&read(0.1, 0.15));
    assert_eq!((found.pieces.len(), rest.out, rest.sticks), (1, 0.0, 0.0));
    assert!((8.0..24.0).contains(&rest.kept), "{rest:?}");
}

/// A stranger's rotary table, recorded at 50 Hz, stands for 0.2 s where it turns round. Behind the
/// low-pass the jump of its acceleration there rings on for 0.2 s: f_c came out 3 % low beside a dip that
/// halved the error, and that it does not have.
#[test]
fn what_rings_after_a_stick_is_left_out_with_it() {
    use crate::axis_structure::{AxisStructure, AxisUnits, fit_structure};
    const DT: f64 = 0.02;
    let (fast, ramp) = (1.5, 1.25);
    // Ways of different length, and what the controller holds the table with.
    let mut at = Vec::new();
    let mut place = 0.0;
    for turn in 0..40 {
        let way = if turn % 2 == 0 { 1.0 } else { -1.0 };
        let steady = 0.6 + 0.13 * f64::from(turn % 7);
        let lasts = 2.0 * ramp + steady;
        let mut t = 0.0;
        while t < lasts {
            let (up, down) = ((t / ramp).min(1.0), ((lasts - t) / ramp).min(1.0));
            let a = if up < 1.0 {
                fast / ramp
            } else if down < 1.0 {
                -fast / ramp
            } else {
                0.0
            };
            let v = fast * up.min(down);
            at.push((place, 12.0 * way * a + 6.2 * way * v + 9.4 * way - 0.7));
            place += way * (v * DT + 0.5 * a * DT * DT);
            t += DT;
        }
        at.extend([(place, 3.0 * way - 0.7); 10]);
    }
    const STEP: f64 = 1.7e-5;
    let position: Vec<f64> = at.iter().map(|(place, _)| (place / STEP).floor() * STEP).collect();
    let force: Vec<f64> = at.iter().map(|(_, force)| *force).collect();
    let given = Signals { time_step: DT, ..signals(&position, &force) };
    let how = Conditioning { low_pass_force: true, ..Conditioning::for_time_step(DT) };
    let (moving, rest) = condition(&given, &how).unwrap().moving().unwrap();
    assert!(rest.sticks > 0.2 * 39.0, "{rest:?}");
    let fit = fit_structure(&moving, AxisStructure::SYMMETRIC, &AxisUnits::ROTARY).unwrap();
    let off =
        |name: &'static str, truth: f64| (fit.estimates.value(name).unwrap() / truth - 1.0).abs();
    let dip = AxisStructure { stribeck: true, ..AxisStructure::SYMMETRIC };
    let with = fit_structure(&moving, dip, &AxisUnits::ROTARY).unwrap();
    // Before, 3 % of f_c and 1.1 % of the torque, of which a dip took a half.
    assert!(off("inertia", 12.0) < 3e-3 && off("f_c", 9.4) < 0.015, "{:?}", fit.estimates);
    let errors = (fit.relative_error, with.relative_error);
    assert!(errors.0 < 0.7 && errors.1 > 0.75 * errors.0, "{errors:?}");
}

/// Of 5 kHz with a motion of a few hertz a fifth is left, at the same times and of the same size.
#[test]
fn a_coarser_recording_has_the_same_motion() {
    let w = 2.0 * std::f64::consts::PI * 1.5;
    let position: Vec<f64> = (0..20_000).map(|i| (w * f64::from(i) * 2e-4).sin()).collect();
    let given = Signals { time_step: 2e-4, ..signals(&position, &position) };
    let how = Conditioning { cutoff: 100.0, decimate: 100, ..HOW };
    let fine = condition(&given, &how).unwrap();
    let coarse = fine.clone().coarsened().unwrap();
    let factor = (coarse.time_step / fine.time_step).round() as usize;
    assert!(factor >= 4, "{factor}");
    assert_eq!(coarse.decimate * factor, fine.decimate / factor * factor);
    assert_eq!(coarse.velocity.len(), fine.velocity.len().div_ceil(factor));
    assert_eq!(coarse.velocity[7], fine.velocity[7 * factor]);
    let time = |of: &Conditioned| of.pieces[0].start + of.first as f64 * of.time_step;
    assert!((time(&coarse) - time(&fine)).abs() < 1e-12);
    for (a, b) in coarse.force.iter().zip(fine.force.iter().step_by(factor)) {
        assert!((a - b).abs() < 0.01, "{a} {b}");
    }
}

#[test]
fn the_default_at_one_kilohertz_is_that_of_the_benchmark() {
    assert_eq!(Conditioning::for_time_step(1e-3), HOW);
    assert!(Conditioning::for_time_step(0.01).cutoff < 50.0);
}

proptest! {
    #[test]
    fn never_panics(
        position in proptest::collection::vec(-1e9..1e9f64, 0..400),
        trim in 0usize..300, order in 0usize..20, cutoff in -10.0..2000.0f64, decimate in 0usize..2000,
    ) {
        let _ = condition(&signals(&position, &position), &Conditioning { cutoff, acceleration_cutoff: 0.5 * cutoff, order, differences: Differences::SixthOrder, trim, decimate, low_pass_force: false });
    }
}

/// Moves from place to place that rest at each end do not show what happens where an axis turns
/// round. Moves without a rest do, and a sine does.
#[test]
fn an_axis_that_stops_to_turn_is_known() {
    let stops = |place: &dyn Fn(f64) -> f64| {
        let position: Vec<f64> = (0..20_000).map(|k| place(1e-3 * f64::from(k))).collect();
        condition(&signals(&position, &position), &HOW).unwrap().moving().unwrap().0.stops_to_turn
    };
    let moves = |t: f64, rest: f64| {
        let (number, within) = ((t / (1.0 + rest)).floor(), (t % (1.0 + rest)).min(1.0));
        // A fifth of the time to speed up, and another to slow down.
        let way = match within {
            begun if begun < 0.2 => 2.5 * begun * begun,
            cruising if cruising < 0.8 => cruising - 0.1,
            ending => 0.8 - 2.5 * (1.0 - ending).powi(2),
        };
        if number % 2.0 == 0.0 { way } else { 0.8 - way }
    };
    assert!(stops(&|t| moves(t, 0.5)));
    assert!(!stops(&|t| moves(t, 0.0)));
    assert!(!stops(&|t| (3.0 * t).sin()));
    // So fast that it is slow for a third of a sample only, beside a slow one.
    assert!(!stops(&|t| 1e-3 * (500.0 * t).sin()));
    assert!(!stops(&|t| 0.1 * (3.0 * t).sin() + 1e-3 * (500.0 * t).sin()));
}
