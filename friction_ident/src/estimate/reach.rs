//! Intervals that must hold what another fit says.

use super::{Doubt, Estimate, Interval, IntervalMethod, Verdict};

/// Share of the value that an interval may reach to each side.
const WIDEST: f64 = 1.0;

impl Estimate {
    /// Widens the interval to what another fit says that is as good. One that has none, or is open
    /// there, stays as it is. An interval that reaches further than the value leaves nothing known of
    /// it, unless it may have either sign; `remedy` says what to measure then.
    pub fn reach(&mut self, low: f64, high: f64, remedy: &'static str) {
        let Some(interval) = self.interval else { return };
        if interval.low <= low && high <= interval.high {
            return;
        }
        let (low, high) = (interval.low.min(low), interval.high.max(high));
        self.interval = Some(Interval { low, high, method: IntervalMethod::Rivals });
        let farthest = (high - self.value).max(self.value - low);
        let wide = farthest > WIDEST * self.value.abs();
        if wide && !self.id.is_signed() && self.is_identified() {
            let doubt = Doubt::RivalsDisagree { low, high };
            self.verdict = Verdict::NotIdentifiable { doubt, remedy };
        }
    }

    /// The same for fits that find these `values`, and are no surer of them than this one is of its
    /// own.
    pub fn reach_around(&mut self, values: impl IntoIterator<Item = f64>, remedy: &'static str) {
        let Some(interval) = self.interval else { return };
        let (below, above) = (self.value - interval.low, interval.high - self.value);
        values.into_iter().for_each(|value| self.reach(value - below, value + above, remedy));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(name: &'static str) -> Estimate {
        let interval = Interval { low: 0.9, high: 1.1, method: IntervalMethod::Linearised };
        Estimate {
            interval: Some(interval),
            standard_error: Some(0.05),
            verdict: Verdict::Identified,
            ..Estimate::given(name, "N m", 1.0, "a test")
        }
    }

    #[test]
    fn an_interval_reaches_to_another_value_and_as_far_beyond() {
        let mut own = estimate("f_c");
        own.reach_around([1.05, 0.98], "more");
        let interval = own.interval.unwrap();
        assert!((interval.low - 0.88).abs() < 1e-12 && (interval.high - 1.15).abs() < 1e-12);
        assert!(own.is_identified());
        own.reach_around([2.5], "more");
        assert!(matches!(
            own.verdict,
            Verdict::NotIdentifiable { doubt: Doubt::RivalsDisagree { .. }, remedy: "more" }
        ));
        let mut offset = estimate("offset");
        offset.reach_around([-2.5], "more");
        assert!(offset.is_identified());
    }
}
