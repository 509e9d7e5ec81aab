//! Straight lines with their standard errors.

use crate::Uncertain;

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
}
