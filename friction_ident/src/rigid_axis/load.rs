//! Forces that the position alone decides: which of them a recording shows.
//!
//! A joint under gravity that is fitted without it gets an inertia and a friction that are wrong,
//! with small errors. Spring and gravity are linear, so that asking costs next to nothing: the
//! recording is cut into contiguous blocks, and each is predicted by the fit to the others.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::{AxisModel, Regression};
use crate::conditioning::Conditioned;
use crate::least_squares;
use crate::statistics::Sample;

/// A force that the position alone decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Load {
    /// None.
    None,
    /// `spring q`.
    Spring,
    /// `gravity_sin sin q + gravity_cos cos q`, of an axis that turns.
    Gravity,
}

impl Load {
    fn parameters(self) -> usize {
        match self {
            Self::None => 0,
            Self::Spring => 1,
            Self::Gravity => 2,
        }
    }

    /// In words, as the subject of a sentence.
    pub fn describe(self) -> &'static str {
        match self {
            Self::None => "no load",
            Self::Spring => "a spring",
            Self::Gravity => "gravity",
        }
    }
}

/// What the comparison of loads says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoadChoice {
    /// The load to use.
    pub chosen: Load,
    /// The loads that were compared, with the share of the force that a fit to the other blocks
    /// does not predict: `100 |error| / |force|` \[%\].
    pub compared: Vec<(Load, f64)>,
}

/// Blocks at most.
const BLOCKS: usize = 8;
/// Rows on each side of a block that take no part in its fit: the memory of the low-pass.
const GUARD: usize = 15;
/// Share of the mean square error without a load that a load must take away: less is no reason to
/// add a term, and may be chance or what else goes with the position.
const WORTH: f64 = 0.1;
/// Standard errors that the gain must be clear of zero by.
const CLEAR: f64 = 2.0;

/// Chooses the load of an axis by blocked cross-validation. A load is used where it takes away a
/// tenth of the mean square error at least, clear of chance by two standard errors over the blocks;
/// of those within one standard error of the best the simplest.
///
/// `base` has the other terms. None where there is no position, or the recording is too short or
/// too poor to compare anything.
pub fn choose_load(
    recording: &Conditioned,
    base: AxisModel,
    candidates: &[Load],
) -> Option<LoadChoice> {
    recording.position.as_ref()?;
    let without = errors(recording, AxisModel { load: Load::None, ..base })?;
    let power = without.power;
    let percent = |blocks: &[f64]| 100.0 * (blocks.iter().sum::<f64>() / power).sqrt();
    let mut compared = vec![(Load::None, percent(&without.blocks))];
    let mut worthy: Vec<(Load, Vec<f64>)> = Vec::new();
    for &load in candidates {
        let Some(with) = errors(recording, AxisModel { load, ..base }) else { continue };
        compared.push((load, percent(&with.blocks)));
        let (gain, error) = gain(&without.blocks, &with.blocks);
        if gain > CLEAR * error && gain > WORTH * without.blocks.iter().sum::<f64>() {
            worthy.push((load, with.blocks));
        }
    }
    let sum = |blocks: &[f64]| blocks.iter().sum::<f64>();
    let best = worthy.iter().min_by(|a, b| sum(&a.1).total_cmp(&sum(&b.1)));
    let chosen = best.and_then(|(_, best)| {
        let close = worthy.iter().filter(|(_, blocks)| {
            let (excess, error) = gain(blocks, best);
            excess <= error
        });
        close.map(|(load, _)| *load).min_by_key(|load| load.parameters())
    });
    Some(LoadChoice { chosen: chosen.unwrap_or(Load::None), compared })
}

/// What `with` errs less than `without` over all blocks, and the standard error of that.
fn gain(without: &[f64], with: &[f64]) -> (f64, f64) {
    let differences = without.iter().zip(with).map(|(a, b)| a - b);
    let sample = Sample::of(differences);
    let blocks = sample.count as f64;
    (blocks * sample.mean, (blocks * sample.variance()).sqrt())
}

/// Sums of squared prediction errors of each block, and of the force.
struct Errors {
    blocks: Vec<f64>,
    power: f64,
}

fn errors(recording: &Conditioned, model: AxisModel) -> Option<Errors> {
    let Regression { matrix, force, .. } = Regression::new(recording, model).ok()?;
    let rows = force.len();
    let guard = GUARD.min(rows / 16);
    let blocks = BLOCKS.min(rows / (2 * guard.max(2)));
    if blocks < 3 || rows < 8 * matrix.ncols() {
        return None;
    }
    let of = |block: usize| -> Option<f64> {
        let (first, end) = (block * rows / blocks, (block + 1) * rows / blocks);
        let kept: Vec<usize> =
            (0..rows).filter(|k| k + guard < first || *k >= end + guard).collect();
        let there: DMatrix<f64> = matrix.select_rows(&kept);
        let measured = DVector::from_iterator(kept.len(), kept.iter().map(|&k| force[k]));
        let solution = least_squares::solve(&there, &measured).ok()?;
        let here = matrix.rows(first, end - first);
        Some((force.rows(first, end - first) - here * solution.x).norm_squared())
    };
    let blocks = (0..blocks).map(of).collect::<Option<_>>()?;
    Some(Errors { blocks, power: force.norm_squared() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AxisTerm, Conditioning, Signals, condition, fit_axis};
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    /// A joint of 18 kg m^2 with friction and `load`, on a motion that repeats nothing.
    fn joint(reach: f64, load: impl Fn(f64) -> f64) -> Conditioned {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(11);
        let waves = [(0.6, 0.7), (0.35, 1.63), (0.1, 3.9)];
        let sum = |t: f64, of: fn(f64, f64, f64) -> f64| -> f64 {
            waves.iter().map(|&(a, w)| reach * of(a, w, t)).sum()
        };
        let time = || (0..30_000).map(|k| f64::from(k) * 1e-3);
        let place: Vec<f64> = time().map(|t| sum(t, |a, w, t| a * (w * t).sin())).collect();
        let force: Vec<f64> = time()
            .zip(&place)
            .map(|(t, q)| {
                let v = sum(t, |a, w, t| a * w * (w * t).cos());
                let a = sum(t, |a, w, t| -a * w * w * (w * t).sin());
                18.0 * a
                    + 6.0 * v
                    + 9.0 * v.signum()
                    + load(*q)
                    + rng.sample::<f64, _>(StandardNormal)
            })
            .collect();
        let signals = Signals {
            time_step: 1e-3,
            position: Some(&place),
            readings: None,
            velocity: None,
            force: &force,
        };
        condition(&signals, &Conditioning::for_time_step(1e-3)).unwrap()
    }

    fn chosen(recording: &Conditioned) -> Load {
        let all = [Load::Spring, Load::Gravity];
        choose_load(recording, AxisModel::SYMMETRIC, &all).unwrap().chosen
    }

    #[test]
    fn a_joint_under_gravity_has_its_own_inertia() {
        let recording = joint(1.3, |q| 60.0 * (q + 0.4).cos());
        assert_eq!(chosen(&recording), Load::Gravity);
        let wrong = fit_axis(&recording, AxisModel::SYMMETRIC).unwrap();
        assert!((wrong.value(AxisTerm::Inertia) / 18.0 - 1.0).abs() > 0.2, "{wrong:?}");
        let model = AxisModel { load: Load::Gravity, ..AxisModel::SYMMETRIC };
        let fit = fit_axis(&recording, model).unwrap();
        let truth = [
            (AxisTerm::Inertia, 18.0),
            (AxisTerm::Viscous, 6.0),
            (AxisTerm::GravitySin, -60.0 * 0.4f64.sin()),
            (AxisTerm::GravityCos, 60.0 * 0.4f64.cos()),
        ];
        for (term, value) in truth {
            let found = fit.term(term).unwrap();
            assert!((found.value - value).abs() < 2.0 * found.half_width, "{found:?}, not {value}");
        }
    }

    #[test]
    fn a_load_is_added_only_where_there_is_one() {
        assert_eq!(chosen(&joint(1.3, |_| 3.0)), Load::None);
        assert_eq!(chosen(&joint(0.2, |q| 40.0 * q)), Load::Spring);
        let recording = joint(1.3, |_| 3.0);
        let none = Conditioned { position: None, ..recording };
        assert_eq!(choose_load(&none, AxisModel::SYMMETRIC, &[Load::Spring]), None);
    }
}
