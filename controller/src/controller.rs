//! The whole controller: linear part, plant inverse, friction compensation and the voltage limit.

use serde::{Deserialize, Serialize};

use crate::design::LinearDrive;
use crate::error::positive;
use crate::{
    Command, ControlMode, ControllerError, DerivativeOn, LagCompensator, LagGains, Pid, PidGains, Reference,
};

/// Friction compensation: the observer's estimate, as volts, added to the command.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compensation {
    /// Whether friction is compensated at all.
    pub enabled: bool,
    /// Voltage that overcomes 1 N m of friction, R_a / (A K_m) [V/(N m)].
    pub volts_per_newton_metre: f64,
    /// Fraction of the estimate that is compensated; 1 for all of it.
    pub scale: f64,
}

/// Everything a controller is made of.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerOptions {
    /// What is regulated.
    pub mode: ControlMode,
    /// Period of the control cycle [s].
    pub period: f64,
    /// Gains of the velocity controller.
    pub lag: LagGains,
    /// Gains of the position controller.
    pub pid: PidGains,
    /// What the PID differentiates.
    pub derivative_on: DerivativeOn,
    /// Time constant of the PID's derivative filter [s].
    pub derivative_filter: f64,
    /// Drive for the plant inverse `B(s) = (T s + 1) / K`; `None` leaves it out.
    pub inverse: Option<LinearDrive>,
    /// Friction compensation.
    pub compensation: Compensation,
    /// Largest magnitude of the command [V].
    pub voltage_limit: f64,
}

impl Default for ControllerOptions {
    /// The thesis's gains at 1 kHz on the SRV-02, compensation physical and switched on, no plant inverse, +-6 V.
    fn default() -> Self {
        Self {
            mode: ControlMode::Velocity,
            period: 1e-3,
            lag: LagGains::THESIS,
            pid: PidGains::THESIS,
            derivative_on: DerivativeOn::Measurement,
            derivative_filter: 0.005,
            inverse: None,
            compensation: Compensation { enabled: true, volts_per_newton_metre: 4.8426, scale: 1.0 },
            voltage_limit: 6.0,
        }
    }
}

/// What the controller is told of the axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Feedback {
    /// Position [rad].
    pub position: f64,
    /// Velocity [rad/s].
    pub velocity: f64,
    /// Friction torque as estimated [N m]; not used while compensation is off.
    pub friction: f64,
}

/// A controller running at a fixed period.
#[derive(Debug, Clone)]
pub struct Controller {
    options: ControllerOptions,
    lag: LagCompensator,
    pid: Pid,
}

impl Controller {
    /// A controller at rest.
    ///
    /// # Errors
    /// [`ControllerError::OutOfRange`] names the gain, limit or period.
    pub fn new(options: ControllerOptions) -> Result<Self, ControllerError> {
        positive("voltage_limit", options.voltage_limit)?;
        positive("volts_per_newton_metre", options.compensation.volts_per_newton_metre)?;
        if !(0.0..=2.0).contains(&options.compensation.scale) {
            return Err(ControllerError::OutOfRange {
                name: "scale",
                value: options.compensation.scale,
                expected: "from 0 to 2 (1 compensates the whole estimate)",
            });
        }
        if let Some(drive) = options.inverse {
            positive("gain", drive.gain)?;
            positive("time_constant", drive.time_constant)?;
        }
        Ok(Self {
            lag: LagCompensator::new(options.lag, options.period)?,
            pid: Pid::new(options.pid, options.derivative_on, options.derivative_filter, options.period)?,
            options,
        })
    }

    /// The options.
    #[must_use]
    pub const fn options(&self) -> &ControllerOptions {
        &self.options
    }

    /// Voltage for this cycle, in its parts. If anything it is told is not a finite number, the command is zero volts and
    /// the controller's state stays as it was.
    #[inline]
    pub fn step(&mut self, reference: &Reference, feedback: &Feedback) -> Command {
        let mode = self.options.mode;
        let (target, seen) = match mode {
            ControlMode::Velocity => (reference.velocity, feedback.velocity),
            ControlMode::Position => (reference.position, feedback.position),
        };
        let error = target - seen;
        let linear = match mode {
            ControlMode::Velocity => self.lag.output(error),
            ControlMode::Position => self.pid.output(error, seen),
        };
        let inverse = self.options.inverse.map_or(0.0, |drive| {
            (reference.velocity + drive.time_constant * reference.acceleration) / drive.gain
        });
        let compensation = &self.options.compensation;
        let friction = if compensation.enabled {
            compensation.scale * compensation.volts_per_newton_metre * feedback.friction
        } else {
            0.0
        };
        let sum = linear + inverse + friction;
        if !sum.is_finite() {
            return Command { mode, reference: target, feedback: seen, error, ..Command::default() };
        }
        let limit = self.options.voltage_limit;
        let total = sum.min(limit).max(-limit);
        let saturated = total != sum;
        let limited = if saturated { sum.signum() } else { 0.0 };
        match mode {
            ControlMode::Velocity => self.lag.update(error, limited),
            ControlMode::Position => self.pid.update(error, seen, limited),
        }
        Command {
            mode,
            reference: target,
            feedback: seen,
            error,
            linear,
            inverse,
            friction,
            dither: 0.0,
            total,
            saturated,
        }
    }

    /// Back to rest.
    pub fn reset(&mut self) {
        self.lag.reset();
        self.pid.reset();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_parts_add_up() {
        let options = ControllerOptions { inverse: Some(LinearDrive::SRV02), ..Default::default() };
        let mut controller = Controller::new(options).unwrap();
        let reference = Reference { position: 0.0, velocity: 1.0, acceleration: 2.0 };
        let command =
            controller.step(&reference, &Feedback { velocity: 0.9, friction: 0.1, ..Default::default() });
        assert!((command.inverse - (1.0 + 0.02388 * 2.0) / 1.863).abs() < 1e-12);
        assert!((command.friction - 0.48426).abs() < 1e-12);
        assert!((command.total - command.linear - command.inverse - command.friction).abs() < 1e-15);
        assert!(!command.saturated);
    }

    #[test]
    fn compensation_can_be_switched_off() {
        let mut options = ControllerOptions::default();
        options.compensation.enabled = false;
        let mut controller = Controller::new(options).unwrap();
        let command =
            controller.step(&Reference::default(), &Feedback { friction: 0.1, ..Default::default() });
        assert_eq!((command.friction, command.total), (0.0, 0.0));
    }

    proptest! {
        /// Whatever comes in, the voltage stays within its limit and is a number.
        #[test]
        fn the_voltage_is_always_within_its_limit(
            position_mode in any::<bool>(),
            inputs in prop::collection::vec((any::<f64>(), any::<f64>(), any::<f64>(), any::<f64>()), 1..100),
        ) {
            let mode = if position_mode { ControlMode::Position } else { ControlMode::Velocity };
            let mut controller = Controller::new(ControllerOptions { mode, ..Default::default() }).unwrap();
            for (r, position, velocity, friction) in inputs {
                let reference = Reference { position: r, velocity: r, acceleration: r };
                let command = controller.step(&reference, &Feedback { position, velocity, friction });
                prop_assert!(command.total.abs() <= 6.0);
            }
        }

        /// A value that is not a number leaves no trace once it is gone.
        #[test]
        fn a_bad_reading_leaves_no_trace(mode in prop::sample::select(vec![ControlMode::Velocity, ControlMode::Position])) {
            let mut controller = Controller::new(ControllerOptions { mode, ..Default::default() }).unwrap();
            let reference = Reference { position: 0.1, velocity: 0.1, acceleration: 0.0 };
            controller.step(&reference, &Feedback::default());
            let mut untouched = controller.clone();
            let bad = Feedback { position: f64::NAN, velocity: f64::NAN, friction: 0.0 };
            prop_assert_eq!(controller.step(&reference, &bad).total, 0.0);
            prop_assert_eq!(controller.step(&reference, &Feedback::default()), untouched.step(&reference, &Feedback::default()));
        }
    }
}
