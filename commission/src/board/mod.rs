//! How a commission stands, for whoever watches it while it goes on.
//!
//! The stages write on a [`Board`]; whoever watches looks at it as often as he likes
//! ([`Board::standing`]). Nothing here waits, and nothing that is written here is read by a stage.

mod cycles;

use std::path::Path;
use std::sync::mpsc::Receiver;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde::Serialize;

pub use self::cycles::Cycle;
use self::cycles::Cycles;
use crate::{Ranged, Stage};

/// Lines that are kept.
const LINES: usize = 100;

/// A board that several may look at. Clones are the same.
#[derive(Debug, Clone, Default)]
pub struct Board(Arc<Inner>);

#[derive(Debug, Default)]
struct Inner {
    standing: Mutex<Standing>,
    cycles: Cycles,
}

/// How a commission stands.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Standing {
    /// The stage that is underway; none before the first, and at the end.
    pub stage: Option<Stage>,
    /// Folder of the results.
    pub folder: String,
    /// What is done now; empty where nothing is.
    pub doing: String,
    /// The stages that are done, in their order.
    pub done: Vec<Done>,
    /// Rig time that was used \[s\].
    pub used: f64,
    /// The most rig time that may be left \[s\].
    pub left: f64,
    /// How well the friction is to be known: half widths as shares of the values.
    pub wanted: Vec<(String, f64)>,
    /// How well it was known, block by block.
    pub narrowed: Vec<Narrowed>,
    /// The curve as it is fitted now.
    pub curve: Option<Fitted>,
    /// What it is fitted to: speed [rad/s] and voltage \[V\].
    pub points: Vec<(f64, f64)>,
    /// Lines that stay, the oldest first.
    pub lines: Vec<String>,
    /// Whether what was found is worth it; none before the end.
    pub worth: Option<String>,
    /// Why it ended before its end.
    pub why: Option<String>,
}

/// A stage that is done.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Done {
    /// Which.
    pub stage: Stage,
    /// Rig time that it took \[s\].
    pub seconds: f64,
    /// What it found: name and value, for people.
    pub found: Vec<(String, String)>,
}

/// The parameters of the curve after a block.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Narrowed {
    /// Blocks until then.
    pub blocks: usize,
    /// Each parameter with its interval.
    pub parameters: Vec<(String, Ranged)>,
}

/// A friction curve as it is fitted to what was measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Fitted {
    /// Static friction \[V\].
    pub f_s: Ranged,
    /// Coulomb friction \[V\].
    pub f_c: Ranged,
    /// Stribeck velocity [rad/s].
    pub v_s: Ranged,
    /// Back-EMF and viscous friction together \[V s/rad\].
    pub slope: Ranged,
    /// Whether it has a dip: without one the static level has no meaning.
    pub dips: bool,
}

impl Fitted {
    fn parameters(&self) -> Vec<(String, Ranged)> {
        let Self { f_s, f_c, v_s, slope, .. } = *self;
        [("f_c", f_c), ("f_s", f_s), ("v_s", v_s), ("slope", slope)]
            .map(|(name, ranged)| (name.to_owned(), ranged))
            .to_vec()
    }
}

impl Board {
    /// What is on it now.
    #[must_use]
    pub fn standing(&self) -> Standing {
        self.write().clone()
    }

    /// The cycles of the rig from now on, as far as whoever listens takes them in time; none where
    /// somebody listens already.
    #[must_use]
    pub fn listen(&self) -> Option<Receiver<Cycle>> {
        self.0.cycles.listen()
    }

    /// A cycle went by.
    pub(crate) fn cycle(&self, cycle: Cycle) {
        self.0.cycles.pass(cycle);
    }

    /// A new commission begins in a folder, for which friction is to be known so well.
    pub(crate) fn begin(&self, folder: &Path, wanted: Vec<(String, f64)>) {
        *self.write() =
            Standing { folder: folder.display().to_string(), wanted, ..Standing::default() };
    }

    /// A stage begins.
    pub(crate) fn begun(&self, stage: Stage) {
        let mut standing = self.write();
        standing.stage = Some(stage);
        standing.doing.clear();
    }

    /// What is done now.
    pub(crate) fn doing(&self, what: &str) {
        what.clone_into(&mut self.write().doing);
    }

    /// Rig time: what was used, and the most that may be left \[s\].
    pub(crate) fn time(&self, used: f64, left: f64) {
        let mut standing = self.write();
        (standing.used, standing.left) = (used, left);
    }

    /// A line that stays.
    pub(crate) fn line(&self, line: &str) {
        let lines = &mut self.write().lines;
        lines.push(line.to_owned());
        let old = lines.len().saturating_sub(LINES);
        lines.drain(..old);
    }

    /// What was measured of the friction after so many blocks, speed [rad/s] and voltage \[V\], and the
    /// curve through it.
    pub(crate) fn measured(&self, blocks: usize, points: Vec<(f64, f64)>, curve: Option<Fitted>) {
        let mut standing = self.write();
        standing.points = points;
        let Some(curve) = curve else { return };
        standing.curve = Some(curve);
        let now = Narrowed { blocks, parameters: curve.parameters() };
        match standing.narrowed.last_mut() {
            Some(last) if last.blocks == blocks => *last = now,
            _ => standing.narrowed.push(now),
        }
    }

    /// A stage is done.
    pub(crate) fn done(&self, stage: Stage, seconds: f64, found: Vec<(String, String)>) {
        let mut standing = self.write();
        standing.stage = None;
        standing.doing.clear();
        standing.done.push(Done { stage, seconds, found });
    }

    /// All is done, and this is what it was worth.
    pub(crate) fn handed_over(&self, worth: String) {
        let mut standing = self.write();
        standing.stage = None;
        standing.doing.clear();
        standing.left = 0.0;
        standing.done.push(Done { stage: Stage::HandOver, seconds: 0.0, found: Vec::new() });
        standing.worth = Some(worth);
    }

    /// It ended before its end.
    pub(crate) fn ended(&self, why: String) {
        self.write().why = Some(why);
    }

    fn write(&self) -> MutexGuard<'_, Standing> {
        // Whoever panicked had nothing half written that anybody stands on.
        self.0.standing.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_lines_are_kept_and_a_block_is_told_once() {
        let board = Board::default();
        board.begin(Path::new("a"), Vec::new());
        for line in 0..LINES + 3 {
            board.line(&line.to_string());
        }
        let lines = board.standing().lines;
        assert_eq!((lines.len(), lines[0].as_str()), (LINES, "3"));
        let one = Ranged::new(1.0, 0.9, 1.1);
        let curve = Fitted { f_s: one, f_c: one, v_s: one, slope: one, dips: true };
        board.measured(11, vec![(1.0, 2.0)], Some(curve));
        board.measured(11, vec![(1.0, 2.0)], Some(curve));
        board.measured(12, vec![(1.0, 2.0), (2.0, 3.0)], Some(curve));
        let standing = board.standing();
        assert_eq!(standing.narrowed.len(), 2);
        assert_eq!(standing.narrowed[1].parameters.len(), 4);
        assert_eq!(standing.points.len(), 2);
        board.begin(Path::new("b"), Vec::new());
        assert!(board.standing().narrowed.is_empty());
    }
}
