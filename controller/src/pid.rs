//! The PID for position: `u = K_p e + K_i integral(e) + K_d d/dt`, the derivative of the error or
//! of the measurement, filtered by `1 / (T_f s + 1)`.
//!
//! The integral follows the trapezoidal rule, the filtered derivative the bilinear rule.
//! Anti-windup: the integral stands still while the output is at its limit and the error would
//! drive it further. With the derivative on the measurement a step of the reference gives no kick.

use ::parameters::{ValueRange, parameters};
use serde::{Deserialize, Serialize};

use crate::ControllerError;
use crate::error::{non_negative, positive};

parameters! {
    /// Gains of a PID.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct PidGains {
        k_p: f64, "Proportional gain K_p of the PID of position", unit("V/rad"),
            range(ValueRange::NON_NEGATIVE);
        k_i: f64, "Integral gain K_i of the PID", unit("V/(rad s)"),
            range(ValueRange::NON_NEGATIVE);
        k_d: f64, "Derivative gain K_d of the PID", unit("V s/rad");
    }
}

impl PidGains {
    /// The thesis's position controller (appendix A; its equation 6.4 prints K_d with the wrong
    /// sign).
    pub const THESIS: Self = Self { k_p: 5.7517, k_i: 10.0, k_d: 0.0768 };
}

/// What the derivative is taken of.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    Serialize,
    Deserialize,
    strum::EnumString,
    strum::IntoStaticStr,
    strum::VariantNames,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum DerivativeOn {
    /// The error: quick, with a kick when the reference jumps.
    Error,
    /// The measurement, with its sign turned.
    #[default]
    Measurement,
}

/// A PID running at a fixed period.
#[derive(Debug, Clone)]
pub struct Pid {
    gains: PidGains,
    on: DerivativeOn,
    half_period: f64,
    /// Bilinear coefficients of the filtered derivative: `d' = decay d + gain (y' - y)`.
    decay: f64,
    gain: f64,
    integral: f64,
    derivative: f64,
    /// Error and differentiated signal of the cycle before; `None` before the first.
    before: Option<(f64, f64)>,
}

impl Pid {
    /// A PID at rest, called every `dt` \[s\], with the derivative's filter time constant `filter`
    /// \[s\], zero or more.
    ///
    /// # Errors
    /// [`ControllerError::OutOfRange`] names the gain.
    pub fn new(
        gains: PidGains,
        on: DerivativeOn,
        filter: f64,
        dt: f64,
    ) -> Result<Self, ControllerError> {
        positive("dt", dt)?;
        gains.check()?;
        non_negative("filter", filter)?;
        // Below half a period the bilinear rule would ring: a backward difference is what remains
        // of the filter there.
        let filter = filter.max(0.5 * dt);
        Ok(Self {
            gains,
            on,
            half_period: 0.5 * dt,
            decay: (2.0 * filter - dt) / (2.0 * filter + dt),
            gain: 2.0 / (2.0 * filter + dt),
            integral: 0.0,
            derivative: 0.0,
            before: None,
        })
    }

    /// Voltage for the present error and measurement \[V\], before any limit.
    #[inline]
    #[must_use]
    pub fn output(&self, error: f64, measurement: f64) -> f64 {
        let (integral, derivative) = self.next(error, measurement);
        self.gains.k_p * error + self.gains.k_i * integral + self.gains.k_d * derivative
    }

    /// Takes the error in, once the output is known to be limited or not. `limited` is the
    /// direction in which the whole command is cut: -1, 0 or 1.
    #[inline]
    pub fn update(&mut self, error: f64, measurement: f64, limited: f64) {
        let (integral, derivative) = self.next(error, measurement);
        if limited * error <= 0.0 {
            self.integral = integral;
        }
        self.derivative = derivative;
        self.before = Some((error, self.differentiated(error, measurement)));
    }

    #[inline]
    fn next(&self, error: f64, measurement: f64) -> (f64, f64) {
        let signal = self.differentiated(error, measurement);
        let (error_before, signal_before) = self.before.unwrap_or((error, signal));
        (
            self.integral + self.half_period * (error + error_before),
            self.decay * self.derivative + self.gain * (signal - signal_before),
        )
    }

    #[inline]
    fn differentiated(&self, error: f64, measurement: f64) -> f64 {
        match self.on {
            DerivativeOn::Error => error,
            DerivativeOn::Measurement => -measurement,
        }
    }

    /// Sets the integral so that the next output for the same error and the same `rate` of what is
    /// differentiated \[rad/s\] is `output` \[V\]; with K_i = 0 there is no state to set.
    pub(crate) fn preload(&mut self, output: f64, error: f64, measurement: f64, rate: f64) {
        self.derivative = rate;
        self.before = Some((error, self.differentiated(error, measurement)));
        if self.gains.k_i > 0.0 {
            let others = self.gains.k_p * error + self.gains.k_d * rate;
            self.integral = (output - others) / self.gains.k_i - 2.0 * self.half_period * error;
        }
    }

    /// The derivative now \[rad/s\].
    pub(crate) const fn derivative(&self) -> f64 {
        self.derivative
    }

    /// Back to rest.
    pub fn reset(&mut self) {
        (self.integral, self.derivative, self.before) = (0.0, 0.0, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Step of the closed loop on `K / (s (T s + 1))`, integrated exactly between samples.
    fn step_response(gains: PidGains, on: DerivativeOn, seconds: f64) -> (f64, Vec<f64>) {
        let (k, t, dt) = (1.863, 0.02388, 1e-4);
        let mut pid = Pid::new(gains, on, 0.0, dt).unwrap();
        // The reference jumps at time zero: the derivative of the error must see it jump.
        pid.update(0.0, 0.0, 0.0);
        let decay = (-dt / t).exp();
        let (mut position, mut w) = (0.0, 0.0);
        let response = (0..(seconds / dt) as usize)
            .map(|_| {
                let e = 1.0 - position;
                let u = pid.output(e, position);
                pid.update(e, position, 0.0);
                position += k * u * dt + (w - k * u) * t * (1.0 - decay);
                w = k * u + (w - k * u) * decay;
                position
            })
            .collect();
        (dt, response)
    }

    fn overshoot_and_rise(on: DerivativeOn, low: f64, high: f64) -> (f64, f64) {
        let (dt, response) = step_response(PidGains::THESIS, on, 5.0);
        let peak = response.iter().copied().fold(0.0, f64::max);
        let time_of = |level: f64| response.iter().position(|y| *y >= level).unwrap() as f64 * dt;
        (100.0 * (peak - 1.0), time_of(high) - time_of(low))
    }

    /// Expected: overshoot 11.19 % and 10-90 % rise 0.1425 s with the derivative of the error,
    /// 12.77 % and 5-95 % rise 0.167 s of the measurement.
    #[test]
    fn the_thesis_gains_step_as_computed() {
        let (overshoot, rise) = overshoot_and_rise(DerivativeOn::Error, 0.1, 0.9);
        assert!(
            (overshoot - 11.19).abs() < 0.1 && (rise - 0.1425).abs() < 1e-3,
            "{overshoot} {rise}"
        );
        let (overshoot, rise) = overshoot_and_rise(DerivativeOn::Measurement, 0.05, 0.95);
        assert!(
            (overshoot - 12.77).abs() < 0.1 && (rise - 0.167).abs() < 1e-3,
            "{overshoot} {rise}"
        );
    }

    #[test]
    fn the_filtered_derivative_of_a_ramp_is_its_slope() {
        for on in [DerivativeOn::Error, DerivativeOn::Measurement] {
            let gains = PidGains { k_p: 0.0, k_i: 0.0, k_d: 1.0 };
            let mut pid = Pid::new(gains, on, 0.005, 1e-3).unwrap();
            let mut u = 0.0;
            for k in 0..200 {
                let y = -3e-3 * f64::from(k);
                u = pid.output(-y, y);
                pid.update(-y, y, 0.0);
            }
            assert!((u - 3.0).abs() < 1e-9, "{u}");
        }
    }

    #[test]
    fn it_does_not_wind_up_at_the_limit() {
        let mut pid = Pid::new(PidGains::THESIS, DerivativeOn::Measurement, 0.005, 1e-3).unwrap();
        for _ in 0..10_000 {
            pid.update(2.0, 0.0, 1.0);
        }
        assert!(pid.output(-0.01, 0.0) < 0.0);
    }
}
