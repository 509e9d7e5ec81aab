//! How much friction a linear loop is proven to stand.
//!
//! What is left of friction after its compensation, `F(w)`, is taken as any function of velocity,
//! also one that changes with time, whose slope seen from zero lies in a sector:
//! `a w^2 <= F w <= b w^2` \[N m s/rad\]. A negative slope is friction that falls with velocity
//! (Stribeck) or is over-compensated. The linear loop is `H(s)` from a braking torque's opposite to
//! velocity. The circle criterion (Zames 1966; Khalil, Nonlinear Systems, theorem 7.1) proves that
//! the loop comes to rest if `(1 + b H) / (1 + a H)` is strictly positive real. Beyond that sector
//! nothing is proven; beyond the range of constant slopes ([`stable_slopes`]) instability is.
//!
//! Coulomb friction fits into a sector without an upper end, since it jumps at zero. With an
//! integrating position loop no such sector is ever proven, and such loops hunt. Over-compensated
//! Coulomb friction, a jump of the wrong sign at zero, fits into no sector at all.

use super::theory::{PositiveRealness, positive_realness};
use super::{LinearLoop, LoopLaw, Polynomial, TransferFunction};
use crate::ControllerError;
use crate::error::positive;

/// Upper end of a sector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UpperSlope {
    /// A slope \[N m s/rad\].
    Finite(f64),
    /// Any finite slope, however large.
    Any,
}

/// What is proven of a loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectorMargin {
    /// Lowest constant slope at which the linear loop is stable \[N m s/rad\]; minus infinity if
    /// there is none.
    pub lowest_constant: f64,
    /// Lowest slope `a` for which every friction in the sector from `a` upwards is proven stable
    /// \[N m s/rad\]; `None` if that is not even proven from the slope zero upwards.
    pub lowest_with_any_upper: Option<f64>,
    /// Upper end of the sector from zero that is proven stable; `None` if the loop without friction
    /// is not.
    pub upper_from_zero: Option<UpperSlope>,
}

/// `H(s)` from minus the friction torque \[N m\] to velocity \[rad/s\], with the loop closed;
/// `volts_per_newton_metre` is `R_a / (A K_m)`.
///
/// # Errors
/// [`ControllerError::OutOfRange`] for a factor that is not above zero.
pub fn friction_to_velocity(
    linear: &LinearLoop,
    volts_per_newton_metre: f64,
) -> Result<TransferFunction, ControllerError> {
    positive("volts_per_newton_metre", volts_per_newton_metre)?;
    let factor = linear.drive.gain * volts_per_newton_metre;
    let mut numerator = linear.controller().denominator.times(&Polynomial::new(vec![factor]));
    if let LoopLaw::Position { .. } = linear.law {
        numerator = numerator.times(&Polynomial::new(vec![0.0, 1.0]));
    }
    Ok(TransferFunction { numerator, denominator: linear.characteristic() })
}

/// Whether every friction in the sector from `lower` to `upper` is proven stable.
#[must_use]
pub fn is_proven(h: &TransferFunction, lower: f64, upper: UpperSlope) -> bool {
    let (n, d) = (&h.numerator, &h.denominator);
    let below = d.plus(lower, n);
    if !below.is_hurwitz() {
        return false;
    }
    match upper {
        UpperSlope::Finite(upper) => {
            let ratio = TransferFunction { numerator: d.plus(upper, n), denominator: below };
            upper > lower && positive_realness(&ratio) == PositiveRealness::StrictlyPositiveReal
        }
        // 1 + (a + b) Re H + a b |H|^2 > 0 for all b is Re H + a |H|^2 >= 0.
        UpperSlope::Any => {
            let ratio = TransferFunction { numerator: n.clone(), denominator: below };
            !matches!(positive_realness(&ratio), PositiveRealness::NotPositiveReal(_))
        }
    }
}

/// The range of constant slopes around zero at which the loop is stable \[N m s/rad\]; `None` if it
/// is not at zero.
#[must_use]
pub fn stable_slopes(h: &TransferFunction) -> Option<(f64, f64)> {
    let stable = |slope: f64| h.denominator.plus(slope, &h.numerator).is_hurwitz();
    stable(0.0).then(|| (-furthest(|slope| stable(-slope)), furthest(stable)))
}

/// The largest value up to which `holds`, from zero; infinity if it holds everywhere up to 1e9.
fn furthest(holds: impl Fn(f64) -> bool) -> f64 {
    let (mut inside, mut outside) = (0.0, 1e-6);
    while holds(outside) {
        if outside > 1e9 {
            return f64::INFINITY;
        }
        (inside, outside) = (outside, 2.0 * outside);
    }
    for _ in 0..60 {
        let middle = 0.5 * (inside + outside);
        if holds(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}

/// What is proven of the loop `h`.
#[must_use]
pub fn sector_margin(h: &TransferFunction) -> SectorMargin {
    let upper = furthest(|upper| is_proven(h, 0.0, UpperSlope::Finite(upper)));
    let upper_from_zero = if is_proven(h, 0.0, UpperSlope::Any) {
        Some(UpperSlope::Any)
    } else {
        (upper > 0.0).then_some(UpperSlope::Finite(upper))
    };
    SectorMargin {
        lowest_constant: stable_slopes(h).map_or(f64::INFINITY, |range| range.0),
        lowest_with_any_upper: (upper_from_zero == Some(UpperSlope::Any))
            .then(|| -furthest(|slope| is_proven(h, -slope, UpperSlope::Any))),
        upper_from_zero,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::LinearDrive;
    use crate::{DerivativeOn, LagGains, PiGains, PidGains, VelocityLaw};

    const R: f64 = 4.8426;

    fn h(law: LoopLaw) -> (LinearLoop, TransferFunction) {
        let linear = LinearLoop { drive: LinearDrive::THESIS, law };
        let h = friction_to_velocity(&linear, R).unwrap();
        (linear, h)
    }

    fn pi() -> LoopLaw {
        LoopLaw::Velocity(VelocityLaw::Pi(PiGains { k_p: 1.0, k_i: 20.0 }))
    }

    fn pid(k_i: f64) -> LoopLaw {
        LoopLaw::Position {
            gains: PidGains { k_i, ..PidGains::THESIS },
            derivative_on: DerivativeOn::Error,
            filter: 0.0,
        }
    }

    /// Velocity after `seconds` from 1 rad/s under the friction `f(t, w)`, relative to the largest
    /// before; continuous PI or PD with integral, small steps.
    fn decays(law: LoopLaw, f: impl Fn(f64, f64) -> f64, seconds: f64) -> bool {
        let LinearDrive { gain, time_constant } = LinearDrive::THESIS;
        let dt = 1e-5;
        let (mut w, mut position, mut integral) = (1.0, 0.0, 0.0);
        for k in 0..(seconds / dt) as usize {
            let u = match law {
                LoopLaw::Velocity(VelocityLaw::Pi(g)) => -g.k_p * w - g.k_i * position,
                LoopLaw::Position { gains, .. } => {
                    -gains.k_p * position - gains.k_i * integral - gains.k_d * w
                }
                LoopLaw::Velocity(VelocityLaw::Lag(_)) => unreachable!(),
            };
            let t = k as f64 * dt;
            w += dt / time_constant * (gain * (u - R * f(t, w)) - w);
            position += dt * w;
            integral += dt * position;
            if w.abs() > 1e3 {
                return false;
            }
        }
        w.abs() < 1e-3
    }

    /// `Re 1/H = (1/K + K_p) / r` at every frequency under a PI: the circle criterion is tight, and
    /// the closed form is the bound.
    #[test]
    fn the_lowest_slope_under_a_pi_is_proven_up_to_where_simulation_diverges() {
        let (_, h) = h(pi());
        let margin = sector_margin(&h);
        let closed_form = -(1.0 / 1.863 + 1.0) / R;
        assert!(
            (margin.lowest_with_any_upper.unwrap() / closed_form - 1.0).abs() < 1e-6,
            "{margin:?}"
        );
        assert!((margin.lowest_constant / closed_form - 1.0).abs() < 1e-6);
        assert_eq!(margin.upper_from_zero, Some(UpperSlope::Any));
        assert!(decays(pi(), |_, w| 0.98 * closed_form * w, 30.0));
        assert!(!decays(pi(), |_, w| 1.02 * closed_form * w, 30.0));
        // Any function in the sector, also one that changes with time.
        let wild = |t: f64, w: f64| {
            if (37.0 * t).sin() * w > 0.0 { 0.9 * closed_form * w } else { 0.5 * w }
        };
        assert!(decays(pi(), wild, 30.0));
    }

    /// The lag differs by the little that its pole leaves: `Re C` falls from `K_p / gamma` to
    /// `K_p`.
    #[test]
    fn the_thesis_lag_stands_friction_that_falls_by_up_to_0_42() {
        let (_, h) = h(LoopLaw::Velocity(VelocityLaw::Lag(LagGains::THESIS)));
        let margin = sector_margin(&h);
        let at_high_frequency = -(1.0 / 1.863 + 1.5136) / R;
        assert!(
            (margin.lowest_with_any_upper.unwrap() - at_high_frequency).abs() < 1e-6,
            "{margin:?}"
        );
        // The linear loop goes unstable at a slope lower by T gamma / (r K T_i).
        let further = at_high_frequency - 0.02388 * 0.0285 / (R * 1.863 * 0.0909);
        assert!((margin.lowest_constant / further - 1.0).abs() < 1e-6, "{margin:?} {further}");
    }

    /// A position loop with an integral is proven for finite slopes only; without one, for any.
    #[test]
    fn the_integral_of_a_position_loop_is_what_hunts() {
        let (_, with) = h(pid(10.0));
        let margin = sector_margin(&with);
        let Some(UpperSlope::Finite(upper)) = margin.upper_from_zero else { panic!("{margin:?}") };
        assert!(margin.lowest_with_any_upper.is_none() && upper > 0.1, "{margin:?}");
        assert!(is_proven(&with, 0.0, UpperSlope::Finite(0.999 * upper)));
        assert!(!is_proven(&with, 0.0, UpperSlope::Finite(1.001 * upper)));
        let changing =
            move |t: f64, w: f64| if (23.0 * t).sin() > 0.0 { 0.99 * upper * w } else { 0.0 };
        assert!(decays(pid(10.0), changing, 60.0));
        let (_, without) = h(pid(0.0));
        let lowest = -(1.0 / 1.863 + 0.0768) / R;
        assert!(
            (sector_margin(&without).lowest_with_any_upper.unwrap() / lowest - 1.0).abs() < 1e-6
        );
    }

    /// The constant slope at which a PID loses its linear stability is where simulation says.
    #[test]
    fn the_lowest_constant_slope_under_a_pid_is_where_simulation_diverges() {
        let (_, with) = h(pid(10.0));
        let lowest = stable_slopes(&with).unwrap().0;
        // Routh: T s^3 + (1 + K K_d + K r a) s^2 + K K_p s + K K_i.
        let routh = (0.02388 * 10.0 / 5.7517 - 1.0 / 1.0) / (1.863 * R) - 0.0768 / R;
        assert!((lowest / routh - 1.0).abs() < 1e-6, "{lowest} {routh}");
        assert!(decays(pid(10.0), |_, w| 0.9 * lowest * w, 20.0));
        assert!(!decays(pid(10.0), |_, w| 1.1 * lowest * w, 60.0));
    }
}
