//! Why a parameter is not identified, as a person reads it: with no more digits than it deserves.

use friction_ident::{Doubt, Estimate};
use report::numbers::significant;

/// Parameters that an axis may be without: of one that is about zero, that is what is to be said.
const ABSENT: [&str; 5] = ["inertia", "f_v", "f_c", "f_s", "sigma1"];

/// What is not known and why, without what helps against it.
#[must_use]
pub fn said(estimate: &Estimate, doubt: &Doubt) -> String {
    match doubt {
        Doubt::NotToBeTrusted { .. } => doubt.to_string(),
        doubt => format!("not identifiable: {}", why(estimate, doubt)),
    }
}

/// The reason alone.
#[must_use]
pub fn why(estimate: &Estimate, doubt: &Doubt) -> String {
    let end = |value: f64| significant(value, 3);
    match doubt {
        Doubt::LargeError { .. } | Doubt::BelowNoise { .. } if is_about_zero(estimate) => {
            "it is not different from zero".to_owned()
        }
        Doubt::AtBound { bound } => {
            format!("the best value lies at its bound {}", significant(*bound, 4))
        }
        Doubt::BelowNoise { effect, standard_error } => format!(
            "the effect it describes, {}, is not clear of its standard error {}",
            end(*effect),
            significant(*standard_error, 2)
        ),
        Doubt::Unsteady { low, high } => format!(
            "it is not the same in all parts of the recording: {} to {}, beyond its interval",
            end(*low),
            end(*high)
        ),
        Doubt::RivalsDisagree { low, high } => {
            format!("other fits put it elsewhere: {} to {}", end(*low), end(*high))
        }
        Doubt::HalvesDisagree { low, high } => format!(
            "disjoint halves of the recordings disagree on it: {} to {}",
            end(*low),
            end(*high)
        ),
        Doubt::Negative { value } => {
            format!("it comes out negative, {}, which friction cannot be", end(*value))
        }
        Doubt::OutsideRange { low, high } => {
            format!("it lies outside the measured range, {} to {}", end(*low), end(*high))
        }
        other => other.to_string(),
    }
}

/// Whether it is one of these whose interval holds zero.
fn is_about_zero(estimate: &Estimate) -> bool {
    ABSENT.contains(&estimate.id.name)
        && estimate.interval.is_some_and(|interval| interval.contains(0.0))
}

#[cfg(test)]
mod tests {
    use friction_ident::{Interval, IntervalMethod, Verdict};

    use super::*;

    fn told(name: &'static str, low: f64, doubt: Doubt) -> String {
        let interval = Interval { low, high: 2e-4, method: IntervalMethod::Robust };
        let estimate = Estimate {
            id: name.into(),
            unit: "N m",
            value: 8e-6,
            standard_error: Some(5e-5),
            interval: Some(interval),
            verdict: Verdict::Identified,
        };
        said(&estimate, &doubt)
    }

    /// `-2.2260e0 to 1.5720e1` and `0.0000002503423742538909` were shown.
    #[test]
    fn numbers_have_as_many_digits_as_they_deserve() {
        let rivals = Doubt::RivalsDisagree { low: -2.226, high: 15.7204 };
        assert!(told("f_v", 1e-6, rivals).ends_with("elsewhere: -2.23 to 15.7"));
        let bound = Doubt::AtBound { bound: 0.0000002503423742538909 };
        assert!(told("presliding", 1e-6, bound).ends_with("bound 2.503e-7"));
        let noise = Doubt::BelowNoise { effect: -4.702e-2, standard_error: 3.664e-2 };
        let noise = told("v_s", -1e-4, noise);
        assert!(noise.contains("-0.0470, is") && noise.ends_with("error 0.037"), "{noise}");
    }

    #[test]
    fn friction_about_zero_says_so() {
        let large = || Doubt::LargeError { relative_error: 6.0 };
        assert_eq!(told("f_c", -1e-4, large()), "not identifiable: it is not different from zero");
        // What is no friction, or clear of zero, says how large its error is.
        assert!(told("delay", -1e-4, large()).contains("of its value"));
        assert!(told("f_c", 1e-6, large()).contains("of its value"));
    }

    #[test]
    fn a_level_that_is_not_one_is_no_matter_of_its_interval() {
        let level = told("f_s", 1e-6, Doubt::NoDip { rest: "f_s".into(), kinetic: "f_c".into() });
        assert!(level.starts_with("not identifiable: f_s lies below f_c"), "{level}");
        let why = "the motion has one speed".to_owned();
        let interval = told("f_s", 1e-6, Doubt::NotToBeTrusted { why });
        assert!(interval.starts_with("its interval is not to be trusted"), "{interval}");
    }
}
