//! Gains from specifications, for a drive `K / (T s + 1)` from volts to velocity (thesis chapter 6 and appendix A).

use serde::{Deserialize, Serialize};

use crate::error::positive;
use crate::{ControllerError, LagGains, PidGains};

/// The linear drive: `T w' + w = K u`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LinearDrive {
    /// Velocity gain K [rad/s per V].
    pub gain: f64,
    /// Time constant T [s].
    pub time_constant: f64,
}

impl LinearDrive {
    /// The SRV-02 as the thesis rounds it: K = 1.863 rad/s per V, T = .02388 s.
    pub const SRV02: Self = Self { gain: 1.863, time_constant: 0.02388 };

    /// `|K / (j w T + 1)|` at `w` [rad/s].
    #[must_use]
    pub fn magnitude(&self, w: f64) -> f64 {
        self.gain / (1.0 + (w * self.time_constant).powi(2)).sqrt()
    }

    pub(crate) fn check(&self) -> Result<(), ControllerError> {
        positive("gain", self.gain)?;
        positive("time_constant", self.time_constant)
    }
}

/// What a velocity loop shall do.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct VelocitySpecification {
    /// Error that remains of a constant reference, as a fraction: .01 for 1 %.
    pub steady_state_error: f64,
    /// Gain crossover [rad/s].
    pub crossover: f64,
}

/// Lag compensator `K_p (T_i s + 1) / (T_i s + gamma)` by the frequency response method.
///
/// The gain at zero frequency, `K_p / gamma = (1 - e) / (e K)`, leaves the error `e`; `K_p = 1 / |G(j w_c)|` puts the
/// crossover at `w_c`; the lag's zero lies a decade below it, `T_i = 10 / w_c`, so that its phase hardly matters there.
///
/// # Errors
/// [`ControllerError::OutOfRange`] for numbers that make no sense; [`ControllerError::Infeasible`] if the drive would need
/// a lead instead (`gamma >= 1`).
pub fn lag_from_specification(
    drive: &LinearDrive,
    specification: &VelocitySpecification,
) -> Result<LagGains, ControllerError> {
    drive.check()?;
    let e = specification.steady_state_error;
    if !(e > 0.0 && e < 1.0) {
        return Err(ControllerError::OutOfRange {
            name: "steady_state_error",
            value: e,
            expected: "between 0 and 1, as a fraction of the reference",
        });
    }
    positive("crossover", specification.crossover)?;
    let k_p = 1.0 / drive.magnitude(specification.crossover);
    let gamma = k_p * drive.gain * e / (1.0 - e);
    if gamma >= 1.0 {
        return Err(ControllerError::Infeasible {
            controller: "lag compensator",
            reason: format!(
                "proportional gain {k_p:.4} V s/rad for the crossover at {} rad/s already leaves less than {e} of error; \
                 ask for a smaller error or a lower crossover",
                specification.crossover
            ),
        });
    }
    Ok(LagGains { k_p, t_i: 10.0 / specification.crossover, gamma })
}

/// What a position loop shall do.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PositionSpecification {
    /// Damping ratio of the dominant pair of poles, above 0.
    pub damping: f64,
    /// Natural frequency of the dominant pair [rad/s].
    pub natural_frequency: f64,
    /// Magnitude of the third, real pole [rad/s].
    pub real_pole: f64,
}

/// PID on the position of the drive, `K / (s (T s + 1))`, by placing the three closed-loop poles:
/// `T s^3 + (1 + K K_d) s^2 + K K_p s + K K_i = T (s^2 + 2 zeta w s + w^2)(s + p)`.
///
/// # Errors
/// [`ControllerError::OutOfRange`] for numbers that make no sense.
pub fn pid_from_poles(
    drive: &LinearDrive,
    specification: &PositionSpecification,
) -> Result<PidGains, ControllerError> {
    drive.check()?;
    let PositionSpecification { damping: zeta, natural_frequency: w, real_pole: p } = *specification;
    positive("damping", zeta)?;
    positive("natural_frequency", w)?;
    positive("real_pole", p)?;
    let (k, t) = (drive.gain, drive.time_constant);
    Ok(PidGains {
        k_p: t * (w * w + 2.0 * zeta * w * p) / k,
        k_i: t * w * w * p / k,
        k_d: (t * (2.0 * zeta * w + p) - 1.0) / k,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_thesis_specification_gives_the_consistent_lag() {
        let specification = VelocitySpecification { steady_state_error: 0.01, crossover: 110.0 };
        let gains = lag_from_specification(&LinearDrive::SRV02, &specification).unwrap();
        assert!((gains.k_p / gains.gamma - 53.140).abs() < 5e-4);
        assert!((gains.k_p - 1.5087).abs() < 5e-5);
        assert!((gains.gamma - 0.02839).abs() < 5e-6);
        assert!((gains.t_i - 0.0909).abs() < 5e-5);
        let decibel = 20.0 * LinearDrive::SRV02.magnitude(110.0).log10();
        assert!((decibel + 3.572).abs() < 5e-4);
    }

    /// The printed gains follow from rounding -3.572 dB to -3.6 dB.
    #[test]
    fn the_printed_lag_is_a_rounding_away() {
        let k_p = 10f64.powf(3.6 / 20.0);
        assert!((k_p - LagGains::THESIS.k_p).abs() < 5e-5);
        assert!((k_p * 1.863 * 0.01 / 0.99 - LagGains::THESIS.gamma).abs() < 5e-5);
    }

    /// Crossover and phase margin of the printed compensator on the printed drive (expected: 111.03 rad/s, 105.2 degrees).
    #[test]
    fn the_printed_lag_crosses_over_where_it_should() {
        let LagGains { k_p, t_i, gamma } = LagGains::THESIS;
        let drive = LinearDrive::SRV02;
        let open = |w: f64| {
            k_p * (1.0 + (w * t_i).powi(2)).sqrt() / (gamma * gamma + (w * t_i).powi(2)).sqrt()
                * drive.magnitude(w)
        };
        let (mut low, mut high) = (50.0, 500.0);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if open(middle) > 1.0 { low = middle } else { high = middle }
        }
        assert!((low - 111.03).abs() < 0.1, "{low}");
        let phase = (low * t_i).atan() - (low * t_i).atan2(gamma) - (low * drive.time_constant).atan();
        assert!((180.0 + phase.to_degrees() - 105.2).abs() < 0.1);
    }

    #[test]
    fn pid_poles_are_where_they_were_asked_for() {
        let drive = LinearDrive::SRV02;
        let gains = pid_from_poles(
            &drive,
            &PositionSpecification { damping: 0.7, natural_frequency: 15.0, real_pole: 30.0 },
        )
        .unwrap();
        // The characteristic polynomial vanishes at -30 and at 15 exp(+-j acos(-.7)).
        let polynomial = |s: f64| {
            drive.time_constant * s.powi(3)
                + (1.0 + drive.gain * gains.k_d) * s * s
                + drive.gain * (gains.k_p * s + gains.k_i)
        };
        assert!(polynomial(-30.0).abs() < 1e-9);
        let at_pair = drive.time_constant * (225.0 * 30.0);
        assert!((drive.gain * gains.k_i - at_pair).abs() < 1e-9);
    }

    #[test]
    fn senseless_specifications_are_refused() {
        let drive = LinearDrive::SRV02;
        for (steady_state_error, crossover) in [(0.0, 110.0), (1.5, 110.0), (0.01, -1.0), (f64::NAN, 110.0)] {
            assert!(
                lag_from_specification(&drive, &VelocitySpecification { steady_state_error, crossover })
                    .is_err()
            );
        }
        let message = lag_from_specification(
            &drive,
            &VelocitySpecification { steady_state_error: 0.6, crossover: 110.0 },
        )
        .unwrap_err()
        .to_string();
        assert!(message.contains("smaller error"), "{message}");
    }
}
