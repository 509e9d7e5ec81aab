//! Where a recording stands still.
//!
//! At rest the velocity that was measured is the sensor's noise, and its sign says nothing. A model
//! without pre-sliding predicts a range there, not a value: whatever is applied, up to the level at
//! which it breaks away. Such samples show nothing of its parameters.
//!
//! A stretch stands still for as long as a window of samples has no more of a mean and a trend than
//! noise has, and no more scatter than the quietest parts of the stretch; or is nothing beside the
//! fastest motion.

use crate::statistics::upper_median;
use crate::stretch::Stretch;
use friction_model::{AnyModel, FrictionModel, ModelVisitor};

/// Samples of a window.
const WINDOW: usize = 25;
/// Share of the mean square of a window that mean and trend may have: a motion slower than its own
/// noise has no sign.
const EXPLAINED: f64 = 0.6;
/// Largest root mean square of a window at rest, over the fastest velocity.
const SLOW: f64 = 0.05;
/// Root mean square over the fastest velocity below which a window counts as no noisier than any
/// other: an encoder that stands still has no noise, and what is left is the low-pass's.
const SILENT: f64 = 1e-3;
/// Root mean square over the fastest velocity below which nothing moves, whatever the trend: a
/// low-pass leaves that much of a count that stays the same, and no sensor tells such a speed beside
/// the fastest one.
const NOTHING: f64 = 1e-5;
/// The same over that of the windows at rest.
const SCATTER: f64 = 3.0;

/// Whether a model predicts a range at rest, and not a value.
pub(crate) fn holds(model: &AnyModel) -> bool {
    struct Holds;
    impl ModelVisitor for Holds {
        type Output = bool;
        fn visit<M: FrictionModel>(self, model: M) -> bool {
            model.holding(0.0).is_some()
        }
    }
    model.visit(Holds)
}

/// Which samples of a stretch stand still.
pub(crate) fn at_rest(stretch: &Stretch) -> Vec<bool> {
    standing(&stretch.velocity)
}

/// Which samples of a velocity are those of rest.
pub(crate) fn standing(velocity: &[f64]) -> Vec<bool> {
    let mut rest = vec![false; velocity.len()];
    if velocity.len() < WINDOW {
        return rest;
    }
    let fastest = velocity.iter().fold(0.0f64, |fastest, v| fastest.max(v.abs()));
    let windows: Vec<(usize, f64)> = velocity
        .windows(WINDOW)
        .map(|window| scatter(window, NOTHING * fastest))
        .enumerate()
        .filter_map(|(first, scatter)| Some((first, scatter?)))
        .filter(|(_, scatter)| *scatter <= SLOW * fastest)
        .collect();
    let mut sizes: Vec<f64> = windows.iter().map(|(_, scatter)| *scatter).collect();
    let Some(usual) = upper_median(&mut sizes) else { return rest };
    let usual = usual.max(SILENT * fastest);
    for (first, scatter) in windows.into_iter().filter(|(_, scatter)| *scatter <= SCATTER * usual) {
        // The motion that begins or ends within the window is no longer rest.
        let most = SCATTER * scatter.max(usual);
        for (rest, v) in rest.iter_mut().zip(velocity).skip(first).take(WINDOW) {
            *rest |= v.abs() <= most;
        }
    }
    rest
}

/// Root mean square of a window whose mean and trend are no more than noise, or that is at most
/// `nothing`; none for motion.
fn scatter(window: &[f64], nothing: f64) -> Option<f64> {
    let n = window.len() as f64;
    let middle = 0.5 * (n - 1.0);
    let (mut sum, mut slope, mut squares) = (0.0, 0.0, 0.0);
    for (k, v) in window.iter().enumerate() {
        sum += v;
        slope += (k as f64 - middle) * v;
        squares += v * v;
    }
    let explained = sum * sum / n + slope * slope * 12.0 / (n * (n * n - 1.0));
    let size = (squares / n).sqrt();
    (explained <= EXPLAINED * squares || size <= nothing).then_some(size)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::*;

    fn stretch(velocity: Vec<f64>) -> Stretch {
        let friction = vec![0.1; velocity.len()];
        Stretch::new(1e-3, velocity, None, friction).unwrap()
    }

    fn share(rest: &[bool]) -> f64 {
        rest.iter().filter(|rest| **rest).count() as f64 / rest.len() as f64
    }

    /// A second of rest, one of creeping at five standard deviations of the noise, one of motion.
    #[test]
    fn noise_is_rest_and_creeping_is_not() {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(3);
        let velocity = (0..3000).map(|k| {
            let v = [0.0, 0.01, 1.0][k / 1000];
            v + 0.002 * rng.sample::<f64, _>(StandardNormal)
        });
        let rest = at_rest(&stretch(velocity.collect()));
        assert!(share(&rest[..1000]) > 0.98, "{}", share(&rest[..1000]));
        assert!(share(&rest[1000..]) < 0.005, "{}", share(&rest[1000..]));
    }

    /// Noise that a low-pass has been through is alike over several samples.
    #[test]
    fn filtered_noise_is_rest_too() {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(4);
        let mut state = 0.0;
        let velocity = (0..4000).map(|k| {
            state = 0.7 * state + 0.001 * rng.sample::<f64, _>(StandardNormal);
            state + if k < 2000 { 0.0 } else { 0.5 * (f64::from(k - 2000) * 3e-3).sin() }
        });
        let rest = at_rest(&stretch(velocity.collect()));
        assert!(share(&rest[..2000]) > 0.9, "{}", share(&rest[..2000]));
        assert!(share(&rest[2100..]) < 0.01, "{}", share(&rest[2100..]));
    }

    /// A stranger's recording: an encoder that stands still shows one and the same count.
    #[test]
    fn an_encoder_without_noise_rests_too() {
        let step = 1e-3;
        let position: Vec<f64> = (0..6000)
            .map(|k| {
                let t = 1e-3 * f64::from(k);
                let moved = if (2.0..4.0).contains(&t) { 2.0 } else { t };
                ((0.7 * (3.0 * moved).sin()) / step).round() * step
            })
            .collect();
        let low_pass = crate::zero_phase::LowPass::butterworth(4, 50.0, 1000.0).unwrap();
        let smooth = low_pass.filter(&position).unwrap();
        let velocity: Vec<f64> = smooth.windows(2).map(|pair| (pair[1] - pair[0]) / 1e-3).collect();
        let thinned: Vec<f64> = velocity.iter().copied().step_by(10).collect();
        let rest = standing(&thinned);
        assert!(share(&rest[200..400]) > 0.9, "{}", share(&rest[200..400]));
        assert!(share(&rest[..195]) + share(&rest[405..]) < 0.02);
    }

    /// The last digits of a low-pass go round in a circle for as long as its input stays the same.
    /// Every so many samples, that is a mean.
    #[test]
    fn what_a_low_pass_leaves_in_its_last_digits_is_rest() {
        let velocity: Vec<f64> = (0..1000)
            .map(|k| if (300..700).contains(&k) { 3e-14 } else { (0.05 * f64::from(k)).sin() })
            .collect();
        let rest = standing(&velocity);
        assert!(share(&rest[300..700]) > 0.98, "{}", share(&rest[300..700]));
        assert_eq!(share(&rest[..290]) + share(&rest[710..]), 0.0);
        // Creeping at a thousandth of the fastest speed is motion.
        let creeps: Vec<f64> =
            velocity.iter().map(|v| if *v == 3e-14 { 1e-3 } else { *v }).collect();
        assert_eq!(share(&standing(&creeps)), 0.0);
    }

    /// Whatever the count at which it stands still.
    #[test]
    fn an_encoder_rests_at_every_count() {
        let step = std::f64::consts::TAU / 16384.0;
        let low_pass = crate::zero_phase::LowPass::butterworth(4, 100.0, 1000.0).unwrap();
        for place in 0..40 {
            let at = |t: f64| 0.2 * f64::from(place) - 4.1 + 0.7 * (3.0 * t).sin();
            let count = |k: i32| {
                let t = 1e-3 * f64::from(k);
                let t = if t < 2.0 { t } else { t.max(5.0) - 3.0 };
                (at(t) / step).round() * step
            };
            let position: Vec<f64> = (0..7000).map(count).collect();
            let smooth = low_pass.filter(&position).unwrap();
            let speed = smooth.windows(3).map(|three| (three[2] - three[0]) / 2e-3);
            let rest = standing(&speed.step_by(5).collect::<Vec<_>>());
            assert!(share(&rest[400..1000]) > 0.95, "{place}: {}", share(&rest[400..1000]));
            assert!(share(&rest[..400]) + share(&rest[1005..]) < 0.02, "{place}");
        }
    }

    #[test]
    fn a_smooth_reversal_is_no_rest() {
        let velocity: Vec<f64> = (0..4000).map(|k| (f64::from(k) * 5e-3).sin()).collect();
        assert_eq!(share(&at_rest(&stretch(velocity))), 0.0);
        let stops: Vec<f64> = (0..4000).map(|k| (f64::from(k) * 5e-3).sin().max(0.0)).collect();
        let share = share(&at_rest(&stretch(stops)));
        assert!((share - 0.45).abs() < 0.06, "{share}");
    }
}
