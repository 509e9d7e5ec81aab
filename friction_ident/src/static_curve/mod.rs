//! The Stribeck curve through steady points, by nonlinear least squares, with honest uncertainty.
//!
//! `F(v) = sgn(v) [f_c + (f_s - f_c) exp(-|v/v_s|^delta)] + f_v v`, odd in the velocity, `delta`
//! fixed (2).
//!
//! For a given `v_s` the curve is linear in the other three, so the start comes from a scan of
//! `v_s` over the measured speeds with a small linear fit at each, under `0 < f_c <= f_s` and
//! `f_v >= 0`. From the best of them Levenberg and Marquardt finish with the analytic Jacobian.
//! Where the data show no dip that is clear of the noise, or only one outside the measured speeds,
//! the result is Coulomb and viscous friction alone (`f_s = f_c`), and the parameters that have
//! lost their meaning say so: [`StribeckFit::estimate`] carries an [`Unidentifiable`] reason
//! instead of an interval.

use serde::Serialize;

use crate::IdentError;
use crate::estimate::Interval;
use crate::statistics::student_95;
use crate::steady_point::{Needed, check_points};

mod data;
mod estimates;
mod exponent;
mod fit;
mod intervals;
mod separable;
#[cfg(test)]
mod tests;

pub use crate::steady_point::SteadyPoint;
pub use exponent::{ExponentFit, fit_exponent};
pub use fit::fit_stribeck;

/// What is not estimated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StribeckOptions {
    /// Exponent of the curve, 0.1 to 10.
    pub delta: f64,
}

impl Default for StribeckOptions {
    fn default() -> Self {
        Self { delta: 2.0 }
    }
}

/// One of the four estimated parameters, in the order of the covariance matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
pub enum StribeckParameter {
    /// Static friction \[N m or N\].
    #[strum(serialize = "f_s")]
    StaticFriction,
    /// Coulomb (kinetic) friction \[N m or N\].
    #[strum(serialize = "f_c")]
    CoulombFriction,
    /// Stribeck velocity \[rad/s or m/s\].
    #[strum(serialize = "v_s")]
    StribeckVelocity,
    /// Viscous friction \[N m s/rad or N s/m\].
    #[strum(serialize = "f_v")]
    Viscous,
}

impl StribeckParameter {
    /// All four, in order: an array, because the covariance and what is made from it have four rows.
    pub const ALL: [Self; 4] =
        [Self::StaticFriction, Self::CoulombFriction, Self::StribeckVelocity, Self::Viscous];

    /// Name in files: `f_s`, `f_c`, `v_s`, `f_v`.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// The parameters of a Stribeck curve; always `0 < f_c <= f_s`, `v_s > 0`, `f_v >= 0`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StribeckValues {
    /// Static friction \[N m or N\].
    pub f_s: f64,
    /// Coulomb (kinetic) friction \[N m or N\].
    pub f_c: f64,
    /// Stribeck velocity \[rad/s or m/s\].
    pub v_s: f64,
    /// Viscous friction \[N m s/rad or N s/m\].
    pub f_v: f64,
    /// Exponent, not estimated.
    pub delta: f64,
}

impl StribeckValues {
    /// Friction at a velocity, zero at zero.
    pub fn torque(&self, velocity: f64) -> f64 {
        if velocity == 0.0 {
            return 0.0;
        }
        let dip = (self.f_s - self.f_c) * self.dip(velocity);
        velocity.signum() * (self.f_c + dip) + self.f_v * velocity
    }

    /// `exp(-|v/v_s|^delta)`.
    fn dip(&self, velocity: f64) -> f64 {
        (-(velocity / self.v_s).abs().powf(self.delta)).exp()
    }

    /// Derivatives of [`torque`](Self::torque) with respect to `f_s`, `f_c`, `v_s`, `f_v`.
    fn gradient(&self, velocity: f64) -> [f64; 4] {
        let sign = if velocity == 0.0 { 0.0 } else { velocity.signum() };
        let power = (velocity / self.v_s).abs().powf(self.delta);
        let dip = (-power).exp();
        // Where the exponential has vanished the power may be infinite; the product is zero all the
        // same.
        let slope = if dip > 0.0 { dip * power * self.delta / self.v_s } else { 0.0 };
        [sign * dip, sign * (1.0 - dip), sign * (self.f_s - self.f_c) * slope, velocity]
    }

    fn get(&self, parameter: StribeckParameter) -> f64 {
        [self.f_s, self.f_c, self.v_s, self.f_v][parameter as usize]
    }
}

/// Why the data do not determine a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, thiserror::Error)]
#[serde(tag = "reason", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Unidentifiable {
    /// The standard error is more than half the value.
    #[error("its standard error is {}", crate::estimate::of_its_value(*relative_error))]
    LargeError {
        /// Standard error over value.
        relative_error: f64,
    },
    /// The dip `f_s - f_c` is less than three of its standard errors, so that it may not be there
    /// at all.
    #[error(
        "the dip f_s - f_c = {dip:.3e} is not clear of its standard error {standard_error:.3e}"
    )]
    NoDip {
        /// `f_s - f_c`.
        dip: f64,
        /// Its standard error; zero where the best fit has no dip.
        standard_error: f64,
    },
    /// The Stribeck velocity lies outside the measured speeds.
    #[error("the dip lies outside the measured speeds, {slowest} to {fastest}")]
    OutsideSpeeds {
        /// Slowest measured speed.
        slowest: f64,
        /// Fastest measured speed.
        fastest: f64,
    },
    /// The interval of the Stribeck velocity has no end on one side: the data fit about as well
    /// without a dip among the measured speeds.
    #[error(
        "its interval, {low:.3e} to {high:.3e}, has no end: the data fit about as well without a dip among the measured speeds"
    )]
    OpenInterval {
        /// Lower end; zero where it is open.
        low: f64,
        /// Upper end; infinite where it is open.
        high: f64,
    },
    /// The best value allowed is the bound itself.
    #[error("the best value lies at its bound {bound}")]
    AtBound {
        /// The bound.
        bound: f64,
    },
}

/// One parameter with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StribeckEstimate {
    /// Which one.
    pub parameter: StribeckParameter,
    /// Best value; without a visible dip `f_s` is `f_c` and `v_s` a placeholder. Always safe to
    /// compute with.
    pub value: f64,
    /// Standard error, absent for a parameter held by a bound.
    pub standard_error: Option<f64>,
    /// 95 % interval from the profile of the likelihood; an end that the data leave open is zero or
    /// infinite. Absent for a viscous term held at zero.
    pub interval: Option<(f64, f64)>,
    /// Why the data do not determine the parameter, if they do not.
    pub unidentifiable: Option<Unidentifiable>,
}

/// A fitted Stribeck curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StribeckFit {
    /// The best parameters.
    pub parameters: StribeckValues,
    /// Standard errors of `f_s`, `f_c`, `v_s`, `f_v`; none for a parameter held by a bound.
    pub standard_errors: [Option<f64>; 4],
    /// Covariance of `f_s`, `f_c`, `v_s`, `f_v`; zero for a parameter held by a bound, and without
    /// a dip `f_s` moves with `f_c`.
    pub covariance: [[f64; 4]; 4],
    /// 95 % intervals of `f_s`, `f_c`, `v_s`, `f_v` from the profile of the likelihood.
    pub intervals: [Option<Interval>; 4],
    /// Variance of a torque of weight one \[(N m)^2 or N^2\].
    pub variance: f64,
    /// Mean square of the residual, sum of squares over the number of points \[(N m)^2 or N^2\].
    pub mse: f64,
    /// Points fitted.
    pub points: usize,
    /// Points minus free parameters.
    pub degrees_of_freedom: usize,
    /// Slowest and fastest measured speed.
    pub speeds: (f64, f64),
    /// Why each parameter is not determined, if it is not.
    pub unidentifiable: [Option<Unidentifiable>; 4],
}

impl StribeckFit {
    /// Friction of the fitted curve at a velocity.
    pub fn torque(&self, velocity: f64) -> f64 {
        self.parameters.torque(velocity)
    }

    /// Standard error of the fitted curve at a velocity, from the covariance of the parameters.
    pub fn standard_error(&self, velocity: f64) -> f64 {
        let gradient = self.parameters.gradient(velocity);
        let mut variance = 0.0;
        for (row, left) in self.covariance.iter().zip(gradient) {
            variance += row.iter().zip(gradient).map(|(c, right)| left * c * right).sum::<f64>();
        }
        variance.max(0.0).sqrt()
    }

    /// Lower and upper edge of the 95 % confidence band of the curve at a velocity: where the curve
    /// lies, not where single measurements scatter.
    pub fn band(&self, velocity: f64) -> (f64, f64) {
        let centre = self.torque(velocity);
        let half = student_95(self.degrees_of_freedom) * self.standard_error(velocity);
        (centre - half, centre + half)
    }

    /// One parameter with its uncertainty.
    pub fn estimate(&self, parameter: StribeckParameter) -> StribeckEstimate {
        let value = self.parameters.get(parameter);
        let standard_error = self.standard_errors[parameter as usize];
        StribeckEstimate {
            parameter,
            value,
            standard_error,
            interval: self.intervals[parameter as usize]
                .map(|interval| (interval.low, interval.high)),
            unidentifiable: self.unidentifiable[parameter as usize],
        }
    }

    /// All four estimates, in order.
    pub fn estimates(&self) -> [StribeckEstimate; 4] {
        StribeckParameter::ALL.map(|parameter| self.estimate(parameter))
    }

    /// Correlation of two parameters, -1 to 1; none where one of them is held by a bound.
    pub fn correlation(&self, a: StribeckParameter, b: StribeckParameter) -> Option<f64> {
        let (a, b) = (a as usize, b as usize);
        Some(self.covariance[a][b] / (self.standard_errors[a]? * self.standard_errors[b]?))
    }
}

/// Checks the points and returns the slowest and fastest speed.
fn check(points: &[SteadyPoint], options: &StribeckOptions) -> Result<(f64, f64), IdentError> {
    if !(0.1..=10.0).contains(&options.delta) {
        return Err(IdentError::Exponent(options.delta));
    }
    check_points(points, &Needed { what: "a Stribeck curve", points: 8, speeds: 5, lower: None })
}
