//! Safety of the loop on the simulated rig: over-compensation is scaled back, and no sensor fault
//! drives the rig beyond its limits.

use controller::{
    AccelerationFeedback, ControlFault, ControlMode, Controller, ControllerOptions, Diagnosis,
    Dither, DitherShape, Feedback, GuardOptions, Impulse, LagGains, PiGains, PidGains,
    PlantInverse, Reference, VelocityLaw, design::LinearDrive,
};
use experiment_runner::control_loop::ControlLoop;
use experiment_runner::cycle::CycleSample;
use experiment_runner::waveform::Waveform;
use friction_model::{AnyModel, ModelName, TimeStep};
use friction_observer::{EstimatorOptions, FrictionEstimator, Seen};
use proptest::prelude::*;
use rig_driver::{Measurement, Rig, RigError, SimulationOptions, Truth};

/// The tasks of the guard's tests.
#[derive(Debug, Clone, Copy)]
enum Task {
    VelocityTracking,
    /// A second at 1 rad/s, then at rest.
    VelocityRegulation,
    PositionTracking,
    /// A step of 1 rad.
    PositionRegulation,
}

impl Task {
    const ALL: [Self; 4] = [
        Self::VelocityTracking,
        Self::VelocityRegulation,
        Self::PositionTracking,
        Self::PositionRegulation,
    ];

    const fn mode(self) -> ControlMode {
        match self {
            Self::VelocityTracking | Self::VelocityRegulation => ControlMode::Velocity,
            Self::PositionTracking | Self::PositionRegulation => ControlMode::Position,
        }
    }

    fn at(self, t: f64) -> Reference {
        let sine =
            |amplitude: f64, w: f64| (amplitude * (w * t).sin(), amplitude * w * (w * t).cos());
        match self {
            Self::VelocityTracking => {
                let (velocity, acceleration) = sine(0.3, 0.107);
                Reference { position: 0.0, velocity, acceleration }
            }
            Self::VelocityRegulation => {
                Reference { velocity: if t < 1.0 { 1.0 } else { 0.0 }, ..Default::default() }
            }
            Self::PositionTracking => {
                let (position, velocity) = sine(1.0, 0.546);
                Reference { position, velocity, acceleration: 0.0 }
            }
            Self::PositionRegulation => Reference { position: 1.0, ..Default::default() },
        }
    }
}

/// What a run came to.
#[derive(Debug)]
struct Outcome {
    /// Root mean square of the shaft's error over the last ten seconds.
    error: f64,
    held_back: f64,
    diagnosis: Option<Diagnosis>,
}

/// Thirty seconds on the simulated rig with noise, its friction that of the proposed model,
/// compensated by `observer`.
fn run(task: Task, observer: ModelName, scale: f64, guard: Option<GuardOptions>) -> Outcome {
    let mut rig =
        SimulationOptions::default().build(AnyModel::test_bed(ModelName::Proposed)).unwrap();
    let dt = TimeStep::new(1e-3).unwrap();
    let mut estimator =
        FrictionEstimator::new(&AnyModel::test_bed(observer), EstimatorOptions::default(), dt)
            .unwrap();
    let mut options = ControllerOptions { mode: task.mode(), guard, ..Default::default() };
    options.compensation.scale = scale;
    let mut controller = Controller::new(options).unwrap();
    let (mut squares, mut held_back, mut diagnosis) = (0.0, 0.0f64, None);
    for k in 0..30_000 {
        let seen = rig.measure();
        let reference = task.at(seen.time);
        let friction = estimator
            .estimate(&Seen {
                velocity: seen.tachometer_velocity,
                position: seen.encoder_position,
                reference_velocity: reference.velocity,
                ..Default::default()
            })
            .torque;
        let feedback = Feedback {
            position: seen.encoder_position,
            velocity: seen.tachometer_velocity,
            friction,
            cycle: Some(seen.cycle),
        };
        let command = controller.step(&reference, &feedback);
        rig.apply(command.total).unwrap();
        held_back = held_back.max(command.held_back);
        diagnosis = diagnosis.or(command.diagnosis);
        if k >= 20_000 {
            let truth = rig.truth().unwrap();
            let error = match task.mode() {
                ControlMode::Velocity => reference.velocity - truth.velocity,
                ControlMode::Position => reference.position - truth.position,
            };
            squares += error * error;
        }
    }
    Outcome { error: (squares / 10_000.0f64).sqrt(), held_back, diagnosis }
}

#[test]
fn a_correct_compensation_is_never_touched() {
    for observer in [ModelName::Proposed, ModelName::LuGre, ModelName::Gms] {
        for task in Task::ALL {
            let found = run(task, observer, 1.0, Some(GuardOptions::default()));
            assert_eq!((found.held_back, found.diagnosis), (0.0, None), "{task:?} {observer}");
        }
    }
}

#[test]
fn over_compensation_hunts_and_the_guard_stops_it() {
    for (task, observer, scale, hunting) in [
        (Task::PositionRegulation, ModelName::Proposed, 1.6, 0.03),
        (Task::PositionRegulation, ModelName::Proposed, 2.0, 0.05),
        (Task::PositionRegulation, ModelName::LuGre, 1.6, 0.03),
        (Task::VelocityRegulation, ModelName::LuGre, 1.6, 0.05),
        (Task::VelocityRegulation, ModelName::LuGre, 2.0, 0.1),
    ] {
        let loose = run(task, observer, scale, None);
        assert!(loose.error > hunting, "{task:?} {observer} {scale}: {loose:?}");
        let guarded = run(task, observer, scale, Some(GuardOptions::default()));
        assert_eq!(guarded.diagnosis, Some(Diagnosis::LimitCycle));
        assert!(
            guarded.error < 0.3 * loose.error,
            "{task:?} {observer} {scale}: {loose:?} {guarded:?}"
        );
        assert!(guarded.held_back > 0.29);
    }
}

/// What goes wrong with a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    None,
    StuckEncoder,
    DeadTachometer,
    /// Velocity and position jump for a cycle, every so many.
    Spikes(u64),
    /// Readings that are not numbers, every so many cycles.
    Dropouts(u64),
    /// Readings that are not numbers for good.
    Lost,
    /// Everything so many cycles old.
    Delayed(usize),
    /// The same measurement once more, for good.
    Frozen,
}

/// A rig whose sensors fail at `from`, and that keeps a record of what is done to it.
struct FaultyRig {
    rig: Box<dyn Rig + Send>,
    fault: Fault,
    from: u64,
    history: Vec<Measurement>,
    limit: f64,
    /// Largest velocity that the drive reaches without load [rad/s].
    no_load: f64,
}

impl Rig for FaultyRig {
    fn period(&self) -> f64 {
        self.rig.period()
    }

    fn measure(&mut self) -> Measurement {
        let true_reading = self.rig.measure();
        self.history.push(true_reading);
        let mut seen = true_reading;
        if seen.cycle < self.from {
            return seen;
        }
        let since = seen.cycle - self.from;
        let at = |cycle: u64| self.history.get(cycle as usize).copied().unwrap_or(true_reading);
        match self.fault {
            Fault::None => {}
            Fault::StuckEncoder => seen.encoder_position = at(self.from).encoder_position,
            Fault::DeadTachometer => seen.tachometer_velocity = 0.0,
            Fault::Spikes(every) if since.is_multiple_of(every) => {
                seen.tachometer_velocity += 1e3;
                seen.encoder_position -= 1e6;
            }
            Fault::Dropouts(every) if since.is_multiple_of(every) => {
                (seen.tachometer_velocity, seen.encoder_position) = (f64::NAN, f64::INFINITY);
            }
            Fault::Spikes(_) | Fault::Dropouts(_) => {}
            Fault::Lost => (seen.tachometer_velocity, seen.encoder_position) = (f64::NAN, f64::NAN),
            Fault::Delayed(cycles) => {
                let old = at(seen.cycle.saturating_sub(cycles as u64));
                seen = Measurement { cycle: seen.cycle, time: seen.time, ..old };
            }
            Fault::Frozen => seen = at(self.from),
        }
        seen
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        assert!(volts.is_finite() && volts.abs() <= self.limit, "{volts} V reached the rig");
        let done = self.rig.apply(volts);
        let velocity = self.rig.truth().map_or(0.0, |truth| truth.velocity);
        assert!(velocity.abs() <= self.no_load, "{velocity} rad/s");
        done
    }

    fn truth(&self) -> Option<Truth> {
        self.rig.truth()
    }
}

/// Drives a loop on a rig with a fault; every cycle is checked by the rig itself.
fn drive(
    fault: Fault,
    options: ControllerOptions,
    estimator: EstimatorOptions,
    (plant, observer): (ModelName, ModelName),
    reference: Waveform,
    cycles: u64,
) -> Vec<CycleSample> {
    let simulation = SimulationOptions { voltage_limit: 10.0, ..Default::default() };
    let limit = options.voltage_limit;
    let rig = FaultyRig {
        rig: simulation.build(AnyModel::test_bed(plant)).unwrap(),
        fault,
        from: cycles / 3,
        history: Vec::new(),
        limit,
        // The converter rounds to the nearest step.
        no_load: simulation.drive.gain() * (limit + simulation.sensors.voltage_resolution),
    };
    let dt = TimeStep::new(1e-3).unwrap();
    let estimator = FrictionEstimator::new(&AnyModel::test_bed(observer), estimator, dt).unwrap();
    let controller = Controller::new(options).unwrap();
    let mut control = ControlLoop::new(Box::new(rig), estimator, controller, reference, 0);
    (0..cycles).map(|_| control.step().unwrap()).collect()
}

const SINE: Waveform = Waveform::SinePosition { amplitude: 1.0, angular_frequency: 3.0 };

#[test]
fn a_lost_or_frozen_sensor_leaves_the_motor_at_zero_volts_with_a_fault() {
    let models = (ModelName::Proposed, ModelName::Proposed);
    for (fault, why) in
        [(Fault::Lost, ControlFault::NotFinite), (Fault::Frozen, ControlFault::Stale)]
    {
        for mode in [ControlMode::Velocity, ControlMode::Position] {
            let options = ControllerOptions { mode, ..Default::default() };
            let samples = drive(fault, options, EstimatorOptions::default(), models, SINE, 900);
            let last = samples.last().unwrap();
            assert_eq!((last.command.total, last.command.fault), (0.0, Some(why)), "{fault:?}");
            let stopped = samples[302..].iter().all(|sample| sample.command.total == 0.0);
            assert!(stopped && samples[250..300].iter().any(|sample| sample.command.total != 0.0));
        }
    }
}

#[test]
fn a_reading_lost_now_and_then_is_no_fault() {
    let models = (ModelName::Proposed, ModelName::Proposed);
    let options = ControllerOptions { mode: ControlMode::Position, ..Default::default() };
    let samples =
        drive(Fault::Dropouts(10), options, EstimatorOptions::default(), models, SINE, 3000);
    assert!(samples.iter().all(|sample| sample.command.fault.is_none()));
    // A tenth of the voltage is missing; the loop still follows.
    let worst = samples[2000..].iter().map(|sample| sample.error().abs()).fold(0.0, f64::max);
    assert!(worst < 0.5, "{worst}");
}

/// Sixteen cases, unless `PROPTEST_CASES` says otherwise.
fn config() -> ProptestConfig {
    let cases = if std::env::var_os("PROPTEST_CASES").is_some() {
        ProptestConfig::default().cases
    } else {
        16
    };
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

fn models() -> impl Strategy<Value = (ModelName, ModelName)> {
    let any = || prop::sample::select(ModelName::ALL.to_vec());
    (any(), any())
}

fn faults() -> impl Strategy<Value = Fault> {
    prop_oneof![
        Just(Fault::None),
        Just(Fault::StuckEncoder),
        Just(Fault::DeadTachometer),
        (1u64..200).prop_map(Fault::Spikes),
        (1u64..50).prop_map(Fault::Dropouts),
        Just(Fault::Lost),
        (1usize..100).prop_map(Fault::Delayed),
        Just(Fault::Frozen),
    ]
}

prop_compose! {
    fn gains()(
        lag in any::<bool>(), k_p in 0.01f64..20.0, t_i in 0.001f64..2.0, gamma in 0.0f64..0.99, k_i in 0.0f64..500.0,
        pid in (0.0f64..100.0, 0.0f64..1000.0, -0.5f64..3.0), on_error in any::<bool>(), filter in 0.0f64..0.05,
    ) -> ControllerOptions {
        ControllerOptions {
            velocity: if lag { VelocityLaw::Lag(LagGains { k_p, t_i, gamma }) } else { VelocityLaw::Pi(PiGains { k_p, k_i }) },
            pid: PidGains { k_p: pid.0, k_i: pid.1, k_d: pid.2 },
            derivative_on: if on_error { controller::DerivativeOn::Error } else { controller::DerivativeOn::Measurement },
            derivative_filter: filter,
            ..Default::default()
        }
    }
}

prop_compose! {
    fn controllers()(
        gains in gains(), position in any::<bool>(), scale in 0.0f64..2.0, inverse in 0u8..3,
        acceleration in prop::option::of((0.0f64..0.05, 0.001f64..0.05)),
        dither in prop::option::of((0.0f64..2.0, 1.0f64..250.0)),
        impulse in prop::option::of((0.0f64..5.0, 0.001f64..0.01)),
        guarded in any::<bool>(), voltage_limit in 0.5f64..10.0,
    ) -> ControllerOptions {
        let mut options = ControllerOptions {
            mode: if position { ControlMode::Position } else { ControlMode::Velocity },
            inverse: match inverse {
                0 => PlantInverse::Off,
                1 => PlantInverse::Gain(LinearDrive::THESIS),
                _ => PlantInverse::Whole(LinearDrive::THESIS),
            },
            acceleration: acceleration.map(|(gain, filter)| AccelerationFeedback { gain, filter }),
            dither: dither.map(|(amplitude, frequency)| Dither { shape: DitherShape::Square, amplitude, frequency }),
            impulse: impulse.map(|(height, width)| Impulse { height, width, period: 0.05 }),
            guard: guarded.then(GuardOptions::default),
            voltage_limit,
            ..gains
        };
        options.compensation.scale = scale;
        options
    }
}

proptest! {
    #![proptest_config(config())]

    /// Whatever the parameters, the models and the fault: no voltage beyond the limit, nothing that
    /// is not a number, no panic, and the shaft below its no-load speed. The rig asserts it in
    /// every cycle.
    #[test]
    fn no_fault_drives_the_rig_beyond_its_limits(
        fault in faults(),
        options in controllers(),
        models in models(),
        injection in 0.0f64..2.0,
        feedforward in any::<bool>(),
        amplitude in 0.0f64..3.0,
        angular_frequency in 0.1f64..30.0,
    ) {
        let technique =
            if feedforward { friction_observer::Technique::Both { share: 0.5 } } else { friction_observer::Technique::Feedback };
        let estimator = EstimatorOptions { technique, injection, ..Default::default() };
        let reference = Waveform::SinePosition { amplitude, angular_frequency };
        let samples = drive(fault, options, estimator, models, reference, 1500);
        prop_assert!(samples.iter().all(|sample| sample.command.total.abs() <= options.voltage_limit));
        if matches!(fault, Fault::Lost | Fault::Frozen) {
            prop_assert!(samples.last().is_some_and(|sample| sample.command.fault.is_some()));
        }
    }
}
