//! Errors of the periods of one block.

use friction_ident::statistics::nearest_rank;

/// Percentiles of |period - nominal| \[us\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PeriodErrors {
    pub(super) p50_us: f64,
    pub(super) p99_us: f64,
    /// Cycles that began a whole period late.
    pub(super) late: u64,
    /// The loop had real-time priority.
    pub(super) realtime: bool,
}

impl PeriodErrors {
    /// Of errors of a period, all in nanoseconds: each percentile is the error of one cycle.
    pub(super) fn of(mut errors: Vec<u64>, period: u64, realtime: bool) -> Self {
        errors.sort_unstable();
        let late = (errors.len() - errors.partition_point(|error| *error < period)) as u64;
        let at = |share| nearest_rank(&errors, share).map_or(0.0, |ns| ns as f64 * 1e-3);
        Self { p50_us: at(0.5), p99_us: at(0.99), late, realtime }
    }
}
