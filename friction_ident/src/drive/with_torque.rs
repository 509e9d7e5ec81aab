//! The fit in volts where the friction torque was measured: linear least squares at each delay.

use nalgebra::{DMatrix, DVector};

use super::fitted::Fitted;
use crate::axis_structure::{LONGEST_DELAY, read_between, rows_of};
use crate::bounded::Minimum;
use crate::conditioning::{Conditioned, Piece};
use crate::estimate::{Estimates, Unknown};
use crate::residual_whiteness::effective_share;
use crate::zero_phase::LowPass;
use crate::{Ending, IdentError, least_squares};

/// Names, units and remedies of the columns and of the delay.
const NAMES: [(&str, &str, &str); 5] = [
    ("inertia", "V s^2", "steps and fast changes of the voltage"),
    ("back_emf", "V s", "several speeds"),
    (
        "volts_per_torque",
        "V/(N m)",
        "reversals, so that the friction changes while the speed hardly does",
    ),
    ("offset", "V", "motion in both directions"),
    ("delay", "s", "steps of the voltage, sampled faster"),
];

/// `u = inertia w' + back_emf w + volts_per_torque F + offset`, all but the voltage read `delay`
/// later.
pub(super) fn with_torque(
    recording: &Conditioned,
    friction: &[&[f64]],
) -> Result<Fitted, IdentError> {
    let Conditioned { time_step, first, velocity, acceleration, force, decimate, .. } = recording;
    let friction = measured_friction(recording, friction)?;
    let filter = match decimate {
        1 => None,
        factor => Some(LowPass::chebyshev(8, 0.05, 0.4 / *factor as f64, 1.0)?),
    };
    let smooth = |column: &[f64]| match &filter {
        Some(filter) => recording.by_piece(column, |piece| filter.filter(piece)),
        None => Ok(column.to_vec()),
    };
    let pieces = &recording.pieces;
    let rows: usize = pieces.iter().map(|piece| rows_of(piece, *decimate)).sum();
    if rows < 40 {
        return Err(IdentError::TooFewSamples {
            what: "the regression, after trimming and decimation,",
            needed: 40,
            found: rows,
            lower: Some("the trim or the decimation"),
        });
    }
    let read = |column: &[f64], delay: f64| -> Vec<f64> {
        let of = |piece: &Piece| {
            let own = column.get(piece.kept.clone()).unwrap_or_default();
            (0..rows_of(piece, *decimate))
                .map(move |k| read_between(own, (k * decimate) as f64 + delay))
        };
        pieces.iter().flat_map(of).collect()
    };
    let y = DVector::from_vec(read(&smooth(force)?, 0.0));
    let columns = [smooth(acceleration)?, smooth(velocity)?, smooth(&friction)?];
    let matrix = |delay: f64| {
        let mut matrix = DMatrix::from_element(rows, 4, 1.0);
        for (j, column) in columns.iter().enumerate() {
            matrix.column_mut(j).copy_from_slice(&read(column, delay));
        }
        matrix
    };
    let solve = |delay: f64| {
        least_squares::solve(&matrix(delay), &y).map_err(|degenerate| {
            let names = degenerate.columns.iter().filter_map(|&j| NAMES.get(j));
            IdentError::Columns { names: names.map(|name| name.0.to_owned()).collect() }
        })
    };
    let delay = golden(0.0, LONGEST_DELAY as f64, |delay| {
        solve(delay).map_or(f64::INFINITY, |solution| solution.residual.norm_squared())
    });
    let solution = solve(delay)?;
    let h = 1e-2;
    let (before, after) = ((delay - h).max(0.0), (delay + h).min(LONGEST_DELAY as f64));
    let slope = (matrix(after) - matrix(before)) * &solution.x / ((after - before) * time_step);
    let design = matrix(delay);
    let mut jacobian = DMatrix::zeros(rows, 5);
    jacobian.columns_mut(0, 4).copy_from(&-&design);
    jacobian.set_column(4, &-slope);
    let mut x = solution.x.as_slice().to_vec();
    x.push(delay * time_step);
    let at_bound = delay < 1e-3 || delay > LONGEST_DELAY as f64 - 1e-3;
    let share = effective_share(solution.residual.as_slice());
    let minimum = Minimum {
        x,
        sum: solution.residual.norm_squared(),
        residuals: solution.residual.clone(),
        jacobian,
        held: vec![false, false, false, false, at_bound],
        evaluations: 0,
        ending: Ending::Converged,
    };
    let unknowns = NAMES.map(|(name, unit, remedy)| Unknown { id: name.into(), unit, remedy });
    let time = |piece: &Piece| {
        let start = piece.start;
        (0..rows_of(piece, *decimate))
            .map(move |k| start + (first + k * decimate) as f64 * time_step)
    };
    Ok(Fitted {
        estimates: Estimates::linearised(&minimum, &unknowns, share),
        time: pieces.iter().flat_map(time).collect(),
        measured: y.as_slice().to_vec(),
        predicted: (design * &solution.x).as_slice().to_vec(),
        share,
    })
}

/// The friction torque on the kept samples of every stretch.
fn measured_friction(recording: &Conditioned, friction: &[&[f64]]) -> Result<Vec<f64>, IdentError> {
    const CHANNEL: &str = "the friction torque";
    let mut kept = Vec::with_capacity(recording.force.len());
    for piece in &recording.pieces {
        let all = friction.get(piece.stretch).copied().unwrap_or_default();
        let own = all.get(recording.first..recording.first + piece.kept.len());
        kept.extend_from_slice(own.ok_or(IdentError::UnequalLengths {
            channel: CHANNEL,
            found: all.len(),
            expected: piece.kept.len() + 2 * recording.first,
        })?);
    }
    if let Some(index) = kept.iter().position(|value| !crate::finite::usable(*value)) {
        let value = kept[index];
        return Err(IdentError::NotFinite {
            channel: CHANNEL,
            index: recording.first + index,
            value,
        });
    }
    Ok(kept)
}

/// The least value of a function with one valley (Kiefer 1953).
fn golden(mut low: f64, mut high: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut fa, mut fb) = (f(a), f(b));
    while high - low > 1e-4 {
        if fa < fb {
            (high, b, fb) = (b, a, fa);
            a = high - ratio * (high - low);
            fa = f(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + ratio * (high - low);
            fb = f(b);
        }
    }
    0.5 * (low + high)
}
