//! Smoothing and differentiation by local polynomials (Savitzky and Golay 1964, Analytical
//! Chemistry 36, 1627).
//!
//! Each sample is replaced by the value, or the slope, at its place of the polynomial that fits a
//! frame of samples around it best. At both ends the first and the last frame are fitted once and
//! read off at every place, so that nothing is lost and nothing is invented. Whatever is a
//! polynomial of the order comes back as it is, peaks keep their height better than under a
//! low-pass, and white noise is damped by a known factor ([`SavitzkyGolay::noise_gain`]).
//!
//! Own code, because the crates that offer it stop at the ends, differentiate not at all, or have
//! seen one release.

use nalgebra::DMatrix;

use crate::IdentError;

/// A filter for one order and one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct SavitzkyGolay {
    frame: usize,
    /// Row `i` gives the polynomial's value at place `i` of a frame.
    value: DMatrix<f64>,
    /// Likewise its slope, per sample.
    slope: DMatrix<f64>,
}

impl SavitzkyGolay {
    /// Polynomials of `order` (0 to 8) over `frame` samples: an odd number, larger than the order,
    /// 999 at most.
    ///
    /// # Errors
    /// [`IdentError::Frame`].
    pub fn new(order: usize, frame: usize) -> Result<Self, IdentError> {
        let refused = IdentError::Frame { order, frame };
        if order > 8 || frame.is_multiple_of(2) || frame <= order || frame > 999 {
            return Err(refused);
        }
        // Places from -1 to 1 keep the powers of one size.
        let half = (frame / 2).max(1) as f64;
        let place = |i: usize| (i as f64 - (frame / 2) as f64) / half;
        let powers = DMatrix::from_fn(frame, order + 1, |i, k| place(i).powi(k as i32));
        let slopes = DMatrix::from_fn(frame, order + 1, |i, k| {
            if k == 0 { 0.0 } else { k as f64 * place(i).powi(k as i32 - 1) / half }
        });
        let decomposed = powers.qr();
        let (q, r) = (decomposed.q(), decomposed.r());
        // The coefficients of the best polynomial are R^-1 Q^T y.
        let coefficients = r.solve_upper_triangular(&q.transpose()).ok_or(refused)?;
        Ok(Self { frame, value: &q * q.transpose(), slope: slopes * coefficients })
    }

    /// Order 3 over 31 samples: the thesis's, section 4.5.
    ///
    /// # Errors
    /// None: the numbers are allowed. A test builds it.
    pub fn thesis() -> Result<Self, IdentError> {
        Self::new(3, 31)
    }

    /// Samples of a frame; the shortest signal that can be filtered.
    pub fn frame(&self) -> usize {
        self.frame
    }

    /// Variance of a smoothed sample over that of the signal's white noise, away from the ends.
    pub fn noise_gain(&self) -> f64 {
        self.value.row(self.frame / 2).norm_squared()
    }

    /// Variance of the derivative over that of the signal's white noise \[1/s^2\], away from the
    /// ends, at the sampling period `time_step` \[s\].
    pub fn derivative_noise_gain(&self, time_step: f64) -> f64 {
        self.slope.row(self.frame / 2).norm_squared() / time_step.powi(2)
    }

    /// The signal smoothed; as long as it was.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] unless the signal fills a frame.
    pub fn smooth(&self, signal: &[f64]) -> Result<Vec<f64>, IdentError> {
        self.apply(&self.value, signal, 1.0)
    }

    /// The signal's derivative \[its unit per second\] at the sampling period `time_step` \[s\]; as
    /// long as the signal.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] unless the signal fills a frame, [`IdentError::TimeStep`].
    pub fn derivative(&self, signal: &[f64], time_step: f64) -> Result<Vec<f64>, IdentError> {
        if !(time_step > 0.0 && time_step.is_finite()) {
            return Err(IdentError::TimeStep(time_step));
        }
        self.apply(&self.slope, signal, 1.0 / time_step)
    }

    fn apply(
        &self,
        weights: &DMatrix<f64>,
        signal: &[f64],
        factor: f64,
    ) -> Result<Vec<f64>, IdentError> {
        let (n, frame, half) = (signal.len(), self.frame, self.frame / 2);
        if n < frame {
            return Err(IdentError::TooFewSamples {
                what: "Savitzky-Golay smoothing",
                needed: frame,
                found: n,
                lower: Some("the frame"),
            });
        }
        let read = |k: usize| {
            let first = k.saturating_sub(half).min(n - frame);
            let row = weights.row(k - first);
            row.iter().zip(&signal[first..first + frame]).map(|(w, y)| w * y).sum::<f64>() * factor
        };
        Ok((0..n).map(read).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal() -> Vec<f64> {
        (0..40).map(f64::from).map(|i| (0.3 * i).sin() + 0.005 * i.powf(1.5)).collect()
    }

    #[test]
    fn white_noise_is_damped_as_the_science_says() {
        let filter = SavitzkyGolay::thesis().unwrap();
        assert!((filter.noise_gain() - 0.0727).abs() < 5e-5, "{}", filter.noise_gain());
        // The cubic's slope at the centre, from the normal equations of its odd part.
        let s = |p: i32| (-15..=15).map(|i| f64::from(i).powi(p)).sum::<f64>();
        let closed = s(6) / (s(2) * s(6) - s(4) * s(4));
        assert!((filter.derivative_noise_gain(1.0) / closed - 1.0).abs() < 1e-12);
    }

    /// SciPy 1.17, `savgol_filter(signal, frame, order)` and `deriv=1, delta=0.01`, both ends
    /// included.
    #[test]
    fn agrees_with_scipy() {
        for (order, frame, smooth, slope) in [
            (
                3,
                31,
                [
                    0.7573268067639,
                    0.7122834890676,
                    0.3706482993086,
                    -0.1236666164627,
                    -0.5606051174744,
                ],
                [
                    -4.126202535455,
                    -4.859119335731,
                    18.54381782214,
                    -40.24445896855,
                    -47.21311262506,
                ],
            ),
            (
                2,
                11,
                [
                    -0.03317324034808,
                    0.3242009130959,
                    0.1739652353884,
                    0.2539605378648,
                    0.3723436946545,
                ],
                [39.35052671216, 32.12430397663, 25.15314307216, 9.20622873373, 14.47040262422],
            ),
        ] {
            let filter = SavitzkyGolay::new(order, frame).unwrap();
            let (smoothed, slopes) =
                (filter.smooth(&signal()).unwrap(), filter.derivative(&signal(), 0.01).unwrap());
            for (k, (expected, expected_slope)) in
                [0, 1, 20, 38, 39].into_iter().zip(smooth.into_iter().zip(slope))
            {
                assert!((smoothed[k] - expected).abs() < 1e-11, "{k}: {}", smoothed[k]);
                assert!((slopes[k] - expected_slope).abs() < 1e-9, "{k}: {}", slopes[k]);
            }
        }
    }

    #[test]
    fn a_cubic_comes_back_with_its_slope_ends_included() {
        let filter = SavitzkyGolay::thesis().unwrap();
        let dt = 0.01;
        let time: Vec<f64> = (0..100).map(|k| f64::from(k) * dt).collect();
        let cubic: Vec<f64> =
            time.iter().map(|t| 1.0 - 2.0 * t + 3.0 * t * t - 4.0 * t * t * t).collect();
        let slope = filter.derivative(&cubic, dt).unwrap();
        for ((smooth, value), (slope, t)) in
            filter.smooth(&cubic).unwrap().iter().zip(&cubic).zip(slope.iter().zip(&time))
        {
            assert!((smooth - value).abs() < 1e-12);
            assert!((slope - (-2.0 + 6.0 * t - 12.0 * t * t)).abs() < 1e-10, "at {t} s: {slope}");
        }
    }

    #[test]
    fn what_cannot_be_filtered_is_refused() {
        for (order, frame) in [(3, 30), (3, 3), (9, 31), (3, 1001), (0, 0)] {
            assert!(
                matches!(SavitzkyGolay::new(order, frame), Err(IdentError::Frame { .. })),
                "{order} {frame}"
            );
        }
        let filter = SavitzkyGolay::thesis().unwrap();
        assert!(matches!(
            filter.smooth(&[0.0; 30]),
            Err(IdentError::TooFewSamples { needed: 31, .. })
        ));
        assert!(filter.derivative(&[0.0; 31], 0.0).is_err() && filter.smooth(&[]).is_err());
        assert_eq!(SavitzkyGolay::new(0, 1).unwrap().smooth(&[2.0, 3.0]).unwrap(), [2.0, 3.0]);
    }
}
