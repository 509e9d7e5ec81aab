//! How far each period was from what it should be, exactly.

use friction_ident::statistics::nearest_rank;
use serde::Serialize;

/// Every period's error.
#[derive(Debug, Clone, Default)]
pub(super) struct PeriodErrors {
    nominal_ns: u64,
    errors_ns: Vec<u64>,
}

/// Percentiles of |period - nominal| \[us\], each the error of one cycle: at least that share of
/// the cycles has no larger one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct PeriodErrorSummary {
    pub(super) cycles: usize,
    pub(super) period_us: f64,
    pub(super) p50_us: f64,
    pub(super) p90_us: f64,
    pub(super) p99_us: f64,
    pub(super) p999_us: f64,
    pub(super) max_us: f64,
    /// Cycles that began a whole period late, or later.
    pub(super) late: usize,
    /// What the system said about the control thread's priority.
    pub(super) priority: String,
}

impl PeriodErrors {
    pub(super) fn new(period: f64) -> Self {
        Self { nominal_ns: (period * 1e9).round() as u64, errors_ns: Vec::new() }
    }

    /// Notes a period \[ns\]; zero is none.
    pub(super) fn note(&mut self, period_ns: u64) {
        if period_ns > 0 {
            self.errors_ns.push(period_ns.abs_diff(self.nominal_ns));
        }
    }

    pub(super) fn summary(mut self, priority: String) -> PeriodErrorSummary {
        self.errors_ns.sort_unstable();
        let all = &self.errors_ns;
        let at = |share| nearest_rank(all, share).map_or(0.0, |ns| ns as f64 * 1e-3);
        PeriodErrorSummary {
            cycles: all.len(),
            period_us: self.nominal_ns as f64 * 1e-3,
            p50_us: at(0.5),
            p90_us: at(0.9),
            p99_us: at(0.99),
            p999_us: at(0.999),
            max_us: at(1.0),
            late: all.len() - all.partition_point(|error| *error < self.nominal_ns),
            priority,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_errors_that_occurred() {
        let mut errors = PeriodErrors::new(1e-3);
        errors.note(0);
        // 1 us to 100 us, early and late in turns.
        for error in (1..=100u64).rev() {
            errors.note(if error % 2 == 0 {
                1_000_000 + error * 1000
            } else {
                1_000_000 - error * 1000
            });
        }
        let summary = errors.summary(String::new());
        assert_eq!((summary.cycles, summary.period_us), (100, 1000.0));
        let found =
            [summary.p50_us, summary.p90_us, summary.p99_us, summary.p999_us, summary.max_us];
        assert_eq!(found, [50.0, 90.0, 99.0, 100.0, 100.0]);
        assert_eq!(summary.late, 0);
        let mut late = PeriodErrors::new(1e-3);
        // A cycle comes early by as much as the one before it was late.
        [1_999_999, 2_000_000, 3_000_000, 1].into_iter().for_each(|period| late.note(period));
        assert_eq!(late.summary(String::new()).late, 2);
        assert_eq!(PeriodErrors::new(1e-3).summary(String::new()).p99_us, 0.0);
    }
}
