//! Whether the parameters stay where they are when part of the recording is left out.
//!
//! A parameter that moves out of its own interval when an eighth of the recording is taken away
//! describes that eighth and not the axis: its interval counts noise, not what the model cannot do.
//! The interval is taken as wide as what is left of the recording makes it.
//! A period is searched anew in each half besides, because near a narrow minimum no search finds
//! another one.

use nalgebra::DMatrix;

use super::left_out::Whole;
use super::search::{Best, Search};
use super::shape::{LONGEST_DELAY, ShapeTerm};
use crate::estimate::{Doubt, Estimate, Estimates, Verdict};
use crate::finite::finite;

/// What helps one that moves.
const THROUGHOUT: &str = "a longer recording in which the effect shows throughout";
/// What helps one that is about zero.
const LARGER: &str =
    "motion in which it is larger against the rest of the force, if the axis has it at all";
/// Parts of the recording, each left out once.
const PARTS: usize = 8;
/// Rows that each parameter needs in what is left.
const ROWS_EACH: usize = 4;
/// Widths of the interval by which a value must be off: three standard errors in place of two,
/// because eight parts times ten parameters are many comparisons.
const MANY: f64 = 1.5;
/// Samples by which a delay may differ: when a reversal happens is known to a sample, and a mean
/// over a few reversals not to much less than a tenth of one.
const RESOLVED: f64 = 0.1;
/// Waves over the travel by which the periods of both halves may differ.
const SLIP: f64 = 0.5;

/// Takes the verdict `identified` from parameters that do not stay within their interval.
pub(super) fn judge(search: &mut Search, best: &Best, whole: &Whole, estimates: &mut Estimates) {
    let rows = search.regressors.count();
    if rows / PARTS * (PARTS - 1) < ROWS_EACH * estimates.parameters.len() {
        return;
    }
    let terms = ShapeTerm::of(&search.structure);
    let values = |found: &Best| -> Vec<f64> {
        let shape = terms.iter().map(|term| term.value(&found.shape));
        found.solution.x.iter().copied().chain(shape).collect()
    };
    let all = values(best);
    let slopes = &whole.slopes;
    let of_all = variances(slopes);
    let resolved = RESOLVED * search.limits.high.delay / LONGEST_DELAY as f64;
    let mut parameters = vec![Moved::default(); estimates.parameters.len()];
    for part in 0..PARTS {
        let out = part * rows / PARTS..(part + 1) * rows / PARTS;
        let kept: Vec<usize> = (0..rows).filter(|row| !out.contains(row)).collect();
        // What is left may not show a term at all: then nothing is learnt from this part.
        let Some(left) = variances(&slopes.select_rows(&kept)) else { continue };
        let values: Vec<f64> = match whole.without(search, out, 0.0) {
            Some(change) => all.iter().zip(change.iter()).map(|(all, by)| all + by).collect(),
            None => {
                search.rows = Some(kept);
                let Ok(found) = search.from(best.shape, &[]) else { continue };
                values(&found)
            }
        };
        for (j, (moved, estimate)) in parameters.iter_mut().zip(&estimates.parameters).enumerate() {
            let of = |all: &[f64]| all.get(j).copied().unwrap_or(f64::NAN);
            let wider = of_all.as_deref().map_or(1.0, |all| (of(&left) / of(all)).sqrt());
            if estimate.id.name != "delay" || (of(&values) - estimate.value).abs() > resolved {
                moved.see(estimate, of(&values), wider);
            }
        }
    }
    for (estimate, moved) in estimates.parameters.iter_mut().zip(parameters) {
        moved.judge(estimate);
    }
    if terms.contains(&ShapeTerm::Period)
        && let Some((low, high)) = periods(search, best, rows)
        && let Some(period) = estimates.get_mut("period")
    {
        doubt(period, Doubt::Unsteady { low, high }, THROUGHOUT);
    }
    search.rows = None;
}

/// Where a parameter goes as parts are left out.
#[derive(Debug, Clone, Copy)]
struct Moved {
    low: f64,
    high: f64,
    /// Beyond its interval.
    leaves: bool,
    /// To the other side of zero, where it cannot be.
    turns: bool,
}

impl Default for Moved {
    fn default() -> Self {
        Self { low: f64::INFINITY, high: f64::NEG_INFINITY, leaves: false, turns: false }
    }
}

impl Moved {
    /// A value that is found without one of the parts, where errors are `wider` than those of the
    /// whole by a factor of at least one: what the part alone showed is missed with it.
    fn see(&mut self, estimate: &Estimate, value: f64, wider: f64) {
        (self.low, self.high) = (self.low.min(value), self.high.max(value));
        let signed = estimate.id.is_signed();
        self.turns |= !signed && value * estimate.value < 0.0;
        self.leaves |= estimate.interval.is_some_and(|all| {
            let reach = if value < estimate.value { all.low } else { all.high };
            (value - estimate.value).abs() > MANY * wider.max(1.0) * (reach - estimate.value).abs()
        });
    }

    /// What that says: one that only changes its sign, within its interval, is about zero, and moves
    /// no further than its error lets it.
    fn judge(&self, estimate: &mut Estimate) {
        if self.leaves {
            doubt(estimate, Doubt::Unsteady { low: self.low, high: self.high }, THROUGHOUT);
        } else if self.turns {
            let standard_error = estimate.standard_error.unwrap_or(0.5 * (self.high - self.low));
            let effect = estimate.value;
            doubt(estimate, Doubt::BelowNoise { effect, standard_error }, LARGER);
        }
    }
}

/// Diagonal of `(J^T J)^-1`; none where the columns depend on one another.
pub(super) fn variances(slopes: &DMatrix<f64>) -> Option<Vec<f64>> {
    let scale: Vec<f64> = slopes.column_iter().map(|column| column.norm()).collect();
    let mut normal = slopes.tr_mul(slopes);
    for i in 0..scale.len() {
        for j in 0..scale.len() {
            normal[(i, j)] /= scale[i] * scale[j];
        }
    }
    let inverse = finite(finite(normal)?.try_inverse()?)?;
    Some(scale.iter().enumerate().map(|(j, s)| inverse[(j, j)] / (s * s)).collect())
}

/// The periods that both halves find by themselves, where they are not one and the same wave.
fn periods(search: &mut Search, best: &Best, rows: usize) -> Option<(f64, f64)> {
    let travel = 0.5 * search.limits.high.period;
    let mut half = |from: usize, to: usize| {
        search.rows = Some((from..to).collect());
        let start = search.other_period(best.shape).ok()?;
        Some(search.from(start, &[]).ok()?.shape.period)
    };
    let (first, second) = (half(0, rows / 2)?, half(rows / 2, rows)?);
    let differ = (travel / first - travel / second).abs() > SLIP;
    differ.then(|| (first.min(second), first.max(second)))
}

fn doubt(estimate: &mut Estimate, doubt: Doubt, remedy: &'static str) {
    // That it moves says more than that its error is large or a guess.
    let vague = matches!(
        estimate.verdict,
        Verdict::Identified
            | Verdict::NotIdentifiable {
                doubt: Doubt::NotToBeTrusted { .. }
                    | Doubt::LargeError { .. }
                    | Doubt::BelowNoise { .. },
                ..
            }
    );
    if vague {
        estimate.verdict = Verdict::NotIdentifiable { doubt, remedy };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Interval, IntervalMethod};

    /// Friction of an axis that has none changed its sign between parts, and was said not to be the
    /// same in all parts.
    #[test]
    fn friction_about_zero_is_not_called_unsteady() {
        let verdict = |values: [f64; 2]| {
            let interval = Interval { low: -0.8, high: 1.0, method: IntervalMethod::Robust };
            let mut estimate = Estimate {
                id: "f_c".into(),
                unit: "N m",
                value: 0.1,
                standard_error: Some(0.45),
                interval: Some(interval),
                verdict: Verdict::Identified,
            };
            let mut moved = Moved::default();
            values.iter().for_each(|value| moved.see(&estimate, *value, 1.0));
            moved.judge(&mut estimate);
            match estimate.verdict {
                Verdict::NotIdentifiable { doubt, .. } => Some(doubt),
                _ => None,
            }
        };
        let zero = Doubt::BelowNoise { effect: 0.1, standard_error: 0.45 };
        assert_eq!(verdict([-0.1, 0.3]), Some(zero));
        assert_eq!(verdict([-0.1, 3.0]), Some(Doubt::Unsteady { low: -0.1, high: 3.0 }));
        assert_eq!(verdict([0.05, 0.3]), None);
    }
}
