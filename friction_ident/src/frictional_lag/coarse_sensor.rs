//! The lag from a torque sensor of coarse steps.
//!
//! Rounding to steps of `q` behind noise of deviation `s` returns on average the torque `F` plus
//!
//! ```text
//! sum_k (-1)^k q / (pi k) exp(-2 (pi k s / q)^2) sin(2 pi k F / q)
//! ```
//!
//! (Widrow and Kollár 2008, Quantization Noise, chapter 4.) This mean error does not fall with the
//! number of samples. With the torque of a first fit it is known, and is taken off.

use std::f64::consts::PI;

use super::pass::Prepared;
use super::{LagFit, LagOptions, LagRecording, fit_lag, fit_lag_with_profiles};
use crate::IdentError;
use crate::estimate::{Doubt, Verdict};

/// Terms of the mean error.
const TERMS: i32 = 6;
/// Noise that fills a step, as a share of it.
const FILLED: f64 = 0.3;
/// Fits before the last one.
const ROUNDS: usize = 3;

/// As [`fit_lag_with_profiles`], for a torque that was rounded to multiples of `torque_step`
/// \[N m or N\]: the mean error of the rounding is computed from the torque of a fit and from the
/// noise, whose variance is the mean square of the residual less `torque_step^2 / 12`, and taken
/// off before the next fit.
///
/// Noise of a third of a step is enough for intervals that cover. With less the mean error hangs on
/// the last digits of the torque and of the noise: `tau` is then not identifiable
/// ([`Doubt::CoarseSensor`]), and its interval does not hold.
///
/// # Errors
/// As [`fit_lag`]; [`IdentError::Resolution`] unless the step is positive.
pub fn fit_lag_of_coarse_torque(
    recordings: &[LagRecording],
    options: &LagOptions,
    torque_step: f64,
) -> Result<LagFit, IdentError> {
    if !(torque_step > 0.0 && torque_step.is_finite()) {
        return Err(IdentError::Resolution(torque_step));
    }
    // The torque of the model is what was measured less the residual.
    let measured = Prepared::new(recordings, &LagOptions { settle: 0, ..*options })?;
    let mut corrected: Vec<Vec<f64>> =
        recordings.iter().map(|recording| recording.torque.to_vec()).collect();
    let mut noise = f64::INFINITY;
    for _ in 0..ROUNDS {
        let fit = fit_lag(&with_torques(recordings, &corrected), options)?;
        let variance = fit.mse - torque_step * torque_step / 12.0;
        let deviation = variance.max(0.0).sqrt();
        noise = noise.min(deviation);
        let values = fit.values;
        let [base_c, base_v] = measured.baseline;
        let linear = [values.f_c - base_c, values.f_s - values.f_c, values.f_v - base_v];
        let residuals = measured.residuals(values.v_s.ln(), values.tau.ln(), &linear);
        let mut residual = residuals.iter();
        for (corrected, recording) in corrected.iter_mut().zip(recordings) {
            let side = recording.velocity.first().map_or(1.0, |v| v.signum());
            for ((to, from), left) in
                corrected.iter_mut().zip(recording.torque).zip(residual.by_ref())
            {
                *to = from - mean_error(from - side * left, deviation, torque_step);
            }
        }
    }
    let mut fit = fit_lag_with_profiles(&with_torques(recordings, &corrected), options)?;
    let tau = fit.estimates.get_mut("tau");
    if let Some(tau) = tau.filter(|tau| noise < FILLED * torque_step && tau.is_identified()) {
        let doubt = Doubt::CoarseSensor { step: torque_step, noise };
        tau.verdict = Verdict::NotIdentifiable { doubt, remedy: super::estimates::remedy("tau") };
    }
    Ok(fit)
}

fn with_torques<'a>(
    recordings: &[LagRecording<'a>],
    torques: &'a [Vec<f64>],
) -> Vec<LagRecording<'a>> {
    recordings
        .iter()
        .zip(torques)
        .map(|(recording, torque)| LagRecording { torque, ..*recording })
        .collect()
}

/// Mean of the rounded torque less the torque.
fn mean_error(torque: f64, deviation: f64, step: f64) -> f64 {
    (1..=TERMS)
        .map(|k| {
            let n = f64::from(k);
            let damped = (-2.0 * (PI * n * deviation / step).powi(2)).exp();
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            sign * step / (PI * n) * damped * (2.0 * PI * n * torque / step).sin()
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::mean_error;

    /// Against the sum over all steps, each with its probability.
    #[test]
    fn the_mean_error_of_rounding_is_that_of_its_distribution() {
        let (step, deviation) = (0.01123, 0.004);
        for i in 0..20 {
            let torque = 0.09 + 0.0011 * f64::from(i);
            // Midpoint rule over the noise.
            let n = 200_000;
            let mean = (0..n)
                .map(|j| {
                    let z = -8.0 + 16.0 * (f64::from(j) + 0.5) / f64::from(n);
                    let density = (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
                    step * ((torque + deviation * z) / step).round() * density * 16.0 / f64::from(n)
                })
                .sum::<f64>();
            let got = mean_error(torque, deviation, step);
            assert!((got - (mean - torque)).abs() < 5e-7, "{torque}: {got} {}", mean - torque);
        }
    }
}
