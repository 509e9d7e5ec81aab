//! What a design is worth on a rig: the linear figures know neither friction, nor noise, nor the
//! end of the voltage.

use controller::ControllerOptions;
use controller::design::{LinearDrive, LoopLaw};
use friction_model::{AnyModel, ModelName, Motor};
use rig_driver::SimulationOptions;
use serde::Serialize;

use super::{Assessment, DesignOptions};
use experiment_runner::compensation::Arm;
use experiment_runner::protocol::TrackingProtocol;
use experiment_runner::test_bed::{TestBed, TestBedError};
use experiment_runner::tracking::TrackingJob;

/// A design beside the default gains, on the simulated rig with this drive, its friction and the
/// noise of its sensors, without compensation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Worth {
    /// Largest magnitude of the voltage that the rig gives \[V\].
    pub voltage_limit: f64,
    /// What the design does.
    pub designed: Tracked,
    /// What the gains do that a run has without any design.
    pub default: Tracked,
}

/// The laboratory's sine of the regulated quantity, followed once: 0.3 rad/s at 0.107 rad/s, or 1
/// rad at 0.546 rad/s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tracked {
    /// Mean square of the error [(rad/s)^2 or rad^2].
    pub mse: f64,
    /// Largest magnitude of the voltage \[V\].
    pub peak_voltage: f64,
    /// Noise of the voltage \[V\]: standard deviation of its change from one period to the next,
    /// over the root of two.
    pub voltage_noise: f64,
}

impl Worth {
    /// Simulates both.
    ///
    /// # Errors
    /// [`TestBedError`] for a drive or a period that cannot be simulated.
    pub fn of(options: &DesignOptions, voltage_limit: f64) -> Result<Self, TestBedError> {
        let linear = options.linear;
        let drive = motor(&linear.drive, options.volts_per_newton_metre);
        let standard = SimulationOptions::default();
        let simulation = SimulationOptions {
            drive,
            period: options.period,
            voltage_limit,
            voltage_range: standard.voltage_range.max(voltage_limit),
            ..standard
        };
        let before = ControllerOptions::default();
        let designed = match linear.law {
            LoopLaw::Velocity(velocity) => ControllerOptions { velocity, ..before },
            LoopLaw::Position { gains, derivative_on, filter } => {
                ControllerOptions { pid: gains, derivative_on, derivative_filter: filter, ..before }
            }
        };
        let protocol = match linear.law {
            LoopLaw::Velocity(_) => TrackingProtocol::velocity(),
            LoopLaw::Position { .. } => TrackingProtocol::position(),
        };
        let track = |controller| {
            let friction = AnyModel::test_bed(ModelName::Proposed);
            let bed = TestBed { simulation, friction, controller, estimator: Default::default() };
            tracked(&bed, &protocol)
        };
        Ok(Self { voltage_limit, designed: track(designed)?, default: track(before)? })
    }

    /// How many times larger the mean square error is than with the default gains.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.designed.mse / self.default.mse
    }
}

fn tracked(bed: &TestBed, protocol: &TrackingProtocol) -> Result<Tracked, TestBedError> {
    let model = AnyModel::test_bed(ModelName::Coulomb);
    let control = bed.control_loop(protocol.mode, protocol.reference, &model, None, 1, 0)?;
    let (mut before, mut squares, mut count, mut peak) = (None, 0.0, 0_u32, 0.0_f64);
    let run = TrackingJob { arm: Arm::None, repetition: 0 }.run(protocol, control, |sample| {
        let volts = sample.command.total;
        peak = peak.max(volts.abs());
        if let Some(before) = before.replace(volts) {
            let change: f64 = volts - before;
            squares += change * change;
            count += 1;
        }
    })?;
    let voltage_noise = (squares / f64::from(2 * count.max(1))).sqrt();
    Ok(Tracked { mse: run.mse, peak_voltage: peak, voltage_noise })
}

/// A motor of this gain, time constant and friction's weight; its gear is in its constant.
fn motor(linear: &LinearDrive, volts_per_newton_metre: f64) -> Motor {
    let motor_constant = 1.0 / linear.gain;
    Motor {
        motor_constant,
        gear_ratio: 1.0,
        armature_resistance: volts_per_newton_metre * motor_constant,
        inertia: linear.time_constant / (linear.gain * volts_per_newton_metre),
    }
}

/// What was found of the voltage and the tracking, and what is to be minded, one sentence each.
#[must_use]
pub(super) fn sentences(found: &Assessment) -> Vec<String> {
    let Some(worth) = &found.worth else { return Vec::new() };
    let Worth { voltage_limit, designed, .. } = worth;
    let (unit, quantity) = match found.options.linear.law {
        LoopLaw::Velocity(_) => ("rad/s", "velocity"),
        LoopLaw::Position { .. } => ("rad", "position"),
    };
    let mut said = Vec::new();
    let ratio = worth.ratio();
    if (0.95..=1.05).contains(&ratio) {
        said.push(format!(
            "On the rig's friction these gains follow a sine of {quantity} as well as the default ones; `frictionlab design {quantity} --retuned` \
             gives better ones."
        ));
    } else if ratio > 1.0 {
        said.push(format!(
            "Warning: on the rig's friction these gains follow a sine of {quantity} {ratio:.1} times worse (mean square) than the default ones. \
             Ask for more, or take `frictionlab design {quantity} --retuned`."
        ));
    } else {
        said.push(format!(
            "On the rig's friction these gains follow a sine of {quantity} {:.1} times better (mean square) than the default ones.",
            1.0 / ratio
        ));
    }
    if let Some((_, figures)) = found.figures.first() {
        let peak = figures.peak_voltage;
        if peak > *voltage_limit {
            said.push(format!(
                "Warning: a step of 1 {unit} asks for {peak:.1} V at its largest, and the rig gives {voltage_limit} V: the step is then slower than the \
                 figures above. Steps up to {:.2} {unit} stay within the limit.",
                voltage_limit / peak
            ));
        } else {
            said.push(format!(
                "A step of 1 {unit} asks for {peak:.1} V at its largest, of {voltage_limit} V that the rig gives."
            ));
        }
    }
    if designed.peak_voltage >= *voltage_limit {
        said.push("Warning: the voltage reaches its limit while the sine is followed.".to_owned());
    }
    let noise = designed.voltage_noise;
    if noise > 0.05 * voltage_limit {
        said.push(format!(
            "Warning: the sensors' noise puts {noise:.2} V (standard deviation) on the voltage, {:.0} % of the limit: the motor gets warm and loud. \
             Ask for less, or for a longer --filter.",
            100.0 * noise / voltage_limit
        ));
    } else {
        said.push(format!(
            "The sensors' noise puts {noise:.3} V (standard deviation) on the voltage."
        ));
    }
    said
}
