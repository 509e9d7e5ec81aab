//! The delay of the slip equation, and intervals that know it is not known.
//!
//! At each delay the equation is linear. The profile of its sum of squares over the delay gives the
//! delay and its interval. A parameter's interval is that of its own profile, for which the delay
//! is free: the union, over all delays within the limit, of what the limit leaves to the parameter
//! there (Bates and Watts 1988, Nonlinear Regression Analysis, section 6.1).

use super::{AtDelay, Sliding};
use crate::IdentError;
use crate::estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Verdict};
use crate::residual_whiteness::effective_share;
use crate::statistics::student_95;

/// Step of the profile \[samples\].
const STEP: f64 = 0.1;

const REMEDY: &str = "record motion that turns back and forth faster";

/// The fit at the delay that explains most, from none to `longest` \[samples\]; its parameters with
/// their profile intervals; the delay \[s\].
pub fn over_delays(
    sliding: &Sliding,
    longest: f64,
) -> Result<(AtDelay, Estimates, Estimate), IdentError> {
    let coarse = nearest(sliding, (0..=longest.floor() as usize).map(|delay| delay as f64))?;
    let fine = (-9..=9).map(|tenths| coarse.delay + f64::from(tenths) * STEP);
    let best = nearest(sliding, fine.filter(|delay| (0.0..=longest).contains(delay)))?;

    let unknowns = sliding.unknowns();
    let share = effective_share(best.minimum.residuals.as_slice());
    let mut estimates = Estimates::linearised(&best.minimum, &unknowns, share);
    let degrees = estimates.degrees_of_freedom as f64;
    let quantile = student_95(estimates.degrees_of_freedom);
    let limit = best.unexplained.powi(2) * (1.0 + quantile * quantile / degrees);

    let mut delays = [best.delay; 2];
    for (end, step) in delays.iter_mut().zip([-STEP, STEP]) {
        let mut inside = (best.delay, best.unexplained.powi(2));
        loop {
            let delay = (inside.0 + step).clamp(0.0, longest);
            if delay == inside.0 {
                break *end = delay;
            }
            let there = sliding.fit(delay)?;
            let level = there.unexplained.powi(2);
            if level >= limit {
                let rise = level - inside.1;
                let part = if rise > 0.0 { (limit - inside.1) / rise } else { 0.0 };
                break *end = inside.0 + part * (delay - inside.0);
            }
            inside = (delay, level);
            // What the limit leaves to each parameter at this delay.
            let left = (degrees * (limit / level.max(f64::MIN_POSITIVE) - 1.0)).sqrt();
            let here = Estimates::linearised(&there.minimum, &unknowns, share);
            for (estimate, here) in estimates.parameters.iter_mut().zip(&here.parameters) {
                if let (Some(interval), Some(error)) = (&mut estimate.interval, here.standard_error)
                {
                    interval.low = interval.low.min(here.value - left * error);
                    interval.high = interval.high.max(here.value + left * error);
                }
            }
        }
    }
    for estimate in &mut estimates.parameters {
        let Some(interval) = &mut estimate.interval else { continue };
        interval.method = IntervalMethod::Profile;
        let error = (interval.high - interval.low) / (2.0 * quantile);
        estimate.standard_error = Some(error);
        let relative_error = error / estimate.value.abs();
        let remedy =
            unknowns.iter().find(|unknown| unknown.id == estimate.id).map(|unknown| unknown.remedy);
        if let (Verdict::Identified, true, Some(remedy)) =
            (&estimate.verdict, relative_error > 0.5, remedy)
        {
            estimate.verdict =
                Verdict::NotIdentifiable { doubt: Doubt::LargeError { relative_error }, remedy };
        }
    }
    let delay = delay_estimate(best.delay, delays, longest, quantile, sliding.time_step);
    Ok((best, estimates, delay))
}

/// The fit that explains most.
fn nearest(sliding: &Sliding, delays: impl Iterator<Item = f64>) -> Result<AtDelay, IdentError> {
    let mut best: Option<AtDelay> = None;
    for delay in delays {
        let found = sliding.fit(delay)?;
        if best.as_ref().is_none_or(|best| found.unexplained < best.unexplained) {
            best = Some(found);
        }
    }
    best.ok_or_else(|| IdentError::NoConvergence("no delay was tried".to_owned()))
}

/// All delays in samples but the result, which is in seconds.
fn delay_estimate(
    best: f64,
    [low, high]: [f64; 2],
    longest: f64,
    quantile: f64,
    time_step: f64,
) -> Estimate {
    let error = (high - low) / (2.0 * quantile);
    let doubt = if best <= 0.0 || best >= longest {
        Some(Doubt::AtBound { bound: best * time_step })
    } else if high >= longest {
        Some(Doubt::OpenInterval)
    } else if error > 0.5 * best {
        Some(Doubt::LargeError { relative_error: error / best })
    } else {
        None
    };
    Estimate {
        id: "delay".into(),
        unit: "s",
        value: best * time_step,
        standard_error: Some(error * time_step),
        interval: Some(Interval {
            low: low * time_step,
            high: high * time_step,
            method: IntervalMethod::Profile,
        }),
        verdict: doubt.map_or(Verdict::Identified, |doubt| Verdict::NotIdentifiable {
            doubt,
            remedy: REMEDY,
        }),
    }
}
