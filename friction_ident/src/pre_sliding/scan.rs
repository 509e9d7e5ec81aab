//! Operators with a level and one or two lengths: scan the lengths, then refine everything.

use std::ops::ControlFlow;

use friction_model::Unit;
use nalgebra::DMatrix;

use super::{Operator, Paths, PreSlidingFit};
use crate::IdentError;
use crate::bounded::{Bound, Patience, Residuals, minimise};
use crate::derived::{Derived, derive};
use crate::estimate::{Estimates, Unknown};
use crate::residual_whiteness::effective_share;

/// Lengths tried, from a fifteenth of the largest displacement to 20 times it.
const TRIALS: usize = 36;
/// Elastic shares tried with each.
const ELASTIC: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
/// Samples of the scan.
const THIN: usize = 400;

const BREAK_AWAY: &str = "move further, until the torque stops rising, and turn on the way";
const TURN: &str = "turn several times at different displacements";

/// `level * operator(lengths)` minus the torque.
struct Problem<'a> {
    data: &'a Paths,
    operator: Operator,
    /// Operator at moved lengths.
    there: [Vec<f64>; 2],
    evaluations: usize,
}

impl<'a> Problem<'a> {
    fn new(data: &'a Paths, operator: Operator) -> Self {
        let room = vec![0.0; data.torque.len()];
        Self { data, operator, there: [room.clone(), room], evaluations: 0 }
    }

    /// The operator along every path.
    fn run(&mut self, lengths: &[f64], out: &mut [f64]) -> bool {
        self.evaluations += 1;
        self.data.ranges().all(|(start, end)| {
            let (path, out) = (self.data.displacement.get(start..end), out.get_mut(start..end));
            path.zip(out).is_some_and(|(path, out)| self.operator.run(lengths, path, out))
        })
    }

    /// Best level for given lengths and the sum of squares with it.
    fn level(&mut self, lengths: &[f64]) -> Option<(f64, f64)> {
        let mut unit = std::mem::take(&mut self.there[0]);
        let allowed = self.run(lengths, &mut unit);
        let along: f64 = unit.iter().zip(&self.data.torque).map(|(u, y)| u * y).sum();
        let squares: f64 = unit.iter().map(|u| u * u).sum();
        self.there[0] = unit;
        let level = along / squares;
        (allowed && level > 0.0).then(|| (level, self.data.sum_of_squares() - level * along))
    }
}

impl Residuals for Problem<'_> {
    fn len(&self) -> usize {
        self.data.torque.len()
    }

    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        let Some((&level, lengths)) = x.split_first() else { return false };
        if !(level > 0.0 && self.run(lengths, out)) {
            return false;
        }
        out.iter_mut().zip(&self.data.torque).for_each(|(u, y)| *u = level * *u - y);
        true
    }

    fn jacobian(&mut self, x: &[f64], residuals: &[f64], jacobian: &mut DMatrix<f64>) -> bool {
        let Some((&level, lengths)) = x.split_first() else { return false };
        for ((entry, r), y) in
            jacobian.column_mut(0).iter_mut().zip(residuals).zip(&self.data.torque)
        {
            *entry = (r + y) / level;
        }
        let mut moved = lengths.to_vec();
        for (j, &length) in lengths.iter().enumerate() {
            // Central differences: the operator is smooth in its lengths but for kinks where a
            // branch closes.
            let h = 1e-5 * length;
            let [mut above, mut below] = std::mem::take(&mut self.there);
            moved[j] = length + h;
            let up = self.run(&moved, &mut above);
            moved[j] = length - h;
            let down = self.run(&moved, &mut below);
            moved[j] = length;
            for (entry, (a, b)) in
                jacobian.column_mut(j + 1).iter_mut().zip(above.iter().zip(&below))
            {
                *entry = level * (a - b) / (2.0 * h);
            }
            self.there = [above, below];
            if !(up && down) {
                return false;
            }
        }
        true
    }
}

/// Fits the level and the lengths.
pub(super) fn fit(data: &Paths, operator: Operator) -> Result<PreSlidingFit, IdentError> {
    let thin = data.thinned(THIN);
    let mut coarse = Problem::new(&thin, operator);
    let length = |i: usize| data.reach / 15.0 * 300f64.powf(i as f64 / (TRIALS - 1) as f64);
    let mut best: Option<(f64, Vec<f64>)> = None;
    for l in (0..TRIALS).map(length) {
        let elastic: &[f64] = if operator.lengths() == 2 { &ELASTIC } else { &[0.0] };
        for share in elastic {
            let lengths = &[l, share * l][..operator.lengths()];
            if let Some((level, sum)) = coarse.level(lengths)
                && best.as_ref().is_none_or(|(least, _)| sum < *least)
            {
                best = Some((sum, std::iter::once(level).chain(lengths.iter().copied()).collect()));
            }
        }
    }
    let falls =
        || IdentError::NoConvergence("the torque falls where the displacement grows".to_owned());
    let (_, start) = best.ok_or_else(falls)?;
    let bounds: Vec<Bound> = start.iter().map(|&x| Bound::within(1e-6 * x, 1e6 * x, x)).collect();
    let mut problem = Problem::new(data, operator);
    let go = &mut |_: &_| ControlFlow::Continue(());
    let minimum =
        minimise(&mut problem, &start, &bounds, &Patience::default(), go).ok_or_else(falls)?;
    let unknown = |name: &'static str, unit: Unit, remedy| Unknown {
        id: name.into(),
        unit: unit.rotary(),
        remedy,
    };
    let level = if matches!(operator, Operator::Power { .. }) { "f_c" } else { "f_s" };
    let unknowns = [
        unknown(level, Unit::Force, BREAK_AWAY),
        unknown("z_b", Unit::Deflection, BREAK_AWAY),
        unknown("z_ba", Unit::Deflection, TURN),
    ];
    let share = effective_share(minimum.residuals.as_slice());
    let raw = Estimates::linearised(&minimum, &unknowns[..minimum.x.len()], share);
    let estimates = match (operator, minimum.x.as_slice()) {
        (Operator::Sine, _) => raw,
        // The length is level over stiffness.
        (_, &[level, length, ..]) => {
            let stiffness = Derived {
                unknown: unknown("sigma0", Unit::Stiffness, "record more samples between turns"),
                value: level / length,
                gradient: vec![1.0 / length, -level / length / length],
            };
            let keep = |j: usize| Derived {
                unknown: unknowns[j],
                value: minimum.x[j],
                gradient: (0..=j).map(|i| f64::from(u8::from(i == j))).collect(),
            };
            let mut derived = vec![keep(0), stiffness];
            derived.extend((2..minimum.x.len()).map(keep));
            derive(&raw, &derived)
        }
        _ => raw,
    };
    let mse = minimum.sum / data.torque.len() as f64;
    Ok(PreSlidingFit {
        estimates,
        mse,
        samples: data.torque.len(),
        evaluations: problem.evaluations,
    })
}
