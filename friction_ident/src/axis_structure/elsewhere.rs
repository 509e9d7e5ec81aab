//! How well the structures that were cross-validated on one recording predict another.
//!
//! Parts of one recording share what acted while it was made: what a structure says of it in the
//! parts kept back it may not say of another. Where there is another, its parts count in the choice
//! as those kept back do.

use super::cross_validation::{CrossValidation, Elsewhere, blocks_for, sum_error};
use super::regressors::Regressors;
use super::search::Search;
use super::shape::PositionScale;
use crate::IdentError;
use crate::conditioning::Conditioned;

impl CrossValidation {
    /// How well the structure, fitted to the whole of `recording`, where it was cross-validated,
    /// predicts `other`.
    ///
    /// # Errors
    /// [`IdentError`] for a recording too short to decimate, without force, or without the position
    /// that the structure needs.
    pub fn tried_on(
        &self,
        recording: &Conditioned,
        other: &Conditioned,
    ) -> Result<Elsewhere, IdentError> {
        let scale = PositionScale::of(recording);
        let solution = Search::new(recording, self.structure, scale)?.solve(&self.shape)?;
        let mut there = Regressors::new(other, self.structure, scale)?;
        let predicted = there.matrix(&self.shape)? * solution.x;
        let mut error = &there.force - predicted;
        there.starts(&self.shape, None)?.leave_out(error.as_mut_slice());
        let (rows, blocks) = (error.len(), blocks_for(other).max(1));
        let block = |block: usize| {
            let (first, end) = (block * rows / blocks, (block + 1) * rows / blocks);
            error.rows(first, end - first).norm_squared() / rows as f64
        };
        let blocks: Vec<f64> = (0..blocks).map(block).collect();
        let force_power = there.force.norm_squared() / rows as f64;
        let relative_error = 100.0 * (blocks.iter().sum::<f64>() / force_power).sqrt();
        Ok(Elsewhere { blocks, force_power, relative_error, rows })
    }

    /// Both recordings in one: their blocks one behind the other, each row with the same weight.
    pub(super) fn pooled(&self) -> Self {
        let Some(elsewhere) = &self.elsewhere else { return self.clone() };
        let rows = self.rows + elsewhere.rows;
        let [here, there] = [self.rows, elsewhere.rows].map(|part| part as f64 / rows as f64);
        let own = self.blocks.iter().map(|block| here * block);
        let blocks: Vec<f64> = own.chain(elsewhere.blocks.iter().map(|b| there * b)).collect();
        let force_power = here * self.force_power + there * elsewhere.force_power;
        let sum: f64 = blocks.iter().sum();
        Self {
            relative_error: 100.0 * (sum / force_power).sqrt(),
            standard_error: 100.0 * sum_error(&blocks) / (2.0 * (sum * force_power).sqrt()),
            blocks,
            force_power,
            rows,
            elsewhere: None,
            ..self.clone()
        }
    }
}
