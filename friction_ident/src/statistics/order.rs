//! What the order of a sample says: quantiles and medians.

use serde::Serialize;

/// The values in ascending order.
pub fn sorted(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// The value below which `share` (0 to 1) of the sorted values lie, on straight lines between
/// neighbours: definition 7 of Hyndman and Fan (1996). None of no values.
///
/// ```
/// use friction_ident::statistics::quantile;
///
/// assert_eq!(quantile(&[1.0, 2.0, 3.0, 4.0], 0.25), Some(1.75));
/// assert_eq!(quantile(&[], 0.5), None);
/// ```
pub fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let place = share * sorted.len().checked_sub(1)? as f64;
    let (below, above) =
        (*sorted.get(place.floor() as usize)?, *sorted.get(place.ceil() as usize)?);
    Some(below + (above - below) * place.fract())
}

/// The least of the sorted values that at least `share` (0 to 1) of them do not exceed: definition
/// 1 of Hyndman and Fan (1996), a value that occurred. None of no values.
///
/// ```
/// use friction_ident::statistics::nearest_rank;
///
/// assert_eq!(nearest_rank(&[10, 20, 30, 40], 0.5), Some(20));
/// assert_eq!(nearest_rank(&[10, 20, 30, 40], 0.9), Some(40));
/// ```
pub fn nearest_rank<T: Copy>(sorted: &[T], share: f64) -> Option<T> {
    let rank = (sorted.len() as f64 * share).ceil().max(1.0) as usize;
    sorted.get(rank - 1).copied()
}

/// The value in the middle, of an even number the upper of the two; the values are reordered. None
/// of no values.
///
/// ```
/// use friction_ident::statistics::upper_median;
///
/// assert_eq!(upper_median(&mut [4.0, 1.0, 3.0, 2.0]), Some(3.0));
/// ```
pub fn upper_median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    (middle < values.len()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Quartiles of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quartiles {
    /// A quarter lies below.
    pub lower: f64,
    /// Half lies below.
    pub median: f64,
    /// Three quarters lie below.
    pub upper: f64,
}

impl Quartiles {
    /// Of the finite values, by [`quantile`]; none where there is none.
    pub fn of(values: &[f64]) -> Option<Self> {
        let sorted = sorted(values.iter().copied().filter(|value| value.is_finite()));
        let at = |share| quantile(&sorted, share);
        Some(Self { lower: at(0.25)?, median: at(0.5)?, upper: at(0.75)? })
    }
}

/// The rank `k` (from zero) for which the `k`-th smallest and the `k`-th largest of `n` independent
/// values enclose the median of their distribution, whatever it is, with at least 95 % (David and
/// Nagaraja 2003, Order Statistics, section 7.1). None below six values: no ranks enclose so much.
pub fn rank_of_95(n: usize) -> Option<usize> {
    // Largest rank whose binomial tail stays within 2.5 %.
    let mut tail = 0.5f64.powi(n.min(1000) as i32);
    let mut term = tail;
    let mut rank = None;
    for k in 0..n {
        if tail > 0.025 {
            break;
        }
        rank = Some(k);
        term *= (n - k) as f64 / (k + 1) as f64;
        tail += term;
    }
    rank
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_interpolate() {
        let values = sorted((0..=100).rev().map(f64::from));
        for share in [0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0] {
            assert_eq!(quantile(&values, share), Some((100.0 * share).round()));
        }
        assert!((quantile(&[1.0, 3.0], 0.05).unwrap() - 1.1).abs() < 1e-12);
        assert_eq!((quantile(&[7.0], 0.3), quantile(&[], 0.5)), (Some(7.0), None));
        assert_eq!(quantile(&[1.0, 2.0], 1.5), None);
    }

    #[test]
    fn quartiles_lie_between_neighbours() {
        let quartiles = Quartiles::of(&[4.0, 1.0, f64::NAN, 3.0, 2.0]).unwrap();
        assert_eq!((quartiles.lower, quartiles.median, quartiles.upper), (1.75, 2.5, 3.25));
        assert_eq!(Quartiles::of(&[]), None);
    }

    #[test]
    fn a_rank_is_that_of_a_value_that_occurred() {
        let values: Vec<u64> = (1..=100).collect();
        let found = [0.0, 0.5, 0.9, 0.99, 0.999, 1.0].map(|share| nearest_rank(&values, share));
        assert_eq!(found, [1, 50, 90, 99, 100, 100].map(Some));
        assert_eq!(nearest_rank::<u64>(&[], 0.5), None);
    }

    #[test]
    fn the_upper_median_is_a_value_of_the_sample() {
        assert_eq!(upper_median(&mut [3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(upper_median(&mut [2.0, 1.0]), Some(2.0));
        assert_eq!(upper_median(&mut []), None);
    }

    /// The ranks of the textbook's table for the sign test at 5 %.
    #[test]
    fn ranks_enclose_the_median() {
        let found = [5, 6, 9, 12, 20, 50].map(rank_of_95);
        assert_eq!(found, [None, Some(0), Some(1), Some(2), Some(5), Some(17)]);
    }
}
