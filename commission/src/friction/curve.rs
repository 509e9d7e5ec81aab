//! The curve in volts, fitted.

use friction_ident::statistics::student_95;
use friction_ident::{SteadyPoint, StribeckOptions, StribeckParameter, fit_stribeck};
use serde::{Deserialize, Serialize};

use super::Point;
use crate::{CommissionError, Ranged, Stage};

/// No voltage is known better than this share of it, whatever the scatter: gain and steps of the
/// converter and the ripple of the speed do not average out.
const KNOWN: f64 = 1e-3;
/// A dip ends below this share of the fastest speed that the rig can have: what bends farther up is
/// another friction.
pub(super) const SLOW: f64 = 0.3;
/// A dip is at least this share of the kinetic level: less is no matter for a compensation.
const DEEP: f64 = 0.02;

/// `u(v) = f_c + (f_s - f_c) exp(-(v/v_s)^2) + slope v` for `v` above zero, odd.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Static friction \[V\].
    pub f_s: Ranged,
    /// Coulomb friction \[V\].
    pub f_c: Ranged,
    /// Stribeck velocity [rad/s].
    pub v_s: Ranged,
    /// Back-EMF and viscous friction together, 1/K \[V s/rad\].
    pub slope: Ranged,
    /// Whether a dip of the curve is clear of the noise.
    pub dips: bool,
    /// Standard deviation of a point around the curve \[V\].
    pub deviation: f64,
    /// What acts in one direction whichever way the shaft turns, mean \[V\].
    pub one_way: f64,
}

impl Curve {
    /// The curve through the points; where no dip is clear of them, the straight line. The rig can
    /// turn as fast as `able` [rad/s], whether or not a point is there.
    ///
    /// # Errors
    /// [`CommissionError::Identification`] if they are too few or no friction.
    pub fn of(points: &[Point], able: f64) -> Result<Self, CommissionError> {
        Self::known_to(points, able, KNOWN)
    }

    /// The same with no interval narrower than that `share` of its value.
    ///
    /// # Errors
    /// As for [`of`](Self::of).
    pub(super) fn known_to(
        points: &[Point],
        able: f64,
        share: f64,
    ) -> Result<Self, CommissionError> {
        let steady: Vec<SteadyPoint> =
            points.iter().map(|point| SteadyPoint::new(point.velocity, point.volts)).collect();
        let fit = fit_stribeck(&steady, &StribeckOptions::default())
            .map_err(|source| CommissionError::Identification { stage: Stage::Friction, source })?;
        let ranged = |parameter| {
            let found = fit.estimate(parameter);
            // What the data do not determine has no interval to rely on.
            let (low, high) = found
                .interval
                .filter(|_| found.unidentifiable.is_none())
                .unwrap_or((f64::NAN, f64::NAN));
            Ranged::new(found.value, low, high).at_least(share)
        };
        let v_s = fit.estimate(StribeckParameter::StribeckVelocity);
        let fastest = points.iter().map(|point| point.velocity).fold(able, f64::max);
        let f_s = ranged(StribeckParameter::StaticFriction);
        let dips = v_s.unidentifiable.is_none()
            && v_s.value < SLOW * fastest
            && f_s.value > (1.0 + DEEP) * fit.parameters.f_c
            && f_s.low.is_some_and(|low| low > fit.parameters.f_c);
        if let (false, Some(straight)) = (dips, Self::straight(points)) {
            return Ok(straight);
        }
        Ok(Self {
            f_s,
            f_c: ranged(StribeckParameter::CoulombFriction),
            v_s: ranged(StribeckParameter::StribeckVelocity),
            slope: ranged(StribeckParameter::Viscous),
            dips,
            deviation: fit.variance.sqrt(),
            one_way: points.iter().map(|point| point.one_way).sum::<f64>() / points.len() as f64,
        })
    }

    /// The straight line through the points: Coulomb and viscous friction, without a dip. None where
    /// they do not lie on a line of friction.
    #[must_use]
    pub fn straight(points: &[Point]) -> Option<Self> {
        let n = points.len() as f64;
        let mean = |of: fn(&Point) -> f64| points.iter().map(of).sum::<f64>() / n;
        let (velocity, volts) = (mean(|point| point.velocity), mean(|point| point.volts));
        let sum = |of: &dyn Fn(&Point) -> f64| points.iter().map(of).sum::<f64>();
        let spread = sum(&|p| (p.velocity - velocity).powi(2));
        let slope = sum(&|p| (p.velocity - velocity) * (p.volts - volts)) / spread;
        let f_c = volts - slope * velocity;
        if points.len() < 3 || !(f_c > 0.0 && slope > 0.0 && slope.is_finite()) {
            return None;
        }
        let squares = sum(&|p| (p.volts - f_c - slope * p.velocity).powi(2));
        let deviation = (squares / (n - 2.0)).sqrt();
        let around = |value: f64, share: f64| {
            let half = student_95(points.len() - 2) * deviation * share.sqrt();
            Ranged::new(value, value - half, value + half).at_least(KNOWN)
        };
        let f_c = around(f_c, 1.0 / n + velocity * velocity / spread);
        Some(Self {
            f_s: f_c,
            f_c,
            v_s: Ranged::new(velocity, f64::NAN, f64::NAN),
            slope: around(slope, 1.0 / spread),
            dips: false,
            deviation,
            one_way: mean(|point| point.one_way),
        })
    }

    /// The voltage at a speed above zero \[V\].
    #[must_use]
    pub fn volts(&self, velocity: f64) -> f64 {
        let dip = (self.f_s.value - self.f_c.value) * (-(velocity / self.v_s.value).powi(2)).exp();
        self.f_c.value + dip + self.slope.value * velocity
    }
}
