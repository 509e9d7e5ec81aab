//! A value with its 95 % interval.

use friction_ident::statistics::student_95;
use serde::{Deserialize, Serialize};

/// A value and its 95 % interval; an end that the data leave open is left out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ranged {
    /// Best value.
    pub value: f64,
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl Ranged {
    /// A value between two ends; an end that is not finite is open.
    #[must_use]
    pub fn new(value: f64, low: f64, high: f64) -> Self {
        let finite = |end: f64| Some(end).filter(|end| end.is_finite());
        Self { value, low: finite(low), high: finite(high) }
    }

    /// The mean of independent values with Student's interval; none of fewer than two.
    #[must_use]
    pub fn mean_of(values: &[f64]) -> Option<Self> {
        if values.len() < 2 {
            return None;
        }
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let half = student_95(values.len() - 1) * (variance / n).sqrt();
        Some(Self::new(mean, mean - half, mean + half))
    }

    /// The same with ends that are at least that share of the value away from it.
    #[must_use]
    pub fn at_least(self, share: f64) -> Self {
        let least = share * self.value.abs();
        Self {
            low: self.low.map(|low| low.min(self.value - least)),
            high: self.high.map(|high| high.max(self.value + least)),
            ..self
        }
    }

    /// Half the interval over the value; none where an end is open.
    #[must_use]
    pub fn relative(&self) -> Option<f64> {
        Some((0.5 * (self.high? - self.low?) / self.value).abs()).filter(|share| share.is_finite())
    }

    /// Whether the interval holds `value`; an open end holds everything on its side.
    #[must_use]
    pub fn holds(&self, value: f64) -> bool {
        self.low.is_none_or(|low| low <= value) && self.high.is_none_or(|high| value <= high)
    }

    /// As people read it: the value and half its interval in per cent, or the ends where zero lies
    /// between them: a share of nearly nothing says nothing.
    #[must_use]
    pub fn said(&self, unit: &str) -> String {
        let value = report::numbers::significant(self.value, 4);
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        match (self.relative(), self.low.zip(self.high)) {
            (Some(_), Some((low, high))) if self.holds(0.0) => {
                let [low, high] = [low, high].map(|end| report::numbers::significant(end, 2));
                format!("{value}{unit} ({low} to {high})")
            }
            (Some(share), _) => {
                format!("{value}{unit} ± {}", report::numbers::percent(100.0 * share, 1))
            }
            (None, _) => format!("{value}{unit}, not determined"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_of_a_mean_is_students() {
        let mean = Ranged::mean_of(&[1.0, 2.0, 3.0]).unwrap();
        // 4.302653 / sqrt(3) = 2.48414.
        assert!((mean.high.unwrap() - 4.48414).abs() < 1e-4 && mean.value == 2.0);
        assert!(mean.holds(0.0) && !mean.holds(5.0));
        assert_eq!(Ranged::mean_of(&[1.0]), None);
    }

    #[test]
    fn a_value_about_zero_is_told_by_its_ends() {
        assert_eq!(Ranged::new(2.0, 1.0, 3.0).said("V"), "2.000 V ± 50.0 %");
        assert_eq!(Ranged::new(-0.5, -2.0, 1.0).said("s"), "-0.5000 s (-2.0 to 1.0)");
    }

    #[test]
    fn an_open_end_holds_everything_and_has_no_width() {
        let open = Ranged::new(1.0, 0.5, f64::INFINITY);
        assert!(open.holds(1e9) && !open.holds(0.4) && open.relative().is_none());
        assert!(open.said("V").contains("not determined"));
    }
}
