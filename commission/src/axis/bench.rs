//! The rig, open for several turns.

use rig_setup::BenchRig;

use crate::CommissionError;

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
