//! How long a whole control step takes: estimator and controller, for every model and technique.
//! `cargo xtask bench-step` runs it.
//!
//! Each step is timed alone with the monotonic clock; the median cost of reading the clock twice
//! with nothing between is taken off. The motion goes to and fro with noise, so that sticking,
//! sliding and reversals are all among the steps. Prints the median and the 99.9th percentile in
//! nanoseconds; ends with code 1 if a percentile is above 1000.

use std::hint::black_box;
use std::process::ExitCode;
use std::time::Instant;

use controller::{Controller, ControllerOptions, Feedback, Reference};
use friction_model::{AnyModel, ModelName, TimeStep};
use friction_observer::adaptive::{LevelOptions, ParameterOptions, StiffnessOptions};
use friction_observer::{
    DisturbanceObserverOptions, EstimatorOptions, FrictionEstimator, FuzzyOptions, RbfOptions,
    Seen, SuperTwistingOptions, Technique, VelocitySource,
};

/// Steps of one measurement, and how many of them in front are not counted.
const STEPS: usize = 40_000;
const WARM: usize = 4_000;

/// Largest accepted 99.9th percentile \[ns\].
const BAR: f64 = 1000.0;

/// Median and 99.9th percentile \[ns\].
#[derive(Clone, Copy)]
struct Latency {
    median: f64,
    high: f64,
}

fn quantiles(mut times: Vec<u64>, clock: f64) -> Latency {
    times.sort_unstable();
    let at = |q: f64| times[((times.len() - 1) as f64 * q).round() as usize] as f64 - clock;
    Latency { median: at(0.5).max(0.0), high: at(0.999).max(0.0) }
}

/// Cost of reading the clock twice \[ns\].
fn clock_cost() -> f64 {
    let mut times: Vec<u64> =
        (0..STEPS).map(|_| Instant::now().elapsed().as_nanos() as u64).collect();
    times.sort_unstable();
    times[STEPS / 2] as f64
}

/// A motion to and fro with noise, one reading a cycle.
fn readings() -> Vec<(Seen, Reference)> {
    let mut random = 1u32;
    (0..STEPS)
        .map(|k| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = 0.035 * (f64::from(random) / f64::from(u32::MAX) - 0.5);
            let t = 1e-3 * k as f64;
            let reference = Reference {
                position: 0.25 * (1.0 - (2.0 * t).cos()),
                velocity: 0.5 * (2.0 * t).sin(),
                acceleration: (2.0 * t).cos(),
            };
            let velocity = reference.velocity + noise;
            let position = (reference.position / VelocitySource::ENCODER_STEP).round()
                * VelocitySource::ENCODER_STEP;
            let voltage = velocity / 1.86 + 0.45 * (velocity / 0.02).tanh();
            let seen = Seen {
                velocity,
                position,
                reference_velocity: reference.velocity,
                error: noise,
                voltage,
                torque: Some(0.1),
            };
            (seen, reference)
        })
        .collect()
}

fn measure(
    model: &AnyModel,
    options: EstimatorOptions,
    readings: &[(Seen, Reference)],
    clock: f64,
) -> Option<Latency> {
    let period = TimeStep::new(1e-3).ok()?;
    let mut estimator = FrictionEstimator::new(model, options, period).ok()?;
    let mut controller = Controller::new(ControllerOptions::default()).ok()?;
    let mut times = Vec::with_capacity(STEPS);
    for (seen, reference) in readings {
        let start = Instant::now();
        let estimate = estimator.estimate(black_box(seen));
        let feedback = Feedback {
            position: seen.position,
            velocity: seen.velocity,
            friction: estimate.torque,
            cycle: None,
        };
        black_box(controller.step(reference, &feedback));
        times.push(start.elapsed().as_nanos() as u64);
    }
    Some(quantiles(times.split_off(WARM), clock))
}

fn main() -> ExitCode {
    let over_models = [
        ("feedback", Technique::Feedback, VelocitySource::Tachometer),
        ("with Kalman", Technique::Feedback, VelocitySource::FUSED),
        ("both", Technique::Both { share: 0.5 }, VelocitySource::Tachometer),
        ("adaptive", Technique::Adaptive(LevelOptions::SRV02), VelocitySource::Tachometer),
        (
            "parameters",
            Technique::AdaptiveParameters(ParameterOptions::SRV02),
            VelocitySource::Tachometer,
        ),
        (
            "stiffness",
            Technique::AdaptiveStiffness(StiffnessOptions::SRV02),
            VelocitySource::Tachometer,
        ),
    ];
    let plain = [
        ("disturbance observer", Technique::DisturbanceObserver(DisturbanceObserverOptions::SRV02)),
        ("rbf", Technique::Rbf(RbfOptions::SRV02)),
        ("super_twisting", Technique::SuperTwisting(SuperTwistingOptions::SRV02)),
        ("fuzzy", Technique::Fuzzy(FuzzyOptions::SRV02)),
    ];
    let (readings, clock) = (readings(), clock_cost());
    println!(
        "estimator and controller, one step [ns]: median / 99.9th percentile; the clock's own {clock:.0} ns are taken off"
    );
    print!("{:24}", "");
    over_models.iter().for_each(|(name, ..)| print!("{name:>16}"));
    println!();
    let mut slow = Vec::new();
    let mut take = |name: String, latency: Option<Latency>| match latency {
        Some(Latency { median, high }) => {
            // Three bundles of bristles side by side are reported only: that model is not for real
            // time, see its page.
            if high > BAR && name != "bristle, stiffness" {
                slow.push(format!("{name}: {high:.0} ns"));
            }
            format!("{median:.0} / {high:.0}")
        }
        None => "refused".to_owned(),
    };
    for name in ModelName::ALL {
        let model = AnyModel::test_bed(name);
        print!("{name:24}");
        for (technique_name, technique, velocity) in over_models {
            let options = EstimatorOptions { technique, velocity, ..Default::default() };
            let latency = measure(&model, options, &readings, clock);
            print!("{:>16}", take(format!("{name}, {technique_name}"), latency));
        }
        println!();
    }
    for (name, technique) in plain {
        let options = EstimatorOptions { technique, ..Default::default() };
        let latency = measure(&AnyModel::test_bed(ModelName::Coulomb), options, &readings, clock);
        println!("{name:24}{:>16}", take(name.to_owned(), latency));
    }
    if slow.is_empty() {
        return ExitCode::SUCCESS;
    }
    println!("above {BAR} ns: {}", slow.join(", "));
    ExitCode::FAILURE
}
