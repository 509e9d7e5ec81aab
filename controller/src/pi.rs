//! The PI for velocity: `C(s) = K_p + K_i / s`.
//!
//! The integral follows the trapezoidal rule, which is the bilinear rule (Tustin) of `1 / s`.
//! Anti-windup: the integral stands still while the output is at its limit and the error would
//! drive it further. It is the lag compensator with gamma = 0: `K_i = K_p / T_i`.

use ::parameters::{ValueRange, parameters};
use serde::{Deserialize, Serialize};

use crate::error::positive;
use crate::{ControllerError, LagGains};

parameters! {
    /// Gains of a PI.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct PiGains {
        k_p: f64, "Proportional gain K_p of the PI", unit("V s/rad"), range(ValueRange::POSITIVE);
        k_i: f64, "Integral gain K_i of the PI", unit("V/rad"), range(ValueRange::NON_NEGATIVE);
    }
}

impl PiGains {
    /// The thesis's lag compensator without its slow pole: `K_i = K_p / T_i`.
    pub const THESIS: Self =
        Self { k_p: LagGains::THESIS.k_p, k_i: LagGains::THESIS.k_p / LagGains::THESIS.t_i };
}

/// A PI running at a fixed period.
#[derive(Debug, Clone)]
pub struct PiController {
    gains: PiGains,
    half_period: f64,
    integral: f64,
    error: f64,
}

impl PiController {
    /// A controller at rest, called every `dt` \[s\].
    ///
    /// # Errors
    /// [`ControllerError::OutOfRange`] names the gain.
    pub fn new(gains: PiGains, dt: f64) -> Result<Self, ControllerError> {
        gains.check()?;
        positive("dt", dt)?;
        Ok(Self { gains, half_period: 0.5 * dt, integral: 0.0, error: 0.0 })
    }

    /// Voltage for the present error \[V\], before any limit.
    #[inline]
    #[must_use]
    pub fn output(&self, error: f64) -> f64 {
        self.gains.k_p * error + self.gains.k_i * self.next(error)
    }

    /// Takes the error in, once the output is known to be limited or not. `limited` is the
    /// direction in which the whole command is cut: -1, 0 or 1.
    #[inline]
    pub fn update(&mut self, error: f64, limited: f64) {
        if limited * error <= 0.0 {
            self.integral = self.next(error);
        }
        self.error = error;
    }

    #[inline]
    fn next(&self, error: f64) -> f64 {
        self.integral + self.half_period * (self.error + error)
    }

    /// Sets the integral so that the next output for the same `error` is `output` \[V\]; with K_i =
    /// 0 there is no state to set.
    pub(crate) fn preload(&mut self, output: f64, error: f64) {
        self.error = error;
        if self.gains.k_i > 0.0 {
            self.integral =
                (output - self.gains.k_p * error) / self.gains.k_i - 2.0 * self.half_period * error;
        }
    }

    /// Back to rest.
    pub fn reset(&mut self) {
        (self.integral, self.error) = (0.0, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// K_p + K_i t for a unit error from time zero, whatever the period; the trapezoid counts half
    /// of the first sample.
    #[test]
    fn a_constant_error_is_integrated() {
        for dt in [1e-4, 1e-3, 1e-2] {
            let mut pi = PiController::new(PiGains { k_p: 2.0, k_i: 3.0 }, dt).unwrap();
            let mut u = 0.0;
            for _ in 0..=(1.0 / dt).round() as usize {
                u = pi.output(1.0);
                pi.update(1.0, 0.0);
            }
            assert!((u - (2.0 + 3.0 * (1.0 + 0.5 * dt))).abs() < 1e-9, "{u}");
        }
    }

    #[test]
    fn it_is_the_lag_compensator_with_its_pole_at_zero() {
        let lag = crate::LagGains { k_p: 1.5, t_i: 0.09, gamma: 0.0 };
        let mut lag = crate::LagCompensator::new(lag, 1e-3).unwrap();
        let mut pi = PiController::new(PiGains { k_p: 1.5, k_i: 1.5 / 0.09 }, 1e-3).unwrap();
        for k in 0..1000 {
            let error = (0.02 * f64::from(k)).sin();
            assert!((pi.output(error) - lag.output(error)).abs() < 1e-12);
            pi.update(error, 0.0);
            lag.update(error, 0.0);
        }
    }

    #[test]
    fn it_does_not_wind_up_at_the_limit() {
        let mut pi = PiController::new(PiGains { k_p: 1.5, k_i: 16.0 }, 1e-3).unwrap();
        for _ in 0..10_000 {
            pi.update(5.0, 1.0);
        }
        assert!(pi.output(-0.1) < 0.0);
    }

    #[test]
    fn gains_out_of_range_are_named() {
        for (gains, name) in
            [(PiGains { k_p: 0.0, k_i: 1.0 }, "k_p"), (PiGains { k_p: 1.0, k_i: -1.0 }, "k_i")]
        {
            assert!(PiController::new(gains, 1e-3).unwrap_err().to_string().starts_with(name));
        }
    }
}
