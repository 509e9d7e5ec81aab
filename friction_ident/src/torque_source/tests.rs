use super::*;

const STEP: f64 = 1e-3;

fn srv02() -> DriveConstants {
    DriveConstants {
        torque_constant: Uncertain::relative(0.5369, 0.01),
        armature_resistance: Uncertain::relative(2.6, 0.02),
        inertia: Uncertain::relative(2.648e-3, 0.02),
    }
}

const EXACT: ChannelDeviations =
    ChannelDeviations { torque: 0.0, velocity: 0.0, voltage: 0.0, current: 0.0 };

/// Velocity 1 - .95 cos(5 t) \[rad/s\] and its derivative.
fn motion(t: f64) -> (f64, f64) {
    (1.0 - 0.95 * (5.0 * t).cos(), 4.75 * (5.0 * t).sin())
}

/// A recording of that motion under the friction `.09 + .04 w` with drive constants `drive`.
fn recording(n: usize, drive: &DriveConstants) -> [Vec<f64>; 4] {
    let (k, r, j) =
        (drive.torque_constant.value, drive.armature_resistance.value, drive.inertia.value);
    let current = |t: f64| {
        let (w, slope) = motion(t);
        (0.09 + 0.04 * w + j * slope) / k
    };
    let times: Vec<f64> = (0..n).map(|i| i as f64 * STEP).collect();
    let velocity = times.iter().map(|&t| motion(t).0).collect();
    let torque = times.iter().map(|&t| 0.09 + 0.04 * motion(t).0).collect();
    // Simpson's rule over the period before: the mean.
    let mean = |value: &dyn Fn(f64) -> f64, t: f64| {
        (value(t - STEP) + 4.0 * value(t - 0.5 * STEP) + value(t)) / 6.0
    };
    let voltage = times.iter().map(|&t| mean(&|t| r * current(t) + k * motion(t).0, t)).collect();
    let amperes = times.iter().map(|&t| mean(&current, t)).collect();
    [velocity, torque, voltage, amperes]
}

/// What `source` needs: the torque column holds what drives the axis if that is recorded.
fn channels_of(source: TorqueSource, n: usize) -> [Vec<f64>; 4] {
    let mut channels = recording(n, &srv02());
    if source == TorqueSource::Driving {
        for (i, torque) in channels[1].iter_mut().enumerate() {
            *torque += srv02().inertia.value * motion(i as f64 * STEP).1;
        }
    }
    channels
}

fn signals(channels: &[Vec<f64>; 4]) -> DriveSignals<'_> {
    let [velocity, torque, voltage, current] = channels;
    DriveSignals { time_step: STEP, velocity, torque, voltage, current }
}

#[test]
fn every_source_gives_the_friction_that_made_the_recording() {
    for &source in TorqueSource::ALL {
        let channels = channels_of(source, 3000);
        let found = friction_torque(source, &signals(&channels), &srv02(), &EXACT).unwrap();
        assert_eq!(found.noise, 0.0);
        for i in 200..2800 {
            let expected = 0.09 + 0.04 * motion(i as f64 * STEP).0;
            // Half a period of delay would be 2.4e-4 N m at the steepest place; the low-pass bends
            // 4e-6.
            assert!(
                (found.torque[i] - expected).abs() < 1e-5,
                "{source:?} {i}: {} {expected}",
                found.torque[i]
            );
        }
    }
}

/// A drive whose constants are off by one standard error each: the error is the one announced,
/// constant by constant.
#[test]
fn a_wrong_constant_makes_the_error_that_was_announced() {
    for source in [TorqueSource::Voltage, TorqueSource::Current, TorqueSource::Driving] {
        let channels = channels_of(source, 2000);
        let right = friction_torque(source, &signals(&channels), &srv02(), &EXACT).unwrap();
        for (which, announced) in right.constants.iter().enumerate() {
            let mut wrong = srv02();
            let constant = match announced.constant {
                DriveConstant::TorqueConstant => &mut wrong.torque_constant,
                DriveConstant::ArmatureResistance => &mut wrong.armature_resistance,
                DriveConstant::Inertia => &mut wrong.inertia,
            };
            constant.value += constant.standard_error;
            let wrong = friction_torque(source, &signals(&channels), &wrong, &EXACT).unwrap();
            for i in 0..2000 {
                let error = wrong.torque[i] - right.torque[i];
                // Up to the second order: 2 % of the error.
                let bound = 0.03 * announced.torque[i].abs() + 2e-4 * right.torque[i].abs();
                assert!((error - announced.torque[i]).abs() < bound, "{source:?} {which} {i}");
            }
        }
        let total = right.systematic(700);
        let squares: f64 = right.constants.iter().map(|c| c.torque[700].powi(2)).sum();
        assert!(total > 0.0 && (total * total / squares - 1.0).abs() < 1e-12);
    }
}

/// White noise on every channel: the scatter of the torque is the one stated.
#[test]
fn the_stated_noise_is_the_scatter() {
    use rand::{RngExt, SeedableRng};
    let deviations =
        ChannelDeviations { torque: 0.007, velocity: 0.01, voltage: 0.02, current: 0.006 };
    let n = 40_000;
    let quiet = recording(n, &srv02());
    let mut noisy = quiet.clone();
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(3);
    let sizes = [deviations.velocity, deviations.torque, deviations.voltage, deviations.current];
    for (channel, size) in noisy.iter_mut().zip(sizes) {
        for value in channel {
            // Evenly distributed with that standard deviation.
            *value += size * 12f64.sqrt() * (random.random::<f64>() - 0.5);
        }
    }
    for &source in TorqueSource::ALL {
        let clean = friction_torque(source, &signals(&quiet), &srv02(), &EXACT).unwrap();
        let found = friction_torque(source, &signals(&noisy), &srv02(), &deviations).unwrap();
        let squares: f64 =
            (300..n - 300).map(|i| (found.torque[i] - clean.torque[i]).powi(2)).sum::<f64>()
                / (n - 600) as f64;
        assert!(
            (squares.sqrt() / found.noise - 1.0).abs() < 0.03,
            "{source:?}: {} {}",
            squares.sqrt(),
            found.noise
        );
    }
}

#[test]
fn what_cannot_be_used_is_named() {
    let channels = recording(400, &srv02());
    let whole = signals(&channels);
    let say = |signals: &DriveSignals<'_>, drive: &DriveConstants| {
        friction_torque(TorqueSource::Voltage, signals, drive, &EXACT).unwrap_err().to_string()
    };
    assert!(
        say(&DriveSignals { voltage: &[], ..whole }, &srv02()).contains("voltage has 0 samples")
    );
    assert!(say(&DriveSignals { time_step: 0.0, ..whole }, &srv02()).contains("sampling period"));
    let mut wrong = srv02();
    wrong.inertia.value = -1.0;
    assert!(say(&whole, &wrong).contains("inertia"));
    // Constants that do not enter are not asked for.
    wrong = DriveConstants { torque_constant: Uncertain::exact(0.0), ..srv02() };
    assert!(say(&whole, &wrong).contains("torque_constant"));
    assert!(friction_torque(TorqueSource::Driving, &whole, &wrong, &EXACT).is_ok());
    let mut broken = channels.clone();
    broken[0][7] = f64::NAN;
    assert!(say(&signals(&broken), &srv02()).contains("sample 7 of the velocity"));
    let short = DriveSignals { velocity: &[0.0; 3], voltage: &[0.0; 3], ..whole };
    assert!(say(&short, &srv02()).contains("low-pass"));
}
