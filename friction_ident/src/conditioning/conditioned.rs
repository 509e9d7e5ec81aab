//! A conditioned recording and its stretches.

use std::ops::Range;

use super::sticks::Stick;
use crate::IdentError;

/// Samples that the anti-alias low-pass of the thinning needs more than: three times its order.
pub(super) const THINNING_PADDING: usize = 24;

/// A conditioned recording, at the full sampling rate or [coarser](Self::coarsened); of one with gaps
/// the stretches stand one behind the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Conditioned {
    /// Sampling period \[s\].
    pub time_step: f64,
    /// Index of the first kept sample in the recording, or in each of its stretches.
    pub first: usize,
    /// Position \[m or rad\], where it was recorded.
    pub position: Option<Vec<f64>>,
    /// Velocity \[m/s or rad/s\].
    pub velocity: Vec<f64>,
    /// Acceleration \[m/s^2 or rad/s^2\].
    pub acceleration: Vec<f64>,
    /// Force \[N\] or torque \[N m\], as recorded unless the settings give it the low-pass.
    pub force: Vec<f64>,
    /// Acceleration that rounding alone can make; anything below is no excitation.
    pub(crate) acceleration_floor: f64,
    /// Velocity that rounding alone can make.
    pub(crate) velocity_floor: f64,
    /// Factor by which the regression thins the samples.
    pub(crate) decimate: usize,
    /// Samples between two that rest is told by.
    pub(crate) stride: usize,
    /// The stretches without a gap; one at least.
    pub(crate) pieces: Vec<Piece>,
    /// Sampling period before any was left out \[s\].
    pub(crate) sampled: f64,
    /// Time over which the low-pass spreads the start of a motion to each side \[s\].
    pub(crate) spread: f64,
    /// Whether short sticks were left out of the motion.
    pub(crate) sticking: bool,
    /// Whether the axis mostly stands still where it turns round, so that the motion does not show
    /// what its contact does there; false before its rests are left out.
    pub stops_to_turn: bool,
    /// Smallest step between two readings of the position \[m or rad\]; zero where there is none.
    pub(crate) step: f64,
    /// How near each kept sample lies to where the readings of the position show that the axis
    /// sticks; empty once the rests are left out.
    pub(crate) sticks: Vec<Stick>,
    /// Velocity of all that was recorded, stretch by stretch: with what the trim takes off before a
    /// stretch, and with the time in which the axis stands still. Bristles live through both.
    pub(crate) lived: Vec<f64>,
}

/// A stretch of a conditioned recording.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piece {
    /// Which of the stretches that were given it is.
    pub stretch: usize,
    /// Its kept samples among all of them.
    pub kept: Range<usize>,
    /// The same among all that was recorded.
    pub origin: Range<usize>,
    /// Where its stretch begins among all that was recorded.
    pub begin: usize,
    /// Direction in which its stretch moves first, 1 or -1; zero where it stands.
    pub way: f64,
    /// Time of its first recorded sample \[s\].
    pub start: f64,
}

impl Conditioned {
    /// Time within which it does not show what comes first \[s\]: half a sample, and where the axis
    /// sticks what the low-pass spreads of its starts.
    pub(crate) fn instant(&self) -> f64 {
        let half = 0.5 * self.sampled;
        if self.sticking { half.max(self.spread) } else { half }
    }

    /// Stretches of the recording that were long enough to be conditioned.
    pub fn stretches(&self) -> usize {
        let mut all: Vec<usize> = self.pieces.iter().map(|piece| piece.stretch).collect();
        all.dedup();
        all.len()
    }
    /// What the axis does, sample by sample: velocity, acceleration, way since the last reversal,
    /// and position where it is known.
    pub(crate) fn motion(&self) -> Vec<Vec<f64>> {
        let mut since = 0.0;
        let mut before = 0.0f64;
        let way = self.velocity.iter().map(|&v| {
            since = if v * before < 0.0 { 0.0 } else { since + v.abs() * self.time_step };
            before = v;
            since
        });
        let mut motion = vec![way.collect(), self.velocity.clone(), self.acceleration.clone()];
        motion.extend(self.position.clone());
        motion
    }

    /// A column made anew stretch by stretch, so that nothing reaches across a gap.
    pub(crate) fn by_piece(
        &self,
        column: &[f64],
        make: impl Fn(&[f64]) -> Result<Vec<f64>, IdentError>,
    ) -> Result<Vec<f64>, IdentError> {
        let mut made = Vec::with_capacity(column.len());
        for piece in &self.pieces {
            made.extend(make(column.get(piece.kept.clone()).unwrap_or_default())?);
        }
        Ok(made)
    }
}
