//! A figure over repetitions, with its uncertainty in two parts.

use friction_ident::statistics::{Sample, quantile, sorted};
use serde::Serialize;

/// One figure with its scatter over the repetitions.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measured {
    /// Mean over the repetitions.
    pub mean: f64,
    /// Lower quartile, median and upper quartile of the repetitions.
    pub quartiles: [f64; 3],
    /// Standard error of the mean by what differs between repetitions; none for a single one.
    pub standard_error: Option<f64>,
    /// Standard deviation by what is the same in all of them, the drive's constants; zero with a
    /// torque sensor.
    pub systematic: f64,
    /// Repetitions.
    pub repetitions: u32,
}

impl Measured {
    /// Sums up repetitions, each a value and its systematic part; `None` without any.
    #[must_use]
    pub fn of(values: &[(f64, f64)]) -> Option<Self> {
        let n = values.len() as f64;
        let sorted = sorted(values.iter().map(|value| value.0));
        let sample = Sample::of(sorted.iter().copied());
        Some(Self {
            mean: sample.mean,
            quartiles: [
                quantile(&sorted, 0.25)?,
                quantile(&sorted, 0.5)?,
                quantile(&sorted, 0.75)?,
            ],
            standard_error: sample.uncertain_mean().map(|mean| mean.standard_error),
            systematic: values.iter().map(|value| value.1).sum::<f64>() / n,
            repetitions: values.len() as u32,
        })
    }

    /// Half the distance of the quartiles.
    #[must_use]
    pub const fn half_spread(&self) -> f64 {
        0.5 * (self.quartiles[2] - self.quartiles[0])
    }

    /// Standard error and systematic part together.
    #[must_use]
    pub fn uncertainty(&self) -> f64 {
        self.standard_error.unwrap_or(0.0).hypot(self.systematic)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_and_errors_of_a_small_sample() {
        let found = Measured::of(&[(4.0, 0.1), (1.0, 0.3), (2.0, 0.2), (3.0, 0.2)]).unwrap();
        assert_eq!((found.mean, found.quartiles), (2.5, [1.75, 2.5, 3.25]));
        // Standard deviation sqrt(5/3), over sqrt(4).
        assert!((found.standard_error.unwrap() - (5.0f64 / 12.0).sqrt()).abs() < 1e-12);
        assert!((found.systematic - 0.2).abs() < 1e-12);
        assert_eq!(Measured::of(&[(1.0, 0.0)]).unwrap().standard_error, None);
        assert!(Measured::of(&[]).is_none());
    }
}
