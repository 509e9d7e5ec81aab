//! Numbers as people write them: as many digits as the uncertainty allows.

/// `value` and `error` with two significant digits of the error, as in `95.12` and `0.11`.
pub fn with_error(value: f64, error: f64) -> (String, String) {
    if !(error.is_finite() && error > 0.0 && value.is_finite()) {
        return (format!("{value:.6}"), format!("{error:.1e}"));
    }
    // Very small quantities read better in powers of ten, of the value's own.
    if value.abs() < 1e-3 && value != 0.0 || value.abs() >= 1e6 {
        let exponent = value.abs().log10().floor() as i32;
        let (value, error) = with_error(value / 10f64.powi(exponent), error / 10f64.powi(exponent));
        return (format!("{value}e{exponent}"), format!("{error}e{exponent}"));
    }
    let decimals = decimals(error);
    (format!("{value:.decimals$}"), format!("{error:.decimals$}"))
}

/// Decimals that show two significant digits of `error`, twelve at most.
fn decimals(error: f64) -> usize {
    (1 - error.log10().floor() as i32).clamp(0, 12) as usize
}

#[cfg(test)]
mod tests {
    use super::with_error;

    #[test]
    fn two_digits_of_the_error() {
        let both = |value, error| {
            let (value, error) = with_error(value, error);
            format!("{value} +- {error}")
        };
        assert_eq!(both(95.1163, 0.1074), "95.12 +- 0.11");
        assert_eq!(both(203.37, 1.136), "203.4 +- 1.1");
        assert_eq!(both(12345.6, 120.0), "12346 +- 120");
        assert_eq!(both(2.6476e-3, 3.1e-5), "0.002648 +- 0.000031");
        assert_eq!(both(2.6476e-5, 3.1e-7), "2.648e-5 +- 0.031e-5");
        assert_eq!(both(-3.17, 0.044), "-3.170 +- 0.044");
        // Nothing falls over on what cannot be shown.
        assert!(both(1.0, f64::NAN).contains("NaN") && both(f64::NAN, 1.0).contains("NaN"));
        assert_eq!(both(1.0, 0.0), "1.000000 +- 0.0e0");
    }
}
