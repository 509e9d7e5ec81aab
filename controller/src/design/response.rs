//! Step response of a loop without friction, with the controller as it runs: discrete, and the
//! drive integrated exactly between its samples.

use serde::{Deserialize, Serialize};

use super::{LinearLoop, LoopLaw};
use crate::error::positive;
use crate::velocity_law::VelocityController;
use crate::{ControllerError, Pid};

/// What rise and settling mean. The thesis does not say which it takes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StepDefinition {
    /// Fraction of the final value at which the rise begins; it ends at 1 minus that.
    pub rise_from: f64,
    /// Half width of the band around the final value in which the response has settled, as a
    /// fraction of it.
    pub band: f64,
}

impl Default for StepDefinition {
    /// Rise from 10 to 90 %, settled within 2 %.
    fn default() -> Self {
        Self { rise_from: 0.1, band: 0.02 }
    }
}

impl StepDefinition {
    /// Rise from 5 to 95 %, settled within 5 %: closest to what the thesis prints.
    pub const FIVE_PERCENT: Self = Self { rise_from: 0.05, band: 0.05 };
}

/// Response to a step of the reference of 1 at time zero, from rest.
#[derive(Debug, Clone, PartialEq)]
pub struct StepResponse {
    /// Time between samples \[s\]; sample k is at `k period`.
    pub period: f64,
    /// What is regulated \[rad/s or rad\].
    pub output: Vec<f64>,
    /// Voltage held from each sample on \[V\].
    pub voltage: Vec<f64>,
    /// Where it ends \[rad/s or rad\].
    pub final_value: f64,
}

/// Figures of a step response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepFigures {
    /// Overshoot over the final value, as a fraction of it; 0 for none.
    pub overshoot: f64,
    /// Rise time \[s\]; `None` if it does not rise within the response.
    pub rise_time: Option<f64>,
    /// Settling time \[s\]; `None` if it has not settled.
    pub settling_time: Option<f64>,
    /// Error that remains, as a fraction of the reference.
    pub steady_state_error: f64,
    /// Largest magnitude of the voltage for a step of 1 \[V\].
    pub peak_voltage: f64,
}

/// The response over `seconds` at the period `dt` \[s\].
///
/// # Errors
/// [`ControllerError::OutOfRange`] for gains, a drive, a period or a length that cannot be.
pub fn step_response(
    linear: &LinearLoop,
    dt: f64,
    seconds: f64,
) -> Result<StepResponse, ControllerError> {
    linear.check(dt)?;
    positive("seconds", seconds)?;
    let samples = (seconds / dt).ceil();
    if samples > 1e7 {
        let expected = "at most ten million control periods";
        return Err(ControllerError::OutOfRange {
            name: "seconds",
            value: seconds,
            expected: expected.into(),
        });
    }
    let mut law: Box<dyn FnMut(f64, f64) -> f64> = match linear.law {
        LoopLaw::Velocity(law) => {
            let mut law = VelocityController::new(law, dt)?;
            Box::new(move |error, _| {
                let u = law.output(error);
                law.update(error, 0.0);
                u
            })
        }
        LoopLaw::Position { gains, derivative_on, filter } => {
            let mut pid = Pid::new(gains, derivative_on, filter, dt)?;
            // A derivative of the error sees the reference jump.
            pid.update(0.0, 0.0, 0.0);
            Box::new(move |error, seen| {
                let u = pid.output(error, seen);
                pid.update(error, seen, 0.0);
                u
            })
        }
    };
    let (gain, time_constant) = (linear.drive.gain, linear.drive.time_constant);
    let decay = (-dt / time_constant).exp();
    let (mut position, mut velocity) = (0.0, 0.0);
    let (mut output, mut voltage) = (Vec::new(), Vec::new());
    for _ in 0..=samples as usize {
        let seen = match linear.law {
            LoopLaw::Velocity(_) => velocity,
            LoopLaw::Position { .. } => position,
        };
        let u = law(1.0 - seen, seen);
        output.push(seen);
        voltage.push(u);
        let end = gain * u;
        position += end * dt + (velocity - end) * time_constant * (1.0 - decay);
        velocity = end + (velocity - end) * decay;
    }
    Ok(StepResponse { period: dt, output, voltage, final_value: 1.0 - linear.steady_state_error() })
}

impl StepResponse {
    /// Its figures; crossings are interpolated between samples.
    #[must_use]
    pub fn figures(&self, definition: &StepDefinition) -> StepFigures {
        let relative = |y: f64| y / self.final_value;
        let peak = self.output.iter().copied().map(relative).fold(0.0, f64::max);
        let low = self.first_reaching(definition.rise_from);
        let high = self.first_reaching(1.0 - definition.rise_from);
        let inside = |y: &f64| (relative(*y) - 1.0).abs() <= definition.band;
        let settling_time = match self.output.iter().rposition(|y| !inside(y)) {
            None => Some(0.0),
            Some(last) => self.output.get(last + 1).map(|&inside| {
                // The edge of the band lies between this sample and the next.
                let (from, to) = (relative(self.output[last]) - 1.0, relative(inside) - 1.0);
                let edge = definition.band.copysign(from);
                (last as f64 + (edge - from) / (to - from)) * self.period
            }),
        };
        StepFigures {
            overshoot: (peak - 1.0).max(0.0),
            rise_time: low.zip(high).map(|(low, high)| high - low),
            settling_time,
            steady_state_error: 1.0 - self.final_value,
            peak_voltage: self.voltage.iter().fold(0.0, |peak, u| peak.max(u.abs())),
        }
    }

    /// When the fraction `level` of the final value is first reached \[s\].
    fn first_reaching(&self, level: f64) -> Option<f64> {
        let target = level * self.final_value;
        let reached = self.output.iter().position(|y| *y >= target)?;
        let Some(before) = reached.checked_sub(1) else { return Some(0.0) };
        let (from, to) = (self.output[before], self.output[reached]);
        Some((before as f64 + (target - from) / (to - from)) * self.period)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::LinearDrive;
    use crate::{DerivativeOn, LagGains, PidGains, VelocityLaw};

    fn figures(law: LoopLaw, definition: &StepDefinition, seconds: f64) -> StepFigures {
        let linear = LinearLoop { drive: LinearDrive::THESIS, law };
        step_response(&linear, 2e-5, seconds).unwrap().figures(definition)
    }

    fn pid(k_d: f64, derivative_on: DerivativeOn) -> LoopLaw {
        LoopLaw::Position {
            gains: PidGains { k_d, ..PidGains::THESIS },
            derivative_on,
            filter: 0.0,
        }
    }

    fn close(value: f64, expected: f64, tolerance: f64) -> bool {
        (value - expected).abs() <= tolerance
    }

    /// Expected of the printed lag: no overshoot, 10-90 % rise 0.0935 s, 2 % settling 0.280 s,
    /// error 0.0100058.
    #[test]
    fn the_thesis_lag_steps_as_computed() {
        let law = LoopLaw::Velocity(VelocityLaw::Lag(LagGains::THESIS));
        let found = figures(law, &StepDefinition::default(), 5.0);
        assert_eq!(found.overshoot, 0.0);
        assert!(close(found.rise_time.unwrap(), 0.0935, 1e-4), "{found:?}");
        assert!(close(found.settling_time.unwrap(), 0.280, 1e-3), "{found:?}");
        assert!(close(found.steady_state_error, 0.010_005_8, 1e-7), "{found:?}");
    }

    /// Expected of the printed PID with the derivative of the error: 11.19 %, rise 0.1425 s (5-95
    /// %: 0.169), settling 1.282 s (5 %: 0.872).
    #[test]
    fn the_thesis_pid_steps_as_computed() {
        let law = pid(0.0768, DerivativeOn::Error);
        let two = figures(law, &StepDefinition::default(), 8.0);
        assert!(close(100.0 * two.overshoot, 11.19, 0.012), "{two:?}");
        assert!(close(two.rise_time.unwrap(), 0.1425, 1.5e-4), "{two:?}");
        assert!(close(two.settling_time.unwrap(), 1.282, 1.3e-3), "{two:?}");
        let five = figures(law, &StepDefinition::FIVE_PERCENT, 8.0);
        assert!(close(five.rise_time.unwrap(), 0.169, 5e-4), "{five:?}");
        assert!(close(five.settling_time.unwrap(), 0.872, 1e-3), "{five:?}");
    }

    /// Expected with the derivative of the measurement: 12.77 %, 5-95 % rise 0.167 s, 5 % settling
    /// 0.936 s.
    #[test]
    fn the_derivative_of_the_measurement_overshoots_more() {
        let found =
            figures(pid(0.0768, DerivativeOn::Measurement), &StepDefinition::FIVE_PERCENT, 8.0);
        assert!(close(100.0 * found.overshoot, 12.77, 0.013), "{found:?}");
        assert!(close(found.rise_time.unwrap(), 0.167, 5e-4), "{found:?}");
        assert!(close(found.settling_time.unwrap(), 0.936, 1e-3), "{found:?}");
    }

    /// Expected of the sign that equation 6.4 prints: 14.65 %, rise 0.099 s, settling 1.249 s.
    #[test]
    fn the_printed_sign_of_the_derivative_gain_is_another_loop() {
        let found = figures(pid(-0.0768, DerivativeOn::Error), &StepDefinition::default(), 8.0);
        assert!(close(100.0 * found.overshoot, 14.65, 0.015), "{found:?}");
        assert!(close(found.rise_time.unwrap(), 0.099, 5e-4), "{found:?}");
        assert!(close(found.settling_time.unwrap(), 1.249, 1.3e-3), "{found:?}");
    }

    /// Expected of unit feedback: 10-90 % rise 1.126 s, settling 2.028 s.
    #[test]
    fn unit_feedback_steps_as_computed() {
        let gains = PidGains { k_p: 1.0, k_i: 0.0, k_d: 0.0 };
        let law = LoopLaw::Position { gains, derivative_on: DerivativeOn::Error, filter: 0.0 };
        let found = figures(law, &StepDefinition::default(), 8.0);
        assert!(close(found.rise_time.unwrap(), 1.126, 1.2e-3), "{found:?}");
        assert!(close(found.settling_time.unwrap(), 2.028, 2.1e-3), "{found:?}");
    }

    #[test]
    fn a_response_that_does_not_settle_says_so() {
        let found = figures(pid(-0.55, DerivativeOn::Error), &StepDefinition::default(), 1.0);
        assert_eq!(found.settling_time, None);
        let linear = LinearLoop { drive: LinearDrive::THESIS, law: pid(0.1, DerivativeOn::Error) };
        assert!(step_response(&linear, 1e-6, 1e9).is_err());
    }
}
