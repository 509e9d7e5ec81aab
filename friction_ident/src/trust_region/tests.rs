//! Problems with known minima, and one whose steps were recorded.

use super::*;

/// `a / (1 + (x / b)^2) + c x` through points: arithmetic alone, so that every machine computes the
/// same.
struct Curve {
    x: Vec<f64>,
    y: Vec<f64>,
}

fn value(p: &[f64], x: f64) -> f64 {
    p[0] / (1.0 + (x / p[1]) * (x / p[1])) + p[2] * x
}

impl Curve {
    fn through(truth: &[f64], noise: f64) -> Self {
        let x: Vec<f64> = (0..20).map(|i| 0.1 + 0.15 * f64::from(i)).collect();
        let sign = |i: usize| if i.is_multiple_of(3) { 1.0 } else { -0.5 };
        let y = x.iter().enumerate().map(|(i, &x)| value(truth, x) + noise * sign(i)).collect();
        Self { x, y }
    }
}

impl Problem for Curve {
    fn residuals(&self, p: &[f64]) -> DVector<f64> {
        let points = self.x.iter().zip(&self.y);
        DVector::from_iterator(self.x.len(), points.map(|(&x, y)| value(p, x) - y))
    }

    fn jacobian(&self, p: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(self.x.len(), 3, |i, j| {
            let (x, below) = (self.x[i], 1.0 + (self.x[i] / p[1]) * (self.x[i] / p[1]));
            [1.0 / below, 2.0 * p[0] * x * x / (p[1] * p[1] * p[1] * below * below), x][j]
        })
    }
}

/// Bits that `levenberg-marquardt` 0.15.0 gave, which agreed with this code on 20 000 random fits,
/// those with damped steps, without end and without a finite result among them.
#[test]
fn every_step_is_that_of_minpack() {
    let curve = Curve::through(&[1.0, 0.4, 0.1], 1e-3);
    for (start, bits) in [
        ([0.7, 0.9, 0.0], [0x3ff0_031b_faff_c2e4, 0x3fd9_9396_f94a_176c, 0x3fb9_9b07_deae_446a]),
        ([1.0, 0.4, 0.1], [0x3ff0_031b_faf2_c957, 0x3fd9_9396_f972_a223, 0x3fb9_9b07_de9f_a461]),
        ([50.0, 3.0, -4.0], [0x3ff0_031b_fb04_3a94, 0x3fd9_9396_f93c_3e0e, 0x3fb9_9b07_deb3_2bf0]),
        ([0.001, 20.0, 5.0], [0x3fe1_0b72_b705_61df, 0x4193_ce64_e1d8_e65f, 0xbfc0_811a_cea5_123c]),
        ([-3.0, 0.05, 2.0], [0x3ff0_031b_faff_c6e3, 0x3fd9_9396_f94a_0ac8, 0x3fb9_9b07_deae_48eb]),
        ([0.1, 0.02, 9.0], [0x3ff0_031b_fb03_c5f3, 0xbfd9_9396_f93d_655b, 0x3fb9_9b07_deb2_cacb]),
    ] {
        let found = minimise(&curve, &start).unwrap();
        let found: Vec<u64> = found.iter().map(|value| value.to_bits()).collect();
        assert_eq!(found, bits, "{start:?}");
    }
}

#[test]
fn exact_data_give_the_truth() {
    let truth = [1.0, 0.4, 0.1];
    let found = minimise(&Curve::through(&truth, 0.0), &[0.7, 0.9, 0.0]).unwrap();
    for (found, truth) in found.iter().zip(truth) {
        assert!((found - truth).abs() < 1e-12, "{found} {truth}");
    }
    assert_eq!(minimise(&Curve::through(&truth, 0.0), &truth).unwrap(), truth);
}

#[test]
fn a_start_without_finite_residuals_is_refused() {
    let curve = Curve::through(&[1.0, 0.4, 0.1], 0.0);
    assert!(minimise(&curve, &[f64::NAN, 1.0, 1.0]).is_err());
}

/// Rosenbrock's valley, from where it is usually begun.
struct Valley;

impl Problem for Valley {
    fn residuals(&self, x: &[f64]) -> DVector<f64> {
        DVector::from_vec(vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]])
    }

    fn jacobian(&self, x: &[f64]) -> DMatrix<f64> {
        DMatrix::from_row_slice(2, 2, &[-20.0 * x[0], 10.0, -1.0, 0.0])
    }
}

#[test]
fn a_bent_valley_is_followed_to_its_end() {
    assert_eq!(minimise(&Valley, &[-1.2, 1.0]).unwrap(), [1.0, 1.0]);
}

/// Two unknowns of which only the sum tells.
struct Twins;

impl Problem for Twins {
    fn residuals(&self, x: &[f64]) -> DVector<f64> {
        DVector::from_fn(5, |i, _| (x[0] + x[1]) * (i + 1) as f64 - 3.0)
    }

    fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(5, 2, |i, _| (i + 1) as f64)
    }
}

#[test]
fn columns_that_are_the_same_are_solved_in_one_of_them() {
    let found = minimise(&Twins, &[1.0, 1.0]).unwrap();
    assert!((found[0] + found[1] - 45.0 / 55.0).abs() < 1e-12, "{found:?}");
}
