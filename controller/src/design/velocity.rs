//! The velocity loop: lag compensator and PI by the frequency response method (thesis section 6.2
//! and appendix A).

use serde::{Deserialize, Serialize};

use super::LinearDrive;
use crate::error::positive;
use crate::{ControllerError, LagGains, PiGains};

/// What a velocity loop shall do.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct VelocitySpecification {
    /// Error that remains of a constant reference, as a fraction: 0.01 for 1 %.
    pub steady_state_error: f64,
    /// Gain crossover \[rad/s\].
    pub crossover: f64,
}

/// Lag compensator `K_p (T_i s + 1) / (T_i s + gamma)` by the frequency response method.
///
/// The gain at zero frequency, `K_p / gamma = (1 - e) / (e K)`, leaves the error `e`;
/// `K_p = 1 / |G(j w_c)|` puts the crossover at `w_c`; the lag's zero lies a decade below it,
/// `T_i = 10 / w_c`, so that its phase hardly matters there.
///
/// # Errors
/// [`ControllerError::OutOfRange`] for numbers that make no sense; [`ControllerError::Infeasible`]
/// if the drive would need a lead instead (`gamma >= 1`).
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
            expected: "between 0 and 1, as a fraction of the reference".into(),
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

/// What a velocity loop without a remaining error shall do.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PiSpecification {
    /// Gain crossover \[rad/s\].
    pub crossover: f64,
    /// Phase margin \[degrees\].
    pub phase_margin: f64,
}

/// PI `K_p + K_i / s` with the stated crossover and phase margin.
///
/// The phase of the drive at the crossover leaves the PI `-180 + margin + atan(w T)`, which sets
/// its zero, `T_i = tan(margin - 90 + atan(w T)) / w`; the gain then is 1 at `w`.
///
/// # Errors
/// [`ControllerError::OutOfRange`] for numbers that make no sense; [`ControllerError::Infeasible`]
/// for a phase margin that no PI gives on this drive at this crossover.
pub fn pi_from_specification(
    drive: &LinearDrive,
    specification: &PiSpecification,
) -> Result<PiGains, ControllerError> {
    drive.check()?;
    let PiSpecification { crossover: w, phase_margin } = *specification;
    positive("crossover", w)?;
    positive("phase_margin", phase_margin)?;
    let lag = (w * drive.time_constant).atan();
    let lead = phase_margin.to_radians() - std::f64::consts::FRAC_PI_2 + lag;
    if !(lead > 0.0 && lead < std::f64::consts::FRAC_PI_2) {
        let least = 90.0 - lag.to_degrees();
        return Err(ControllerError::Infeasible {
            controller: "PI",
            reason: format!(
                "at {w} rad/s its phase margin on this drive is between {least:.1} and {:.1} degrees, not {phase_margin}; \
                 ask for one in between, or for another crossover",
                least + 90.0
            ),
        });
    }
    let t_i = lead.tan() / w;
    let k_p = lead.sin() / drive.magnitude(w);
    Ok(PiGains { k_p, k_i: k_p / t_i })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_thesis_specification_gives_the_consistent_lag() {
        let specification = VelocitySpecification { steady_state_error: 0.01, crossover: 110.0 };
        let gains = lag_from_specification(&LinearDrive::THESIS, &specification).unwrap();
        assert!((gains.k_p / gains.gamma - 53.140).abs() < 5e-4);
        assert!((gains.k_p - 1.5087).abs() < 5e-5);
        assert!((gains.gamma - 0.02839).abs() < 5e-6);
        assert!((gains.t_i - 0.0909).abs() < 5e-5);
        let decibel = 20.0 * LinearDrive::THESIS.magnitude(110.0).log10();
        assert!((decibel + 3.572).abs() < 5e-4);
    }

    /// The printed gains follow from rounding -3.572 dB to -3.6 dB.
    #[test]
    fn the_printed_lag_is_a_rounding_away() {
        let k_p = 10f64.powf(3.6 / 20.0);
        assert!((k_p - LagGains::THESIS.k_p).abs() < 5e-5);
        assert!((k_p * 1.863 * 0.01 / 0.99 - LagGains::THESIS.gamma).abs() < 5e-5);
    }

    /// Crossover and phase margin of the printed compensator on the printed drive (expected: 111.03
    /// rad/s, 105.2 degrees).
    #[test]
    fn the_printed_lag_crosses_over_where_it_should() {
        let LagGains { k_p, t_i, gamma } = LagGains::THESIS;
        let drive = LinearDrive::THESIS;
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
        let phase =
            (low * t_i).atan() - (low * t_i).atan2(gamma) - (low * drive.time_constant).atan();
        assert!((180.0 + phase.to_degrees() - 105.2).abs() < 0.1);
    }

    /// The open loop at the asked crossover has gain 1 and the asked phase.
    #[test]
    fn the_pi_crosses_over_where_it_was_asked_to() {
        let drive = LinearDrive::THESIS;
        for (w, margin) in [(50.0, 60.0), (110.0, 80.0), (300.0, 45.0)] {
            let gains = pi_from_specification(
                &drive,
                &PiSpecification { crossover: w, phase_margin: margin },
            )
            .unwrap();
            let law = crate::design::LoopLaw::Velocity(crate::VelocityLaw::Pi(gains));
            let open = crate::design::LinearLoop { drive, law }.open(w);
            assert!((open.norm() - 1.0).abs() < 1e-12);
            assert!((180.0 + open.arg().to_degrees() - margin).abs() < 1e-9);
        }
        let error =
            pi_from_specification(&drive, &PiSpecification { crossover: 50.0, phase_margin: 20.0 })
                .unwrap_err();
        assert!(error.to_string().contains("between 39.9 and 129.9"), "{error}");
    }

    #[test]
    fn senseless_specifications_are_refused() {
        let drive = LinearDrive::THESIS;
        for (steady_state_error, crossover) in
            [(0.0, 110.0), (1.5, 110.0), (0.01, -1.0), (f64::NAN, 110.0)]
        {
            assert!(
                lag_from_specification(
                    &drive,
                    &VelocitySpecification { steady_state_error, crossover }
                )
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
