//! How far a bristle lags: along with the nonlinear parameters the ratio of its levels, which are
//! linear ones.

use nalgebra::DVector;

use super::AxisStructure;
use super::search::{Best, EXACT, Search, System};
use super::shape::{PositionScale, Shape, ShapeTerm};
use crate::IdentError;

/// Change of the logarithm of `f_s` over `f_c` up to which a lag is that of the fit, how much more of
/// it is enough where the fit need not be exact (a multiple of the root of the share that is enough),
/// and how often the lag is made anew.
const SAME_RATIO: f64 = 1e-3;
const ENOUGH_RATIO: f64 = 3.0;
const ROUNDS: usize = 8;
/// The same change beyond which a fit is none.
const SETTLED: f64 = 0.05;

impl Search<'_> {
    /// The best fit without a starting point. Where the lag of that does not settle, it may from where
    /// the dip follows at once, or from the fit whose directions share their levels.
    ///
    /// # Errors
    /// Those of the fit.
    pub fn least(&mut self, scale: PositionScale) -> Result<Best, IdentError> {
        let best = self.whole()?;
        if self.settled(&best).is_ok() {
            return Ok(best);
        }
        let own = self.structure;
        let at_once = AxisStructure { lag: false, ..own };
        let shared = AxisStructure { asymmetric: false, ..own };
        for simpler in [at_once, shared].into_iter().filter(|simpler| *simpler != own) {
            let other = Search::new(self.regressors.recording, simpler, scale);
            let start = other.and_then(|mut other| other.whole());
            let from = start.and_then(|start| self.grown(&simpler, start.shape, EXACT));
            if let Some(found) = from.ok().filter(|found| self.settled(found).is_ok()) {
                return Ok(found);
            }
        }
        Ok(best)
    }

    /// The best fit from a starting point, with some nonlinear parameters kept at it, done when the sum
    /// of squares does not fall by more than `enough` of itself.
    ///
    /// How far a bristle lags hangs on the ratio of its levels, which is searched with the others,
    /// the levels tied to it. Then they are free. The force is of the first degree in them: its
    /// derivatives at one ratio times the levels are the force itself. With them for columns each fit
    /// gives the ratio for the next (Gauss and Newton): where the ratios of both directions are one,
    /// it is that of the search already.
    pub fn closer(
        &mut self,
        start: Shape,
        kept: &[ShapeTerm],
        enough: f64,
    ) -> Result<Best, IdentError> {
        let same = SAME_RATIO.max(ENOUGH_RATIO * enough.sqrt());
        let mut best = match self.structure.lag {
            true => self.tied(start, kept, enough)?,
            false => self.closer_at(start, kept, enough)?,
        };
        for _ in 0..ROUNDS {
            let ratio = self.ratio(&best.solution.x);
            let Some(ratio) = ratio.filter(|ratio| !is_same(*ratio, &best.shape, same)) else {
                break;
            };
            let damped = self.regressors.damped(&best.solution.x);
            best = self.closer_at(Shape { ratio, damped, ..best.shape }, kept, enough)?;
        }
        Ok(best)
    }

    /// Whether the lag of a fit is that of its levels; a fit without one is settled.
    ///
    /// # Errors
    /// [`IdentError::UnsettledLag`]: what such a fit predicts is no bristle's force.
    pub fn settled(&self, best: &Best) -> Result<(), IdentError> {
        let of = best.shape.ratio;
        match self.regressors.ratio(&best.solution.x) {
            // Nor is one that is no number.
            Some(found) if !is_same(found, &best.shape, SETTLED) => {
                Err(IdentError::UnsettledLag { found, of })
            }
            _ => Ok(()),
        }
    }

    /// `f_s` over `f_c` of a fit whose bristle lags.
    fn ratio(&self, linear: &DVector<f64>) -> Option<f64> {
        let (low, high) = (self.limits.low.ratio, self.limits.high.ratio);
        let ratio = self.regressors.ratio(linear)?;
        Some(if ratio.is_nan() { 1.0 } else { ratio.clamp(low, high) })
    }

    /// That of levels tied to their ratio, which is searched too.
    fn tied(
        &mut self,
        mut start: Shape,
        kept: &[ShapeTerm],
        enough: f64,
    ) -> Result<Best, IdentError> {
        if start.ratio == 1.0 {
            // Of a dip that is none nothing hangs on the Stribeck velocity.
            let free = self.solve(&start)?;
            start.ratio = self.ratio(&free.x).unwrap_or(1.0);
        }
        let mut terms = self.moving(kept);
        terms.push(ShapeTerm::Ratio);
        let mut shape = self.searched(start, &terms, enough);
        let System { matrix, force, .. } = self.system(&shape)?;
        if let Some(fit) = self.projection(matrix, &force, Some(shape.ratio)) {
            shape.damped = self.regressors.damped(&fit.rest(&force).0);
        }
        let solution = self.solve(&shape)?;
        Ok(Best { shape, solution })
    }
}

/// Whether a ratio of the levels is that of `shape` but for a share.
fn is_same(ratio: f64, shape: &Shape, share: f64) -> bool {
    (ratio / shape.ratio).ln().abs() < share
}
