//! Whether the data say anything about a parameter, and the interval that they leave it.

use serde::Serialize;

use crate::parameter_id::ParameterId;

/// How an interval was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum IntervalMethod {
    /// Value plus and minus Student's quantile times the standard error.
    Linearised,
    /// The same with an error that holds under coloured residuals and model error
    /// ([`robust_covariance`](crate::robust_covariance)).
    Robust,
    /// Where the profile of the likelihood crosses its limit: right for curved problems, and
    /// open-ended where it must be.
    Profile,
    /// The range over repeated searches that fit equally well.
    EquallyGoodFits,
    /// Widened to what other structures or models say that predict as well, or what sliding far from
    /// rest says.
    Rivals,
    /// From the differences between fits of disjoint halves of the recordings.
    HalfSamples,
    /// From the ranks of repeated measurements, without assuming a distribution.
    Ranks,
}

/// A 95 % confidence interval; an end may be infinite.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// How it was found.
    pub method: IntervalMethod,
}

impl Interval {
    /// Whether `value` lies within.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// A relative error in words: per cent as long as these say something,
/// `more than 10 times its value` beyond.
pub(crate) fn of_its_value(relative_error: f64) -> String {
    const SENSIBLE: f64 = 10.0;
    if relative_error <= SENSIBLE {
        format!("{:.0} % of its value", 100.0 * relative_error)
    } else {
        format!("more than {SENSIBLE:.0} times its value")
    }
}

/// What makes an error of less than half the value a large one.
fn to_zero(relative_error: f64) -> &'static str {
    if relative_error <= 0.5 { ", and its interval reaches zero" } else { "" }
}

/// Why the data do not determine a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, thiserror::Error)]
#[serde(tag = "reason", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Doubt {
    /// The standard error is more than half the value, or the interval reaches zero.
    #[error("its standard error is {}{}", of_its_value(*relative_error), to_zero(*relative_error))]
    LargeError {
        /// Standard error over value.
        relative_error: f64,
    },
    /// Its error is a guess.
    #[error("its interval is not to be trusted: {why}")]
    NotToBeTrusted {
        /// Why.
        why: String,
    },
    /// The interval has no end on one side.
    #[error("its interval has no end: the data fit about as well without the effect")]
    OpenInterval,
    /// The best value allowed is a bound itself.
    #[error("the best value lies at its bound {bound}")]
    AtBound {
        /// The bound.
        bound: f64,
    },
    /// Changing it changes nothing in this data.
    #[error("it changes nothing in this data")]
    NoEffect,
    /// It cannot be told from another parameter.
    #[error("it cannot be told from {other} (correlation {correlation:.4})")]
    Confounded {
        /// The other parameter.
        other: String,
        /// Their correlation.
        correlation: f64,
    },
    /// What it describes is not clear of the noise.
    #[error(
        "the effect it describes, {effect:.3e}, is not clear of its standard error {standard_error:.3e}"
    )]
    BelowNoise {
        /// Size of the effect.
        effect: f64,
        /// Its standard error.
        standard_error: f64,
    },
    /// What it is the mean of happened too rarely.
    #[error("it needs {needed} events, and the recording has {found}")]
    TooFewEvents {
        /// Events found.
        found: usize,
        /// Events needed.
        needed: usize,
    },
    /// It does not stay within its interval when part of the recording is left out.
    #[error(
        "it is not the same in all parts of the recording: {low:.4e} to {high:.4e}, beyond its interval"
    )]
    Unsteady {
        /// Least value without one of the parts.
        low: f64,
        /// Greatest.
        high: f64,
    },
    /// Friction below zero would drive the axis.
    #[error("it comes out negative, {value:.3e}, which friction cannot be")]
    Negative {
        /// The value.
        value: f64,
    },
    /// A level at rest that does not lie above the kinetic one.
    #[error("{rest} lies below {kinetic}: a dip is not what this recording shows")]
    NoDip {
        /// The level at rest.
        rest: ParameterId,
        /// The kinetic one.
        kinetic: ParameterId,
    },
    /// Only its ratio to something unknown is determined.
    #[error("only its ratio to the torque per volt is determined")]
    RatioOnly,
    /// The sensor's steps are too coarse for the noise to fill them: the mean error of rounding is
    /// not known well enough.
    #[error(
        "the sensor's steps of {step:.3e} are too coarse for the noise of {noise:.3e} that should fill them"
    )]
    CoarseSensor {
        /// One step.
        step: f64,
        /// Standard deviation of the noise before rounding.
        noise: f64,
    },
    /// Repeated searches that fit equally well disagree.
    #[error("the {fits} equally good fits disagree on it")]
    Scatter {
        /// Least of them.
        low: f64,
        /// Greatest.
        high: f64,
        /// How many fits there are.
        fits: usize,
    },
    /// There is nothing to compare it with.
    #[error("there are no two recordings to be compared: nothing confirms the value")]
    Unrepeated,
    /// Fits of disjoint halves of the recordings differ too much.
    #[error("disjoint halves of the recordings disagree on it: {low:.4e} to {high:.4e}")]
    HalvesDisagree {
        /// Least of them.
        low: f64,
        /// Greatest.
        high: f64,
    },
    /// Structures or models that predict as well put it elsewhere.
    #[error("other fits put it elsewhere: {low:.4e} to {high:.4e}")]
    RivalsDisagree {
        /// Least of them.
        low: f64,
        /// Greatest.
        high: f64,
    },
    /// Its 95 % interval is wider than the value.
    #[error("its 95 % interval is wider than its value; its standard error is {}", of_its_value(*relative_error))]
    WideInterval {
        /// Standard error over value.
        relative_error: f64,
    },
    /// The whole fit has failed.
    #[error("the fit has failed")]
    FailedFit,
    /// It lies outside the range that was measured.
    #[error("it lies outside the measured range, {low} to {high}")]
    OutsideRange {
        /// Lower end of the range.
        low: f64,
        /// Upper end.
        high: f64,
    },
}

/// Whether the data determine a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Verdict {
    /// They do.
    Identified,
    /// They do not.
    NotIdentifiable {
        /// Why.
        doubt: Doubt,
        /// What to measure instead.
        remedy: &'static str,
    },
    /// It was not estimated but computed from others, or given.
    Given {
        /// Where it comes from.
        source: &'static str,
    },
}

impl Verdict {
    /// Whether nothing but an interval that reaches zero speaks against the parameter.
    pub(crate) fn is_for_reaching_zero(&self) -> bool {
        let Self::NotIdentifiable { doubt: Doubt::LargeError { relative_error }, .. } = self else {
            return false;
        };
        *relative_error <= 0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_beyond_sense_is_told_in_times() {
        let doubt = |relative_error| Doubt::LargeError { relative_error }.to_string();
        assert_eq!(doubt(0.62), "its standard error is 62 % of its value");
        assert_eq!(
            doubt(0.42),
            "its standard error is 42 % of its value, and its interval reaches zero"
        );
        assert_eq!(doubt(3_222_979.53), "its standard error is more than 10 times its value");
        assert_eq!(doubt(f64::INFINITY), "its standard error is more than 10 times its value");
    }
}
