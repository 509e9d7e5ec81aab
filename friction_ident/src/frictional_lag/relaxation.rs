//! The lag of LuGre and GMS: their own states in sliding.
//!
//! Sliding in one direction, the bristle force `b` of LuGre, and of each slipping element of GMS per share, obeys
//!
//! ```text
//! b' = r (1 - b / g(v)),   r = sigma0 v (LuGre),   r_i = sigma0_i C / alpha_i (GMS)
//! F  = sum_i alpha_i b_i + d_i (1 - b_i / g(v)) + f_v v,   d = sigma1 v (LuGre),   d_i = sigma1_i C (GMS)
//! ```
//!
//! The state is advanced by the two-point formula of Obreshkov with two derivatives (fourth order, A-stable), which needs the velocity at the samples alone; the
//! derivatives with respect to the parameters follow the linearised equation by the trapezoidal rule.

use std::ops::ControlFlow;

use friction_model::Unit;
use nalgebra::DMatrix;
use serde::Serialize;

use super::pass::Prepared;
use super::{LagOptions, LagRecording, fit_lag, search::remedy};
use crate::IdentError;
use crate::bounded::{Bound, Patience, Residuals, minimise};
use crate::estimate::{Estimates, Unknown};
use crate::residual_whiteness::effective_share;

/// Which model slides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Relaxation<'a> {
    /// LuGre: `f_s`, `f_c`, `v_s`, `f_v`, `sigma0`, `sigma1` are estimated.
    LuGre,
    /// GMS with what earlier stages found: `f_s`, `f_c`, `v_s`, `f_v` and the attraction `c` common to all elements are estimated.
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
    /// Simulations.
    pub evaluations: usize,
}

/// One element: share, rate per unit of the rate's unknown, and micro-damping likewise.
#[derive(Debug, Clone, Copy)]
struct Element {
    alpha: f64,
    rate: f64,
    damping: f64,
}

/// Unknowns: f_s, f_c, v_s, f_v, rate, and LuGre's damping.
const RATE: usize = 4;
const DAMPING: usize = 5;

struct Problem<'a> {
    data: &'a Prepared,
    /// dv/dt of each recording.
    slopes: Vec<Vec<f64>>,
    elements: Vec<Element>,
    lugre: bool,
    settle: usize,
    samples: usize,
    evaluations: usize,
}

/// Derivative of samples, of fourth order.
fn slope(v: &[f64], dt: f64) -> Vec<f64> {
    let n = v.len();
    (0..n)
        .map(|k| {
            let first = k.saturating_sub(2).min(n.saturating_sub(5));
            let Some(&[a, b, c, d, e]) = v.get(first..first + 5).and_then(|w| w.first_chunk()) else {
                return 0.0;
            };
            let weights = match k - first {
                0 => [-25.0, 48.0, -36.0, 16.0, -3.0],
                1 => [-3.0, -10.0, 18.0, -6.0, 1.0],
                2 => [1.0, -8.0, 0.0, 8.0, -1.0],
                3 => [-1.0, 6.0, -18.0, 10.0, 3.0],
                _ => [3.0, -16.0, 36.0, -48.0, 25.0],
            };
            weights.iter().zip([a, b, c, d, e]).map(|(w, v)| w * v).sum::<f64>() / (12.0 * dt)
        })
        .collect()
}

/// What one sample says to every element.
#[derive(Clone, Copy, Default)]
struct Sample {
    /// Velocity for LuGre, 1 for GMS, and its derivative.
    u: f64,
    u_slope: f64,
    g: f64,
    g_slope: f64,
    /// Derivatives of g with respect to f_s, f_c, v_s.
    by: [f64; 3],
}

/// An element's state and its derivatives with respect to f_s, f_c, v_s and the rate.
#[derive(Clone, Copy)]
struct State {
    b: f64,
    by: [f64; 4],
}

impl Problem<'_> {
    /// Simulates; `see` gets the fitted sample's number, the force and its derivatives with respect to the six unknowns.
    fn run(&self, x: &[f64], sensitive: bool, mut see: impl FnMut(usize, f64, &[f64; 6])) -> bool {
        let &[f_s, f_c, v_s, f_v, rate, ..] = x else { return false };
        let lugre_damping = x.get(DAMPING).copied().unwrap_or(0.0);
        let allowed = f_s > 0.0 && f_c > 0.0 && v_s > 0.0 && rate > 0.0;
        if !allowed {
            return false;
        }
        let delta = self.data.delta;
        let inverse = v_s.powf(-delta);
        let mut row = 0;
        for (recording, slopes) in self.data.recordings.iter().zip(&self.slopes) {
            let at = |k: usize| -> Option<(Sample, f64)> {
                let (&v, &power, &a) = (recording.speed.get(k)?, recording.power.get(k)?, slopes.get(k)?);
                let exponent = power * inverse;
                let dip = if exponent > 42.0 { 0.0 } else { (-exponent).exp() };
                let by_ln = delta * exponent * dip;
                let (u, u_slope) = if self.lugre { (v, a) } else { (1.0, 0.0) };
                let sample = Sample {
                    u,
                    u_slope,
                    g: f_c + (f_s - f_c) * dip,
                    g_slope: -(f_s - f_c) * by_ln * a / v,
                    by: [dip, 1.0 - dip, (f_s - f_c) * by_ln / v_s],
                };
                Some((sample, v))
            };
            let Some((mut now, mut v)) = at(0) else { continue };
            let [a, b, c] = now.by;
            let mut states = vec![State { b: now.g, by: [a, b, c, 0.0] }; self.elements.len()];
            let half = 0.5 * recording.dt;
            for k in 0..recording.speed.len() {
                if k >= self.settle {
                    let mut force = f_v * v;
                    let mut by = [0.0, 0.0, 0.0, v, 0.0, 0.0];
                    for (element, state) in self.elements.iter().zip(&states) {
                        let free = 1.0 - state.b / now.g;
                        let per_damping = now.u * free;
                        let damping = if self.lugre { lugre_damping } else { rate * element.damping };
                        force += element.alpha * state.b + damping * per_damping;
                        if sensitive {
                            let through = element.alpha - damping * now.u / now.g;
                            let by_g = damping * now.u * state.b / (now.g * now.g);
                            for (by, (state, g)) in by.iter_mut().zip(state.by.iter().zip(now.by)) {
                                *by += through * state + by_g * g;
                            }
                            by[RATE] += through * state.by[3];
                            if self.lugre {
                                by[DAMPING] += per_damping;
                            } else {
                                by[RATE] += element.damping * per_damping;
                            }
                        }
                    }
                    see(row, force, &by);
                    row += 1;
                }
                let Some((next, v_next)) = at(k + 1) else { break };
                for (element, state) in self.elements.iter().zip(&mut states) {
                    advance(state, element.rate, rate, &now, &next, half, sensitive);
                }
                (now, v) = (next, v_next);
            }
        }
        true
    }
}

/// From one sample to the next; `half` is half the period.
#[inline(always)]
fn advance(
    state: &mut State,
    per_rate: f64,
    rate: f64,
    now: &Sample,
    next: &Sample,
    half: f64,
    sensitive: bool,
) {
    let twelfth = half * half / 3.0;
    let coefficients = |s: &Sample| {
        let r = rate * per_rate * s.u;
        let beta = r / s.g;
        let r_slope = rate * per_rate * s.u_slope;
        let beta_slope = (r_slope - beta * s.g_slope) / s.g;
        (r, beta, r_slope - beta * r, beta * beta - beta_slope)
    };
    let (r0, beta0, curve0, bend0) = coefficients(now);
    let (r1, beta1, curve1, bend1) = coefficients(next);
    let before = state.b;
    let right =
        before * (1.0 - half * beta0 + twelfth * bend0) + half * (r0 + r1) + twelfth * (curve0 - curve1);
    state.b = right / (1.0 + half * beta1 + twelfth * bend1);
    if sensitive {
        let inverse = 1.0 / (1.0 + half * beta1);
        let decay = (1.0 - half * beta0) * inverse;
        let gain = half * inverse;
        let (w0, w1) = (beta0 * before / now.g, beta1 * state.b / next.g);
        for (by, (g0, g1)) in state.by.iter_mut().zip(now.by.iter().zip(next.by)) {
            *by = decay * *by + gain * (w0 * g0 + w1 * g1);
        }
        let drive = (r0 * (1.0 - before / now.g) + r1 * (1.0 - state.b / next.g)) / rate;
        state.by[3] = decay * state.by[3] + gain * drive;
    }
}

impl Residuals for Problem<'_> {
    fn len(&self) -> usize {
        self.samples
    }

    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        self.evaluations += 1;
        let torque =
            self.data.recordings.iter().flat_map(|r| r.torque.iter().zip(&r.speed).skip(self.settle));
        let [base_c, base_v] = self.data.baseline;
        for (out, (y, v)) in out.iter_mut().zip(torque) {
            *out = -(y + base_c + base_v * v);
        }
        self.run(x, false, |row, force, _| {
            if let Some(out) = out.get_mut(row) {
                *out += force;
            }
        })
    }

    fn jacobian(&mut self, x: &[f64], _: &[f64], jacobian: &mut DMatrix<f64>) -> bool {
        let (rows, columns) = jacobian.shape();
        let all = jacobian.as_mut_slice();
        self.run(x, true, |row, _, by| {
            for (column, value) in by.iter().enumerate().take(columns) {
                if let Some(entry) = all.get_mut(column * rows + row) {
                    *entry = *value;
                }
            }
        })
    }
}

/// Fits LuGre or GMS to recordings of sliding in one direction, which begin in steady sliding.
///
/// # Errors
/// As [`fit_lag`]; [`IdentError::ElementCount`] where the lists of GMS are empty or differ in length.
pub fn fit_relaxation(
    recordings: &[LagRecording],
    options: &LagOptions,
    model: Relaxation,
) -> Result<RelaxationFit, IdentError> {
    let data = Prepared::new(recordings, options)?;
    let elements = match model {
        Relaxation::LuGre => vec![Element { alpha: 1.0, rate: 1.0, damping: 0.0 }],
        Relaxation::Gms { alpha, sigma0, sigma1 } => {
            let n = alpha.len();
            let usable = alpha.iter().chain(sigma0).all(|&x| x > 0.0 && x.is_finite())
                && sigma1.iter().all(|&x| x >= 0.0 && x.is_finite());
            if n == 0 || sigma0.len() != n || sigma1.len() != n || !usable {
                return Err(IdentError::ElementCount(n));
            }
            let lists = alpha.iter().zip(sigma0).zip(sigma1);
            let mut merged: Vec<Element> = Vec::new();
            for ((&alpha, k), &damping) in lists {
                let rate = k / alpha;
                // Elements of one rate move together.
                match merged.iter_mut().find(|other| (other.rate / rate - 1.0).abs() < 1e-12) {
                    Some(twin) => (twin.alpha, twin.damping) = (twin.alpha + alpha, twin.damping + damping),
                    None => merged.push(Element { alpha, rate, damping }),
                }
            }
            merged
        }
    };
    let lugre = model == Relaxation::LuGre;
    let slopes = data.recordings.iter().map(|r| slope(&r.speed, r.dt)).collect();
    let samples = data.samples();
    let settle = options.settle;
    let mut problem = Problem { data: &data, slopes, elements, lugre, settle, samples, evaluations: 0 };
    // The proposed model's lag lies near; its time constant gives the rate.
    let first = fit_lag(recordings, options)?.values;
    let (f_c, f_s) = (first.f_c, first.f_s.max(1.001 * first.f_c));
    let v_s = first.v_s.min(data.speeds.1);
    let mean_rate = problem.elements.iter().map(|e| e.alpha * e.rate).sum::<f64>()
        / problem.elements.iter().map(|e| e.alpha).sum::<f64>();
    let rate = f_s / first.tau / mean_rate / if lugre { v_s } else { 1.0 };
    let start = |factor: f64| {
        let mut x = vec![f_s, f_c, v_s, first.f_v.max(0.0), factor * rate];
        if lugre {
            x.push(0.05 * first.f_v.abs());
        }
        x
    };
    let mut scratch = vec![0.0; samples];
    let mut sum_of = |x: &[f64]| {
        let allowed = problem.residuals(x, &mut scratch);
        if allowed { scratch.iter().map(|r| r * r).sum() } else { f64::INFINITY }
    };
    let best = [0.3, 1.0, 3.0]
        .map(start)
        .into_iter()
        .map(|x| (sum_of(&x), x))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, x)| x)
        .unwrap_or_default();
    let mut bounds = vec![
        Bound::within(1e-3 * f_s, 1e3 * f_s, f_s),
        Bound::within(1e-3 * f_c, 1e3 * f_c, f_c),
        Bound::within(0.2 * data.speeds.0, 10.0 * data.speeds.1, v_s),
        Bound::within(0.0, f64::INFINITY, first.f_v.abs().max(1e-6)),
        Bound::within(1e-4 * rate, 1e4 * rate, rate),
    ];
    if lugre {
        bounds.push(Bound::within(0.0, f64::INFINITY, first.f_v.abs().max(1e-6)));
    }
    // About a hundredth of a standard error, as usual programs stop.
    let patience = Patience { sum: 1e-8, step: 1e-9, ..Patience::default() };
    let go = &mut |_: &_| ControlFlow::Continue(());
    let minimum = minimise(&mut problem, &best, &bounds, &patience, go)
        .ok_or_else(|| IdentError::NoConvergence("the relaxation cannot be simulated".to_owned()))?;
    let unknown = |name: &str, unit: Unit| Unknown {
        name: name.to_owned(),
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
    let share = effective_share(minimum.residuals.as_slice());
    let estimates = Estimates::linearised(&minimum, &unknowns, share);
    let mse = minimum.sum / samples as f64;
    Ok(RelaxationFit { estimates, mse, samples, evaluations: problem.evaluations })
}
