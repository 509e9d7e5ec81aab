//! Fuzzy compensation: a small table of rules over the error and the velocity's error (Takagi and
//! Sugeno 1985, of order zero; the rules are those of MacVicar-Whelan 1976). The thesis names the
//! technique (section 2.4) and does not try it.
//!
//! ```text
//! F^ = -limit * sum_ij m_i(e / e_1) m_j(d / d_1) T_ij
//! ```
//!
//! Both inputs have the same five sets: large and small, negative and positive, and zero: triangles
//! on -1, -1/2, 0, 1/2 and 1 that sum to one, so that inputs beyond the scales count as large. The
//! rules say: push against the error, less where it already goes back, in full where both are on one
//! side.
//!
//! | T | d nl | ns | z | ps | pl |
//! |---|---|---|---|---|---|
//! | **e nl** | -1 | -1 | -1 | -0.7 | 0 |
//! | **ns** | -1 | -1 | -0.7 | 0 | 0.7 |
//! | **z** | -1 | -0.7 | 0 | 0.7 | 1 |
//! | **ps** | -0.7 | 0 | 0.7 | 1 | 1 |
//! | **pl** | 0 | 0.7 | 1 | 1 | 1 |
//!
//! What is fuzzy about it is a gain that falls as the error grows: steep next to zero, where
//! friction holds the shaft, and never more than the limit. It is odd, continuous and without memory:
//! it cannot wind up, and it leaves an error under constant friction. Near zero it is a PD of the
//! gains `1.4 limit / e_1` and `1.4 limit / d_1`. In a velocity loop both errors are the same one.

use ::parameters::{ValueRange, parameters};

use crate::ObserverError;
use crate::finite::believed;

parameters! {
    /// What a fuzzy compensator is made of.
    #[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct FuzzyOptions {
        error: f64, "Controlled error that counts as large", unit("rad or rad/s"),
            range(ValueRange::POSITIVE);
        rate: f64, "Error of the velocity that counts as large", unit("rad/s"),
            range(ValueRange::POSITIVE);
        limit: f64, "Estimate where both are large", unit("N m"), range(ValueRange::POSITIVE);
    }
}

impl FuzzyOptions {
    /// For the velocity loop of the thesis's test bed.
    pub const SRV02: Self = Self { error: 0.2, rate: 0.2, limit: 0.1 };

    /// For its position loop.
    pub const SRV02_POSITION: Self = Self { error: 0.02, rate: 0.5, limit: 0.1 };
}

/// Number of sets of each input.
const SETS: usize = 5;

/// The rules, rows by the error, columns by the velocity's error.
const TABLE: [[f64; SETS]; SETS] = [
    [-1.0, -1.0, -1.0, -0.7, 0.0],
    [-1.0, -1.0, -0.7, 0.0, 0.7],
    [-1.0, -0.7, 0.0, 0.7, 1.0],
    [-0.7, 0.0, 0.7, 1.0, 1.0],
    [0.0, 0.7, 1.0, 1.0, 1.0],
];

/// A fuzzy compensator. It has no state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FuzzyCompensator {
    options: FuzzyOptions,
}

impl FuzzyCompensator {
    /// A compensator of these options.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the option.
    pub fn new(options: &FuzzyOptions) -> Result<Self, ObserverError> {
        options.check()?;
        Ok(Self { options: *options })
    }

    /// What it takes for friction now \[N m\], from the velocity's and the controlled `error`, both
    /// measured minus wanted. What is not finite is not believed: the torque is zero then.
    #[inline]
    #[must_use]
    pub fn observe(&self, velocity_error: f64, error: f64) -> f64 {
        let (Some(fast), Some(off)) = (believed(velocity_error), believed(error)) else {
            return 0.0;
        };
        let by_error = memberships(off / self.options.error);
        let by_rate = memberships(fast / self.options.rate);
        let row = |row: &[f64; SETS]| -> f64 { row.iter().zip(&by_rate).map(|(t, m)| t * m).sum() };
        let sum: f64 = TABLE.iter().zip(&by_error).map(|(rules, m)| m * row(rules)).sum();
        -self.options.limit * sum
    }
}

/// How much `x` belongs to each set; they sum to one.
#[inline]
fn memberships(x: f64) -> [f64; SETS] {
    // In steps from one set to the next, the first at zero.
    let place = 2.0 * (x.clamp(-1.0, 1.0) + 1.0);
    let mut all = [0.0; SETS];
    for (one, middle) in all.iter_mut().zip([0.0, 1.0, 2.0, 3.0, 4.0]) {
        *one = (1.0 - (place - middle).abs()).max(0.0);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPTIONS: FuzzyOptions = FuzzyOptions::SRV02_POSITION;

    fn at(error: f64, rate: f64) -> f64 {
        FuzzyCompensator::new(&OPTIONS).unwrap().observe(rate, error)
    }

    #[test]
    fn near_zero_it_is_the_pd_that_its_page_says() {
        let (e, d) = (1e-6 * OPTIONS.error, 1e-6 * OPTIONS.rate);
        let expected = -1.4e-6 * OPTIONS.limit;
        assert!((at(e, 0.0) / expected - 1.0).abs() < 1e-6);
        assert!((at(0.0, d) / expected - 1.0).abs() < 1e-6);
        assert!((at(e, d) / (2.0 * expected) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn it_pushes_against_the_error_and_never_more_than_its_limit() {
        let mut before = f64::INFINITY;
        for k in -200..=200 {
            let error = 0.01 * f64::from(k) * OPTIONS.error;
            let torque = at(error, 0.0);
            assert!(torque <= before + 1e-15, "{error}");
            before = torque;
            for rate in [-1.0, -0.3, 0.0, 0.2, 0.9].map(|x| x * OPTIONS.rate) {
                let torque = at(error, rate);
                assert!(torque.abs() <= OPTIONS.limit * (1.0 + 1e-12));
                assert!((torque + at(-error, -rate)).abs() < 1e-15, "odd at {error}, {rate}");
            }
        }
        assert_eq!(at(1e9, 1e9), -OPTIONS.limit);
        assert_eq!((at(f64::NAN, 0.0), at(0.0, f64::INFINITY)), (0.0, 0.0));
    }
}
