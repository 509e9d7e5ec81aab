//! What several searches of one data set, and searches of disjoint halves of it, say together.
//!
//! The mean position error has many local minima of almost equal depth. A parameter that differs
//! from one to the next while the error does not is not determined by the data, whatever the
//! curvature at each of them says. And seeds that agree say nothing of the noise: that is what the
//! halves of the recordings are for.

use super::fit_quality::FitQuality;
use super::search::Found;
use super::space::Free;
use crate::estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Verdict};
use crate::statistics::student_95;

/// Errors within this fraction above the best count as equally good: leaving out one log of twelve
/// changes the mean by as much.
pub const EQUALLY_GOOD: f64 = 0.1;
/// Half a range over the value above which a parameter is not identified: of fits that should
/// agree, or of a 95 % interval as two standard errors.
const WIDE: f64 = 0.25;
/// Half a 95 % interval over the value above which a parameter is not identified.
const WIDE_INTERVAL: f64 = 0.5;

/// The best search's parameters, each with its 95 % interval.
///
/// The interval comes from `halves`, the fits of disjoint halves of the recordings
/// ([`half_samples`](super::half_samples())): standard error from their differences, in the
/// coordinate that the search uses, Student's factor for as many degrees of freedom as splits. It
/// is never narrower than the range of the searches that fit equally well. Without halves it is
/// that range, and nothing is identified. A fit that has failed identifies nothing either.
///
/// `None` where nothing was found.
pub fn estimates(
    free: &[Free],
    found: &[Found],
    halves: &[[Found; 2]],
    quality: &FitQuality,
) -> Option<Estimates> {
    let best = found
        .iter()
        .min_by(|a, b| a.error.total_cmp(&b.error))
        .filter(|best| best.error.is_finite())?;
    let equals: Vec<&Found> =
        found.iter().filter(|other| other.error <= best.error * (1.0 + EQUALLY_GOOD)).collect();
    let failed = quality.doubt().is_some();
    let estimate = |(index, free): (usize, &Free)| {
        let at = |found: &Found| found.values.get(index).copied();
        let value = at(best).unwrap_or(f64::NAN);
        let (seeds_low, seeds_high) = range(equals.iter().filter_map(|other| at(other)));
        let pairs: Vec<[f64; 2]> =
            halves.iter().filter_map(|[a, b]| Some([at(a)?, at(b)?])).collect();
        let (low, high, method, standard_error) = if pairs.is_empty() {
            (seeds_low, seeds_high, IntervalMethod::EquallyGoodFits, None)
        } else {
            let place = free.place_of(value);
            let squares: f64 =
                pairs.iter().map(|[a, b]| (free.place_of(*a) - free.place_of(*b)).powi(2)).sum();
            let error = 0.5 * (squares / pairs.len() as f64).sqrt();
            let reach = student_95(pairs.len()) * error;
            let low = free.value_at((place - reach).max(0.0)).min(seeds_low);
            let high = free.value_at((place + reach).min(1.0)).max(seeds_high);
            let width =
                free.value_at((place + error).min(1.0)) - free.value_at((place - error).max(0.0));
            (low, high, IntervalMethod::HalfSamples, Some(0.5 * width))
        };
        let margin = 1e-3 * (free.high - free.low);
        // A value at zero says that the effect is absent. At any other bound the search wanted to
        // leave.
        let bound = [free.low, free.high]
            .into_iter()
            .find(|&bound| bound != 0.0 && (value - bound).abs() <= margin);
        let too_far = |[a, b]: &&[f64; 2]| 0.5 * (a - b).abs() > WIDE * value.abs();
        let doubt = if failed {
            Some(Doubt::FailedFit)
        } else if let Some(bound) = bound {
            Some(Doubt::AtBound { bound })
        } else if 0.5 * (seeds_high - seeds_low) > WIDE * value.abs() {
            Some(Doubt::Scatter { low: seeds_low, high: seeds_high, fits: equals.len() })
        } else if pairs.is_empty() {
            Some(Doubt::Unrepeated)
        } else if pairs.iter().any(|pair| too_far(&pair)) {
            let (low, high) = range(pairs.iter().flatten().copied());
            Some(Doubt::HalvesDisagree { low, high })
        } else if 0.5 * (high - low) > WIDE_INTERVAL * value.abs() {
            let relative_error = standard_error.unwrap_or(f64::NAN) / value.abs();
            Some(Doubt::WideInterval { relative_error })
        } else {
            None
        };
        let verdict = match doubt {
            Some(doubt) => Verdict::NotIdentifiable { doubt, remedy: free.parameter.remedy() },
            None => Verdict::Identified,
        };
        Estimate {
            id: free.parameter.name().into(),
            unit: free.parameter.unit(),
            value,
            standard_error,
            interval: Some(Interval { low, high, method }),
            verdict,
        }
    };
    let parameters: Vec<Estimate> = free.iter().enumerate().map(estimate).collect();
    Some(Estimates { parameters, ..Estimates::default() })
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

#[cfg(test)]
mod tests {
    use super::super::parameter::ServoParameter;
    use super::super::space::usual;
    use super::*;

    const GOOD: FitQuality = FitQuality { error: 0.03, motion: 0.5, goal: 0.1 };

    fn fit(values: [f64; 3], error: f64) -> Found {
        Found { values: values.to_vec(), error, evaluations: 1 }
    }

    fn free() -> Vec<Free> {
        use ServoParameter::{Coulomb, Resistance, TorqueConstant};
        usual(&[TorqueConstant, Coulomb, Resistance])
    }

    fn doubt(estimates: &Estimates, index: usize) -> Doubt {
        match &estimates.parameters[index].verdict {
            Verdict::NotIdentifiable { doubt, .. } => doubt.clone(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn fits_that_are_equally_good_but_differ_identify_nothing() {
        let found = [
            fit([0.40, 0.001, 5.0], 0.0340),
            fit([0.41, 0.010, 5.0], 0.0341),
            // Far from the best: it says nothing.
            fit([2.0, 0.001, 2.5], 0.05),
        ];
        let halves = vec![[found[0].clone(), found[1].clone()]; 4];
        let estimates = estimates(&free(), &found, &halves, &GOOD).unwrap();
        assert!(estimates.parameters[0].is_identified());
        assert_eq!(doubt(&estimates, 1), Doubt::Scatter { low: 0.001, high: 0.010, fits: 2 });
        assert_eq!(doubt(&estimates, 2), Doubt::AtBound { bound: 5.0 });
    }

    #[test]
    fn seeds_that_agree_say_nothing_where_the_halves_disagree() {
        let found = [fit([0.40, 0.05, 3.0], 0.03), fit([0.40, 0.05, 3.0], 0.03)];
        let half = [fit([0.30, 0.05, 3.1], 0.02), fit([0.60, 0.052, 2.9], 0.02)];
        let halves = vec![half; 4];
        let told = estimates(&free(), &found, &halves, &GOOD).unwrap();
        assert_eq!(doubt(&told, 0), Doubt::HalvesDisagree { low: 0.30, high: 0.60 });
        assert!(told.parameters[1].is_identified() && told.parameters[2].is_identified());
        let interval = told.parameters[2].interval.unwrap();
        assert!(interval.low < 2.8 && interval.high > 3.2, "{interval:?}");
        // A single recording has no halves: nothing confirms its values.
        let alone = estimates(&free(), &found, &[], &GOOD).unwrap();
        assert_eq!(doubt(&alone, 2), Doubt::Unrepeated);
        // Nor does a fit that has failed identify anything.
        let failed = FitQuality { error: 0.5, ..GOOD };
        let told = estimates(&free(), &found, &halves, &failed).unwrap();
        assert!((0..3).all(|i| doubt(&told, i) == Doubt::FailedFit));
    }
}
