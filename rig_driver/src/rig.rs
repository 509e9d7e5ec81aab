//! The one trait every rig is driven through.

use crate::{Measurement, RigError, Truth};

/// A servo axis that is measured and driven once a control cycle.
///
/// The simulated test bed is lock-step: `apply` advances its time by one period.
pub trait Rig {
    /// Period of the control cycle [s].
    fn period(&self) -> f64;

    /// Whether the rig has a clock of its own, so that [`wait`](Self::wait) sets the pace and not the caller's clock.
    fn keeps_time(&self) -> bool {
        false
    }

    /// Waits until the rig's next cycle has begun. A rig that is in lock-step with its caller does not wait.
    ///
    /// # Errors
    /// [`RigError`] if the cycle does not come: the rig is gone, hangs or has restarted.
    fn wait(&mut self) -> Result<(), RigError> {
        Ok(())
    }

    /// Readings of the present cycle.
    fn measure(&mut self) -> Measurement;

    /// Sets the motor voltage [V] for the coming period. A voltage beyond the limits is cut, and the next measurement says so.
    ///
    /// # Errors
    /// A voltage that is not finite is refused: the rig applies zero volts and latches a fault.
    fn apply(&mut self, volts: f64) -> Result<(), RigError>;

    /// Lets the motor move. A simulated rig always may.
    ///
    /// # Errors
    /// [`RigError`] if the rig does not, because of a latched fault or because it is gone.
    fn activate(&mut self) -> Result<(), RigError> {
        Ok(())
    }

    /// Holds the motor at zero volts until activated again.
    ///
    /// # Errors
    /// [`RigError`] if the rig does not say that it did.
    fn deactivate(&mut self) -> Result<(), RigError> {
        self.apply(0.0)
    }

    /// What no sensor shows, where the rig is simulated.
    fn truth(&self) -> Option<Truth> {
        None
    }
}
