//! The rig as the stages drive it: under the safety layer, with its time counted.

mod bench;
mod known;
mod meeting;
mod opening;
mod repeats;
mod shown;
mod turns;

use std::cell::{Cell, RefCell};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::SystemTime;

use rig_driver::Calibration;
use rig_driver::safety::Travel;
use rig_setup::{BenchRig, Opened, RigChoice, RigDescription, RigSetup, RigSetupError};
use work::progress::Progress;

pub use self::bench::Bench;
pub use self::known::Known;
use self::opening::Opening;
use self::repeats::Repeats;
use crate::board::Board;
use crate::reach::Reach;
use crate::{CommissionError, Stage};

/// The rig, opened for one stage at a time. Between stages it is closed, at zero volts.
///
/// Where its line fails, the rig is waited for and the turn at hand repeated from rest, a few times
/// only; what is about the motor, and what the user wants, ends the commission.
pub struct Axis<'a> {
    opening: Opening,
    stop: Arc<AtomicBool>,
    progress: &'a Progress,
    /// Where it is written how the commission stands.
    board: Board,
    allowed: f64,
    used: f64,
    /// Rig time after which all is expected to be done \[s\].
    expected: Cell<f64>,
    /// How far the winding was above ambient when the rig was left last \[K\]: whoever opens it anew
    /// tells the safety layer.
    rise: Cell<f64>,
    /// A torque sensor that showed the friction, and may cease to.
    torque: Cell<bool>,
    /// What was noticed of it since.
    noticed: RefCell<Vec<String>>,
}

impl<'a> Axis<'a> {
    /// A rig that may be driven for `allowed` seconds, `used` of which are over.
    pub fn new(
        rig: &RigChoice,
        setup: RigSetup,
        stop: Arc<AtomicBool>,
        progress: &'a Progress,
        (allowed, used): (f64, f64),
    ) -> Self {
        progress.advance(used);
        Self {
            // The commission finds its own calibration.
            opening: Opening::new(rig.clone(), RigSetup { calibration: None, ..setup }),
            stop,
            progress,
            board: Board::default(),
            allowed,
            used,
            expected: Cell::new(allowed),
            rise: Cell::new(0.0),
            torque: Cell::new(false),
            noticed: RefCell::default(),
        }
    }

    /// What is done is written on that board from now on.
    pub fn write_on(&mut self, board: &Board) {
        self.board = board.clone();
        self.tell_time();
    }

    /// Where it is written how the commission stands.
    pub(crate) fn board(&self) -> &Board {
        &self.board
    }

    /// Rig time that was used \[s\].
    #[must_use]
    pub const fn used(&self) -> f64 {
        self.used
    }

    /// Rig time that is left \[s\].
    #[must_use]
    pub fn left(&self) -> f64 {
        (self.allowed - self.used).max(0.0)
    }

    /// Says what is done now, on the bar.
    pub fn say(&self, stage: Stage, what: &str) {
        self.progress.stage(format!("{stage}: {what}"));
        self.board.doing(what);
    }

    /// Says a line that stays, of what the report tells too.
    pub fn tell(&self, line: &str) {
        self.progress.line(line);
        self.board.line(line);
    }

    /// Only so much rig time is expected to be needed from now on \[s\].
    pub fn expect(&self, seconds: f64) {
        let expected = self.used + seconds.min(self.left());
        self.progress.expect(expected.ceil() as u64);
        self.expected.set(expected);
        self.tell_time();
    }

    /// Readings are corrected by this from now on.
    pub fn calibrate(&mut self, calibration: Calibration) {
        let setup = &mut self.opening.setup;
        let before = setup.calibration.unwrap_or_default();
        // The ends turn with the encoder's sign.
        if before.encoder_sign != calibration.encoder_sign {
            setup.limits.travel = setup.limits.travel.map(|travel| Travel {
                min: -travel.max,
                max: -travel.min,
                ..travel
            });
        }
        setup.calibration = Some(calibration);
    }

    /// The encoder has nothing to be held against: a tachometer that shows no motion, or a torque
    /// sensor that shows no friction, is no fault from now on.
    pub fn trust_the_encoder_alone(&mut self) {
        self.opening.encoder_alone = true;
    }

    /// The torque sensor showed the friction: it is told where it stands still from now on.
    pub fn watch_torque(&self) {
        self.torque.set(true);
    }

    /// What was noticed while it was driven.
    #[must_use]
    pub fn noticed(&self) -> Vec<String> {
        self.noticed.borrow().clone()
    }

    /// Only this device is driven from now on.
    pub fn drive_only(&mut self, description: Option<RigDescription>) {
        self.opening.expected = description;
    }

    /// The shaft is to stay in there, by the rig's own count.
    pub fn stay_within(&mut self, travel: Option<Travel>) {
        self.opening.setup.limits.travel = travel;
    }

    /// The shaft is to stay below that speed by its encoder [rad/s].
    pub fn stay_below(&mut self, velocity: f64) {
        self.opening.setup.limits.velocity = Some(velocity);
    }

    /// Where the stages may be, as the readings are corrected; none where the travel has no ends.
    #[must_use]
    pub fn reach(&self) -> Option<Reach> {
        self.opening.setup.limits.travel.as_ref().map(Reach::within)
    }

    /// Whether the user wants it to end.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Refuses what takes more rig time than is left.
    ///
    /// # Errors
    /// [`CommissionError::OutOfTime`].
    pub fn reserve(&self, stage: Stage, needed: f64) -> Result<(), CommissionError> {
        let left = self.left();
        if needed <= left {
            return Ok(());
        }
        Err(CommissionError::OutOfTime { stage, needed, left, allowed: self.allowed })
    }

    /// The rig for several turns; it is at zero volts between them and afterwards.
    ///
    /// # Errors
    /// [`CommissionError::Rig`] if it refuses, [`CommissionError::LineLost`] if it is not there.
    pub fn bench(&self) -> Result<Bench, CommissionError> {
        let opened = self.open_or_wait(&mut Repeats::none())?;
        let stop = Arc::clone(&self.stop);
        let bench = if self.opening.comes_back() {
            let again = self.opening.clone();
            BenchRig::reopening(opened, stop, Box::new(move || again.open()))?
        } else {
            // A card whose watchdog expired is not driven again by itself.
            BenchRig::new(opened, stop)?
        };
        bench.warm(self.rise.get());
        Ok(Bench(bench))
    }

    fn count(&mut self, seconds: f64) {
        self.used += seconds;
        self.progress.advance(seconds);
        self.tell_time();
    }

    fn tell_time(&self) {
        self.board.time(self.used, (self.expected.get() - self.used).max(0.0));
    }

    fn open(&self) -> Result<Opened, CommissionError> {
        if self.is_stopped() {
            return Err(RigSetupError::Stopped.into());
        }
        Ok(self.opening.open()?)
    }

    /// The same, waited for where it was there before and does not answer.
    fn open_or_wait(&self, repeats: &mut Repeats) -> Result<Opened, CommissionError> {
        let asked = SystemTime::now();
        self.open().or_else(|error| self.opened_anew(repeats, error, asked))
    }
}
