//! Means and straight lines with their standard errors.

use friction_ident::Uncertain;

/// Mean of independent values, with its standard error; none of fewer than two.
pub fn mean(values: &[f64]) -> Option<Uncertain> {
    let n = values.len();
    if n < 2 {
        return None;
    }
    let mean = values.iter().sum::<f64>() / n as f64;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    Some(Uncertain { value: mean, standard_error: (squares / (n - 1) as f64 / n as f64).sqrt() })
}

/// Least-squares line `y = intercept + slope x`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Slope with its standard error.
    pub slope: Uncertain,
    /// Root mean square of the residuals.
    pub residual: f64,
}

/// The line through points; none of fewer than three, or where all `x` are the same.
pub fn line(points: &[(f64, f64)]) -> Option<Line> {
    let n = points.len() as f64;
    if points.len() < 3 {
        return None;
    }
    let (x_mean, y_mean) =
        (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let xx: f64 = points.iter().map(|p| (p.0 - x_mean).powi(2)).sum();
    let xy: f64 = points.iter().map(|p| (p.0 - x_mean) * (p.1 - y_mean)).sum();
    if xx <= 0.0 || !xx.is_finite() || !xy.is_finite() {
        return None;
    }
    let slope = xy / xx;
    let squares: f64 = points.iter().map(|p| (p.1 - y_mean - slope * (p.0 - x_mean)).powi(2)).sum();
    Some(Line {
        slope: Uncertain { value: slope, standard_error: (squares / (n - 2.0) / xx).sqrt() },
        residual: (squares / n).sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five points about y = 4 + 1.98 (x - 2), as least squares have it.
    #[test]
    fn a_line_has_the_slope_and_standard_error_of_the_textbook() {
        let points = [(0.0, 0.1), (1.0, 1.9), (2.0, 4.1), (3.0, 5.9), (4.0, 8.0)];
        let found = line(&points).unwrap();
        let expected = 19.8 / 10.0;
        assert!((found.slope.value - expected).abs() < 1e-12, "{found:?}");
        let squares: f64 =
            points.iter().map(|(x, y)| (y - 4.0 - expected * (x - 2.0)).powi(2)).sum();
        assert!((found.slope.standard_error - (squares / 3.0 / 10.0).sqrt()).abs() < 1e-12);
        assert!(
            line(&points[..2]).is_none() && line(&[(1.0, 0.0), (1.0, 1.0), (1.0, 2.0)]).is_none()
        );
    }

    #[test]
    fn a_mean_is_as_sure_as_its_scatter_and_number_allow() {
        let found = mean(&[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert_eq!(found.value, 2.5);
        assert!((found.standard_error - (5.0f64 / 3.0 / 4.0).sqrt()).abs() < 1e-15);
        assert!(mean(&[1.0]).is_none());
    }
}
