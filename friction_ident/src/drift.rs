//! Whether the friction of an axis, or a constant force, changes while it is recorded: grease warms
//! up, a belt settles, the zero of a sensor wanders.
//!
//! A fit takes friction for the same throughout. Where it is not, and the motion is another late
//! than early (a chirp, a list of rising speeds), viscous friction takes up what time has done, and
//! no error counts that. So what the fit leaves in the direction of motion is averaged over blocks
//! of time, and a line through the blocks says whether it goes with time.

use crate::rigid_axis::Prediction;
use crate::statistics::{Sample, root_mean_square};

/// Blocks of time.
const BLOCKS: usize = 12;
/// Blocks in which the axis must have turned round for anything to be said.
const FEWEST_BLOCKS: usize = 6;
/// Rows of each direction that such a block needs.
const FEWEST_ROWS: usize = 4;
/// Deviations of a normal distribution beyond which a slope is no chance: once in 1000 recordings.
const BEYOND_CHANCE: f64 = 3.3;
/// Share of the friction below which nobody would notice the change.
const NOTICED: f64 = 0.05;

/// The change of the friction from the beginning to the end of a recording, as a share of its root
/// mean square; below zero where it falls. None where it is not clear of chance, or too small to
/// matter.
#[must_use]
pub fn drift(prediction: &Prediction) -> Option<f64> {
    // A constant force cancels.
    change(prediction, |forward, backward| 0.5 * (forward - backward))
}

/// The same of a constant force, as a share of the same: the zero of a sensor that wanders.
#[must_use]
pub fn wander(prediction: &Prediction) -> Option<f64> {
    // Friction cancels.
    change(prediction, |forward, backward| 0.5 * (forward + backward))
}

/// The change of what the mean residuals of both directions say.
fn change(prediction: &Prediction, of: impl Fn(f64, f64) -> f64) -> Option<f64> {
    let residual = prediction.residual();
    let (time, velocity) = (&prediction.time, &prediction.velocity);
    let rows = residual.len().min(time.len()).min(velocity.len());
    let points: Vec<(f64, f64)> = (0..BLOCKS)
        .filter_map(|block| {
            let own = block * rows / BLOCKS..(block + 1) * rows / BLOCKS;
            let along = |way: f64| {
                let own = own.clone().filter(move |&k| way * velocity[k] > 0.0);
                Sample::of(own.map(|k| residual[k]))
            };
            let (forward, backward) = (along(1.0), along(-1.0));
            let middle = time.get((own.start + own.end) / 2)?;
            let both = forward.count.min(backward.count) >= FEWEST_ROWS;
            both.then_some((*middle, of(forward.mean, backward.mean)))
        })
        .collect();
    let (slope, clear) = slope(&points)?;
    let size = root_mean_square(&prediction.friction);
    let change = slope * (time.last()? - time.first()?) / size;
    (clear > BEYOND_CHANCE && change.abs() > NOTICED).then_some(change)
}

/// The slope of a line through points, and by how many deviations it is clear of zero.
fn slope(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    if points.len() < FEWEST_BLOCKS {
        return None;
    }
    let n = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (t, y) = (mean(|point| point.0), mean(|point| point.1));
    let spread: f64 = points.iter().map(|point| (point.0 - t).powi(2)).sum();
    let slope = points.iter().map(|point| (point.0 - t) * (point.1 - y)).sum::<f64>() / spread;
    let left: f64 = points.iter().map(|p| (p.1 - y - slope * (p.0 - t)).powi(2)).sum();
    let degrees = n - 2.0;
    let ratio = slope.powi(2) * spread / left;
    // Wallace (1959): Student's t as a normal deviation.
    let clear = (8.0 * degrees + 1.0) / (8.0 * degrees + 3.0) * (degrees * ratio.ln_1p()).sqrt();
    (clear.is_finite() && slope.is_finite()).then_some((slope, clear))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::*;
    use crate::axis_term::AxisTerm;
    use crate::{AxisModel, Conditioning, Signals, condition, fit_axis};

    /// A joint whose friction is `share` more at the end than at the beginning, moved faster and
    /// faster.
    fn found(seed: u64, share: f64) -> (f64, Option<f64>) {
        let (viscous, drift, wander) = moved(seed, share, 0.0);
        assert_eq!(wander, None);
        (viscous, drift)
    }

    /// The same under a constant force that grows by so much.
    fn moved(seed: u64, share: f64, grows: f64) -> (f64, Option<f64>, Option<f64>) {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let (dt, length) = (2e-3, 40.0);
        let (place, force): (Vec<f64>, Vec<f64>) = (0..20_000)
            .map(|k| {
                let t = dt * f64::from(k);
                let rate = 0.5 + 2.0 * t / length;
                let (sin, cos) = (0.5 * t + t * t / length).sin_cos();
                let (v, a) = (0.8 * rate * cos, -0.8 * rate * rate * sin + 1.6 / length * cos);
                let grown = 1.0 + share * (t / length - 0.5);
                let friction = grown * (0.5 * v + 1.2 * v.signum());
                let noise = 0.05 * rng.sample::<f64, _>(StandardNormal);
                (0.8 * sin, 0.1 * a + friction + 0.2 + grows * t / length + noise)
            })
            .unzip();
        let signals = Signals {
            time_step: dt,
            position: Some(&place),
            readings: None,
            velocity: None,
            force: &force,
        };
        let recording = condition(&signals, &Conditioning::for_time_step(dt)).unwrap();
        let fit = fit_axis(&recording, AxisModel::SYMMETRIC).unwrap();
        let viscous = fit.value(AxisTerm::Viscous);
        let along = fit.predict(&recording).unwrap();
        (viscous, drift(&along), wander(&along))
    }

    /// Grease that warms up: the viscous friction of a chirp comes out wrong, and no interval says
    /// so.
    #[test]
    fn friction_that_falls_while_it_is_recorded_is_told() {
        let (viscous, drift) = found(1, -0.4);
        assert!(viscous < 0.3, "{viscous}");
        assert!(drift.is_some_and(|change| change < -0.05), "{drift:?}");
        assert!(found(2, 0.4).1.is_some_and(|change| change > 0.05));
    }

    #[test]
    fn friction_that_stays_is_not() {
        for seed in 0..20 {
            assert_eq!(found(seed, 0.0).1, None, "{seed}");
        }
    }

    /// A sensor whose zero wanders: no residual said so, and the levels of a dip took it up.
    #[test]
    fn a_constant_force_that_grows_is_told_and_is_no_change_of_friction() {
        for (seed, grows) in [(3, 0.6), (4, -0.6)] {
            let (_, drift, wander) = moved(seed, 0.0, grows);
            assert_eq!(drift, None);
            assert!(wander.is_some_and(|change| change * grows > 0.1), "{wander:?}");
        }
    }
}
