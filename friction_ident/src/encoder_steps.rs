//! A position from between the steps of an encoder.
//!
//! An encoder that turns slowly stands still for many samples and then jumps by a step; the difference of such positions is a row of spikes. But where it
//! jumps, the axis is known to be at the edge between two counts. The position is drawn straight from edge to edge: never further than a step
//! from what was read, and its velocity is the mean velocity between two edges.

/// The step of an encoder that can be seen in `position` \[m or rad\]: the greatest length of which all differences are multiples, where the
/// position stands still for a fifth of the samples at least. None for a position without such steps.
///
/// ```
/// let slow: Vec<f64> = (0..1000).map(|k| (0.03 * k as f64).floor() * 0.5).collect();
/// assert_eq!(friction_ident::encoder_steps::step_of(&slow), Some(0.5));
/// assert_eq!(friction_ident::encoder_steps::step_of(&[0.0, 0.1, 0.25]), None);
/// ```
pub fn step_of(position: &[f64]) -> Option<f64> {
    let differences = position.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let largest = position.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
    let rounding = 1e-9 * largest;
    let (mut still, mut step) = (0usize, f64::INFINITY);
    for difference in differences.clone() {
        if difference <= rounding {
            still += 1;
        } else {
            step = step.min(difference);
        }
    }
    // Positions printed with few digits are multiples to that rounding only.
    let is_multiple = |d: f64| (d / step - (d / step).round()).abs() < 0.05;
    let stands = 5 * still >= position.len().saturating_sub(1);
    (step.is_finite() && stands && differences.filter(|&d| d > rounding).all(is_multiple)).then_some(step)
}

/// The position drawn straight from edge to edge \[m or rad\], as long as `position`. A position without jumps comes back as it is.
pub fn between_edges(position: &[f64]) -> Vec<f64> {
    let (Some(&first), Some(&last)) = (position.first(), position.last()) else { return Vec::new() };
    // (time in samples, position) of the edges, and of both ends.
    let mut knots = vec![(0.0, first)];
    for (k, pair) in position.windows(2).enumerate() {
        if pair[0] != pair[1] {
            knots.push((k as f64 + 0.5, 0.5 * (pair[0] + pair[1])));
        }
    }
    knots.push(((position.len() - 1) as f64, last));
    let mut drawn = Vec::with_capacity(position.len());
    let mut knot = 0;
    for k in 0..position.len() {
        let at = k as f64;
        while knot + 2 < knots.len() && knots[knot + 1].0 < at {
            knot += 1;
        }
        let ((t0, p0), (t1, p1)) = (knots[knot], knots[(knot + 1).min(knots.len() - 1)]);
        drawn.push(if t1 > t0 { p0 + (p1 - p0) * (at - t0) / (t1 - t0) } else { p0 });
    }
    drawn
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::savitzky_golay::SavitzkyGolay;

    const STEP: f64 = TAU / 4096.0;
    const DT: f64 = 1e-3;

    fn encoder(position: impl Fn(f64) -> f64, samples: usize) -> (Vec<f64>, Vec<f64>) {
        let truth: Vec<f64> = (0..samples).map(|k| position(k as f64 * DT)).collect();
        let read = truth.iter().map(|p| (p / STEP).round() * STEP).collect();
        (truth, read)
    }

    #[test]
    fn the_step_is_seen_where_the_axis_is_slow() {
        let (_, slow) = encoder(|t| 0.3 * (0.5 * t).sin(), 8000);
        assert!((step_of(&slow).unwrap() / STEP - 1.0).abs() < 1e-9);
        let (smooth, _) = encoder(|t| 0.3 * (0.5 * t).sin(), 8000);
        assert_eq!(step_of(&smooth), None);
        assert_eq!(step_of(&[0.0; 100]), None);
        assert_eq!(step_of(&[]), None);
    }

    #[test]
    fn the_drawn_position_stays_within_a_step_of_the_truth() {
        let (truth, read) = encoder(|t| 0.02 * (0.5 * t).sin() + 0.004 * (3.0 * t).sin(), 20_000);
        for (drawn, truth) in between_edges(&read).iter().zip(&truth) {
            assert!((drawn - truth).abs() <= STEP, "{drawn} beside {truth}");
        }
        assert_eq!(between_edges(&[1.0, 1.0, 1.0]), [1.0, 1.0, 1.0]);
        assert_eq!(between_edges(&[2.0]), [2.0]);
        assert!(between_edges(&[]).is_empty());
    }

    /// At .03 rad/s the differences of what is read are 0 or 1.5 rad/s; drawn from edge to edge and smoothed they stay near .03.
    #[test]
    fn steps_do_not_become_velocity_spikes() {
        let (_, read) = encoder(|t| 0.03 * t + 2e-4, 5000);
        let filter = SavitzkyGolay::thesis().unwrap();
        let velocity = filter.derivative(&between_edges(&read), DT).unwrap();
        for v in &velocity[100..4900] {
            assert!((v - 0.03).abs() < 0.002, "{v}");
        }
        let straight = filter.derivative(&read, DT).unwrap();
        assert!(straight[100..4900].iter().any(|v| (v - 0.03).abs() > 0.02), "or the drawing is not needed");
    }
}
