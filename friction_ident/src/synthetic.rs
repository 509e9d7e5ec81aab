//! What the experiments show of a known friction: recordings for studies of the identification
//! itself.
//!
//! Made by the model along given motions, with white noise on the friction. The motions are scaled
//! to how far the contact bends. Two sets of different motions exist, one to fit and one to try the
//! fit on.

use friction_model::AnyModel;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

use crate::output_error::predict;
use crate::staged::FrictionData;
use crate::steady_point::SteadyPoint;
use crate::stretch::Stretch;

/// Sampling period \[s\].
const DT: f64 = 1e-3;
/// Samples that a steady point averages.
const AVERAGED: f64 = 100.0;

/// Which of the two sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Set {
    /// 80 velocities each way, a nested path, a chirp, reversals.
    Estimation,
    /// Velocities between those, another nested path, a sine of 5 rad/s, other reversals.
    Validation,
}

/// The recordings of a truth that bends by `reach` \[m or rad\], with `noise` \[N or N m\] on each
/// sample of the friction (a tenth of it on steady points, which are means).
pub fn experiments(truth: &AnyModel, reach: f64, noise: f64, set: Set, seed: u64) -> FrictionData {
    let mut rng = Pcg64Mcg::seed_from_u64(
        seed.wrapping_mul(2).wrapping_add(u64::from(set == Set::Validation)),
    );
    let mut white = move |deviation: f64| deviation * rng.sample::<f64, _>(StandardNormal);
    let shift = if set == Set::Estimation { 0.0 } else { 0.5 };
    let speed =
        |i: f64| if i < 30.0 { 0.03 + 0.47 * i / 29.0 } else { 0.55 + 3.45 * (i - 30.0) / 49.0 };
    let points = (0..80)
        .map(|i| speed(f64::from(i) + shift))
        .flat_map(|v| [v, -v])
        .map(|v| SteadyPoint::new(v, truth.steady_state(v) + white(noise / AVERAGED.sqrt())))
        .collect();
    // Two tones that beat stay within 0.8 of the reach: nested loops.
    let nested = |t: f64, (a, b): (f64, f64)| 0.4 * reach * (a * (a * t).cos() + b * (b * t).cos());
    let mut stretches = match set {
        Set::Estimation => vec![
            along(truth, 4000, |t| nested(t, (3.5, 2.5))),
            along(truth, 9425, |t| 1.0 - 0.95 * (0.53 * t * t).cos()),
            along(truth, 6000, |t| {
                0.4 * (1.3 * t).sin() * (0.37 * t).cos() + 0.03 * (11.0 * t).sin()
            }),
        ],
        Set::Validation => vec![
            along(truth, 4000, |t| nested(t, (4.3, 1.7))),
            along(truth, 6000, |t| 1.0 - 0.95 * (5.0 * t).cos()),
            along(truth, 6000, |t| 0.3 * (0.9 * t).sin() + 0.05 * (7.0 * t).sin()),
        ],
    };
    for friction in stretches.iter_mut().flat_map(|stretch| &mut stretch.friction) {
        *friction += white(noise);
    }
    FrictionData::sort(points, stretches, Some(reach))
}

/// The model along a velocity, sampled.
fn along(truth: &AnyModel, samples: usize, velocity: impl Fn(f64) -> f64) -> Stretch {
    let velocity: Vec<f64> = (0..samples).map(|k| velocity(k as f64 * DT)).collect();
    let friction = vec![0.0; samples];
    let mut stretch = Stretch {
        time_step: DT,
        velocity,
        position: None,
        friction,
        deviation: None,
        before: Default::default(),
    };
    if stretch.kind(None) == crate::stretch::StretchKind::Lag {
        stretch.before = crate::stretch::Before::Slid;
    }
    stretch.friction = predict(truth, &stretch);
    stretch
}

#[cfg(test)]
mod tests {
    use friction_model::ModelName;

    use super::*;

    #[test]
    fn both_sets_show_every_kind_and_differ() {
        let truth = AnyModel::test_bed(ModelName::Proposed);
        let [one, other] =
            [Set::Estimation, Set::Validation].map(|set| experiments(&truth, 0.006, 0.0, set, 1));
        for data in [&one, &other] {
            assert_eq!(
                (data.points.len(), data.pre_sliding.len(), data.lag.len(), data.mixed.len()),
                (160, 1, 1, 1)
            );
        }
        assert!(
            one.points
                .iter()
                .all(|point| other.points.iter().all(|other| point.velocity != other.velocity))
        );
        let range =
            one.pre_sliding[0].travel().into_iter().fold(0.0f64, |range, x| range.max(x.abs()));
        assert!((0.003..0.006).contains(&range), "{range}");
    }

    #[test]
    fn noise_is_white_and_of_the_given_size() {
        let truth = AnyModel::test_bed(ModelName::Stribeck);
        let [clean, noisy] =
            [0.0, 1e-3].map(|noise| experiments(&truth, 0.006, noise, Set::Estimation, 3));
        let off: Vec<f64> =
            clean.lag[0].friction.iter().zip(&noisy.lag[0].friction).map(|(a, b)| b - a).collect();
        let rms = (off.iter().map(|r| r * r).sum::<f64>() / off.len() as f64).sqrt();
        assert!((rms / 1e-3 - 1.0).abs() < 0.03, "{rms}");
        assert!(crate::residual_whiteness::effective_share(&off) > 0.9);
    }
}
