//! The path of a position in counts beside a measured velocity.
//!
//! Each knows what the other does not. The velocity tells the motion within a count, but its offset
//! and its lag add up to a drift that soon is longer than a contact bends. The counts never drift,
//! and tell nothing within a count. What the way by the velocity lacks is therefore sought as the
//! correction that varies least of all that agree with the counts: the shortest line through the
//! tube of readings less way, a count wide (the taut string of Davies and Kovac 2001, Annals of
//! Statistics 29, 1-65). It is straight wherever the counts leave it free, so that it adds no noise
//! of theirs to the motion.
//!
//! The noise of the velocity is left then. A contact at rest under a load takes it for motion to and
//! fro, and a bristle that gives way with every bit of it has let the load go after seconds. So the
//! path is the shortest of those, too, that lie as near as the noise lets one tell.

use std::collections::VecDeque;

/// Deviations of the readings from the way by the velocity that the tube is wide at least to each
/// side: readings may scatter by more than their counts do.
const DEVIATIONS: f64 = 2.0;

/// Time over which the noise of the velocity is summed up to a way that cannot be told from rest
/// \[s\], and deviations of that way.
const UNTOLD: f64 = 0.25;
const OF_THE_WAY: f64 = 2.0;

/// The path by a measured velocity, corrected by the least that brings it to the readings of a
/// position \[m or rad\], with the length of a count: zero where it is not told in counts.
pub fn path_beside_velocity(
    position: &[f64],
    count: f64,
    velocity: &[f64],
    time_step: f64,
) -> Vec<f64> {
    let mut way = 0.0;
    let mut before = None;
    let mut path: Vec<f64> = velocity
        .iter()
        .map(|&v| {
            way += before.map_or(0.0, |before: f64| 0.5 * time_step * (before + v));
            before = Some(v);
            way
        })
        .collect();
    let apart: Vec<f64> = position.iter().zip(&path).map(|(q, way)| q - way).collect();
    let half = f64::max(0.5 * count, DEVIATIONS * scatter(&apart));
    path.iter_mut().zip(taut_string(&apart, half)).for_each(|(way, by)| *way += by);
    let untold = OF_THE_WAY * noise(velocity) * (time_step * UNTOLD).sqrt();
    taut_string(&path, untold.min(half))
}

/// The path of a position whose readings scatter [m or rad], without the motion to and fro that is
/// within their scatter.
pub fn path_within_scatter(position: &[f64]) -> Vec<f64> {
    taut_string(position, DEVIATIONS * noise(position))
}

/// Deviation of the noise of one sample, from fourth differences in the usual case: of white noise
/// they have the square root of 70 times the deviation, and of a motion next to nothing.
fn noise(values: &[f64]) -> f64 {
    let fourth = values.windows(5).map(|v| v[0] - 4.0 * v[1] + 6.0 * v[2] - 4.0 * v[3] + v[4]);
    usual(fourth) / 70f64.sqrt()
}

/// Deviation of one reading, from how neighbours differ in the usual case.
fn scatter(apart: &[f64]) -> f64 {
    usual(apart.windows(2).map(|pair| pair[1] - pair[0])) / std::f64::consts::SQRT_2
}

/// Standard deviation of what is normal in the usual case: the median of its magnitude is 0.6745 of
/// it.
fn usual(values: impl Iterator<Item = f64>) -> f64 {
    let mut sizes: Vec<f64> = values.map(f64::abs).collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let middle = sizes.len() / 2;
    let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
    *median / 0.6745
}

/// A knot of the string: sample, and value there.
type Knot = (usize, f64);

fn slope(from: Knot, to: Knot) -> f64 {
    (to.1 - from.1) / (to.0 - from.0) as f64
}

/// The shortest line that stays within `half` of `values` and begins and ends on them. Each sample
/// enters and leaves the two chains once.
fn taut_string(values: &[f64], half: f64) -> Vec<f64> {
    let (Some(&first), last) = (values.first(), values.len().saturating_sub(1)) else {
        return Vec::new();
    };
    let mut knots: Vec<Knot> = vec![(0, first)];
    let mut anchor = (0, first);
    // From the anchor on: the bounds that a line would touch from below, and from above.
    let (mut upper, mut lower) = (VecDeque::<Knot>::new(), VecDeque::<Knot>::new());
    for (k, &value) in values.iter().enumerate().skip(1) {
        let half = if k == last { 0.0 } else { half };
        extend(&mut upper, anchor, (k, value + half), |before, after| before >= after);
        extend(&mut lower, anchor, (k, value - half), |before, after| before <= after);
        while let (Some(&above), Some(&below)) = (upper.front(), lower.front())
            && slope(anchor, above) < slope(anchor, below)
        {
            // No straight line reaches both: it bends at the bound that comes first.
            let bend = if above.0 < below.0 { &mut upper } else { &mut lower };
            anchor = bend.pop_front().unwrap_or((k, value));
            knots.push(anchor);
        }
    }
    if last > 0 {
        knots.push((last, values[last]));
    }
    let mut line = Vec::with_capacity(values.len());
    line.push(first);
    for pair in knots.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        line.extend((from.0 + 1..=to.0).map(|k| from.1 + slope(from, to) * (k - from.0) as f64));
    }
    line
}

/// Adds a bound to a chain that bends one way only.
fn extend(chain: &mut VecDeque<Knot>, anchor: Knot, bound: Knot, bends: fn(f64, f64) -> bool) {
    while let Some(&back) = chain.back() {
        let before = chain.len().checked_sub(2).and_then(|place| chain.get(place));
        let before = before.copied().unwrap_or(anchor);
        if !bends(slope(before, back), slope(back, bound)) {
            break;
        }
        chain.pop_back();
    }
    chain.push_back(bound);
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};

    use super::*;

    const COUNT: f64 = std::f64::consts::TAU / 4096.0;

    /// A sensor of velocity that reads 2 mrad/s too much had gone 0.06 rad astray after half a
    /// minute, ten times as far as the contact bends.
    #[test]
    fn a_velocity_with_an_offset_does_not_drift_away_from_the_counts() {
        let dt = 2e-3;
        let position = |k: usize| 0.02 * (0.7 * dt * k as f64).sin();
        let velocity = |k: usize| 0.014 * (0.7 * dt * k as f64).cos() + 2e-3;
        let counted: Vec<f64> =
            (0..15_000).map(|k| (position(k) / COUNT).round() * COUNT).collect();
        let velocity: Vec<f64> = (0..15_000).map(velocity).collect();
        let path = path_beside_velocity(&counted, COUNT, &velocity, dt);
        let off = |k: usize| path[k] - position(k);
        assert!((0..15_000).all(|k| off(k).abs() < COUNT));
        // Within a count the motion is that of the velocity: the offset is seen and taken away.
        let way_off = |k: usize| (off(k + 1) - off(k)) / dt;
        let error = (100..14_900).map(|k| way_off(k).powi(2)).sum::<f64>() / 14_800.0;
        assert!(error.sqrt() < 3e-4, "{}", error.sqrt());
    }

    #[test]
    fn a_velocity_without_fault_is_followed_as_it_is() {
        let dt = 1e-3;
        let position = |k: usize| 1.2 * (1.0 - (0.5 * dt * k as f64).cos());
        let velocity: Vec<f64> = (0..20_000).map(|k| 0.6 * (0.5 * dt * k as f64).sin()).collect();
        let counted: Vec<f64> =
            (0..20_000).map(|k| (position(k) / COUNT).floor() * COUNT).collect();
        let path = path_beside_velocity(&counted, COUNT, &velocity, dt);
        for k in 500..19_000 {
            let way = (path[k + 1] - path[k]) / dt;
            assert!((way - velocity[k]).abs() < 2e-3, "{k}: {way} for {}", velocity[k]);
        }
    }

    /// Held under a load for half a minute: by the way of the noise a bristle of 0.005 rad had let
    /// go half of the load.
    #[test]
    fn a_noisy_velocity_does_not_move_an_axis_that_rests() {
        let dt = 2e-3;
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(1);
        let mut noisy = || 1.3e-3 * rng.sample::<f64, _>(rand_distr::StandardNormal);
        let count = 0.1 * COUNT;
        let velocity: Vec<f64> = (0..15_000).map(|_| noisy()).collect();
        let path = path_beside_velocity(&vec![7.0 * count; 15_000], count, &velocity, dt);
        let way: f64 = path.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
        let by_velocity: f64 = velocity.iter().map(|v| v.abs() * dt).sum();
        assert!(way < 0.02 * by_velocity, "{way} of {by_velocity}");
    }

    proptest! {
        /// Within the tube, and no longer than any other line there: the readings are one.
        #[test]
        fn the_string_stays_in_its_tube_and_is_the_shortest(
            values in prop::collection::vec(-3.0..3.0f64, 1..60),
            half in 0.0..2.0f64,
        ) {
            let line = taut_string(&values, half);
            prop_assert_eq!(line.len(), values.len());
            for (at, value) in line.iter().zip(&values) {
                prop_assert!((at - value).abs() <= half + 1e-9, "{at} for {value}");
            }
            let varies = |line: &[f64]| line.windows(2).map(|p| (p[1] - p[0]).abs()).sum::<f64>();
            prop_assert!(varies(&line) <= varies(&values) + 1e-9);
            // Wherever it bends, it bends at a bound, and away from it.
            for k in 1..line.len().saturating_sub(1) {
                let bend = line[k + 1] - 2.0 * line[k] + line[k - 1];
                if bend.abs() > 1e-9 {
                    let bound = values[k] + bend.signum() * half;
                    prop_assert!((line[k] - bound).abs() < 1e-9, "{k}: {} and {bound}", line[k]);
                }
            }
        }
    }
}
