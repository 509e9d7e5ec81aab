//! Maxwell slip: `N` stops in parallel, the pre-sliding part of GMS and Xiong's model.

use std::ops::ControlFlow;

use friction_model::Unit;
use nalgebra::DMatrix;

use super::spectrum::spectrum;
use super::{Paths, PreSlidingFit};
use crate::IdentError;
use crate::bounded::{Bound, Minimum, Patience, Residuals, minimise};
use crate::derived::{Derived, derive};
use crate::estimate::{Doubt, Estimate, Estimates, Unknown, Verdict};
use crate::parameter_id::ParameterId;
use crate::residual_whiteness::effective_share;

/// How a model calls shares and stiffnesses.
#[derive(Debug, Clone, Copy)]
pub(super) struct Names {
    share: &'static str,
    stiffness: &'static str,
}

pub(super) const GMS: Names = Names { share: "alpha", stiffness: "sigma0" };
pub(super) const XIONG: Names = Names { share: "lambda", stiffness: "k" };

const SLIP: &str = "move further, until every element slips and the torque stops rising";
const NESTED: &str =
    "turn more often at different displacements, so that the elements slip one by one";

/// Samples on which the starts compete.
const THIN: usize = 400;

/// Stops as residuals: unknowns are the stiffnesses, then the widths.
#[derive(Debug)]
pub struct MaxwellSlip<'a> {
    data: &'a Paths,
    elements: usize,
    evaluations: usize,
}

impl Residuals for MaxwellSlip<'_> {
    fn len(&self) -> usize {
        self.data.torque.len()
    }

    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        self.evaluations += 1;
        out.iter_mut().zip(&self.data.torque).for_each(|(r, y)| *r = -y);
        let (stiffnesses, widths) = x.split_at(self.elements.min(x.len()));
        for (&k, &w) in stiffnesses.iter().zip(widths) {
            self.each(w, |i, deflection, _| {
                if let Some(r) = out.get_mut(i) {
                    *r += k * deflection;
                }
            });
        }
        true
    }

    /// `dF/dk` is the deflection; `dF/dw` is `k` times the side on which the stop slipped last.
    fn jacobian(&mut self, x: &[f64], _: &[f64], jacobian: &mut DMatrix<f64>) -> bool {
        let (stiffnesses, widths) = x.split_at(self.elements.min(x.len()));
        for (e, (&k, &w)) in stiffnesses.iter().zip(widths).enumerate() {
            let (mut by_k, mut by_w) = jacobian.columns_range_pair_mut(e, e + self.elements);
            self.each(w, |i, deflection, side| (by_k[i], by_w[i]) = (deflection, k * side));
        }
        true
    }
}

impl MaxwellSlip<'_> {
    /// Runs a stop along every path; `see` gets the sample, the deflection and the side on which it
    /// slipped last, zero before.
    fn each(&self, width: f64, mut see: impl FnMut(usize, f64, f64)) {
        for (start, end) in self.data.ranges() {
            let (mut before, mut deflection, mut side) = (0.0, 0.0f64, 0.0);
            for (i, &x) in self.data.displacement.iter().enumerate().take(end).skip(start) {
                deflection += x - before;
                before = x;
                if deflection.abs() > width {
                    side = 1.0f64.copysign(deflection);
                    deflection = side * width;
                }
                see(i, deflection, side);
            }
        }
    }
}

/// The best of several starts on thinned paths, refined on all samples.
fn best(data: &Paths, elements: usize) -> Option<(Minimum, usize)> {
    let thin = data.thinned(THIN);
    let fine = spectrum(&thin);
    let total: f64 = fine.stiffnesses.iter().sum();
    if total <= 0.0 {
        return None;
    }
    let mut starts = vec![fine.merged(elements)];
    // Fewer stops in the spectrum than elements: split evenly instead; and even starts of their
    // own.
    for spread in [0.1f64, 0.35] {
        let width = |i: usize| data.reach * spread.powf(1.0 - (i as f64 + 0.5) / elements as f64);
        starts.push(super::Spectrum {
            widths: (0..elements).map(width).collect(),
            stiffnesses: vec![total / elements as f64; elements],
        });
    }
    let bounds: Vec<Bound> = (0..2 * elements)
        .map(|j| {
            let scale = if j < elements { total / elements as f64 } else { data.reach };
            Bound::within(1e-6 * scale, 1e3 * scale, scale)
        })
        .collect();
    let patience = Patience { iterations: 60, ..Patience::default() };
    let go = &mut |_: &_| ControlFlow::Continue(());
    let mut coarse = MaxwellSlip { data: &thin, elements, evaluations: 0 };
    let mut winner: Option<Minimum> = None;
    for start in starts.iter().filter(|start| start.widths.len() == elements) {
        let x: Vec<f64> = start.stiffnesses.iter().chain(&start.widths).copied().collect();
        if let Some(found) = minimise(&mut coarse, &x, &bounds, &patience, go)
            && winner.as_ref().is_none_or(|winner| found.sum < winner.sum)
        {
            winner = Some(found);
        }
    }
    let mut problem = MaxwellSlip { data, elements, evaluations: 0 };
    let found = minimise(&mut problem, &winner?.x, &bounds, &Patience::default(), go)?;
    Some((found, problem.evaluations))
}

/// Fits `elements` stops and names them as a model does: static level, shares and stiffnesses, the
/// narrowest element first.
pub(super) fn fit(
    data: &Paths,
    elements: usize,
    names: Names,
) -> Result<PreSlidingFit, IdentError> {
    let nothing = || IdentError::NoConvergence("no stops explain the torque".to_owned());
    let (found, evaluations) = best(data, elements).ok_or_else(nothing)?;
    let mse = found.sum / data.torque.len() as f64;
    let share = effective_share(found.residuals.as_slice());
    let mut order: Vec<usize> = (0..elements).collect();
    order.sort_by(|&a, &b| found.x[elements + a].total_cmp(&found.x[elements + b]));
    let unknown = |id, unit: Unit, remedy| Unknown { id, unit: unit.rotary(), remedy };
    let element = |name: &'static str, i: usize| ParameterId::new(name).element(i);
    let raw_names: Vec<Unknown> = (0..2 * elements)
        .map(|j| {
            let (name, unit, remedy) = if j < elements {
                (names.stiffness, Unit::Stiffness, NESTED)
            } else {
                ("width", Unit::Deflection, SLIP)
            };
            unknown(element(name, j % elements), unit, remedy)
        })
        .collect();
    let raw = Estimates::linearised(&found, &raw_names, share);
    let (k, w) = (|i: usize| found.x[i], |i: usize| found.x[elements + i]);
    let f_s: f64 = (0..elements).map(|i| k(i) * w(i)).sum();
    // d f_s = sum w dk + k dw.
    let level: Vec<f64> =
        (0..2 * elements).map(|j| if j < elements { w(j) } else { k(j - elements) }).collect();
    let mut derived = vec![Derived {
        unknown: unknown("f_s".into(), Unit::Force, SLIP),
        value: f_s,
        gradient: level.clone(),
    }];
    for (place, &i) in order.iter().enumerate() {
        let value = k(i) * w(i) / f_s;
        let mut gradient: Vec<f64> = level.iter().map(|slope| -value * slope / f_s).collect();
        gradient[i] += w(i) / f_s;
        gradient[elements + i] += k(i) / f_s;
        derived.push(Derived {
            unknown: unknown(element(names.share, place), Unit::None, SLIP),
            value,
            gradient,
        });
    }
    for (place, &i) in order.iter().enumerate() {
        let gradient = (0..2 * elements).map(|j| f64::from(u8::from(i == j))).collect();
        let unknown = unknown(element(names.stiffness, place), Unit::Stiffness, NESTED);
        derived.push(Derived { unknown, value: k(i), gradient });
    }
    let estimates = derive(&raw, &derived);
    Ok(PreSlidingFit { estimates, mse, samples: data.torque.len(), evaluations })
}

/// Springs that never slip: the data determine their sum, which is shared evenly, and nothing of
/// each.
pub(super) fn fit_springs(data: &Paths, elements: usize) -> Result<PreSlidingFit, IdentError> {
    let squares: f64 = data.displacement.iter().map(|x| x * x).sum();
    let along: f64 = data.displacement.iter().zip(&data.torque).map(|(x, y)| x * y).sum();
    let stiffness = along / squares;
    let residuals: Vec<f64> =
        data.displacement.iter().zip(&data.torque).map(|(x, y)| stiffness * x - y).collect();
    let sum: f64 = residuals.iter().map(|r| r * r).sum();
    let samples = data.torque.len();
    let minimum = Minimum {
        x: vec![stiffness],
        jacobian: DMatrix::from_column_slice(samples, 1, &data.displacement),
        held: vec![false],
        sum,
        evaluations: 1,
        ending: crate::bounded::Ending::Converged,
        residuals: residuals.into(),
    };
    let share = effective_share(minimum.residuals.as_slice());
    let unit = Unit::Stiffness.rotary();
    let whole = Unknown { id: "sigma0".into(), unit, remedy: NESTED };
    let mut estimates = Estimates::linearised(&minimum, &[whole], share);
    if elements > 1 {
        let each = (0..elements).map(|i| Estimate {
            id: ParameterId::new("sigma0").element(i),
            unit,
            value: stiffness / elements as f64,
            standard_error: None,
            interval: None,
            verdict: Verdict::NotIdentifiable {
                doubt: Doubt::Confounded { other: "the other springs".to_owned(), correlation: -1.0 },
                remedy: "let the elements slip: fit GMS or Xiong's model, on paths that turn at different displacements",
            },
        });
        estimates.parameters.extend(each);
        let n = elements + 1;
        for (matrix, diagonal) in
            [(&mut estimates.correlation, 1.0), (&mut estimates.covariance, 0.0)]
        {
            matrix.iter_mut().for_each(|row| row.resize(n, 0.0));
            matrix.extend(
                (1..n).map(|i| (0..n).map(|j| if i == j { diagonal } else { 0.0 }).collect()),
            );
        }
    }
    Ok(PreSlidingFit { estimates, mse: sum / samples as f64, samples, evaluations: 1 })
}
