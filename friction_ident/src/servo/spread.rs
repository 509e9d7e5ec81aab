//! What several searches of one data set say together: medians, quartiles, and which parameters
//! they agree on.
//!
//! The mean position error has many local minima of almost equal depth. A parameter that differs
//! from one to the next while the error does not is not determined by the data, whatever the
//! curvature at each of them says.

use super::parameter::ServoParameter;
use super::search::Found;
use crate::estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Verdict};

/// Errors within this fraction above the best count as equally good: leaving out one log of twelve
/// changes the mean by as much.
pub const EQUALLY_GOOD: f64 = 0.1;
/// Half the range over equally good fits, over the median, above which a parameter is not
/// identified.
const WIDE: f64 = 0.25;

/// The best search's parameters with their range over all searches whose error is within
/// [`EQUALLY_GOOD`] of the best.
///
/// The interval is that range; it is no confidence interval, but no honest one is narrower. `None`
/// where nothing was found.
pub fn estimates(parameters: &[ServoParameter], found: &[Found]) -> Option<Estimates> {
    let best = found
        .iter()
        .min_by(|a, b| a.error.total_cmp(&b.error))
        .filter(|best| best.error.is_finite())?;
    let equals: Vec<&Found> =
        found.iter().filter(|other| other.error <= best.error * (1.0 + EQUALLY_GOOD)).collect();
    let estimate = |(index, &parameter): (usize, &ServoParameter)| {
        let value = best.values.get(index).copied().unwrap_or(f64::NAN);
        let values = || equals.iter().filter_map(|other| other.values.get(index).copied());
        let (low, high) = values()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let (bottom, top) = parameter.bounds();
        let margin = 1e-3 * (top - bottom);
        // A value at zero says that the effect is absent. At any other bound the search wanted to
        // leave.
        let bound = [bottom, top]
            .into_iter()
            .find(|&bound| bound != 0.0 && (value - bound).abs() <= margin);
        let doubt = if let Some(bound) = bound {
            Some(Doubt::AtBound { bound })
        } else if 0.5 * (high - low) > WIDE * value.abs() {
            Some(Doubt::Scatter { low, high, fits: equals.len() })
        } else if equals.len() < 2 {
            Some(Doubt::Unrepeated)
        } else {
            None
        };
        let verdict = match doubt {
            Some(doubt) => Verdict::NotIdentifiable { doubt, remedy: parameter.remedy() },
            None => Verdict::Identified,
        };
        Estimate {
            id: parameter.name().into(),
            unit: parameter.unit(),
            value,
            standard_error: None,
            interval: Some(Interval { low, high, method: IntervalMethod::EquallyGoodFits }),
            verdict,
        }
    };
    let parameters: Vec<Estimate> = parameters.iter().enumerate().map(estimate).collect();
    Some(Estimates { parameters, ..Estimates::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fits_that_are_equally_good_but_differ_identify_nothing() {
        let parameters =
            [ServoParameter::TorqueConstant, ServoParameter::Coulomb, ServoParameter::Resistance];
        let fit =
            |values: [f64; 3], error| Found { values: values.to_vec(), error, evaluations: 1 };
        let found = [
            fit([0.40, 0.001, 5.0], 0.0340),
            fit([0.41, 0.010, 5.0], 0.0341),
            // Far from the best: it says nothing.
            fit([2.0, 0.001, 2.5], 0.05),
        ];
        let estimates = estimates(&parameters, &found).unwrap();
        assert!(estimates.parameters[0].is_identified());
        let doubt = |i: usize| match &estimates.parameters[i].verdict {
            Verdict::NotIdentifiable { doubt, .. } => doubt.clone(),
            other => panic!("{other:?}"),
        };
        assert_eq!(doubt(1), Doubt::Scatter { low: 0.001, high: 0.010, fits: 2 });
        assert_eq!(doubt(2), Doubt::AtBound { bound: 5.0 });
    }
}
