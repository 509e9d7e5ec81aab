//! A recording without the time in which the axis stands still.

use std::ops::Range;

use super::conditioned::{Conditioned, Piece, THINNING_PADDING};
use crate::IdentError;
use crate::rest::standing;

/// Thinned samples that motion between two rests must have to be of use.
const LEAST_ROWS: usize = 8;

impl Conditioned {
    /// The recording without the time in which it stands still, and how long that was \[s\].
    ///
    /// At rest the sign of the velocity is that of its noise, and friction is whatever is applied: a
    /// regression on it is ruined. Rest is told from motion after the low-pass, at twice its cutoff,
    /// where noise is nearly white. However long the rest is, it says nothing of friction in motion.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] where no motion between two rests is long enough.
    pub fn moving(self) -> Result<(Self, f64), IdentError> {
        let stride = self.stride;
        let shortest = THINNING_PADDING.max(LEAST_ROWS * self.decimate) + 1;
        let mut pieces = Vec::new();
        let mut kept: Vec<Range<usize>> = Vec::new();
        let mut longest = 0;
        for piece in &self.pieces {
            let velocity = self.velocity.get(piece.kept.clone()).unwrap_or_default();
            let thinned: Vec<f64> = velocity.iter().copied().step_by(stride).collect();
            let rest = standing(&thinned);
            let at_rest = |k: usize| rest.get(k / stride).copied().unwrap_or(false);
            let mut begin = 0;
            while begin < velocity.len() {
                let state = at_rest(begin);
                let same = (begin..velocity.len()).take_while(|&k| at_rest(k) == state).count();
                let end = begin + same;
                longest = longest.max(if state { 0 } else { same });
                if !state && same >= shortest {
                    let from = kept.iter().map(ExactSizeIterator::len).sum::<usize>();
                    let own = piece.kept.start + begin..piece.kept.start + end;
                    pieces.push(Piece {
                        stretch: piece.stretch,
                        kept: from..from + same,
                        origin: piece.origin.start + begin..piece.origin.start + end,
                        begin: piece.begin,
                        way: piece.way,
                        start: piece.start + begin as f64 * self.time_step,
                    });
                    kept.push(own);
                }
                begin = end;
            }
        }
        let left: usize = kept.iter().map(ExactSizeIterator::len).sum();
        let out = self.velocity.len() - left;
        if out == 0 || self.velocity.iter().all(|v| v.abs() <= self.velocity_floor) {
            return Ok((self, 0.0));
        }
        if left == 0 {
            return Err(IdentError::TooFewSamples {
                what: "the motion between two rests",
                needed: shortest,
                found: longest,
                lower: Some("the decimation"),
            });
        }
        let of = |column: &[f64]| -> Vec<f64> {
            kept.iter().filter_map(|range| column.get(range.clone())).flatten().copied().collect()
        };
        let moving = Self {
            position: self.position.as_deref().map(of),
            velocity: of(&self.velocity),
            acceleration: of(&self.acceleration),
            force: of(&self.force),
            pieces,
            ..self
        };
        let seconds = out as f64 * moving.time_step;
        Ok((moving, seconds))
    }
}
