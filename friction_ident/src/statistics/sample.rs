//! Mean and scatter.

use crate::Uncertain;

/// Root of the mean of the squares; zero of no values.
pub fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Mean and scatter of a sample.
///
/// ```
/// use friction_ident::statistics::Sample;
///
/// let sample = Sample::of([1.0, 2.0, 3.0, 4.0].into_iter());
/// assert_eq!((sample.mean, sample.variance()), (2.5, 5.0 / 3.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// How many values.
    pub count: usize,
    /// Their mean; not a number of no values.
    pub mean: f64,
    /// Sum of the squares of their distances from the mean.
    pub squares: f64,
}

impl Sample {
    /// Of `values`, which are gone through twice.
    pub fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let count = values.clone().count();
        let mean = values.clone().sum::<f64>() / count as f64;
        let squares = values.map(|value| (value - mean).powi(2)).sum();
        Self { count, mean, squares }
    }

    /// Variance of the distribution that the sample was drawn from; zero of a single value.
    pub fn variance(&self) -> f64 {
        self.squares / self.count.saturating_sub(1).max(1) as f64
    }

    /// Standard deviation of the distribution that the sample was drawn from; zero of a single
    /// value.
    pub fn deviation(&self) -> f64 {
        self.variance().sqrt()
    }

    /// Standard deviation of the values themselves, which are all there are.
    pub fn own_deviation(&self) -> f64 {
        (self.squares / self.count as f64).sqrt()
    }

    /// The mean with its standard error, if the values are independent; none of fewer than two.
    pub fn uncertain_mean(&self) -> Option<Uncertain> {
        let standard_error = (self.variance() / self.count as f64).sqrt();
        (self.count > 1).then_some(Uncertain { value: self.mean, standard_error })
    }
}

/// Mean and scatter of values that are not kept, by Welford's update (1962, Technometrics 4, 419).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RunningSample {
    /// How many values.
    pub count: u32,
    /// Their mean; zero of no values.
    pub mean: f64,
    squares: f64,
}

impl RunningSample {
    /// Takes in one more.
    pub fn add(&mut self, value: f64) {
        self.count += 1;
        let difference = value - self.mean;
        self.mean += difference / f64::from(self.count);
        self.squares += difference * (value - self.mean);
    }

    /// Standard deviation of the distribution that the sample was drawn from; zero of fewer than
    /// two values.
    pub fn deviation(&self) -> f64 {
        if self.count < 2 { 0.0 } else { (self.squares / f64::from(self.count - 1)).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_is_as_sure_as_its_scatter_and_number_allow() {
        let found = Sample::of([1.0, 2.0, 3.0, 4.0].into_iter());
        let mean = found.uncertain_mean().unwrap();
        assert_eq!(mean.value, 2.5);
        assert!((mean.standard_error - (5.0f64 / 3.0 / 4.0).sqrt()).abs() < 1e-15);
        assert!((found.own_deviation() - 1.25f64.sqrt()).abs() < 1e-15);
        let single = Sample::of([1.0].into_iter());
        assert_eq!((single.uncertain_mean(), single.deviation()), (None, 0.0));
        assert!(Sample::of([].into_iter()).mean.is_nan());
    }

    #[test]
    fn values_that_are_not_kept_have_the_same_mean_and_scatter() {
        let values: Vec<f64> = (0..1000).map(|i| 1e3 + f64::from(i * 7919 % 101)).collect();
        let mut running = RunningSample::default();
        values.iter().for_each(|&value| running.add(value));
        let sample = Sample::of(values.iter().copied());
        assert!((running.mean / sample.mean - 1.0).abs() < 1e-14);
        assert!((running.deviation() / sample.deviation() - 1.0).abs() < 1e-12);
        assert_eq!(RunningSample::default().deviation(), 0.0);
    }

    #[test]
    fn squares_have_a_root_of_their_mean() {
        assert_eq!((root_mean_square(&[3.0, -3.0]), root_mean_square(&[])), (3.0, 0.0));
    }
}
