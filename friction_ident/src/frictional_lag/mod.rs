//! Frictional lag: sliding in one direction at varying speed.
//!
//! In gross sliding the proposed model and Xiong's are
//!
//! ```text
//! gamma' = (g(v) - gamma) / tau,   F = gamma + f_v v,   g(v) = f_c + (f_s - f_c) exp(-|v / v_s|^delta)
//! ```
//!
//! (thesis eqs. 4.41 and 4.42). The torque is linear in `f_c`, `f_s - f_c` and `f_v`; only `v_s`
//! and `tau` are not. [`fit_lag`] searches these two by variable projection (Golub and Pereyra
//! 1973, in Kaufman's form of 1975): each pass filters the recording once and leaves a handful of
//! sums. [`fit_relaxation`] does LuGre and GMS, whose states relax at a rate of their own.
//!
//! The filter integrates the lag exactly for the quintic through six neighbouring samples of `g`,
//! so the result does not depend on how the recording was simulated; a velocity with noise is
//! better smoothed before.

use serde::Serialize;

use crate::IdentError;
use crate::estimate::{Estimate, Estimates, Interval, Verdict};
use crate::profile::{Search, profile_interval, sum_limit};

mod coarse_sensor;
mod estimates;
mod filter;
mod pass;
mod point;
mod relaxation;
mod search;
mod start;
#[cfg(test)]
mod tests;

pub use coarse_sensor::fit_lag_of_coarse_torque;
use pass::Prepared;
pub use relaxation::{Relaxation, RelaxationFit, fit_relaxation};

/// One recording of sliding in one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LagRecording<'a> {
    /// Velocity \[rad/s or m/s\], of one sign throughout.
    pub velocity: &'a [f64],
    /// Friction torque at the same instants \[N m or N\]; positive opposes positive velocity.
    pub torque: &'a [f64],
    /// Sampling period \[s\].
    pub dt: f64,
}

/// State of the lag at the first sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum InitialLag {
    /// Sliding steadily at the first velocity: `gamma = g(v)`.
    #[default]
    Steady,
    /// At rest just before: `gamma = f_s`.
    Rest,
}

/// What is not estimated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LagOptions {
    /// Exponent of the Stribeck curve, 0.1 to 10.
    pub delta: f64,
    /// State at the first sample of each recording.
    pub initial: InitialLag,
    /// Samples at the beginning of each recording that drive the lag but are not fitted.
    pub settle: usize,
}

impl Default for LagOptions {
    fn default() -> Self {
        Self { delta: 2.0, initial: InitialLag::Steady, settle: 0 }
    }
}

/// Parameters of the lag.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LagValues {
    /// Static friction \[N m or N\].
    pub f_s: f64,
    /// Coulomb (kinetic) friction \[N m or N\].
    pub f_c: f64,
    /// Stribeck velocity \[rad/s or m/s\].
    pub v_s: f64,
    /// Viscous friction \[N m s/rad or N s/m\].
    pub f_v: f64,
    /// Time constant \[s\].
    pub tau: f64,
}

/// A fitted lag.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LagFit {
    /// Best values.
    pub values: LagValues,
    /// With errors, intervals and verdicts: `f_s`, `f_c`, `v_s`, `f_v`, `tau`.
    pub estimates: Estimates,
    /// Mean square of the residual \[(N m)^2 or N^2\].
    pub mse: f64,
    /// Samples fitted.
    pub samples: usize,
    /// Passes over the data.
    pub passes: usize,
}

/// Fewest samples of a recording.
const FEWEST: usize = 50;

/// Fits the lag of the proposed model or Xiong's to recordings of sliding in one direction, each at
/// any sampling period well below the lag's own time scale.
///
/// # Errors
/// [`IdentError::TooFewSamples`] below 50 samples a recording, [`IdentError::UnequalLengths`],
/// [`IdentError::NotFinite`], [`IdentError::TimeStep`], [`IdentError::Reversal`] where the velocity
/// is zero or changes its sign, [`IdentError::Exponent`], [`IdentError::ZeroForce`],
/// [`IdentError::TooFewSpeeds`] for a constant velocity, [`IdentError::NotFriction`] for a torque
/// that drives.
pub fn fit_lag(recordings: &[LagRecording], options: &LagOptions) -> Result<LagFit, IdentError> {
    let data = Prepared::new(recordings, options)?;
    Ok(search::fit(&data, false)?.0)
}

/// As [`fit_lag`], with errors that take the likeness of neighbouring residuals into account
/// ([`effective_share`](crate::residual_whiteness::effective_share)), and with intervals of `v_s`
/// and `tau` from the profile of the likelihood: some thirty passes more. An interval that stays
/// open makes its parameter not identifiable.
///
/// The intervals know of noise only. A torque in steps that the noise does not fill (deviation
/// below half a step) has a mean error besides, and `tau`'s interval then misses in one recording
/// of nine or more: [`fit_lag_of_coarse_torque`] takes it off.
///
/// # Errors
/// As [`fit_lag`].
pub fn fit_lag_with_profiles(
    recordings: &[LagRecording],
    options: &LagOptions,
) -> Result<LagFit, IdentError> {
    let data = Prepared::new(recordings, options)?;
    let (mut fit, share) = search::fit(&data, true)?;
    let limit = sum_limit(fit.mse * fit.samples as f64, fit.samples, 5, share);
    let best = [fit.values.v_s.ln(), fit.values.tau.ln()];
    for (j, name) in ["v_s", "tau"].into_iter().enumerate() {
        let (low, high) = data.range(j);
        let Some(estimate) = fit.estimates.get_mut(name) else { continue };
        let relative =
            estimate.standard_error.map_or(0.1, |error| error / estimate.value).clamp(1e-9, 1.0);
        let search = Search { best: best[j], step: relative, low, high, limit };
        // In the logarithm; the other one follows from trial to trial.
        let mut other = best[1 - j];
        let interval = profile_interval(&search, &mut |x| {
            let (sum, at) = search::held(&data, j, x, other, &mut fit.passes)?;
            other = at;
            Some(sum)
        });
        let ends = Interval {
            low: if interval.low <= low { 0.0 } else { interval.low.exp() },
            high: if interval.high >= high { f64::INFINITY } else { interval.high.exp() },
            ..interval
        };
        estimate.interval = Some(ends);
        if (ends.low == 0.0 || ends.high == f64::INFINITY) && estimate.is_identified() {
            estimate.verdict = Verdict::NotIdentifiable {
                doubt: crate::Doubt::OpenInterval,
                remedy: estimates::remedy(name),
            };
        }
    }
    Ok(fit)
}

impl LagFit {
    /// The estimate of `tau`.
    pub fn tau(&self) -> Option<&Estimate> {
        self.estimates.get("tau")
    }
}
