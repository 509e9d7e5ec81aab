//! A recording at a lower rate.

use super::conditioned::{Conditioned, Piece, THINNING_PADDING};
use crate::IdentError;
use crate::zero_phase::decimate;

/// Samples that are left between two that rest is told by: four in a period of the cutoff.
const SAMPLES_A_STRIDE: usize = 2;
/// Samples that are left between two rows of the regression: a reversal is known to one of them.
const SAMPLES_A_ROW: usize = 8;

impl Conditioned {
    /// The recording at a lower rate that still holds all of the motion, where the regression keeps
    /// far fewer samples than there are: what is computed sample by sample, bristles above all, then
    /// costs a fraction. Motion is beyond its low-pass, so that leaving samples out loses nothing;
    /// the force goes through an anti-alias low-pass. As it was where there is nothing to gain.
    ///
    /// # Errors
    /// Those of the low-pass.
    pub fn coarsened(self) -> Result<Self, IdentError> {
        let of_motion = self.stride / SAMPLES_A_STRIDE;
        let factor = of_motion.min(self.decimate / SAMPLES_A_ROW);
        let shortest = self.pieces.iter().map(|piece| piece.kept.len()).min().unwrap_or(0);
        let is_cut = self.pieces.len() > self.stretches();
        if factor < 2 || shortest <= THINNING_PADDING || is_cut {
            return Ok(self);
        }
        let thin = |column: &[f64]| {
            self.by_piece(column, |own| Ok(own.iter().copied().step_by(factor).collect()))
        };
        let sticks = self.pieces.iter().flat_map(|piece| {
            let own = self.sticks.get(piece.kept.clone()).unwrap_or_default();
            own.iter().copied().step_by(factor)
        });
        let sticks = sticks.collect();
        let force = self.by_piece(&self.force, |own| decimate(own, factor))?;
        let position = self.position.as_deref().map(thin).transpose()?;
        let (velocity, acceleration) = (thin(&self.velocity)?, thin(&self.acceleration)?);
        let time_step = self.time_step * factor as f64;
        let (mut pieces, mut from) = (Vec::with_capacity(self.pieces.len()), 0);
        // The first sample stays where it is; counts of samples before it are others.
        let first = (self.first as f64 / factor as f64).round() as usize;
        let shift = self.first as f64 * self.time_step - first as f64 * time_step;
        let mut lived = Vec::with_capacity(self.lived.len() / factor + 1);
        for piece in self.pieces {
            let kept = from..from + piece.kept.len().div_ceil(factor);
            from = kept.end;
            let start = piece.start + shift;
            // The history is thinned so that the first kept sample stays.
            let begin = lived.len();
            let before = piece.origin.start - piece.begin;
            let whole = piece.begin + before % factor..piece.origin.end;
            lived.extend(self.lived.get(whole).unwrap_or_default().iter().step_by(factor));
            let first = begin + before / factor;
            let origin = first..first + kept.len();
            pieces.push(Piece { kept, origin, begin, start, ..piece });
        }
        Ok(Self {
            time_step,
            first,
            position,
            velocity,
            acceleration,
            force,
            lived,
            sticks,
            pieces,
            decimate: (self.decimate as f64 / factor as f64).round() as usize,
            stride: (self.stride / factor).max(1),
            ..self
        })
    }
}
