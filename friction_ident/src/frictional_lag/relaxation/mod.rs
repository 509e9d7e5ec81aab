//! The lag of LuGre and GMS: their own states in sliding.
//!
//! Sliding in one direction, the bristle force `b` of LuGre, and of each slipping element of GMS
//! per share, obeys
//!
//! ```text
//! b' = r (1 - b / g(v)),   r = sigma0 v (LuGre),   r_i = sigma0_i C / alpha_i (GMS)
//! F  = sum_i alpha_i b_i + d_i (1 - b_i / g(v)) + f_v v,   d = sigma1 v (LuGre),   d_i = sigma1_i C (GMS)
//! ```
//!
//! The state is advanced by the two-point formula of Obreshkov with two derivatives (fourth order,
//! A-stable), which needs the velocity at the samples alone; the derivatives with respect to the
//! parameters follow the linearised equation, driven by the trapezoidal rule. A pass leaves the
//! normal equations only. The search begins on a part of the samples.

use friction_model::Unit;
use nalgebra::SMatrix;
use serde::Serialize;
use wide::f64x4;

use super::estimates::remedy;
use super::pass::Prepared;
use super::search::near;
use super::{InitialLag, LagOptions, LagRecording};
use crate::IdentError;
use crate::estimate::{Estimates, NormalEquations, Unknown};
use crate::residual_whiteness::effective_share;

mod simulation;
mod track;
mod walk;

use simulation::{Element, Normal, Trial, UNKNOWNS};
use track::Tracks;
use walk::{Found, walk};

/// Which model slides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Relaxation<'a> {
    /// LuGre: `f_s`, `f_c`, `v_s`, `f_v`, `sigma0`, `sigma1` are estimated.
    LuGre,
    /// GMS with what earlier stages found: `f_s`, `f_c`, `v_s`, `f_v` and the attraction `c` common
    /// to all elements are estimated.
    Gms {
        /// Shares, above zero.
        alpha: &'a [f64],
        /// Stiffnesses, above zero, one a share.
        sigma0: &'a [f64],
        /// Micro-damping, zero or more, one a share.
        sigma1: &'a [f64],
    },
}

/// A fitted relaxation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RelaxationFit {
    /// Parameters with the names of parameter files; GMS's attraction is `c`.
    pub estimates: Estimates,
    /// Mean square of the residual \[(N m)^2 or N^2\].
    pub mse: f64,
    /// Samples fitted.
    pub samples: usize,
    /// Passes over the recordings, those of the coarse search over a part of the samples included.
    pub evaluations: usize,
}

impl Relaxation<'_> {
    /// Elements; those of one rate move together and count as one.
    fn elements(&self) -> Result<Vec<Element>, IdentError> {
        let Self::Gms { alpha, sigma0, sigma1 } = *self else {
            return Ok(vec![Element { alpha: 1.0, rate: 1.0, damping: 0.0 }]);
        };
        let n = alpha.len();
        let usable = alpha.iter().chain(sigma0).all(|&x| x > 0.0 && x.is_finite())
            && sigma1.iter().all(|&x| x >= 0.0 && x.is_finite());
        if n == 0 || sigma0.len() != n || sigma1.len() != n || !usable {
            return Err(IdentError::ElementCount(n));
        }
        let mut merged: Vec<Element> = Vec::new();
        for ((&alpha, k), &damping) in alpha.iter().zip(sigma0).zip(sigma1) {
            let rate = k / alpha;
            match merged.iter_mut().find(|other| (other.rate / rate - 1.0).abs() < 1e-12) {
                Some(twin) => {
                    (twin.alpha, twin.damping) = (twin.alpha + alpha, twin.damping + damping)
                }
                None => merged.push(Element { alpha, rate, damping }),
            }
        }
        Ok(merged)
    }
}

/// Fits LuGre or GMS to recordings of sliding in one direction.
///
/// # Errors
/// As [`fit_lag`](super::fit_lag); [`IdentError::ElementCount`] where the lists of GMS are empty or
/// differ in length.
pub fn fit_relaxation(
    recordings: &[LagRecording],
    options: &LagOptions,
    model: Relaxation,
) -> Result<RelaxationFit, IdentError> {
    let data = Prepared::new(recordings, options)?;
    let elements = model.elements()?;
    let lugre = model == Relaxation::LuGre;
    // The proposed model's lag lies near; its time constant gives the rate.
    let first = near(&data)?;
    let share: f64 = elements.iter().map(|element| element.alpha).sum();
    let mean_rate =
        elements.iter().map(|element| element.alpha * element.rate).sum::<f64>() / share;
    let level = first.f_c.max(0.1 * first.f_s);
    let dip = (first.f_s - first.f_c).max(0.01 * level);
    let rate = level / (first.tau * mean_rate * if lugre { first.v_s } else { 1.0 });
    let bounds = [
        (-level, 1e3 * level),
        (1e-3 * level, 1e3 * level),
        data.range(0),
        (0.0, f64::INFINITY),
        (rate.ln() - 9.0, rate.ln() + 9.0),
        (0.0, if lugre { f64::INFINITY } else { 0.0 }),
    ];
    let slope = first.f_v.abs().max(1e-6);
    let usual = [level, level, 1.0, slope, 1.0, slope];
    let start = Trial {
        x: [dip, level / share, first.v_s.ln(), first.f_v.max(0.0), rate.ln(), 0.0],
        delta: data.delta,
        lugre,
        from_rest: data.initial == InitialLag::Rest,
        baseline: data.baseline,
    };
    let (mut passes, mut moving) = (0, Vec::with_capacity(data.samples()));
    let mut search = |tracks: &Tracks, start: Trial, moving: &mut Vec<f64>| {
        let samples = tracks.totals[0] as usize;
        walk(start, &bounds, &usual, samples, &mut |trial| {
            passes += 1;
            if elements.len() == 1 {
                trial.pass::<f64>(tracks, &elements, moving)
            } else {
                trial.pass::<f64x4>(tracks, &elements, moving)
            }
        })
    };
    let tracks = Tracks::new(&data);
    let coarse = tracks.coarse(first.tau).and_then(|coarse| search(&coarse, start, &mut moving));
    let start = coarse.map_or(start, |found| Trial { x: found.moved(), ..start });
    let found = search(&tracks, start, &mut moving).ok_or_else(|| {
        IdentError::NoConvergence("the relaxation cannot be simulated".to_owned())
    })?;
    let samples = data.samples();
    let [_, f_c, _, f_v, ..] = found.x;
    let offset = [f_c - data.baseline[0], f_v - data.baseline[1]];
    let fitted =
        data.recordings.iter().flat_map(|r| r.torque.iter().zip(&r.speed).skip(options.settle));
    let residuals: Vec<f64> = fitted
        .zip(&moving)
        .map(|((y, v), moving)| y - offset[0] - offset[1] * v - moving)
        .collect();
    let sum = found.sum();
    let estimates = estimates(&found, lugre, sum, samples, effective_share(&residuals));
    Ok(RelaxationFit { estimates, mse: sum / samples as f64, samples, evaluations: passes })
}

impl Found {
    /// The unknowns after the last small step.
    fn moved(&self) -> [f64; UNKNOWNS] {
        std::array::from_fn(|i| self.x[i] + self.step[i])
    }

    /// The sum of squares there.
    fn sum(&self) -> f64 {
        let Normal { matrix, gradient, sum, .. } = &self.normal;
        (sum - 2.0 * gradient.dot(&self.step) + self.step.dot(&(matrix * self.step))).max(0.0)
    }
}

/// In the parameters of parameter files.
fn estimates(found: &Found, lugre: bool, sum: f64, samples: usize, share: f64) -> Estimates {
    let unknown = |name: &'static str, unit: Unit| Unknown {
        id: name.into(),
        unit: unit.rotary(),
        remedy: remedy(if ["sigma0", "sigma1", "c"].contains(&name) { "tau" } else { name }),
    };
    let (level, damping) = (Unit::Force, Unit::Damping);
    let mut unknowns = vec![
        unknown("f_s", level),
        unknown("f_c", level),
        unknown("v_s", Unit::Speed),
        unknown("f_v", damping),
        if lugre { unknown("sigma0", Unit::Stiffness) } else { unknown("c", Unit::Speed) },
    ];
    if lugre {
        unknowns.push(unknown("sigma1", damping));
    }
    let [dip, f_c, ln_v_s, f_v, ln_rate, sigma1] = found.moved();
    let (v_s, rate) = (ln_v_s.exp(), ln_rate.exp());
    // f_s - f_c, f_c and the logarithms by f_s, f_c and the plain ones.
    let mut turn = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::identity();
    turn[(0, 1)] = -1.0;
    turn[(2, 2)] = 1.0 / v_s;
    turn[(4, 4)] = 1.0 / rate;
    let matrix = turn.transpose() * found.normal.matrix * turn;
    let n = unknowns.len();
    let normal = NormalEquations {
        x: &[dip + f_c, f_c, v_s, f_v, rate, sigma1][..n],
        held: &found.held[..n],
        matrix: matrix.view((0, 0), (n, n)).into_owned().as_slice().to_vec(),
        sum,
        residuals: samples,
    };
    normal.estimates(&unknowns, share)
}
