//! Recursive least squares with forgetting, in bounds.
//!
//! ```text
//! k     = P phi / (lambda r + phi' P phi)
//! theta = clip(theta + k (y - phi' theta))
//! P     = (P - k phi' P) / lambda,     scaled down where a variance exceeds its limit
//! ```
//!
//! Aastrom and Wittenmark, Adaptive Control (2nd ed. 1995), section 2.2, with the two remedies of
//! section 11.5 against wind-up of the covariance: limits on it, and no update at all while the
//! caller finds the excitation poor.

use nalgebra::{SMatrix, SVector};

/// Least squares over `N` parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeastSquares<const N: usize> {
    theta: SVector<f64, N>,
    covariance: SMatrix<f64, N, N>,
    /// Largest variances.
    limits: SVector<f64, N>,
    bounds: [(f64, f64); N],
    forgetting: f64,
    noise: f64,
}

impl<const N: usize> LeastSquares<N> {
    /// An estimate that starts at `theta` with standard deviations `deviations`, which are also the
    /// largest it may ever have. `forgetting` is the factor lambda of one update, above 0 and at
    /// most 1; `noise` the variance of a measurement; `bounds` lowest and highest value of each
    /// parameter.
    #[must_use]
    pub fn new(
        theta: [f64; N],
        deviations: [f64; N],
        bounds: [(f64, f64); N],
        forgetting: f64,
        noise: f64,
    ) -> Self {
        let limits = SVector::from(deviations.map(|deviation| deviation * deviation));
        let covariance = SMatrix::from_diagonal(&limits);
        Self { theta: SVector::from(theta), covariance, limits, bounds, forgetting, noise }
    }

    /// Takes one measurement `y = phi . theta` in. One that is not finite is left out.
    #[inline]
    pub fn update(&mut self, phi: [f64; N], y: f64) {
        let phi = SVector::from(phi);
        let along = self.covariance * phi;
        let gain = along / (self.forgetting * self.noise + phi.dot(&along));
        let theta = self.theta + gain * (y - phi.dot(&self.theta));
        let covariance = (self.covariance - gain * along.transpose()) / self.forgetting;
        if !(theta.iter().all(|x| x.is_finite()) && covariance.iter().all(|x| x.is_finite())) {
            return;
        }
        for (value, (new, (low, high))) in self.theta.iter_mut().zip(theta.iter().zip(&self.bounds))
        {
            *value = new.max(*low).min(*high);
        }
        let excess =
            covariance.diagonal().zip_map(&self.limits, |variance, limit| variance / limit).max();
        let scale = if excess > 1.0 { 1.0 / excess } else { 1.0 };
        self.covariance = 0.5 * scale * (covariance + covariance.transpose());
    }

    /// The estimate.
    #[must_use]
    pub fn parameters(&self) -> [f64; N] {
        self.theta.into()
    }

    /// The variances of the estimate, in the sense of its own model of the noise.
    #[must_use]
    pub fn variances(&self) -> [f64; N] {
        self.covariance.diagonal().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(forgetting: f64) -> LeastSquares<2> {
        LeastSquares::new([0.0, 0.0], [100.0, 100.0], [(-10.0, 10.0); 2], forgetting, 1.0)
    }

    fn data(k: u32) -> ([f64; 2], f64) {
        let phi = [1.0, (0.37 * f64::from(k)).sin()];
        (phi, 2.0 * phi[0] - 3.0 * phi[1] + 0.1 * (1.7 * f64::from(k)).cos())
    }

    /// Without forgetting it is the solution of the normal equations with the prior as two more
    /// rows.
    #[test]
    fn without_forgetting_it_is_the_least_squares_solution() {
        let mut recursive = plain(1.0);
        let mut normal = SMatrix::<f64, 2, 2>::identity() * 1e-4;
        let mut right = SVector::<f64, 2>::zeros();
        for k in 0..200 {
            let (phi, y) = data(k);
            recursive.update(phi, y);
            let phi = SVector::from(phi);
            normal += phi * phi.transpose();
            right += phi * y;
        }
        let expected = normal.try_inverse().unwrap() * right;
        for (found, expected) in recursive.parameters().iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }

    #[test]
    fn neither_parameters_nor_covariance_leave_their_bounds() {
        let mut wild = plain(0.9);
        for k in 0..5000u32 {
            let phi = [1.0, if k < 100 { 1.0 } else { 0.0 }];
            wild.update(phi, if k % 7 == 0 { f64::NAN } else { 1e6 });
            wild.update([1e300, f64::INFINITY], 1.0);
        }
        assert!(wild.parameters().iter().all(|x| x.abs() <= 10.0));
        assert!(
            wild.variances().iter().all(|v| (0.0..=1e4 * (1.0 + 1e-9)).contains(v)),
            "{wild:?}"
        );
    }

    #[test]
    fn what_is_forgotten_does_not_hold_it_back() {
        let mut quick = plain(0.95);
        for k in 0..200 {
            let (phi, y) = data(k);
            quick.update(phi, y);
        }
        for k in 200..400 {
            let (phi, y) = data(k);
            quick.update(phi, y + 1.0);
        }
        assert!((quick.parameters()[0] - 3.0).abs() < 0.1, "{:?}", quick.parameters());
    }
}
