//! Positive real transfer functions: what the thesis's theorems on observer-based compensation ask
//! of the linear loop.
//!
//! Theorem 5.1 (velocity) asks that `G(s)` of eq. 5.48 is strictly positive real, and it is.
//! Theorem 5.2 (position) asks that `G(s)` of eq. 5.67 is positive real, and with a PID it never
//! is: `Re 1/G(jw) = K_p - J w^2`, so that `Re G < 0` above `sqrt(K_p / J)`, whatever the gains.
//!
//! The checks follow the definitions (Khalil, Nonlinear Systems, section 6.3): stable poles, and
//! the real part on the imaginary axis. The latter has the sign of a polynomial in `w^2`, whose
//! smallest value lies at zero, at infinity or at a root of its derivative; no frequency grid is
//! involved.

use super::TransferFunction;
use crate::error::positive;
use crate::{ControllerError, LagGains, PidGains};

/// Verdict on a transfer function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PositiveRealness {
    /// Strictly positive real: still positive real if its poles are moved a little to the right.
    StrictlyPositiveReal,
    /// Positive real: it gives no energy, but may store some for ever.
    PositiveReal,
    /// Neither, for the stated reason.
    NotPositiveReal(Obstacle),
}

/// Why a transfer function is not positive real.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Obstacle {
    /// Degrees of numerator and denominator differ by more than 1, or a degree at infinity has the
    /// wrong sign.
    AtInfinity,
    /// A pole in the right half-plane, or on the imaginary axis where none may be.
    Pole {
        /// Real part \[rad/s\].
        real: f64,
        /// Imaginary part \[rad/s\].
        imaginary: f64,
    },
    /// The real part is negative on the imaginary axis.
    Negative {
        /// Where it begins to be \[rad/s\].
        from: f64,
    },
    /// Its poles could not be found: coefficients that are not finite, or no poles and zeros at
    /// all.
    NotANumber,
}

impl std::fmt::Display for PositiveRealness {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::StrictlyPositiveReal => f.write_str("strictly positive real"),
            Self::PositiveReal => f.write_str("positive real, not strictly"),
            Self::NotPositiveReal(Obstacle::AtInfinity) => {
                f.write_str("not positive real: it falls or rises too fast at high frequencies")
            }
            Self::NotPositiveReal(Obstacle::Pole { real, imaginary }) => {
                write!(
                    f,
                    "not positive real: it has a pole at {real:.4} +- {:.4} j rad/s",
                    imaginary.abs()
                )
            }
            Self::NotPositiveReal(Obstacle::Negative { from }) => {
                write!(f, "not positive real: its real part is negative from {from:.4} rad/s on")
            }
            Self::NotPositiveReal(Obstacle::NotANumber) => {
                f.write_str("not positive real: it is not a proper function")
            }
        }
    }
}

/// Relative size below which a value counts as zero: rounding of the coefficients.
const ROUNDING: f64 = 1e-11;

/// Whether `g`, whose numerator and denominator have no common root, is strictly positive real,
/// positive real or neither.
#[must_use]
pub fn positive_realness(g: &TransferFunction) -> PositiveRealness {
    use PositiveRealness::{NotPositiveReal, PositiveReal, StrictlyPositiveReal};
    let (n, d) = (&g.numerator, &g.denominator);
    let numbers = n.coefficients().iter().chain(d.coefficients()).all(|c| c.is_finite());
    if n.coefficients().is_empty() || d.coefficients().is_empty() || !numbers {
        return NotPositiveReal(Obstacle::NotANumber);
    }
    if n.degree().abs_diff(d.degree()) > 1 || n.leading() * d.leading() <= 0.0 {
        return NotPositiveReal(Obstacle::AtInfinity);
    }
    let Some(poles) = d.roots() else { return NotPositiveReal(Obstacle::NotANumber) };
    let mut stable = true;
    let slope = d.derivative();
    for pole in poles {
        if pole.re < -1e-9 * pole.norm() {
            continue;
        }
        stable = false;
        // On the axis: simple, with a residue above zero. At a multiple pole the residue is not
        // finite or not real.
        let residue = n.at_complex(pole) / slope.at_complex(pole);
        let on_axis = pole.re.abs() <= 1e-9 * pole.norm();
        if !(on_axis && residue.re > 0.0 && residue.im.abs() <= 1e-6 * residue.re) {
            return NotPositiveReal(Obstacle::Pole { real: pole.re, imaginary: pole.im });
        }
    }
    // Its sign for x = w^2 >= 0; a pole on the axis leaves the sign beside it.
    let real = g.real_part();
    let Some(extremes) = real.derivative().positive_roots() else {
        return NotPositiveReal(Obstacle::NotANumber);
    };
    let mut strict = stable;
    for x in std::iter::once(0.0).chain(extremes) {
        let (value, size) = (real.at(x), real.magnitude_at(x));
        if value < -ROUNDING * size {
            return NotPositiveReal(Obstacle::Negative { from: begins_negative(&real) });
        }
        strict &= value > ROUNDING * size;
    }
    if real.leading() < 0.0 {
        return NotPositiveReal(Obstacle::Negative { from: begins_negative(&real) });
    }
    // At infinity: Re G, w^2 Re G or G / s must stay above zero.
    let needed = if n.degree() == d.degree() { d.degree() } else { d.degree().max(n.degree()) - 1 };
    strict &= real.degree() == needed && !real.coefficients().is_empty();
    if strict { StrictlyPositiveReal } else { PositiveReal }
}

/// The lowest frequency above which the polynomial in `w^2` is negative.
fn begins_negative(real: &super::Polynomial) -> f64 {
    let mut edges = vec![0.0];
    edges.extend(real.positive_roots().unwrap_or_default());
    let inside = |k: usize| match edges.get(k + 1) {
        Some(next) => 0.5 * (edges[k] + next),
        None => 2.0 * edges[k] + 1.0,
    };
    (0..edges.len()).find(|&k| real.at(inside(k)) < 0.0).map_or(f64::NAN, |k| edges[k].sqrt())
}

/// `G(s)` of theorem 5.1: from the error of the friction estimate to the velocity error, for an
/// inertia `J` \[kg m^2\] under a lag compensator whose output is a torque (thesis eq. 5.48).
///
/// # Errors
/// [`ControllerError::OutOfRange`] for an inertia that is not above zero.
pub fn velocity_theorem(inertia: f64, lag: LagGains) -> Result<TransferFunction, ControllerError> {
    positive("inertia", inertia)?;
    let LagGains { k_p, t_i, gamma } = lag;
    Ok(TransferFunction::new(
        vec![gamma, t_i],
        vec![k_p, inertia * gamma + k_p * t_i, inertia * t_i],
    ))
}

/// `G(s)` of theorem 5.2: from the error of the friction estimate to the position error, for an
/// inertia `J` \[kg m^2\] under a PID whose output is a torque (thesis eq. 5.67).
///
/// # Errors
/// [`ControllerError::OutOfRange`] for an inertia that is not above zero.
pub fn position_theorem(inertia: f64, pid: PidGains) -> Result<TransferFunction, ControllerError> {
    positive("inertia", inertia)?;
    Ok(TransferFunction::new(vec![0.0, 1.0], vec![pid.k_i, pid.k_p, pid.k_d, inertia]))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use PositiveRealness::{NotPositiveReal, PositiveReal, StrictlyPositiveReal};

    fn verdict(numerator: &[f64], denominator: &[f64]) -> PositiveRealness {
        positive_realness(&TransferFunction::new(numerator.to_vec(), denominator.to_vec()))
    }

    /// Textbook cases (Khalil, examples 6.4 and exercises; Ioannou and Tao 1987).
    #[test]
    fn textbook_functions_are_judged_as_in_the_textbook() {
        assert_eq!(verdict(&[1.0], &[1.0, 1.0]), StrictlyPositiveReal);
        assert_eq!(verdict(&[1.0], &[0.0, 1.0]), PositiveReal);
        assert_eq!(verdict(&[0.0, 1.0], &[4.0, 0.0, 1.0]), PositiveReal);
        // (s + 3) / ((s + 1)(s + 2)) has w^2 Re G -> 0: positive on the axis, not strictly.
        assert_eq!(verdict(&[3.0, 1.0], &[2.0, 3.0, 1.0]), PositiveReal);
        assert_eq!(verdict(&[2.5, 1.0], &[2.0, 3.0, 1.0]), StrictlyPositiveReal);
        // Re = (8 - x) / |D|^2 for (s + 4) / ((s + 1)(s + 2)).
        let NotPositiveReal(Obstacle::Negative { from }) = verdict(&[4.0, 1.0], &[2.0, 3.0, 1.0])
        else {
            panic!()
        };
        assert!((from - 8f64.sqrt()).abs() < 1e-9);
        assert_eq!(verdict(&[1.0], &[1.0, 1.0, 1.0]), NotPositiveReal(Obstacle::AtInfinity));
        assert!(matches!(verdict(&[1.0], &[-1.0, 1.0]), NotPositiveReal(Obstacle::Pole { .. })));
        assert!(matches!(
            verdict(&[1.0, 1.0], &[0.0, 0.0, 1.0]),
            NotPositiveReal(Obstacle::Pole { .. })
        ));
    }

    #[test]
    fn theorem_5_1_holds_for_the_thesis() {
        let g = velocity_theorem(0.0026, LagGains::THESIS).unwrap();
        assert_eq!(positive_realness(&g), StrictlyPositiveReal);
        // w^2 Re G -> K_p / J^2.
        let w = 1e6;
        assert!((w * w * g.at_frequency(w).re / (1.5136 / 0.0026f64.powi(2)) - 1.0).abs() < 1e-4);
    }

    proptest! {
        /// G of theorem 5.1 is strictly positive real for every lag: `Re 1/G = Re C(jw) > 0`.
        #[test]
        fn theorem_5_1_holds_for_every_lag(
            k_p in 0.01f64..100.0, t_i in 0.001f64..10.0, gamma in 0.001f64..0.999, inertia in 1e-5f64..1.0,
        ) {
            let g = velocity_theorem(inertia, LagGains { k_p, t_i, gamma }).unwrap();
            prop_assert_eq!(positive_realness(&g), StrictlyPositiveReal);
        }

        /// The hypothesis of theorem 5.2 is false for every PID: the real part is negative above
        /// `sqrt(K_p / J)`, or the loop is not even stable.
        #[test]
        fn the_hypothesis_of_theorem_5_2_fails_for_every_pid(
            k_p in 0.01f64..100.0, k_i in 0.0f64..100.0, k_d in -1.0f64..10.0, inertia in 1e-5f64..1.0,
        ) {
            let g = position_theorem(inertia, PidGains { k_p, k_i, k_d }).unwrap();
            // Degrees 3 and 1 already rule it out.
            prop_assert_eq!(positive_realness(&g), NotPositiveReal(Obstacle::AtInfinity));
            let w = (k_p / inertia).sqrt();
            prop_assert!(g.at_frequency(1.001 * w).re < 0.0);
            prop_assert!(g.at_frequency(0.999 * w).re > 0.0);
        }
    }

    #[test]
    fn the_thesis_pid_loses_positivity_at_47_radians_a_second() {
        let g = position_theorem(0.0026, PidGains::THESIS).unwrap();
        assert!((begins_negative(&g.real_part()) - (5.7517f64 / 0.0026).sqrt()).abs() < 1e-6);
        assert!((begins_negative(&g.real_part()) - 47.0).abs() < 0.1);
    }
}
