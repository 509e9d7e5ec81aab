//! Estimates as a person reads them, a row each.

use friction_ident::{Estimate, Verdict};
use report::numbers::value_and_error as with_error;

use crate::verdict::said;

/// Name, value, unit, 95 % interval and verdict of each estimate.
#[must_use]
pub fn rows(estimates: &[Estimate]) -> Vec<[String; 5]> {
    estimates
        .iter()
        .map(|estimate| {
            let error =
                estimate.standard_error.filter(|error| error.is_finite()).unwrap_or(f64::NAN);
            let (value, _) = with_error(estimate.value, error);
            let value = if estimate.value.is_nan() { "unknown".to_owned() } else { value };
            let end = |end: f64| {
                if end.is_finite() { with_error(end, error).0 } else { "open".to_owned() }
            };
            let interval = match estimate.interval {
                Some(interval) => format!("[{}, {}]", end(interval.low), end(interval.high)),
                None => "no interval".to_owned(),
            };
            let verdict = match &estimate.verdict {
                Verdict::Identified => "identified".to_owned(),
                Verdict::NotIdentifiable { doubt, remedy } => {
                    format!("{}; needs {remedy}", said(estimate, doubt))
                }
                Verdict::Given { source } => format!("given: {source}"),
            };
            [estimate.id.to_string(), value, estimate.unit.to_owned(), interval, verdict]
        })
        .collect()
}
