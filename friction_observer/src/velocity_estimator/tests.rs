//! Velocity estimators on a drive that is simulated exactly, seen through a quantised encoder and a
//! noisy tachometer at 1 kHz.

use super::*;

const DT: f64 = 1e-3;

/// The tachometer's noise: even, with a standard deviation of .0101 rad/s, from a multiplicative
/// generator.
struct Noise(u32);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (f64::from(self.0) / f64::from(u32::MAX) - 0.5) * 0.0101 * 12f64.sqrt()
    }
}

/// True velocities, and what each source makes of the readings, while `volts(t)` drives against
/// smoothed Coulomb friction.
fn drive(
    volts: impl Fn(f64) -> f64,
    seconds: f64,
    sources: &[VelocitySource],
) -> (Vec<f64>, Vec<Vec<f64>>) {
    let nominal = NominalDrive::SRV02;
    let period = TimeStep::new(DT).unwrap();
    let mut estimators: Vec<_> = sources
        .iter()
        .map(|source| VelocityEstimator::new(*source, &nominal, period).unwrap())
        .collect();
    let (mut noise, mut truth, mut estimates) =
        (Noise(7), Vec::new(), vec![Vec::new(); sources.len()]);
    let decay = (-DT / nominal.time_constant).exp();
    let lag = nominal.time_constant * (1.0 - decay);
    let (mut position, mut w, mut voltage) = (0.0, 0.0, 0.0);
    for k in 0..(seconds / DT) as u32 {
        let read = (position / VelocitySource::ENCODER_STEP).round() * VelocitySource::ENCODER_STEP;
        let seen = Seen { velocity: w + noise.next(), position: read, voltage, ..Seen::default() };
        truth.push(w);
        for (estimator, estimates) in estimators.iter_mut().zip(&mut estimates) {
            estimates.push(estimator.estimate(&seen));
        }
        voltage = volts(f64::from(k) * DT);
        let friction = 0.05 * (w / 0.02).tanh() + 0.04 * w;
        let end = nominal.gain * (voltage - nominal.volts_per_newton_metre * friction);
        position += end * (DT - lag) + w * lag;
        w = decay * w + (1.0 - decay) * end;
    }
    (truth, estimates)
}

fn rms(errors: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut n) = (0.0, 0.0);
    errors.for_each(|e| (sum, n) = (sum + e * e, n + 1.0));
    f64::sqrt(sum / n)
}

const ALL: [VelocitySource; 5] = [
    VelocitySource::Tachometer,
    VelocitySource::TachometerLowPass { time_constant: 0.005 },
    VelocitySource::TRACKING_LOOP,
    VelocitySource::ENCODER_KALMAN,
    VelocitySource::FUSED,
];

/// Motion to and fro up to 1.2 rad/s. Differences of the encoder err by half a count a cycle, .6
/// rad/s; the tracking loop, which lags behind this acceleration, is better by six times, the
/// others by twelve times or more.
#[test]
fn every_estimator_is_far_better_than_differences_of_the_encoder() {
    let (truth, estimates) = drive(|t| 1.2 * (3.0 * t).sin(), 10.0, &ALL);
    let errors: Vec<f64> =
        estimates.iter().map(|e| rms(e.iter().zip(&truth).map(|(a, b)| a - b))).collect();
    let (mut position, mut before, mut differences) = (0.0, 0.0, Vec::new());
    for w in &truth {
        let read = (position / VelocitySource::ENCODER_STEP).round() * VelocitySource::ENCODER_STEP;
        differences.push((read - before) / DT - w);
        (position, before) = (position + w * DT, read);
    }
    let difference = rms(differences.into_iter());
    assert!(difference > 0.5, "{difference}");
    for (source, error) in ALL.iter().zip(&errors) {
        let better = if *source == VelocitySource::TRACKING_LOOP { 6.0 } else { 12.0 };
        assert!(*error < difference / better, "{source:?}: {error} beside {difference}");
    }
    let [tachometer, _, _, _, fused] = errors[..] else { panic!("five sources") };
    assert!((tachometer - 0.0101).abs() < 3e-4, "{tachometer}");
    assert!(fused < 0.75 * tachometer, "{errors:?}");
}

/// At a steady speed none has a lag or a bias: the mean over a second is the speed to 1 mrad/s.
#[test]
fn at_a_steady_speed_none_is_biased() {
    let (truth, estimates) = drive(|_| 1.0, 4.0, &ALL);
    for (source, estimates) in ALL.iter().zip(&estimates) {
        let mean = estimates[3000..].iter().sum::<f64>() / 1000.0;
        assert!((mean - truth[3999]).abs() < 1e-3, "{source:?}: {mean}, not {}", truth[3999]);
    }
}

/// On a ramp of velocity the low-pass lags by its time constant, the tracking loop by 2/b; the
/// Kalman filters know the voltage and lag far less.
#[test]
fn on_a_ramp_each_lags_as_computed() {
    let ramp = 0.5;
    let volts = |t: f64| (ramp * (t + 0.02388)) / 1.862_545 + 4.842_615 * (0.05 + 0.04 * ramp * t);
    let (truth, estimates) = drive(volts, 4.0, &ALL);
    let slope = (truth[3900] - truth[1900]) / 2.0;
    let lag =
        |i: usize| (2000..4000).map(|k| truth[k] - estimates[i][k]).sum::<f64>() / 2000.0 / slope;
    assert!((lag(1) - 0.0045).abs() < 7e-4, "low-pass: {}", lag(1));
    assert!((lag(2) - 2.0 / 60.0).abs() < 2e-3, "tracking loop: {}", lag(2));
    assert!(lag(3).abs() < 2e-3 && lag(4).abs() < 2e-3, "Kalman: {} and {}", lag(3), lag(4));
}

/// A shaft that stands still between two counts: no drift, whatever the noise of the tachometer.
#[test]
fn at_rest_none_drifts() {
    let (_, estimates) = drive(|_| 0.0, 60.0, &ALL);
    for (source, estimates) in ALL.iter().zip(&estimates) {
        let mean = estimates[50_000..].iter().sum::<f64>() / 10_000.0;
        assert!(mean.abs() < 5e-4, "{source:?}: {mean}");
    }
}

#[test]
fn after_a_step_of_the_voltage_all_have_settled_in_a_fifth_of_a_second() {
    let (truth, estimates) = drive(|t| if t < 1.0 { 0.0 } else { 1.5 }, 2.0, &ALL);
    for (source, estimates) in ALL.iter().zip(&estimates) {
        let late = rms((1200..2000).map(|k| estimates[k] - truth[k]));
        assert!(late < 0.07, "{source:?}: {late}");
    }
}

#[test]
fn dropouts_are_bridged_or_said() {
    let period = TimeStep::new(DT).unwrap();
    for source in ALL {
        let mut estimator = VelocityEstimator::new(source, &NominalDrive::SRV02, period).unwrap();
        let at = |k: u32| f64::from(k) * 0.5 * DT;
        for k in 0..2000 {
            estimator.estimate(&Seen { velocity: 0.5, position: at(k), ..Seen::default() });
        }
        let lost = Seen {
            velocity: f64::NAN,
            position: f64::INFINITY,
            voltage: f64::NAN,
            ..Seen::default()
        };
        let during = estimator.estimate(&lost);
        assert!(during.is_nan() || (during - 0.5).abs() < 0.1, "{source:?}: {during}");
        let after =
            estimator.estimate(&Seen { velocity: 0.5, position: at(2001), ..Seen::default() });
        assert!((after - 0.5).abs() < 0.1, "{source:?}: {after}");
    }
}

#[test]
fn options_out_of_range_are_refused_by_name() {
    for (source, name) in [
        (VelocitySource::TachometerLowPass { time_constant: 0.0 }, "time_constant"),
        (VelocitySource::EncoderTrackingLoop { bandwidth: f64::NAN }, "bandwidth"),
        (VelocitySource::EncoderKalman { encoder_step: 0.0, friction_walk: 0.3 }, "encoder_step"),
        (VelocitySource::EncoderKalman { encoder_step: 1e-3, friction_walk: 0.0 }, "friction_walk"),
    ] {
        let message = source.check().unwrap_err().to_string();
        assert!(message.starts_with(name), "{message}");
    }
}
