//! Which structure predicts best: blocked cross-validation inside one recording.
//!
//! The recording is cut into contiguous blocks. Each in turn is predicted by a fit to the others,
//! all parameters fitted anew, the nonlinear ones included. Rows next to the block are left out of
//! the fit: the low-pass before the thinning reaches across.

use std::ops::Range;

use nalgebra::DVector;
use serde::Serialize;

use super::AxisStructure;
use super::left_out::Whole;
use super::naming::{AxisUnits, unknowns};
use super::rows::rows_of;
use super::search::{Best, Search};
use super::shape::{PositionScale, Shape};
use crate::IdentError;
use crate::conditioning::Conditioned;
use crate::parameter_id::{ParameterId, Side};
use crate::statistics::Sample;

/// Share of the sum of squares by which a search must still fall to go on: structures differ by far
/// more.
pub(super) const ENOUGH: f64 = 1e-5;
/// The same share that a step in place of a search may leave over.
const OVER: f64 = 1e-3;
/// Rows on each side of a block that take no part in its fit: the length of the anti-alias
/// low-pass's memory, in thinned samples.
const GUARD: usize = 15;
/// Blocks where the recording is long enough for them.
const USUAL: usize = 8;
/// Share of a recording that must lie below the Stribeck velocity for a rise of the friction up to
/// there to be seen, and not only passed through.
const SEEN: f64 = 0.1;
/// The guard of a recording of so few rows: its strongest neighbours.
const SHORTEST_GUARD: usize = 3;

/// The guard that a recording of `rows` can spare: of a short one a 16th on each side of a block.
fn guard(rows: usize) -> usize {
    GUARD.min((rows / 16).max(SHORTEST_GUARD))
}

/// Blocks that suit a recording: eight, and fewer where they would be shorter than their guards.
/// Nothing can be compared below two.
pub fn blocks_for(recording: &Conditioned) -> usize {
    let rows = recording.pieces.iter().map(|piece| rows_of(piece, recording.decimate)).sum();
    USUAL.min(most(rows))
}

fn most(rows: usize) -> usize {
    (rows / (2 * guard(rows))).min(50)
}

/// How well one structure predicts what it has not seen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CrossValidation {
    /// The structure.
    pub structure: AxisStructure,
    /// The nonlinear parameters, fitted to all blocks.
    #[serde(skip)]
    pub shape: Shape,
    /// Sum of squared prediction errors of each block, over the rows of the whole recording
    /// \[N^2 or (N m)^2\].
    pub blocks: Vec<f64>,
    /// Mean square of the force \[N^2 or (N m)^2\].
    pub force_power: f64,
    /// `100 |prediction error| / |force|` over all blocks \[%\].
    pub relative_error: f64,
    /// Its standard error, from the spread of the blocks \[%\].
    pub standard_error: f64,
    /// What friction does over the first speeds, by the fit.
    pub first_speeds: FirstSpeeds,
    /// Rows of the recording.
    pub rows: usize,
    /// The same of another recording that took part in the comparison.
    pub elsewhere: Option<Elsewhere>,
}

/// How well a structure predicts a recording that it was not fitted to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Elsewhere {
    /// Sum of squared prediction errors of each contiguous block, over the rows of the recording
    /// \[N^2 or (N m)^2\].
    pub blocks: Vec<f64>,
    /// Mean square of the force \[N^2 or (N m)^2\].
    pub force_power: f64,
    /// `100 |prediction error| / |force|` \[%\].
    pub relative_error: f64,
    /// Rows of the recording.
    pub rows: usize,
}

/// What friction does over the first speeds, the likeliest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FirstSpeeds {
    /// It falls, as in a Stribeck dip, or stays as it is, or it rises over speeds at which a tenth
    /// of the recording lies.
    Plausible,
    /// It rises, in one direction by more than it falls in the other, over speeds at which less of
    /// the recording lies.
    Rises,
}

/// Predicts each of `blocks` contiguous blocks from the others.
///
/// # Errors
/// [`IdentError::BlockCount`] outside 2 to 50 or where a block would be shorter than its guards,
/// and those of [`fit_structure`](super::fit_structure) for the recording as a whole or without one
/// of its blocks.
pub fn cross_validate(
    recording: &Conditioned,
    structure: AxisStructure,
    blocks: usize,
) -> Result<CrossValidation, IdentError> {
    cross_validate_beside(recording, structure, blocks, &[])
}

/// The same beside structures that were cross-validated on the recording before: the search for the
/// nonlinear parameters begins where that of the best one with a part less has ended, and only what
/// is new is searched all over.
///
/// # Errors
/// Those of [`cross_validate`]; [`IdentError::IdleLag`] where a dip that follows at once, with as many
/// parameters, fits the recording as well as one that lags, and [`IdentError::NoDipToLag`] where the
/// friction does not fall.
pub fn cross_validate_beside(
    recording: &Conditioned,
    structure: AxisStructure,
    blocks: usize,
    known: &[CrossValidation],
) -> Result<CrossValidation, IdentError> {
    let scale = PositionScale::of(recording);
    let mut search = Search::new(recording, structure, scale)?;
    let rows = search.regressors.count();
    if !(2..=50).contains(&blocks) || blocks > most(rows) {
        return Err(IdentError::BlockCount { blocks, rows, most: most(rows) });
    }
    let guard = guard(rows);
    let at_once = AxisStructure { lag: false, ..structure };
    let simpler = |score: &&CrossValidation| {
        let fewer = score.structure.parameters() < structure.parameters();
        fewer && structure.neighbours().contains(&score.structure)
            || structure.lag && score.structure == at_once
    };
    let simpler = known.iter().filter(simpler);
    let best = match simpler.min_by(|a, b| a.relative_error.total_cmp(&b.relative_error)) {
        Some(simpler) => search.grown(&simpler.structure, simpler.shape, ENOUGH)?,
        None => search.least(scale)?,
    };
    if let Some(prompt) = known.iter().find(|score| structure.lag && score.structure == at_once) {
        let prompt = Search::new(recording, at_once, scale)?.solve(&prompt.shape)?;
        let [prompt, lagging] = [&prompt, &best.solution].map(|fit| fit.residual.norm_squared());
        if lagging >= prompt {
            return Err(IdentError::IdleLag);
        }
        if let Some(ratio) = search.regressors.ratio(&best.solution.x).filter(|ratio| *ratio <= 1.0)
        {
            return Err(IdentError::NoDipToLag { ratio });
        }
    }
    search.settled(&best)?;
    search.possible(&best)?;
    let first_speeds = first_speeds(&structure, &best, &search);
    let whole = Whole::of(&mut search, &best)?;
    let mut squares = Vec::with_capacity(blocks);
    for block in 0..blocks {
        let (first, end) = (block * rows / blocks, (block + 1) * rows / blocks);
        let out = first.saturating_sub(guard)..(end + guard).min(rows);
        let error = match whole.without(&search, out.clone(), OVER) {
            Some(change) => whole.rest(&change, first..end),
            None => searched(&mut search, &best, out, first..end)?,
        };
        squares.push(error.norm_squared() / rows as f64);
    }
    let force_power = search.regressors.force.norm_squared() / rows as f64;
    let sum: f64 = squares.iter().sum();
    let relative_error = 100.0 * (sum / force_power).sqrt();
    let standard_error = 100.0 * sum_error(&squares) / (2.0 * (sum * force_power).sqrt());
    let shape = best.shape;
    let blocks = squares;
    Ok(CrossValidation {
        structure,
        shape,
        blocks,
        force_power,
        relative_error,
        standard_error,
        first_speeds,
        rows,
        elsewhere: None,
    })
}

/// What the friction of a fit does over the first speeds.
fn first_speeds(structure: &AxisStructure, best: &Best, search: &Search) -> FirstSpeeds {
    let names = unknowns(structure, &AxisUnits::LINEAR);
    let value = |id: ParameterId| {
        let place = names.iter().position(|unknown| unknown.id == id)?;
        best.solution.x.get(place).copied()
    };
    let (mut fall, mut rise) = (0.0, 0.0);
    for &side in Side::of(structure.asymmetric) {
        let [f_s, f_c] = ["f_s", "f_c"].map(|name| value(ParameterId::new(name).side(side)));
        if let (Some(f_s), Some(f_c)) = (f_s, f_c) {
            (fall, rise) = (f64::max(fall, f_s - f_c), f64::max(rise, f_c - f_s));
        }
    }
    let slow = |v: &f64| v.abs() < best.shape.v_s;
    let velocity = search.regressors.velocity(&best.shape);
    let seen = velocity.iter().filter(|v| slow(v)).count() as f64 >= SEEN * velocity.len() as f64;
    if rise > fall && !seen { FirstSpeeds::Rises } else { FirstSpeeds::Plausible }
}

/// Error of the prediction of the rows in `block` by a search without those in `out`.
fn searched(
    search: &mut Search,
    best: &Best,
    out: Range<usize>,
    block: Range<usize>,
) -> Result<DVector<f64>, IdentError> {
    search.rows = Some((0..search.regressors.count()).filter(|k| !out.contains(k)).collect());
    let found = search.closer(best.shape, &[], ENOUGH);
    search.rows = None;
    let Best { shape, solution } = found?;
    let matrix = search.regressors.matrix(&shape)?;
    let predicted = matrix.rows(block.start, block.len()) * &solution.x;
    let mut error = search.regressors.force.rows(block.start, block.len()) - predicted;
    let rows: Vec<usize> = block.collect();
    search.regressors.starts(&shape, Some(&rows))?.leave_out(error.as_mut_slice());
    Ok(error)
}

/// Standard error of the sum of independent parts.
pub(super) fn sum_error(parts: &[f64]) -> f64 {
    (parts.len() as f64 * Sample::of(parts.iter().copied()).variance()).sqrt()
}
