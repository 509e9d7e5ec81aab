//! Pre-sliding: stiffness, breakaway displacement and static level from slow paths of displacement
//! and torque.
//!
//! The motion is so slow that neither inertia nor damping counts; the torque is then a function of
//! the path alone, and every model reduces to a hysteresis operator:
//!
//! | model | operator | parameters |
//! |---|---|---|
//! | proposed | sine virgin curve, Masing's doubling, non-local memory (thesis eq. 3.53) | `f_s`, `z_b` |
//! | LuGre | `dF/dx = sigma0 (1 - sgn(x') F / f_s)` (thesis eq. 2.19 for `v -> 0`) | `f_s`, `sigma0` |
//! | Dahl | `dF/dx = sigma0 (1 - sgn(x') F / f_c)^delta` (thesis eq. 2.17) | `f_c`, `sigma0`, `delta` given |
//! | elasto-plastic | LuGre's, elastic below `z_ba` (Dupont et al. 2002) | `f_s`, `sigma0`, `z_ba` |
//! | GMS, Xiong | `N` stops `k_i` of width `w_i` in parallel (Maxwell slip) | `f_s`, shares and stiffnesses |
//!
//! Displacements count from the unloaded contact: a path starts at rest at zero, wherever its first
//! sample lies. Each operator is linear in its level, and the one or two lengths in it are scanned
//! before the search, so that no start is asked for; Maxwell slip starts from the best spectrum of
//! many stops.

use serde::Serialize;

use crate::IdentError;
use crate::estimate::Estimates;

mod maxwell_slip;
mod operator;
mod scan;
mod spectrum;
mod stops;
#[cfg(test)]
mod tests;

pub use maxwell_slip::MaxwellSlip;
pub use operator::Operator;
pub use spectrum::{Spectrum, stop_spectrum};
pub use stops::stops;

/// One slow path, sample by sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PreSlidingPath<'a> {
    /// Displacement from the unloaded contact \[rad or m\].
    pub displacement: &'a [f64],
    /// Friction torque \[N m or N\]; positive at positive displacement on first loading.
    pub torque: &'a [f64],
}

/// Which model's operator is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PreSlidingModel {
    /// The thesis's own.
    Proposed,
    /// LuGre.
    LuGre,
    /// Dahl with a given exponent.
    Dahl {
        /// Exponent, 0.1 to 10; 1 is LuGre's operator.
        delta: f64,
    },
    /// Dupont's elasto-plastic model.
    ElastoPlastic,
    /// GMS: shares `alpha`, stiffnesses `sigma0`.
    Gms {
        /// Elements, 1 to 16.
        elements: usize,
    },
    /// Xiong: shares `lambda`, stiffnesses `k`.
    Xiong {
        /// Elements, 1 to 16.
        elements: usize,
    },
    /// Springs side by side that never slip, as the thesis fitted GMS and Xiong (eqs. 4.30 and
    /// 4.32): only their sum is seen.
    Springs {
        /// Springs, 1 to 16.
        elements: usize,
    },
}

/// A fitted operator.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PreSlidingFit {
    /// Parameters with the names of parameter files.
    pub estimates: Estimates,
    /// Mean square of the residual \[(N m)^2 or N^2\].
    pub mse: f64,
    /// Samples fitted.
    pub samples: usize,
    /// How often the whole path was run through.
    pub evaluations: usize,
}

/// Elements at most, as in the models.
const MAX_ELEMENTS: usize = 16;

/// Fits the operator of `model` to slow paths, each of which starts from the unloaded contact.
///
/// # Errors
/// [`IdentError::TooFewSamples`] below 20 samples in all, [`IdentError::UnequalLengths`],
/// [`IdentError::NotFinite`], [`IdentError::ZeroForce`], [`IdentError::NoMotion`] for a path that
/// stands still, [`IdentError::Exponent`], [`IdentError::ElementCount`],
/// [`IdentError::NoConvergence`] for torques that fall where the displacement grows.
pub fn fit_pre_sliding(
    paths: &[PreSlidingPath],
    model: PreSlidingModel,
) -> Result<PreSlidingFit, IdentError> {
    let data = Paths::new(paths)?;
    match model {
        PreSlidingModel::Proposed => scan::fit(&data, Operator::Sine),
        PreSlidingModel::LuGre => scan::fit(&data, Operator::Exponential),
        PreSlidingModel::Dahl { delta } => {
            if !(0.1..=10.0).contains(&delta) {
                return Err(IdentError::Exponent(delta));
            }
            scan::fit(&data, Operator::Power { delta })
        }
        PreSlidingModel::ElastoPlastic => scan::fit(&data, Operator::ElastoPlastic),
        PreSlidingModel::Gms { elements } => {
            maxwell_slip::fit(&data, check(elements)?, maxwell_slip::GMS)
        }
        PreSlidingModel::Xiong { elements } => {
            maxwell_slip::fit(&data, check(elements)?, maxwell_slip::XIONG)
        }
        PreSlidingModel::Springs { elements } => maxwell_slip::fit_springs(&data, check(elements)?),
    }
}

fn check(elements: usize) -> Result<usize, IdentError> {
    if (1..=MAX_ELEMENTS).contains(&elements) {
        Ok(elements)
    } else {
        Err(IdentError::ElementCount(elements))
    }
}

/// Checked paths, as moves from sample to sample.
#[derive(Debug, Clone)]
struct Paths {
    /// Displacements; every path begins with a move from the unloaded contact.
    displacement: Vec<f64>,
    torque: Vec<f64>,
    /// Index of the first sample of each path.
    starts: Vec<usize>,
    /// Largest displacement.
    reach: f64,
}

impl Paths {
    fn new(paths: &[PreSlidingPath]) -> Result<Self, IdentError> {
        let mut all =
            Self { displacement: Vec::new(), torque: Vec::new(), starts: Vec::new(), reach: 0.0 };
        for path in paths {
            if path.displacement.len() != path.torque.len() {
                return Err(IdentError::UnequalLengths {
                    channel: "the displacement",
                    found: path.displacement.len(),
                    expected: path.torque.len(),
                });
            }
            for (channel, values) in
                [("the displacement", path.displacement), ("the torque", path.torque)]
            {
                if let Some((index, &value)) =
                    values.iter().enumerate().find(|(_, value)| !crate::finite::usable(**value))
                {
                    return Err(IdentError::NotFinite { channel, index, value });
                }
            }
            all.starts.push(all.displacement.len());
            all.displacement.extend_from_slice(path.displacement);
            all.torque.extend_from_slice(path.torque);
        }
        let found = all.torque.len();
        if found < 20 {
            let what = "a pre-sliding operator";
            return Err(IdentError::TooFewSamples { what, needed: 20, found, lower: None });
        }
        if all.torque.iter().all(|&torque| torque == 0.0) {
            return Err(IdentError::ZeroForce);
        }
        all.reach = all.displacement.iter().fold(0.0, |most, x| x.abs().max(most));
        if all.reach == 0.0 {
            return Err(IdentError::NoMotion);
        }
        Ok(all)
    }

    /// About `samples` samples, the turns among them: operators of the path keep their values at
    /// samples that stay.
    fn thinned(&self, samples: usize) -> Self {
        let stride = (self.torque.len() / samples.max(1)).max(1);
        let mut thin = Self {
            displacement: Vec::new(),
            torque: Vec::new(),
            starts: Vec::new(),
            reach: self.reach,
        };
        for (start, end) in self.ranges() {
            thin.starts.push(thin.torque.len());
            for i in start..end {
                let turn = i > start && i + 1 < end && {
                    let [before, here, after] = [i - 1, i, i + 1].map(|i| self.displacement[i]);
                    (here - before) * (after - here) <= 0.0
                };
                if turn || (i - start) % stride == 0 || i + 1 == end {
                    thin.displacement.push(self.displacement[i]);
                    thin.torque.push(self.torque[i]);
                }
            }
        }
        thin
    }

    /// First sample and end of each path.
    fn ranges(&self) -> impl Iterator<Item = (usize, usize)> {
        let ends = self.starts.iter().skip(1).copied().chain([self.torque.len()]);
        self.starts.iter().copied().zip(ends)
    }

    fn sum_of_squares(&self) -> f64 {
        self.torque.iter().map(|torque| torque * torque).sum()
    }
}
