//! Which points of a long line are worth drawing.
//!
//! A screen is a thousand or two pixels wide, a recording a hundred thousand samples long. Taking
//! every n-th sample would lose the spikes that an engineer looks for, so the samples are cut into
//! stretches and each stretch keeps the least and the greatest of every coordinate. Drawn through
//! those points a line covers the same pixels as the whole one. Because the stretches are counted
//! in samples, closed loops are served as well as signals over time.

/// Indices to keep so that at most `limit` remain, in rising order; `None` when all may stay.
///
/// `coordinates` are the series of one trace (x and y; x, lower and upper edge), all of one length.
/// A stretch in which a value is not finite also keeps the first such place, so that gaps stay
/// gaps.
pub(super) fn keep(coordinates: &[&[f64]], limit: usize) -> Option<Vec<usize>> {
    let n = coordinates.iter().map(|c| c.len()).min().unwrap_or(0);
    if n <= limit {
        return None;
    }
    // Two extremes a coordinate and one gap from each stretch, and the two ends.
    let stretches = (limit.saturating_sub(2) / (2 * coordinates.len() + 1)).max(1);
    let mut kept = Vec::with_capacity(limit);
    for k in 0..stretches {
        let (from, to) = (k * n / stretches, (k + 1) * n / stretches);
        let from_here = kept.len();
        kept.extend((from..to).find(|&i| coordinates.iter().any(|c| !c[i].is_finite())));
        for c in coordinates {
            let finite = || (from..to).filter(|&i| c[i].is_finite());
            kept.extend(finite().min_by(|&a, &b| c[a].total_cmp(&c[b])));
            kept.extend(finite().max_by(|&a, &b| c[a].total_cmp(&c[b])));
        }
        kept[from_here..].sort_unstable();
    }
    kept.insert(0, 0);
    kept.push(n - 1);
    kept.dedup();
    Some(kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
        values
            .filter(|v| v.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)))
    }

    #[test]
    fn short_lines_stay_whole() {
        let x = [0.0, 1.0, 2.0];
        assert_eq!(keep(&[&x, &x], 3), None);
        assert_eq!(keep(&[&[], &[]], 0), None);
    }

    #[test]
    fn a_single_spike_survives() {
        let x: Vec<f64> = (0..100_000).map(f64::from).collect();
        let mut y = vec![0.0; x.len()];
        y[54_321] = 1.0;
        assert!(keep(&[&x, &y], 4000).unwrap().contains(&54_321));
    }

    #[test]
    fn a_gap_stays_a_gap() {
        let x: Vec<f64> = (0..50_000).map(f64::from).collect();
        let mut y = vec![0.0; x.len()];
        y[777] = f64::NAN;
        let kept = keep(&[&x, &y], 1000).unwrap();
        assert_eq!(kept.iter().filter(|&&i| y[i].is_nan()).count(), 1);
    }

    proptest! {
        /// Every stretch keeps its extremes: within any of them, drawn and full data span the same
        /// range.
        #[test]
        fn extremes_of_every_stretch_survive(
            y in prop::collection::vec(prop_oneof![9 => -1e3..1e3, 1 => Just(f64::NAN)], 1..3000),
            limit in 12usize..400,
        ) {
            let x: Vec<f64> = (0..y.len()).map(|i| (i as f64 * 0.01).sin()).collect();
            let coordinates = [&x[..], &y[..]];
            let Some(kept) = keep(&coordinates, limit) else {
                prop_assert!(y.len() <= limit);
                return Ok(());
            };
            prop_assert!(kept.len() <= limit, "{} points kept, {limit} allowed", kept.len());
            prop_assert!(kept.windows(2).all(|w| w[0] < w[1]), "order changed");
            prop_assert_eq!((kept[0], kept[kept.len() - 1]), (0, y.len() - 1));
            let stretches = (limit - 2) / 5;
            for k in 0..stretches {
                let range = k * y.len() / stretches..(k + 1) * y.len() / stretches;
                for c in coordinates {
                    let drawn = kept.iter().filter(|i| range.contains(i)).map(|&i| c[i]);
                    prop_assert_eq!(extremes(drawn), extremes(c[range.clone()].iter().copied()));
                }
            }
        }
    }
}
