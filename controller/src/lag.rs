//! The lag compensator for velocity: `C(s) = K_p (T_i s + 1) / (T_i s + gamma)` (thesis eq. 6.4 and
//! appendix A).
//!
//! Written as `u = K_p (e + x)` with `T_i x' = (1 - gamma) e - gamma x`, and discretised by the
//! bilinear rule (Tustin), which keeps the gain at zero frequency and the stability for any period.
//! Anti-windup: `x` stands still while the output is at its limit and the error would drive it
//! further.

use ::parameters::{ValueRange, parameters};
use serde::{Deserialize, Serialize};

use crate::ControllerError;
use crate::error::positive;

parameters! {
    /// Gains of a lag compensator. `K_p / gamma` is the gain at zero frequency.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct LagGains {
        k_p: f64, "Gain K_p of the lag compensator", unit("V s/rad"), range(ValueRange::POSITIVE);
        t_i: f64, "Time constant T_i of the lag compensator", unit("s"),
            range(ValueRange::POSITIVE);
        gamma: f64, "Ratio gamma of the lag compensator", range(ValueRange::Double(0.0, 1.0));
    }
}

impl LagGains {
    /// As the thesis prints them, from rounding -3.572 dB to -3.6 dB.
    pub const THESIS: Self = Self { k_p: 1.5136, t_i: 0.0909, gamma: 0.0285 };
}

/// A lag compensator running at a fixed period.
#[derive(Debug, Clone)]
pub struct LagCompensator {
    k_p: f64,
    /// Bilinear coefficients: `x' = decay x + gain (e + e')`.
    decay: f64,
    gain: f64,
    x: f64,
    e: f64,
}

impl LagCompensator {
    /// A compensator at rest, called every `dt` \[s\].
    ///
    /// # Errors
    /// [`ControllerError::OutOfRange`] names the gain.
    pub fn new(gains: LagGains, dt: f64) -> Result<Self, ControllerError> {
        gains.check()?;
        positive("dt", dt)?;
        if !(0.0..1.0).contains(&gains.gamma) {
            return Err(ControllerError::OutOfRange {
                name: "gamma",
                value: gains.gamma,
                expected: "at least 0 and below 1".into(),
            });
        }
        let half = 0.5 * dt;
        let denominator = gains.t_i + gains.gamma * half;
        Ok(Self {
            k_p: gains.k_p,
            decay: (gains.t_i - gains.gamma * half) / denominator,
            gain: (1.0 - gains.gamma) * half / denominator,
            x: 0.0,
            e: 0.0,
        })
    }

    /// Voltage for the present error \[V\], before any limit.
    #[inline]
    #[must_use]
    pub fn output(&self, error: f64) -> f64 {
        self.k_p * (error + self.next(error))
    }

    /// Takes the error in, once the output is known to be limited or not. `limited` is the
    /// direction in which the whole command is cut: -1, 0 or 1.
    #[inline]
    pub fn update(&mut self, error: f64, limited: f64) {
        if limited * error <= 0.0 {
            self.x = self.next(error);
        }
        self.e = error;
    }

    #[inline]
    fn next(&self, error: f64) -> f64 {
        self.decay * self.x + self.gain * (self.e + error)
    }

    /// Sets `x` so that the next output for the same `error` is `output` \[V\]. The lag has no
    /// integrator: with a constant error it leaves that output again for its own, with its time
    /// constant `T_i / gamma`.
    pub(crate) fn preload(&mut self, output: f64, error: f64) {
        self.e = error;
        // At `T_i = gamma dt / 2` the next output does not depend on the state.
        if self.decay.abs() > 1e-9 {
            self.x = (output / self.k_p - error - 2.0 * self.gain * error) / self.decay;
        }
    }

    /// Back to rest.
    pub fn reset(&mut self) {
        (self.x, self.e) = (0.0, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Step of the closed loop on `K / (T s + 1)`, integrated exactly between samples.
    fn step_response(gains: LagGains, dt: f64, seconds: f64) -> Vec<f64> {
        let (k, t) = (1.863, 0.02388);
        let mut controller = LagCompensator::new(gains, dt).unwrap();
        let decay = (-dt / t).exp();
        let mut w = 0.0;
        (0..(seconds / dt) as usize)
            .map(|_| {
                let e = 1.0 - w;
                let u = controller.output(e);
                controller.update(e, 0.0);
                w = k * u + (w - k * u) * decay;
                w
            })
            .collect()
    }

    /// Expected of the printed compensator: no overshoot, 10-90 % rise 0.0935 s, error 0.0100058, 2
    /// % settling 0.280 s.
    #[test]
    fn the_closed_loop_steps_as_designed() {
        let dt = 1e-4;
        let response = step_response(LagGains::THESIS, dt, 3.0);
        let end = *response.last().unwrap();
        // The slow pole leaves a little of the transient after three seconds.
        assert!((1.0 - end - 0.010_005_8).abs() < 1e-6, "{end}");
        assert!(response.iter().all(|w| *w <= end + 1e-9));
        let time_of =
            |level: f64| response.iter().position(|w| *w >= level * end).unwrap() as f64 * dt;
        assert!((time_of(0.9) - time_of(0.1) - 0.0935).abs() < 1e-3);
        let settled =
            response.iter().rposition(|w| (w - end).abs() > 0.02 * end).unwrap() as f64 * dt;
        assert!((settled - 0.280).abs() < 3e-3, "{settled}");
    }

    #[test]
    fn the_period_hardly_matters() {
        let fine = step_response(LagGains::THESIS, 1e-4, 0.5);
        let coarse = step_response(LagGains::THESIS, 1e-3, 0.5);
        for (k, w) in coarse.iter().enumerate() {
            assert!((w - fine[10 * k + 9]).abs() < 0.02, "sample {k}");
        }
    }

    #[test]
    fn it_does_not_wind_up_at_the_limit() {
        let mut controller = LagCompensator::new(LagGains::THESIS, 1e-3).unwrap();
        for _ in 0..10_000 {
            controller.update(5.0, 1.0);
        }
        // Free again as soon as the error turns round.
        assert!(controller.output(-0.1) < 0.0);
    }

    #[test]
    fn gains_out_of_range_are_named() {
        let wrong = LagGains { gamma: 1.2, ..LagGains::THESIS };
        assert!(LagCompensator::new(wrong, 1e-3).unwrap_err().to_string().starts_with("gamma"));
        assert!(LagCompensator::new(LagGains::THESIS, 0.0).is_err());
    }
}
