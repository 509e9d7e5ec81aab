//! The gain of a Kalman filter that has run for long: the stabilising solution of the discrete
//! Riccati equation.
//!
//! Structure-preserving doubling (Chu, Fan, Lin and Wang 2004): each iteration covers twice the
//! time of the one before, so that a filter that needs seconds to settle is solved in about
//! fifteen.

use nalgebra::{Matrix3, SMatrix};

/// Iterations, each of which doubles the time: 2^40 cycles.
const DOUBLINGS: usize = 40;

/// Gain `K` with which a filter of `x' = A x + noise(Q)`, `y = C x + noise(R)` corrects its
/// prediction; `None` if numbers fail.
pub(super) fn steady_gain<const O: usize>(
    a: &Matrix3<f64>,
    c: &SMatrix<f64, O, 3>,
    q: &Matrix3<f64>,
    r: &SMatrix<f64, O, O>,
) -> Option<SMatrix<f64, 3, O>> {
    let mut a_k = a.transpose();
    let mut g_k = c.transpose() * r.try_inverse()? * c;
    let mut p = *q;
    for _ in 0..DOUBLINGS {
        let inverse = (Matrix3::identity() + g_k * p).try_inverse()?;
        let step = a_k.transpose() * p * inverse * a_k;
        g_k += a_k * inverse * g_k * a_k.transpose();
        a_k = a_k * inverse * a_k;
        p += step;
        p = 0.5 * (p + p.transpose());
        if step.norm() <= 1e-14 * p.norm() {
            break;
        }
    }
    let gain = p * c.transpose() * (c * p * c.transpose() + r).try_inverse()?;
    gain.iter().all(|x| x.is_finite()).then_some(gain)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix1, RowVector3};

    use super::*;

    /// The recursion of the filter itself, run for long, has the same gain.
    #[test]
    fn the_gain_is_that_of_the_filter_after_a_long_time() {
        let dt: f64 = 1e-3;
        let decay = (-dt / 0.024).exp();
        let a = Matrix3::new(1.0, dt, 0.0, 0.0, decay, -0.37, 0.0, 0.0, 1.0);
        let c = RowVector3::new(1.0, 0.0, 0.0);
        let q = Matrix3::from_diagonal(&nalgebra::Vector3::new(0.0, 1e-9, 9e-5));
        let r = Matrix1::new(1.9e-7);
        let gain = steady_gain(&a, &c, &q, &r).unwrap();
        let (mut p, mut recursive) = (q, gain);
        for _ in 0..20_000 {
            recursive = p * c.transpose() / (c * p * c.transpose() + r)[0];
            p = a * (p - recursive * c * p) * a.transpose() + q;
        }
        assert!((gain - recursive).norm() < 1e-9 * gain.norm(), "{gain} {recursive}");
    }
}
