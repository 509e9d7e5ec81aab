//! What is repeated where the line to the rig failed, and how often.

use std::time::SystemTime;

use rig_setup::{NotReopened, Opened, PATIENCE, RigSetupError, come_back, counted_on};

use super::{Axis, Bench};
use crate::CommissionError;

/// Repeats of one block after which a line that fails again ends the commission.
const REPEATS: u32 = 3;

/// The repeats of one block.
pub(super) struct Repeats(u32);

impl Repeats {
    /// None yet.
    pub(super) const fn none() -> Self {
        Self(0)
    }

    /// Counts one more, because of `error`.
    ///
    /// # Errors
    /// [`CommissionError::LineLost`] where there were enough.
    fn count(&mut self, error: &CommissionError) -> Result<(), CommissionError> {
        if self.0 == REPEATS {
            let why = format!("what was underway was repeated {REPEATS} times, in vain");
            return Err(lost(error, why));
        }
        self.0 += 1;
        Ok(())
    }
}

/// The line failed with `error`, and that was the end because of `why`.
fn lost(error: &CommissionError, why: String) -> CommissionError {
    CommissionError::LineLost { said: error.to_string(), why }
}

impl Axis<'_> {
    /// Does `block`, and once more after the rig was opened anew where its line failed. What is
    /// about the motor, and what the user wants, is never repeated.
    pub(super) fn repeated<T>(
        &mut self,
        bench: &Bench,
        mut block: impl FnMut(&mut Self) -> Result<T, CommissionError>,
    ) -> Result<T, CommissionError> {
        let mut repeats = Repeats::none();
        loop {
            let error = match block(self) {
                Err(error) if self.is_lost(&error) => error,
                done => return done,
            };
            self.refuse_if_stopped()?;
            repeats.count(&error)?;
            self.wait_for_line(&error, || bench.0.reconnect())?;
        }
    }

    /// The rig opened anew after its line failed with `error`; it was `heard` last then.
    ///
    /// # Errors
    /// `error` itself where it is none of the line; [`CommissionError::LineLost`] where it does not
    /// come back, or was repeated enough.
    pub(super) fn opened_anew(
        &self,
        repeats: &mut Repeats,
        error: CommissionError,
        heard: SystemTime,
    ) -> Result<Opened, CommissionError> {
        if !self.is_lost(&error) {
            return Err(error);
        }
        self.refuse_if_stopped()?;
        repeats.count(&error)?;
        let limited = self.opening.setup.limits.travel.is_some();
        self.wait_for_line(&error, || {
            let opened = come_back(|| self.opening.open(), heard, &self.stop)?;
            if limited {
                counted_on(&opened, heard)?;
            }
            Ok(opened)
        })
    }

    /// Whether it is the line that failed, of a rig that is opened again by itself.
    fn is_lost(&self, error: &CommissionError) -> bool {
        self.opening.comes_back() && error.is_of_the_line()
    }

    fn wait_for_line<T>(
        &self,
        error: &CommissionError,
        back: impl FnOnce() -> Result<T, NotReopened>,
    ) -> Result<T, CommissionError> {
        self.tell(&format!("{error}: zero volts. It goes on by itself if the line is back within {PATIENCE} s; ctrl-C before you touch the rig"));
        match back() {
            Ok(there) => {
                self.tell("the line is back; what was underway is repeated");
                Ok(there)
            }
            Err(why) => {
                self.refuse_if_stopped()?;
                Err(lost(error, why.to_string()))
            }
        }
    }

    /// What the user stopped ends as that, whatever the line does.
    fn refuse_if_stopped(&self) -> Result<(), CommissionError> {
        if self.is_stopped() { Err(RigSetupError::Stopped.into()) } else { Ok(()) }
    }
}
