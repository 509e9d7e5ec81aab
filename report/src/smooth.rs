//! One loop out of many, without the noise: what a picture of hysteresis shows.

use std::ops::Range;

/// Share of its extent by which a signal has to pass the middle before it counts: more than noise.
const BAND: f64 = 0.2;

/// Share of the samples at each end that do not count for the middle.
const SELDOM: f64 = 0.15;

/// Means over `half` samples on each side, fewer at the ends.
#[must_use]
pub fn moving_mean(values: &[f64], half: usize) -> Vec<f64> {
    let mut sums = Vec::with_capacity(values.len() + 1);
    sums.push(0.0);
    for value in values {
        sums.push(sums[sums.len() - 1] + value);
    }
    let mean = |i: usize| {
        let reach = half.min(i).min(values.len() - 1 - i);
        let (from, to) = (i - reach, i + reach + 1);
        (sums[to] - sums[from]) / (to - from) as f64
    };
    (0..values.len()).map(mean).collect()
}

/// One whole cycle of a signal that goes up and down: the last of those with the largest swing
/// within a twentieth. Everything if it has no whole cycle.
#[must_use]
pub fn one_cycle(values: &[f64]) -> Range<usize> {
    let extent = |values: &[f64]| {
        values
            .iter()
            .filter(|v| v.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)))
    };
    // What happens seldom, a transient say, does not tell where the middle is.
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let quantile = |share: f64| {
        sorted.get((share * (sorted.len() as f64 - 1.0)) as usize).copied().unwrap_or(0.0)
    };
    let (low, high) = (quantile(SELDOM), quantile(1.0 - SELDOM));
    let (middle, band) = (0.5 * (low + high), BAND * (high - low));
    let mut risings = Vec::new();
    let mut below = false;
    for (i, &value) in values.iter().enumerate() {
        if value < middle - band {
            below = true;
        } else if value > middle && below {
            below = false;
            risings.push(i);
        }
    }
    let mut cycles = risings.windows(2).map(|pair| pair[0]..pair[1] + 1);
    let swing = |range: &Range<usize>| {
        let (low, high) = extent(&values[range.clone()]);
        high - low
    };
    let largest = cycles.clone().map(|range| swing(&range)).fold(0.0, f64::max);
    cycles.rfind(|range| swing(range) >= 0.95 * largest).unwrap_or(0..values.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_keeps_a_slope_and_takes_noise_off() {
        let noisy: Vec<f64> =
            (0..1000).map(|i| f64::from(i) + if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let smooth = moving_mean(&noisy, 10);
        assert_eq!(smooth.len(), 1000);
        for (i, value) in smooth.iter().enumerate().take(990).skip(10) {
            assert!((value - i as f64).abs() < 0.1, "{i} {value}");
        }
        assert!(moving_mean(&[], 3).is_empty());
        assert_eq!(moving_mean(&[1.0, 2.0], 0), [1.0, 2.0]);
    }

    #[test]
    fn of_many_cycles_one_is_left() {
        let wave: Vec<f64> =
            (0..1000).map(|i| (f64::from(i) * 0.0628).sin() + 0.05 * f64::from(i % 3)).collect();
        let cycle = one_cycle(&wave);
        assert!((90..115).contains(&cycle.len()), "{cycle:?}");
        // A transient far from the cycles does not hide them.
        let late: Vec<f64> = (0..1000)
            .map(
                |i| if i < 80 { -30.0 + 0.3 * f64::from(i) } else { (f64::from(i) * 0.0628).sin() },
            )
            .collect();
        let cycle = one_cycle(&late);
        assert!((90..115).contains(&cycle.len()), "{cycle:?}");
        // What only rises has none.
        assert_eq!(one_cycle(&[0.0, 1.0, 2.0]), 0..3);
        assert_eq!(one_cycle(&[]), 0..0);
    }
}
