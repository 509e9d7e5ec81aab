//! Several recordings of one drive.

use crate::estimate::{Estimate, Interval, IntervalMethod};
use crate::statistics::student_95;

/// One list of estimates from several: each quantity the mean of its identified values, weighted by
/// their variances; where the recordings differ by more than their errors say, the error grows by
/// the root of the reduced chi-square (Birge 1932). What no recording identifies stays as in the
/// first.
pub fn combine(recordings: &[Vec<Estimate>]) -> Vec<Estimate> {
    let Some((first, rest)) = recordings.split_first() else { return Vec::new() };
    if rest.is_empty() {
        return first.clone();
    }
    let mut names: Vec<&Estimate> = Vec::new();
    for estimate in recordings.iter().flatten() {
        if !names.iter().any(|known| known.id == estimate.id) {
            names.push(estimate);
        }
    }
    names.into_iter().map(|like| together(like, recordings)).collect()
}

fn together(like: &Estimate, recordings: &[Vec<Estimate>]) -> Estimate {
    let usable: Vec<(&Estimate, f64)> = recordings
        .iter()
        .flatten()
        .filter(|estimate| estimate.id == like.id && estimate.is_identified())
        .filter_map(|estimate| {
            Some((estimate, estimate.standard_error.filter(|error| *error > 0.0)?))
        })
        .collect();
    let Some((model, _)) = usable.first() else { return like.clone() };
    let n = usable.len();
    if n == 1 {
        return (*model).clone();
    }
    let weights: f64 = usable.iter().map(|(_, error)| error.powi(-2)).sum();
    let mean = usable.iter().map(|(estimate, error)| estimate.value * error.powi(-2)).sum::<f64>()
        / weights;
    let chi: f64 =
        usable.iter().map(|(estimate, error)| ((estimate.value - mean) / error).powi(2)).sum();
    let birge = (chi / (n - 1) as f64).sqrt().max(1.0);
    let error = birge / weights.sqrt();
    // Where the scatter decides, only the recordings count as degrees of freedom.
    let half = error * if birge > 1.0 { student_95(n - 1) } else { student_95(1000) };
    Estimate {
        value: mean,
        standard_error: Some(error),
        interval: Some(Interval {
            low: mean - half,
            high: mean + half,
            method: IntervalMethod::Linearised,
        }),
        ..(*model).clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Verdict;

    fn estimate(value: f64, error: f64) -> Vec<Estimate> {
        vec![Estimate {
            id: "gain".into(),
            unit: "1",
            value,
            standard_error: Some(error),
            interval: None,
            verdict: Verdict::Identified,
        }]
    }

    /// Weights 1 and 4: mean (1 + 4 * 1.1) / 5, error 1 / sqrt(5); values ten errors apart widen it
    /// by their scatter.
    #[test]
    fn precise_recordings_count_more_and_scatter_widens_the_error() {
        let both = combine(&[estimate(1.0, 1.0), estimate(1.1, 0.5)]);
        assert!((both[0].value - 1.08).abs() < 1e-12);
        assert!((both[0].standard_error.unwrap() - 0.2f64.sqrt()).abs() < 1e-12);
        let apart = combine(&[estimate(1.0, 0.1), estimate(2.0, 0.1)]);
        assert!((apart[0].standard_error.unwrap() - 0.5).abs() < 1e-12, "{apart:?}");
    }
}
