//! Numbers as a person reads them, on paper and on the terminal: one place for all.
//!
//! Every function gives whole text with a leading zero and a point; none gives more digits than the
//! number deserves.

/// Improvements beyond this many per cent are told as times.
const SENSIBLE_PERCENT: f64 = 1000.0;

/// A factor that is so large that its size means nothing any more.
const LARGEST_FACTOR: f64 = 1e4;

/// So many significant digits, without trailing zeros: `0.02` for 0.019999999999999997.
#[must_use]
pub fn plain(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { format!("{value}") };
    }
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let rounded: f64 = scientific.parse().unwrap_or(value);
    match exponent.parse::<i32>().unwrap_or(0) {
        -4..15 => format!("{rounded}"),
        exponent => {
            let short = if mantissa.contains('.') {
                mantissa.trim_end_matches('0').trim_end_matches('.')
            } else {
                mantissa
            };
            format!("{short}e{exponent}")
        }
    }
}

/// So many significant digits, trailing zeros kept: 16.47, 0.09940, 1.235e6.
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return plain(value, digits);
    }
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent = scientific.split_once('e').and_then(|(_, e)| e.parse::<i32>().ok()).unwrap_or(0);
    if (-3..6).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        scientific
    }
}

/// `value` and `error` with two significant digits of the error, as in `95.12` and `0.11`; no error
/// where there is none.
#[must_use]
pub fn value_and_error(value: f64, error: f64) -> (String, String) {
    if !(error.is_finite() && error > 0.0 && value.is_finite()) {
        return (significant(value, 4), String::new());
    }
    // Very small and very large quantities read better in powers of ten, of the value's own.
    if value.abs() < 1e-3 && value != 0.0 || value.abs() >= 1e6 {
        let exponent = value.abs().log10().floor() as i32;
        let (value, error) =
            value_and_error(value / 10f64.powi(exponent), error / 10f64.powi(exponent));
        return (format!("{value}e{exponent}"), format!("{error}e{exponent}"));
    }
    // A small error of zero, or of much more than the value, in powers of ten too.
    if error < 1e-12 {
        return (significant(value, 4), format!("{error:.1e}"));
    }
    let decimals = (1 - error.log10().floor() as i32).max(0) as usize;
    (format!("{value:.decimals$}"), format!("{error:.decimals$}"))
}

/// `95.12 ± 0.11`; the value alone where there is no uncertainty.
#[must_use]
pub fn with_error(value: f64, error: f64) -> String {
    match value_and_error(value, error) {
        (value, error) if error.is_empty() => value,
        (value, error) => format!("{value} ± {error}"),
    }
}

/// `1 seed`, `2 seeds`.
#[must_use]
pub fn count(number: usize, one: &str) -> String {
    if number == 1 { format!("1 {one}") } else { format!("{number} {one}s") }
}

/// `1 search`, `2 searches`.
#[must_use]
pub fn searches(number: usize) -> String {
    if number == 1 { "1 search".to_owned() } else { format!("{number} searches") }
}

/// By how many per cent something became smaller, less than none if larger; as times where per cent
/// mean nothing any more: `94.2`, `-12.0`, `28 times larger`.
#[must_use]
pub fn smaller_by(percent: f64) -> String {
    if percent.is_nan() {
        return "-".to_owned();
    }
    if percent > -SENSIBLE_PERCENT {
        // Adding zero makes of -0 a 0.
        return format!("{:.1}", (percent * 10.0).round() / 10.0 + 0.0);
    }
    format!("{} larger", times(1.0 - percent / 100.0))
}

/// A share in per cent with this many decimals; as times beyond sense: `4.56 %`, `322 times`.
#[must_use]
pub fn percent(value: f64, decimals: usize) -> String {
    if value.abs() < SENSIBLE_PERCENT || value.is_nan() {
        format!("{value:.decimals$} %")
    } else {
        times(value.abs() / 100.0)
    }
}

/// `0.70 times`, `3.2 times`, `30 times`, `more than 10000 times`.
#[must_use]
pub fn times(factor: f64) -> String {
    match factor {
        factor if factor > LARGEST_FACTOR => format!("more than {LARGEST_FACTOR} times"),
        factor if factor >= 9.95 => format!("{factor:.0} times"),
        factor if factor >= 0.995 => format!("{factor:.1} times"),
        factor => format!("{} times", significant(factor, 2)),
    }
}

/// How long a simulation took: `42 s of rig time in 0.8 s, 52 times as fast as real time`.
#[must_use]
pub fn rig_time(rig_seconds: f64, wall_seconds: f64) -> String {
    let both = format!("{} s of rig time in {} s", tenths(rig_seconds), tenths(wall_seconds));
    let factor = rig_seconds / wall_seconds;
    match factor {
        factor if !factor.is_finite() => both,
        factor if factor >= 1.05 => format!("{both}, {} as fast as real time", times(factor)),
        // With its pauses a run in real time takes longer than its motions.
        factor => format!("{both}, {:.0} % of real time", 100.0 * factor),
    }
}

/// Seconds: tenths of short times, none of long ones.
fn tenths(seconds: f64) -> String {
    if seconds >= 100.0 {
        format!("{seconds:.0}")
    } else {
        plain((10.0 * seconds).round() / 10.0, 4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_that_mean_nothing_are_left_out() {
        for (value, text) in [
            (0.019999999999999997, "0.02"),
            (0.5, "0.5"),
            (1.862547, "1.86255"),
            (0.0, "0"),
            (-1234.0, "-1234"),
            (2.5e-7, "2.5e-7"),
            (3e20, "3e20"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(plain(value, 6), text);
        }
    }

    #[test]
    fn significant_digits_are_kept() {
        for (value, text) in [
            (0.0994, "0.09940"),
            (16.469, "16.47"),
            (1_234_567.0, "1.235e6"),
            (0.0, "0"),
            (2e-7, "2.000e-7"),
            (-12345.0, "-12345"),
            (9.99999, "10.00"),
        ] {
            assert_eq!(significant(value, 4), text);
        }
    }

    #[test]
    fn an_error_has_two_digits_and_none_is_none() {
        for (value, error, text) in [
            (95.1163, 0.1074, "95.12 ± 0.11"),
            (203.37, 1.136, "203.4 ± 1.1"),
            (12345.6, 120.0, "12346 ± 120"),
            (2.6476e-3, 3.1e-5, "0.002648 ± 0.000031"),
            (2.6476e-5, 3.1e-7, "2.648e-5 ± 0.031e-5"),
            (-3.17, 0.044, "-3.170 ± 0.044"),
            (0.0994, 0.0, "0.09940"),
            (0.0994, f64::NAN, "0.09940"),
        ] {
            assert_eq!(with_error(value, error), text);
        }
        assert!(!with_error(1.0, 0.0).contains('±'), "no ± 0e0");
    }

    #[test]
    fn one_is_not_many() {
        assert_eq!(
            (count(1, "seed"), count(0, "seed"), count(5, "seed")),
            ("1 seed".into(), "0 seeds".into(), "5 seeds".into())
        );
    }

    #[test]
    fn percentages_beyond_sense_are_times() {
        for (value, text) in [
            (94.25, "94.3"),
            (-0.01, "0.0"),
            (-250.0, "-250.0"),
            (-2700.0, "28 times larger"),
            (-322_297_953.0, "more than 10000 times larger"),
            (f64::NEG_INFINITY, "more than 10000 times larger"),
            (f64::NAN, "-"),
        ] {
            assert_eq!(smaller_by(value), text);
        }
        assert_eq!(percent(4.556, 2), "4.56 %");
        assert_eq!(percent(322_297_953.0, 1), "more than 10000 times");
        assert_eq!(percent(3220.0, 1), "32 times");
    }

    #[test]
    fn real_time_is_told_as_it_was() {
        assert_eq!(rig_time(42.0, 60.0), "42 s of rig time in 60 s, 70 % of real time");
        assert_eq!(
            rig_time(523.6, 17.7),
            "524 s of rig time in 17.7 s, 30 times as fast as real time"
        );
        assert_eq!(rig_time(3.0, 2.0), "3 s of rig time in 2 s, 1.5 times as fast as real time");
        assert_eq!(rig_time(3.0, 0.0), "3 s of rig time in 0 s");
    }
}
