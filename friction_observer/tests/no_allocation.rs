//! A control cycle, estimator and controller, allocates nothing: over all models, techniques and
//! velocity estimators.

use std::hint::black_box;

use allocation_counter::measure;
use controller::design::LinearDrive;
use controller::{
    AccelerationFeedback, ControlMode, Controller, ControllerOptions, Dither, DitherShape,
    Feedback, Impulse, PiGains, PlantInverse, Reference, VelocityLaw,
};
use friction_model::{AnyModel, ModelName, TimeStep};
use friction_observer::adaptive::{LevelOptions, ParameterOptions, StiffnessOptions};
use friction_observer::{
    DisturbanceObserverOptions, EstimatorOptions, FrictionEstimator, FuzzyOptions, RbfOptions,
    Seen, SuperTwistingOptions, Technique, VelocitySource,
};

const CYCLES: u32 = 3000;

fn allocations(model: &AnyModel, options: EstimatorOptions, mode: ControlMode) -> u64 {
    let mut estimator =
        FrictionEstimator::new(model, options, TimeStep::new(1e-3).unwrap()).unwrap();
    let mut controller = Controller::new(ControllerOptions { mode, ..Default::default() }).unwrap();
    let mut change = Some((*model, options));
    measure(|| {
        let mut voltage = 0.0;
        for k in 0..CYCLES {
            let t = 1e-3 * f64::from(k);
            let velocity = if k % 401 == 400 { f64::NAN } else { 0.5 * (2.0 * t).sin() };
            let position = 0.25 * (1.0 - (2.0 * t).cos());
            let reference = Reference {
                position,
                velocity: 0.5 * (2.0 * t).sin(),
                acceleration: (2.0 * t).cos(),
            };
            let seen = Seen {
                velocity,
                position,
                reference_velocity: reference.velocity,
                error: velocity - reference.velocity,
                voltage,
                torque: Some(0.1),
            };
            let friction = estimator.estimate(&seen).torque;
            voltage = controller
                .step(&reference, &Feedback { position, velocity, friction, cycle: None })
                .total;
            if k == CYCLES / 2
                && let Some((model, options)) = change.take()
            {
                black_box(estimator.change(&model, options)).unwrap();
            }
        }
        black_box(voltage);
    })
    .count_total
}

#[test]
fn no_cycle_allocates() {
    let techniques = [
        Technique::Feedback,
        Technique::Feedforward,
        Technique::Both { share: 0.5 },
        Technique::Adaptive(LevelOptions::SRV02),
        Technique::AdaptiveParameters(ParameterOptions::SRV02),
        Technique::AdaptiveStiffness(StiffnessOptions::SRV02),
        Technique::DisturbanceObserver(DisturbanceObserverOptions::SRV02),
        Technique::Rbf(RbfOptions::SRV02),
        Technique::SuperTwisting(SuperTwistingOptions::SRV02),
        Technique::Fuzzy(FuzzyOptions::SRV02),
    ];
    let sources =
        [VelocitySource::Tachometer, VelocitySource::TRACKING_LOOP, VelocitySource::FUSED];
    for name in ModelName::ALL {
        let model = AnyModel::test_bed(name);
        let both = AnyModel::asymmetric(&model, &AnyModel::chapter_3(name)).unwrap();
        for technique in techniques {
            for (model, velocity, mode) in [
                (&model, sources[0], ControlMode::Velocity),
                (&model, sources[1], ControlMode::Position),
                (&both, sources[2], ControlMode::Velocity),
            ] {
                let options = EstimatorOptions {
                    technique,
                    velocity,
                    injection: 0.035,
                    ahead: 1.0,
                    ..Default::default()
                };
                assert_eq!(
                    allocations(model, options, mode),
                    0,
                    "{name}, {technique:?}, {velocity:?}"
                );
            }
        }
    }
}

/// Every law, every addition, missing measurements until the fault, and a change in the middle.
#[test]
fn no_part_of_the_controller_allocates() {
    let lag = ControllerOptions {
        inverse: PlantInverse::Whole(LinearDrive::THESIS),
        acceleration: Some(AccelerationFeedback { gain: 0.02, filter: 0.005 }),
        dither: Some(Dither { shape: DitherShape::Sine, amplitude: 0.2, frequency: 125.0 }),
        impulse: Some(Impulse { height: 0.3, width: 0.002, period: 0.1 }),
        ..Default::default()
    };
    let pi =
        ControllerOptions { velocity: VelocityLaw::Pi(PiGains { k_p: 1.0, k_i: 20.0 }), ..lag };
    let position = ControllerOptions { mode: ControlMode::Position, ..lag };
    for (from, to) in [(lag, pi), (pi, position), (position, lag)] {
        let mut controller = Controller::new(from).unwrap();
        let mut faults = 0;
        let counted = measure(|| {
            for k in 0..CYCLES {
                // A friction estimate that swings without a reason is the guard's business.
                let friction = if k % 40 < 20 { 0.3 } else { -0.3 };
                let velocity = if k > CYCLES - 50 { f64::NAN } else { 0.1 };
                let feedback =
                    Feedback { position: 0.1, velocity, friction, cycle: Some(u64::from(k)) };
                let reference = Reference { velocity: 0.2, position: 0.2, acceleration: 0.1 };
                faults += u32::from(controller.step(&reference, &feedback).total == 0.0);
                if k == CYCLES / 2 {
                    controller.change(to).unwrap();
                }
            }
        });
        assert_eq!(counted.count_total, 0, "{from:?}");
        assert!(faults >= 49, "{faults} cycles without a measurement gave zero volts");
    }
}

/// The counter counts.
#[test]
fn the_counter_sees_an_allocation() {
    assert_eq!(measure(|| drop(black_box(vec![1]))).count_total, 1);
}
