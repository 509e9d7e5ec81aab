//! A recording without the time in which the axis stands still.

use std::ops::Range;

use super::conditioned::{Conditioned, Piece, THINNING_PADDING};
use super::sticks::Stick;
use crate::IdentError;
use crate::rest::standing;
use crate::statistics::{quantile, sorted};

/// Thinned samples that motion between two rests must have to be of use, and between short sticks.
const LEAST_ROWS: usize = 8;
const LEAST_ROWS_BETWEEN_STICKS: usize = 4;

/// Share of the motion that must be left where short sticks are left out too.
const LEAST_LEFT: f64 = 0.25;

/// Share of what is left between the sticks, as far as the low-pass spreads them, that must be left
/// where it does not ring any more: what rings a little is better than nothing.
const BESIDE_RINGS: f64 = 0.75;

/// Share of the usual largest speed that is reached to both sides of a turn: an axis that settles
/// behind a move turns too.
const TURNS: f64 = 0.1;
/// Times as long as at the usual acceleration that a turn takes at least in which an axis stops. Axes
/// that reverse in motion take 1 to 2.5 times as long, moves with the shortest of rests 3.9 times.
const LONG: f64 = 3.0;

/// For how long a recording stands still.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rest {
    /// Time that is left out \[s\].
    pub out: f64,
    /// What of it are short sticks that an encoder shows, with what the low-pass spreads of them and
    /// the motion between two that is too short to be of use \[s\].
    pub sticks: f64,
    /// Time of short sticks that stays in, because too little motion would be left between them \[s\].
    pub kept: f64,
}

/// What is left of a recording without its rests.
struct Motion {
    pieces: Vec<Piece>,
    /// The samples that are kept, of each piece.
    kept: Vec<Range<usize>>,
    /// Samples of the longest motion, kept or not.
    longest: usize,
}

impl Motion {
    fn samples(&self) -> usize {
        self.kept.iter().map(ExactSizeIterator::len).sum()
    }
}

impl Conditioned {
    /// The recording without the time in which it stands still, and how long that was.
    ///
    /// At rest the sign of the velocity is that of its noise, and friction is whatever is applied: a
    /// regression on it is ruined. Rest is told from motion after the low-pass, at twice its cutoff,
    /// where noise is nearly white; an encoder shows shorter ones by its readings, which are left out
    /// where enough motion is left between them. However long the rest is, it says nothing of friction
    /// in motion.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] where no motion between two rests is long enough.
    pub fn moving(self) -> Result<(Self, Rest), IdentError> {
        let rests = self.rests();
        let mut motion = self.between(&rests, LEAST_ROWS);
        let (mut sticking, mut rest) = (false, Rest::default());
        let only = rests.iter().zip(&self.sticks);
        let only = only.filter(|(rest, stick)| **stick == Stick::At && !**rest);
        rest.kept = only.count() as f64 * self.time_step;
        // As far as the low-pass rings, or as far as it spreads them.
        let without = |how: Stick| {
            let or_sticks =
                rests.iter().zip(&self.sticks).map(|(rest, stick)| *rest || *stick >= how);
            let or_sticks: Vec<bool> = or_sticks.collect();
            self.between(&or_sticks, LEAST_ROWS_BETWEEN_STICKS)
        };
        if self.sticks.iter().any(|stick| *stick > Stick::Away) {
            let (rings, at) = (without(Stick::Rings), without(Stick::At));
            let left = |motion: &Motion| motion.samples() as f64;
            let found = if left(&rings) >= BESIDE_RINGS * left(&at) { rings } else { at };
            if left(&found) >= LEAST_LEFT * left(&motion) {
                let fewer = motion.samples().saturating_sub(found.samples());
                rest = Rest { sticks: fewer as f64 * self.time_step, kept: 0.0, ..rest };
                (motion, sticking) = (found, true);
            }
        }
        let stops_to_turn = self.stops_to_turn();
        let left = motion.samples();
        let out = self.velocity.len() - left;
        if out == 0 || self.velocity.iter().all(|v| v.abs() <= self.velocity_floor) {
            return Ok((Self { stops_to_turn, ..self }, rest));
        }
        if left == 0 {
            return Err(IdentError::TooFewSamples {
                what: "the motion between two rests",
                needed: self.shortest(LEAST_ROWS),
                found: motion.longest,
                lower: Some("the decimation"),
            });
        }
        let Motion { pieces, kept, .. } = motion;
        let of = |column: &[f64]| -> Vec<f64> {
            kept.iter().filter_map(|range| column.get(range.clone())).flatten().copied().collect()
        };
        let moving = Self {
            position: self.position.as_deref().map(of),
            velocity: of(&self.velocity),
            acceleration: of(&self.acceleration),
            force: of(&self.force),
            sticks: Vec::new(),
            sticking,
            stops_to_turn,
            pieces,
            ..self
        };
        rest.out = out as f64 * moving.time_step;
        Ok((moving, rest))
    }

    /// Samples that motion must have to give so many rows.
    fn shortest(&self, rows: usize) -> usize {
        THINNING_PADDING.max(rows * self.decimate) + 1
    }

    /// Which samples are those of rest, by the velocity.
    fn rests(&self) -> Vec<bool> {
        let mut all = vec![false; self.velocity.len()];
        for piece in &self.pieces {
            let velocity = self.velocity.get(piece.kept.clone()).unwrap_or_default();
            let thinned: Vec<f64> = velocity.iter().copied().step_by(self.stride).collect();
            let rest = standing(&thinned);
            let own = all.get_mut(piece.kept.clone()).unwrap_or_default();
            for (k, at_rest) in own.iter_mut().enumerate() {
                *at_rest = rest.get(k / self.stride).copied().unwrap_or(false);
            }
        }
        all
    }

    /// Whether the axis mostly stands still where it turns round: more than twice as often as not it
    /// takes far longer for that than at its usual acceleration.
    fn stops_to_turn(&self) -> bool {
        let motion = self.velocity.iter().zip(&self.acceleration).step_by(self.stride);
        let speeds = sorted(motion.clone().map(|(v, _)| v.abs()));
        let clear = TURNS * quantile(&speeds, 0.95).unwrap_or(0.0);
        let moves = motion.filter(|(v, _)| v.abs() > clear);
        let accelerations = sorted(moves.map(|(_, a)| a.abs()));
        let usual = quantile(&accelerations, 0.9).unwrap_or(f64::INFINITY);
        // Both ends of a turn lie up to a sample away from where its speed is clear.
        let at_once = LONG * 2.0 * clear / usual / self.time_step + 2.0;
        let (mut turns, mut stops) = (0usize, 0usize);
        for piece in &self.pieces {
            let velocity = self.velocity.get(piece.kept.clone()).unwrap_or_default();
            let mut last: Option<(usize, f64)> = None;
            for (k, v) in velocity.iter().enumerate().filter(|(_, v)| v.abs() > clear) {
                let before = last.replace((k, *v)).filter(|(_, before)| before * v < 0.0);
                if let Some((since, _)) = before {
                    match ((k - since) as f64) < at_once {
                        true => turns += 1,
                        false => stops += 1,
                    }
                }
            }
        }
        2 * turns < stops
    }

    /// The motion between `rests` that gives at least so many rows each.
    fn between(&self, rests: &[bool], rows: usize) -> Motion {
        let shortest = self.shortest(rows);
        let mut motion = Motion { pieces: Vec::new(), kept: Vec::new(), longest: 0 };
        let mut from = 0;
        for piece in &self.pieces {
            let rest = rests.get(piece.kept.clone()).unwrap_or_default();
            let mut begin = 0;
            for same in rest.chunk_by(|a, b| a == b) {
                let (moves, end) = (same.first() == Some(&false), begin + same.len());
                motion.longest = motion.longest.max(if moves { same.len() } else { 0 });
                if moves && same.len() >= shortest {
                    motion.pieces.push(Piece {
                        stretch: piece.stretch,
                        kept: from..from + same.len(),
                        origin: piece.origin.start + begin..piece.origin.start + end,
                        begin: piece.begin,
                        way: piece.way,
                        start: piece.start + begin as f64 * self.time_step,
                    });
                    motion.kept.push(piece.kept.start + begin..piece.kept.start + end);
                    from += same.len();
                }
                begin = end;
            }
        }
        motion
    }
}
