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
use super::rows::rows_of;
use super::search::{Best, Search};
use super::shape::{PositionScale, Shape};
use crate::IdentError;
use crate::conditioning::Conditioned;
use crate::statistics::{Sample, student_95_of};

/// Share of the sum of squares by which a search must still fall to go on: structures differ by far
/// more.
const ENOUGH: f64 = 1e-5;
/// The same share that a step in place of a search may leave over.
const OVER: f64 = 1e-3;
/// Rows on each side of a block that take no part in its fit: the length of the anti-alias
/// low-pass's memory, in thinned samples.
const GUARD: usize = 15;
/// Blocks where the recording is long enough for them.
const USUAL: usize = 8;
/// Share of the best error by which another may be larger and still count as alike.
const ALIKE: f64 = 0.05;
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
/// Those of [`cross_validate`].
pub fn cross_validate_beside(
    recording: &Conditioned,
    structure: AxisStructure,
    blocks: usize,
    known: &[CrossValidation],
) -> Result<CrossValidation, IdentError> {
    let mut search = Search::new(recording, structure, PositionScale::of(recording))?;
    let rows = search.regressors.count();
    if !(2..=50).contains(&blocks) || blocks > most(rows) {
        return Err(IdentError::BlockCount { blocks, rows, most: most(rows) });
    }
    let guard = guard(rows);
    let simpler = |score: &&CrossValidation| {
        score.structure.parameters() < structure.parameters()
            && structure.neighbours().contains(&score.structure)
    };
    let simpler = known.iter().filter(simpler);
    let best = match simpler.min_by(|a, b| a.relative_error.total_cmp(&b.relative_error)) {
        Some(simpler) => search.grown(&simpler.structure, simpler.shape, ENOUGH)?,
        None => search.whole()?,
    };
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
    Ok(CrossValidation { structure, shape, blocks, force_power, relative_error, standard_error })
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
    Ok(search.regressors.force.rows(block.start, block.len()) - predicted)
}

/// Standard error of the sum of independent parts.
fn sum_error(parts: &[f64]) -> f64 {
    (parts.len() as f64 * Sample::of(parts.iter().copied()).variance()).sqrt()
}

/// A structure against the best one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Ranked {
    /// Its place in the list that was given.
    pub index: usize,
    /// Relative error less that of the best structure \[percentage points\].
    pub excess: f64,
    /// Standard error of the excess, from the differences block by block: what all structures find
    /// hard cancels.
    pub excess_error: f64,
    /// Whether the excess is within one standard error.
    pub within: bool,
}

/// What the comparison says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Choice {
    /// The structures from the best to the worst.
    pub ranking: Vec<Ranked>,
    /// Place in the given list of the best prediction.
    pub best: usize,
    /// Place in the given list of the structure to use.
    pub chosen: usize,
}

/// Chooses by the one-standard-error rule (Breiman, Friedman, Olshen and Stone 1984): of the
/// structures whose excess over the best is within one standard error, the one with the fewest
/// parameters; of equals the better one. The standard error is that of the paired difference, and
/// at most that of the best structure's own error: an excess that is uncertain because it is large
/// gives no leave. A structure that predicts worse than one with no more parameters is never
/// chosen.
///
/// None for an empty list, or for structures with different numbers of blocks.
pub fn choose(scores: &[CrossValidation]) -> Option<Choice> {
    let best = (0..scores.len())
        .min_by(|&a, &b| scores[a].relative_error.total_cmp(&scores[b].relative_error))?;
    let winner = &scores[best];
    if scores.iter().any(|score| score.blocks.len() != winner.blocks.len()) {
        return None;
    }
    let mut ranking: Vec<Ranked> = scores
        .iter()
        .enumerate()
        .map(|(index, score)| {
            let difference: Vec<f64> =
                score.blocks.iter().zip(&winner.blocks).map(|(a, b)| a - b).collect();
            let (a, b) = (score.blocks.iter().sum::<f64>(), winner.blocks.iter().sum::<f64>());
            let root = winner.force_power.sqrt() * (a.sqrt() + b.sqrt());
            let percent = |value: f64| if root > 0.0 { 100.0 * value / root } else { 0.0 };
            let (excess, excess_error) = (percent(a - b), percent(sum_error(&difference)));
            let chance = student_95_of(winner.blocks.len().saturating_sub(1) as f64) * excess_error;
            let within =
                excess <= chance.min(winner.standard_error).min(ALIKE * winner.relative_error);
            Ranked { index, excess, excess_error, within }
        })
        .collect();
    ranking.sort_by(|a, b| a.excess.total_cmp(&b.excess));
    let parameters = |ranked: &Ranked| scores[ranked.index].structure.parameters();
    let within = ranking.iter().filter(|ranked| ranked.within);
    let beaten = |ranked: &Ranked| {
        let better = |other: &Ranked| other.excess < ranked.excess;
        ranking.iter().any(|other| better(other) && parameters(other) <= parameters(ranked))
    };
    let chosen = within
        .filter(|ranked| !beaten(ranked))
        .min_by(|a, b| parameters(a).cmp(&parameters(b)).then(a.excess.total_cmp(&b.excess)))?;
    let chosen = chosen.index;
    Some(Choice { ranking, best, chosen })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn score(structure: AxisStructure, blocks: &[f64]) -> CrossValidation {
        let sum: f64 = blocks.iter().sum();
        CrossValidation {
            structure,
            shape: Shape { delay: 0.0, v_s: 1.0, displacement: 1.0, period: 1.0 },
            blocks: blocks.to_vec(),
            force_power: 1.0,
            relative_error: 100.0 * sum.sqrt(),
            standard_error: 100.0 * sum_error(blocks) / (2.0 * sum.sqrt()),
        }
    }

    /// Differences of 1e-4, 3e-4, 1e-4, 3e-4: their sum is 8e-4 with a standard error of sqrt(4 *
    /// 4/3) e-4.
    #[test]
    fn the_excess_is_paired_block_by_block() {
        let best = score(
            AxisStructure { delay: true, ..AxisStructure::ASYMMETRIC },
            &[0.01, 0.02, 0.01, 0.05],
        );
        let other = score(AxisStructure::ASYMMETRIC, &[0.0101, 0.0203, 0.0101, 0.0503]);
        let choice = choose(&[other.clone(), best.clone()]).unwrap();
        assert_eq!((choice.best, choice.chosen), (1, 1));
        let worse = choice.ranking[1];
        let root = 0.09f64.sqrt() + 0.0908f64.sqrt();
        assert!((worse.excess - 100.0 * 8e-4 / root).abs() < 1e-9, "{worse:?}");
        assert!(
            (worse.excess_error - 100.0 * (16.0f64 / 3.0).sqrt() * 1e-4 / root).abs() < 1e-9,
            "{worse:?}"
        );
        assert!((worse.excess - (other.relative_error - best.relative_error)).abs() < 1e-9);
    }

    #[test]
    fn of_equally_good_structures_the_simplest_is_chosen() {
        let rich = AxisStructure { delay: true, stribeck: true, ..AxisStructure::ASYMMETRIC };
        let scores = [
            score(rich, &[0.01, 0.02, 0.03]),
            score(AxisStructure::ASYMMETRIC, &[0.011, 0.0195, 0.03]),
        ];
        let choice = choose(&scores).unwrap();
        assert_eq!((choice.chosen, choice.rivals().collect()), (1, vec![0]));
        assert_eq!(choose(&[]), None);
    }

    /// 13 % beside 6.6 %, because of one block that the simple structure cannot predict at all: the
    /// excess is as uncertain as it is large.
    #[test]
    fn a_structure_that_is_worse_is_not_chosen_because_its_excess_is_uncertain() {
        let rich = AxisStructure { delay: true, stribeck: true, ..AxisStructure::ASYMMETRIC };
        let middle = AxisStructure { delay: true, ..AxisStructure::ASYMMETRIC };
        let best = score(rich, &[0.0006, 0.0005, 0.0006, 0.0005, 0.0006, 0.0005, 0.0006, 0.0005]);
        let worst = score(
            AxisStructure::SYMMETRIC,
            &[0.0006, 0.0005, 0.0006, 0.0135, 0.0006, 0.0005, 0.0006, 0.0005],
        );
        let choice = choose(&[worst.clone(), best.clone()]).unwrap();
        assert!(choice.ranking[1].excess <= choice.ranking[1].excess_error, "{choice:?}");
        assert_eq!(choice.chosen, 1);
        // One that is sure to be a little worse does not make room for one that may be much worse.
        let blocks = best.blocks.iter().map(|block| block + 2e-6).collect::<Vec<_>>();
        let choice = choose(&[worst, score(middle, &blocks), best]).unwrap();
        assert_ne!(choice.chosen, 0, "{choice:?}");
    }

    /// Its excess is uncertain, that of a simpler structure is smaller and sure.
    #[test]
    fn a_structure_is_never_worse_than_a_simpler_one() {
        let rich = AxisStructure { delay: true, stribeck: true, ..AxisStructure::ASYMMETRIC };
        let middle = AxisStructure { delay: true, ..AxisStructure::ASYMMETRIC };
        let best = score(rich, &[0.010, 0.020, 0.010, 0.050]);
        let simple = score(AxisStructure::ASYMMETRIC, &[0.0101, 0.0201, 0.0101, 0.0501]);
        let unsure = score(middle, &[0.010, 0.015, 0.013, 0.0535]);
        let choice = choose(&[unsure, simple, best]).unwrap();
        let place = |index| choice.ranking.iter().find(|ranked| ranked.index == index).unwrap();
        assert!(place(0).excess <= place(0).excess_error && place(0).excess > place(1).excess);
        assert!(place(1).excess > place(1).excess_error);
        assert_eq!(choice.chosen, 2);
    }
}
