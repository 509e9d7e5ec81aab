//! How much smaller the errors become, as a distribution over the draws.

use friction_ident::statistics::{quantile, sorted};
use serde::Serialize;

use super::{Cell, Trial};

/// Percentiles of a sample, interpolated linearly between its ordered values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Percentiles {
    /// 5th.
    pub p5: f64,
    /// 25th.
    pub p25: f64,
    /// 50th.
    pub median: f64,
    /// 75th.
    pub p75: f64,
    /// 95th.
    pub p95: f64,
}

impl Percentiles {
    /// Of `values`; not numbers where there are none.
    #[must_use]
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let sorted = sorted(values);
        let at = |share: f64| quantile(&sorted, share).unwrap_or(f64::NAN);
        Self { p5: at(0.05), p25: at(0.25), median: at(0.5), p75: at(0.75), p95: at(0.95) }
    }
}

/// What an arm is worth, beside the linear controller alone under the same noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Worth {
    /// Mean square alone divided by mean square compensated.
    pub mse_ratio: Percentiles,
    /// Largest error alone divided by largest error compensated.
    pub max_error_ratio: Percentiles,
    /// Mean square, compensated [(rad/s)^2 or rad^2].
    pub mse: Percentiles,
    /// Share of the draws whose mean square is larger than that of the linear controller alone.
    pub worse: f64,
    /// Voltage [V, root mean square], median.
    pub effort: f64,
}

impl Cell {
    /// What the arm of that index is worth.
    #[must_use]
    pub fn worth(&self, arm: usize) -> Worth {
        let pairs: Vec<(Trial, Trial)> = self.pairs(arm).collect();
        let worse = pairs.iter().filter(|(alone, with)| with.mse > alone.mse).count();
        Worth {
            mse_ratio: Percentiles::of(pairs.iter().map(|(alone, with)| alone.mse / with.mse)),
            max_error_ratio: Percentiles::of(
                pairs.iter().map(|(alone, with)| alone.max_error / with.max_error),
            ),
            mse: Percentiles::of(pairs.iter().map(|(_, with)| with.mse)),
            worse: worse as f64 / pairs.len() as f64,
            effort: Percentiles::of(pairs.iter().map(|(_, with)| with.effort)).median,
        }
    }

    /// Mean square alone divided by mean square compensated, ordered.
    #[must_use]
    pub fn ratios(&self, arm: usize) -> Vec<f64> {
        sorted(self.pairs(arm).map(|(alone, with)| alone.mse / with.mse))
    }

    /// The most that any compensation without a plant inverse could be worth on the average: mean
    /// square alone divided by that without friction.
    #[must_use]
    pub fn ceiling(&self) -> f64 {
        self.worth(0).mse.median / self.floor.mse
    }

    /// The linear controller alone, and the arm, in each draw.
    fn pairs(&self, arm: usize) -> impl Iterator<Item = (Trial, Trial)> {
        self.draws.iter().filter_map(move |trials| Some((*trials.first()?, *trials.get(arm)?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_interpolate() {
        let values = Percentiles::of((0..=100).rev().map(f64::from));
        assert_eq!(
            (values.p5, values.p25, values.median, values.p75, values.p95),
            (5.0, 25.0, 50.0, 75.0, 95.0)
        );
        assert_eq!(Percentiles::of([1.0, 3.0]).median, 2.0);
        assert!((Percentiles::of([1.0, 3.0]).p5 - 1.1).abs() < 1e-12);
        assert!(Percentiles::of([]).median.is_nan());
    }
}
