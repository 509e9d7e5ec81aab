//! Errors of a fit along recordings, under coloured residuals and model error.

use super::linearised::is_large;
use super::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Verdict};
use crate::bounded::Minimum;
use crate::robust_covariance::{Course, robust_covariance};

/// Replaces errors, covariance and intervals by those of [`robust_covariance`], and says how far
/// the sum of squares may rise within the interval of each parameter. Estimates without such errors
/// keep none, and are not identified.
pub(crate) fn robust_errors(
    minimum: &Minimum,
    course: &Course,
    estimates: &mut Estimates,
) -> Vec<f64> {
    // What changes nothing has no error, and would leave the others without one.
    let acts = |&j: &usize| minimum.jacobian.column(j).norm_squared() > 0.0;
    let free: Vec<usize> =
        (0..minimum.x.len()).filter(|&j| !minimum.held[j]).filter(acts).collect();
    let jacobian = minimum.jacobian.select_columns(&free);
    let found = robust_covariance(&jacobian, minimum.residuals.as_slice(), course);
    let white = estimates.residual_deviation.powi(2);
    let mut rises = vec![f64::INFINITY; minimum.x.len()];
    let mut least = f64::INFINITY;
    for (a, &j) in free.iter().enumerate() {
        let Some(estimate) = estimates.parameters.get_mut(j) else { continue };
        let error = found.as_ref().and_then(|found| found.parameters.get(a));
        let Some(error) = error.filter(|error| error.standard_error.is_finite()) else {
            estimate.standard_error = None;
            estimate.interval = None;
            doubt(estimate, Doubt::LargeError { relative_error: f64::INFINITY });
            continue;
        };
        // The squared error per variance of the residual, (J^T J)^-1.
        let sensitivity = estimates.covariance[j][j] / white;
        let half = error.half_width();
        rises[j] = half * half / sensitivity;
        least = least.min(error.degrees_of_freedom);
        estimate.standard_error = Some(error.standard_error);
        let (low, high) = (estimate.value - half, estimate.value + half);
        estimate.interval = Some(Interval { low, high, method: IntervalMethod::Robust });
        let relative_error = error.standard_error / estimate.value.abs();
        let large = is_large(relative_error, half / error.standard_error);
        let was_large = matches!(
            estimate.verdict,
            Verdict::NotIdentifiable { doubt: Doubt::LargeError { .. }, .. }
        );
        if was_large && !large {
            estimate.verdict = Verdict::Identified;
        }
        if let Some(why) = error.doubt {
            doubt(estimate, Doubt::NotToBeTrusted { why: why.to_string() });
        }
        if large {
            doubt(estimate, Doubt::LargeError { relative_error });
        }
    }
    if let Some(found) = &found {
        for (a, &i) in free.iter().enumerate() {
            for (b, &j) in free.iter().enumerate() {
                estimates.covariance[i][j] = found.covariance[(a, b)];
            }
        }
        if least.is_finite() {
            estimates.degrees_of_freedom = least as usize;
        }
    }
    rises
}

fn doubt(estimate: &mut Estimate, doubt: Doubt) {
    if estimate.verdict == Verdict::Identified {
        let remedy = "a longer recording in which the motion shows the effect throughout";
        estimate.verdict = Verdict::NotIdentifiable { doubt, remedy };
    }
}
