//! How regular the loop is: periods and execution times in buckets, without allocation once made.

use serde::Serialize;

/// Buckets of one microsecond, up to 20 ms; what is longer goes into the last.
const BUCKETS: usize = 20_000;

/// Percentiles of a duration \[us\], to one microsecond.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Percentiles {
    /// Half are at most this long \[us\].
    pub p50: f64,
    /// 99 % are at most this long \[us\].
    pub p99: f64,
    /// 99.9 % are at most this long \[us\].
    pub p999: f64,
    /// The longest \[us\], exact.
    pub max: f64,
}

/// Durations in buckets.
#[derive(Debug, Clone)]
struct Histogram {
    buckets: Box<[u64]>,
    count: u64,
    max_ns: u64,
}

impl Histogram {
    fn new() -> Self {
        Self { buckets: vec![0; BUCKETS].into_boxed_slice(), count: 0, max_ns: 0 }
    }

    fn add(&mut self, ns: u64) {
        let bucket = usize::try_from(ns / 1000).unwrap_or(BUCKETS).min(BUCKETS - 1);
        self.buckets[bucket] += 1;
        self.count += 1;
        self.max_ns = self.max_ns.max(ns);
    }

    fn clear(&mut self) {
        self.buckets.fill(0);
        (self.count, self.max_ns) = (0, 0);
    }

    /// Zeros if there are no durations.
    fn percentiles(&self) -> Percentiles {
        let max = self.max_ns as f64 * 1e-3;
        let at = |fraction: f64| {
            let rank = (self.count as f64 * fraction).ceil().max(1.0) as u64;
            let mut seen = 0;
            for (bucket, count) in self.buckets.iter().enumerate() {
                seen += count;
                if seen >= rank {
                    // The upper edge of the bucket: at most this long. The last bucket has none.
                    return if bucket == BUCKETS - 1 { max } else { max.min(bucket as f64 + 1.0) };
                }
            }
            0.0
        };
        Percentiles { p50: at(0.5), p99: at(0.99), p999: at(0.999), max }
    }
}

/// How regular the loop was.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Timing {
    /// Cycles run.
    pub cycles: u64,
    /// From the start of a cycle to the start of the next.
    pub period: Percentiles,
    /// From the start of a cycle to its end.
    pub execution: Percentiles,
    /// Cycles that started a whole period late or more.
    pub overruns: u64,
}

/// Collects [`Timing`].
#[derive(Debug)]
pub struct Stopwatch {
    period: Histogram,
    execution: Histogram,
    cycles: u64,
}

impl Default for Stopwatch {
    fn default() -> Self {
        Self::new()
    }
}

impl Stopwatch {
    /// One that has seen nothing.
    #[must_use]
    pub fn new() -> Self {
        Self { period: Histogram::new(), execution: Histogram::new(), cycles: 0 }
    }

    /// Notes a cycle. `period_ns` is zero for the first.
    pub fn note(&mut self, period_ns: u64, execution_ns: u64) {
        if period_ns > 0 {
            self.period.add(period_ns);
        }
        self.execution.add(execution_ns);
        self.cycles += 1;
    }

    /// Forgets what it has seen.
    pub fn clear(&mut self) {
        self.period.clear();
        self.execution.clear();
        self.cycles = 0;
    }

    /// What it has seen.
    #[must_use]
    pub fn timing(&self, overruns: u64) -> Timing {
        Timing {
            cycles: self.cycles,
            period: self.period.percentiles(),
            execution: self.execution.percentiles(),
            overruns,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_upper_edges_and_the_longest_is_exact() {
        let mut histogram = Histogram::new();
        for microsecond in 0..1000 {
            histogram.add(microsecond * 1000 + 500);
        }
        let expected = Percentiles { p50: 500.0, p99: 990.0, p999: 999.0, max: 999.5 };
        assert_eq!(histogram.percentiles(), expected);
        histogram.add(3_000_000_000);
        assert_eq!(histogram.percentiles().max, 3e6);
    }

    #[test]
    fn nothing_measured_is_zero() {
        assert_eq!(Histogram::new().percentiles(), Percentiles::default());
    }

    #[test]
    fn the_first_cycle_has_no_period() {
        let mut stopwatch = Stopwatch::new();
        stopwatch.note(0, 10_000);
        stopwatch.note(1_000_000, 10_000);
        let timing = stopwatch.timing(3);
        assert_eq!((timing.cycles, timing.overruns), (2, 3));
        assert_eq!(timing.period.p50, 1000.0);
        stopwatch.clear();
        assert_eq!(stopwatch.timing(0), Timing::default());
    }
}
