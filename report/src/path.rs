//! Where the arrows of a path stand.

/// Arrows of a path.
const ARROWS: usize = 5;

/// How far an arrow looks back for its direction, as a share of the path: further than noise
/// reaches.
const BACK: f64 = 0.01;

/// For each arrow the index of the point before and of the point at its tip. Lengths are measured
/// with both axes' extents as units, since that is how the path is seen.
pub(super) fn arrows(x: &[f64], y: &[f64]) -> Vec<(usize, usize)> {
    let finite: Vec<usize> =
        (0..x.len().min(y.len())).filter(|&i| x[i].is_finite() && y[i].is_finite()).collect();
    let extent = |values: &[f64]| {
        let (low, high) =
            finite.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &i| {
                (low.min(values[i]), high.max(values[i]))
            });
        if high > low { high - low } else { 1.0 }
    };
    let (width, height) = (extent(x), extent(y));
    let mut so_far = Vec::with_capacity(finite.len());
    let mut length = 0.0;
    for (place, &i) in finite.iter().enumerate() {
        if let Some(&before) = place.checked_sub(1).and_then(|place| finite.get(place)) {
            length += ((x[i] - x[before]) / width).hypot((y[i] - y[before]) / height);
        }
        so_far.push(length);
    }
    if length <= 0.0 {
        return Vec::new();
    }
    (0..ARROWS)
        .filter_map(|arrow| {
            let at = length * (arrow as f64 + 0.5) / ARROWS as f64;
            let tip = so_far.partition_point(|&so_far| so_far < at).clamp(1, finite.len() - 1);
            let before = so_far.partition_point(|&so_far| so_far < at - BACK * length).min(tip - 1);
            let (before, tip) = (finite[before], finite[tip]);
            (x[before] != x[tip] || y[before] != y[tip]).then_some((before, tip))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_follow_the_path() {
        let angle = |i: usize| i as f64 * 0.01 * std::f64::consts::TAU;
        let x: Vec<f64> = (0..=100).map(|i| angle(i).cos()).collect();
        let y: Vec<f64> = (0..=100).map(|i| 1e-3 * angle(i).sin()).collect();
        let found = arrows(&x, &y);
        assert_eq!(found.len(), ARROWS);
        for (before, tip) in found {
            assert!(before < tip && tip - before <= 3);
        }
    }

    #[test]
    fn what_does_not_move_has_none() {
        assert!(arrows(&[], &[]).is_empty());
        assert!(arrows(&[1.0, 1.0, f64::NAN], &[2.0, 2.0, 0.0]).is_empty());
        assert!(arrows(&[1.0], &[2.0]).is_empty());
    }
}
