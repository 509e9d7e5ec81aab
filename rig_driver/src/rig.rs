//! The one trait every rig is driven through.

use crate::{Measurement, RigError, Truth};

/// A servo axis that is measured and driven once a control cycle.
///
/// The simulated test bed is lock-step: `apply` advances its time by one period.
pub trait Rig {
    /// Period of the control cycle [s].
    fn period(&self) -> f64;

    /// Readings of the present cycle.
    fn measure(&mut self) -> Measurement;

    /// Sets the motor voltage [V] for the coming period. A voltage beyond the limits is cut, and the next measurement says so.
    ///
    /// # Errors
    /// A voltage that is not finite is refused: the rig applies zero volts and latches a fault.
    fn apply(&mut self, volts: f64) -> Result<(), RigError>;

    /// What no sensor shows, where the rig is simulated.
    fn truth(&self) -> Option<Truth> {
        None
    }
}
