//! The rig, open for several turns.

use std::sync::Arc;

use rig_setup::BenchRig;

use super::Axis;
use super::repeats::Repeats;
use crate::CommissionError;

impl Axis<'_> {
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
}

/// A rig that is open for several turns. Dropped, it leaves zero volts.
pub struct Bench(pub(super) BenchRig);

impl Bench {
    /// Where the shaft is by the rig's own count \[rad\].
    ///
    /// # Errors
    /// [`CommissionError::Rig`] if it refuses to say.
    pub fn place(&self) -> Result<f64, CommissionError> {
        if let Some(place) = self.0.place() {
            return Ok(place);
        }
        drop(self.0.lend()?);
        Ok(self.0.place().unwrap_or_default())
    }

    /// Where it was when the turn that goes on, or the last one, began \[rad\]: readings of a turn
    /// are counted from there.
    #[must_use]
    pub fn origin(&self) -> f64 {
        self.0.origin().unwrap_or_default()
    }

    /// What the safety layer allows \[V\].
    #[must_use]
    pub const fn voltage_limit(&self) -> f64 {
        self.0.voltage_limit()
    }

    /// Period of the cycle \[s\].
    #[must_use]
    pub const fn period(&self) -> f64 {
        self.0.period()
    }
}
