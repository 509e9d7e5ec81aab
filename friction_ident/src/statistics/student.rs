//! From a standard error to an interval.

/// The two-sided 95 % quantile of Student's distribution with `degrees` degrees of freedom.
///
/// Cornish-Fisher expansion around the normal quantile (Abramowitz and Stegun 26.7.5): right to
/// 1e-3 at four degrees and to 1e-6 from twenty on. Infinite for zero degrees, where no interval
/// exists.
///
/// ```
/// assert!((friction_ident::statistics::student_95(10) - 2.228139).abs() < 1e-4);
/// ```
pub fn student_95(degrees: usize) -> f64 {
    // Below four degrees the expansion is coarse; these are the exact values.
    match degrees {
        0 => return f64::INFINITY,
        1 => return 12.706205,
        2 => return 4.302653,
        3 => return 3.182446,
        _ => {}
    }
    let z: f64 = 1.959_963_984_540_054;
    let n = degrees as f64;
    let (z3, z5, z7, z9) = (z.powi(3), z.powi(5), z.powi(7), z.powi(9));
    z + (z3 + z) / (4.0 * n)
        + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * n.powi(2))
        + (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * n.powi(3))
        + (79.0 * z9 + 776.0 * z7 + 1482.0 * z5 - 1920.0 * z3 - 945.0 * z) / (92_160.0 * n.powi(4))
}

/// The same for degrees of freedom that are no whole number, as Satterthwaite's are: between whole
/// ones the logarithm of the quantile runs straight over one over the degrees. Infinite below half
/// a degree.
pub fn student_95_of(degrees: f64) -> f64 {
    if degrees.is_nan() || degrees < 0.5 {
        return f64::INFINITY;
    }
    let degrees = degrees.clamp(1.0, 1e9);
    let below = degrees.floor();
    let (low, high) = (student_95(below as usize).ln(), student_95(below as usize + 1).ln());
    let share = (1.0 / below - 1.0 / degrees) / (1.0 / below - 1.0 / (below + 1.0));
    (low + share * (high - low)).exp()
}

#[cfg(test)]
mod tests {
    use super::{student_95, student_95_of};

    /// The quantile at 2.5 degrees is 3.5582 (by numerical integration of the density).
    #[test]
    fn degrees_need_not_be_whole() {
        assert!((student_95_of(3.0) - 3.182446).abs() < 1e-9);
        assert!((student_95_of(2.5) / 3.558 - 1.0).abs() < 0.01, "{}", student_95_of(2.5));
        assert!((student_95_of(1e12) - 1.959964).abs() < 1e-6);
        assert!(student_95_of(0.2).is_infinite() && student_95_of(f64::NAN).is_infinite());
    }

    #[test]
    fn agrees_with_the_tables() {
        for (degrees, expected, tolerance) in
            [(4, 2.776445, 1e-3), (5, 2.570582, 5e-4), (20, 2.085963, 1e-6), (76, 1.991673, 1e-6)]
        {
            assert!((student_95(degrees) - expected).abs() < tolerance, "{degrees}");
        }
        assert!((student_95(10_000_000) - 1.959964).abs() < 1e-6);
    }
}
