//! Samples that cannot be true: the Hampel identifier (Hampel 1974; Pearson 2002, IEEE Trans.
//! Control Systems Technology 10, 55).
//!
//! A sample that is further from the median of its neighbourhood than so many robust deviations is
//! replaced by that median. Which, from what and to what is returned: nothing is changed silently.
//! A step, as friction makes at a reversal, is no outlier: the median follows it at once.

use serde::Serialize;

use crate::IdentError;
use crate::quantiser::step_of;
use crate::statistics::upper_median;

/// The identifier's two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Hampel {
    /// Samples looked at on either side, three at least.
    pub half_window: usize,
    /// Robust deviations (1.4826 times the median absolute deviation) beyond which a sample is not
    /// believed.
    pub threshold: f64,
}

impl Default for Hampel {
    /// Five samples on either side, six deviations: of white noise fewer than one sample in a
    /// million.
    fn default() -> Self {
        Self { half_window: 5, threshold: 6.0 }
    }
}

/// One sample that was replaced.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Replaced {
    /// Which, counted from zero.
    pub index: usize,
    /// What it was.
    pub measured: f64,
    /// What it became.
    pub by: f64,
}

/// A signal without its outliers.
#[derive(Debug, Clone, PartialEq)]
pub struct Cleaned {
    /// The signal, as long as it was.
    pub signal: Vec<f64>,
    /// What was replaced, in order.
    pub replaced: Vec<Replaced>,
}

/// Factor from the median absolute deviation of a normal distribution to its standard deviation.
const TO_DEVIATION: f64 = 1.4826;

impl Hampel {
    /// Replaces the outliers of `signal`. The deviation of a neighbourhood never counts as less
    /// than the usual one of the signal or than a converter's step: eleven samples may be alike by
    /// chance, and a signal that mostly stands still may move by its steps. The first and last
    /// three samples have too few neighbours and stay.
    ///
    /// # Errors
    /// [`IdentError::Hampel`] for a window of fewer than three samples or a threshold that is not
    /// above zero, [`IdentError::NotFinite`].
    pub fn clean(&self, signal: &[f64]) -> Result<Cleaned, IdentError> {
        let Self { half_window, threshold } = *self;
        if half_window < FEWEST || !(threshold > 0.0 && threshold.is_finite()) {
            return Err(IdentError::Hampel { half_window, threshold });
        }
        if let Some(index) = signal.iter().position(|value| !crate::finite::usable(*value)) {
            return Err(IdentError::NotFinite {
                channel: "the signal",
                index,
                value: signal[index],
            });
        }
        let n = signal.len();
        let middle = |values: &mut [f64]| upper_median(values).unwrap_or(0.0);
        let mut window = Vec::with_capacity(2 * half_window + 1);
        // Near the ends the window shrinks on both sides alike: one-sided it would call a slope an
        // outlier.
        let mut around: Vec<(f64, f64)> = (FEWEST..n.saturating_sub(FEWEST))
            .map(|index| {
                let reach = half_window.min(index).min(n - 1 - index);
                window.clear();
                window.extend_from_slice(&signal[index - reach..=index + reach]);
                let by = middle(&mut window);
                window.iter_mut().for_each(|value| *value = (*value - by).abs());
                (by, TO_DEVIATION * middle(&mut window))
            })
            .collect();
        let mut deviations: Vec<f64> = around.iter().map(|(_, deviation)| *deviation).collect();
        let usual = middle(&mut deviations);
        let least = usual.max(least_deviation(signal));
        let mut cleaned = Cleaned { signal: signal.to_vec(), replaced: Vec::new() };
        for (index, (by, deviation)) in (FEWEST..).zip(around.drain(..)) {
            let measured = signal[index];
            if (measured - by).abs() > threshold * deviation.max(least) {
                cleaned.signal[index] = by;
                cleaned.replaced.push(Replaced { index, measured, by });
            }
        }
        Ok(cleaned)
    }
}

/// Neighbours on either side without which nothing is judged.
const FEWEST: usize = 3;

/// The converter's step where it is seen ten times at least, and never less than the rounding of
/// printed numbers.
fn least_deviation(signal: &[f64]) -> f64 {
    let largest = signal.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
    let rounding = 1e-9 * largest;
    let moves = signal.windows(2).filter(|pair| (pair[1] - pair[0]).abs() > rounding).count();
    match step_of(signal) {
        Some(step) if moves >= 10 => step.max(rounding),
        _ => rounding,
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64Mcg;

    use super::*;

    fn noise(n: usize, deviation: f64) -> Vec<f64> {
        let mut rng = Pcg64Mcg::seed_from_u64(4);
        (0..n).map(|_| deviation * rng.sample::<f64, _>(StandardNormal)).collect()
    }

    /// Friction of a slow reversing motion: steps of twice the Coulomb level.
    fn reversing(n: usize) -> Vec<f64> {
        (0..n).map(|k| (0.02 * k as f64).sin()).map(|v| 0.09 * v.signum() + 0.04 * v).collect()
    }

    #[test]
    fn spikes_are_replaced_and_reported() {
        let mut signal: Vec<f64> =
            reversing(4000).iter().zip(noise(4000, 1e-3)).map(|(a, b)| a + b).collect();
        let places = [100, 777, 778, 3995];
        places.iter().for_each(|&k| signal[k] += 0.5);
        let cleaned = Hampel::default().clean(&signal).unwrap();
        let found: Vec<_> = cleaned.replaced.iter().map(|replaced| replaced.index).collect();
        assert_eq!(found, places, "{:?}", cleaned.replaced);
        for replaced in &cleaned.replaced {
            assert_eq!(
                (replaced.measured, replaced.by),
                (signal[replaced.index], cleaned.signal[replaced.index])
            );
            assert!((replaced.measured - replaced.by - 0.5).abs() < 0.01, "{replaced:?}");
        }
    }

    #[test]
    fn the_steps_of_friction_at_reversals_are_no_outliers() {
        for deviation in [0.0, 1e-4, 6e-3] {
            let signal: Vec<f64> = reversing(20_000)
                .iter()
                .zip(noise(20_000, deviation))
                .map(|(a, b)| a + b)
                .collect();
            let cleaned = Hampel::default().clean(&signal).unwrap();
            assert!(cleaned.replaced.len() <= 1, "{deviation}: {:?}", cleaned.replaced);
        }
    }

    /// A quiet torque sensor shows one step of its converter most of the time; the next step is no
    /// outlier.
    #[test]
    fn converter_steps_are_no_outliers() {
        let step = 0.01123;
        let signal: Vec<f64> =
            noise(20_000, 0.0045).iter().map(|x| ((x + 0.0925) / step).round() * step).collect();
        assert!(Hampel::default().clean(&signal).unwrap().replaced.is_empty());
    }

    #[test]
    fn what_cannot_be_cleaned_is_refused() {
        assert!(Hampel { half_window: 2, threshold: 3.0 }.clean(&[1.0]).is_err());
        assert!(Hampel { half_window: 3, threshold: f64::NAN }.clean(&[1.0]).is_err());
        assert!(Hampel::default().clean(&[1.0, f64::NAN]).is_err());
        assert!(Hampel::default().clean(&[]).unwrap().signal.is_empty());
        assert!(Hampel::default().clean(&[0.0, 9.0, 0.0]).unwrap().replaced.is_empty());
        let lonely = [0.0, 0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(Hampel::default().clean(&lonely).unwrap().signal, [0.0; 9]);
    }
}
