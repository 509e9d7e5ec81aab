//! The one trait every rig is driven through.

use crate::safety::{Event, FaultReport, Refused, Request, State};
use crate::{Measurement, RigError, Truth};

/// Voltage range of a rig whose description does not tell it [V]: that of the converters of the
/// thesis's card.
pub const VOLTAGE_RANGE: f64 = 10.0;

/// Highest voltage that any rig is driven with, whatever it says of itself [V]: the end of
/// extra-low direct voltage, which may be touched.
pub const HIGHEST_VOLTAGE: f64 = 60.0;

/// A servo axis that is measured and driven once a control cycle.
///
/// The simulated test bed is lock-step: `apply` advances its time by one period.
pub trait Rig {
    /// Period of the control cycle [s].
    fn period(&self) -> f64;

    /// Largest magnitude of the motor voltage that the rig can put out, by its own description [V].
    /// The safety layer takes no limit beyond it.
    fn voltage_range(&self) -> f64 {
        VOLTAGE_RANGE
    }

    /// Whether the rig has a clock of its own, so that [`wait`](Self::wait) sets the pace and not
    /// the caller's clock.
    fn keeps_time(&self) -> bool {
        false
    }

    /// Waits until the rig's next cycle has begun. A rig that is in lock-step with its caller does
    /// not wait.
    ///
    /// # Errors
    /// [`RigError`] if the cycle does not come: the rig is gone, hangs or has restarted.
    fn wait(&mut self) -> Result<(), RigError> {
        Ok(())
    }

    /// Tells the time on the caller's clock at the beginning of a cycle [s]. Rigs in lock-step need
    /// not know it.
    fn tell_time(&mut self, _now: f64) {}

    /// Readings of the present cycle.
    fn measure(&mut self) -> Measurement;

    /// Sets the motor voltage [V] for the coming period. A voltage beyond the limits is cut, and
    /// the next measurement says so.
    ///
    /// # Errors
    /// A voltage that is not finite is refused: the rig applies zero volts and latches a fault.
    /// Under supervision ([`Supervised`](crate::safety::Supervised)) so is every voltage but zero
    /// while the rig is not active.
    fn apply(&mut self, volts: f64) -> Result<(), RigError>;

    /// Lets the motor move. A simulated rig always may.
    ///
    /// # Errors
    /// [`RigError`] if the rig does not, because of a latched fault or because it is gone.
    fn activate(&mut self) -> Result<(), RigError> {
        Ok(())
    }

    /// Puts the motor at zero volts at once, between cycles too. A rig that has to be stopped by
    /// more than a voltage of zero does that.
    ///
    /// # Errors
    /// [`RigError`] if the rig refuses.
    fn halt(&mut self) -> Result<(), RigError> {
        self.apply(0.0)
    }

    /// Takes the motor's leave to move away: the opposite of [`activate`](Self::activate). Done
    /// when the motor is to rest, whether somebody asked for it or a fault latched. Zero volts are
    /// on the way before it returns; it does not wait for long, the control thread is in it.
    ///
    /// # Errors
    /// [`RigError`] if the rig refuses or is gone.
    fn deactivate(&mut self) -> Result<(), RigError> {
        self.halt()
    }

    /// Stops the motor as strongly as the rig can: zero volts at once, and where the rig has a stop
    /// of its own that is latched too. `Ok` says that the rig did it, not only that it was told. It
    /// may be asked again while it holds.
    ///
    /// # Errors
    /// [`RigError`] if the rig refuses, is gone or does not say that it stopped.
    fn emergency_stop(&mut self) -> Result<(), RigError> {
        self.halt()
    }

    /// Clears a fault of the back end, whose cause is mended. The motor stays at zero volts.
    ///
    /// # Errors
    /// [`RigError`] if the cause is still there.
    fn clear(&mut self) -> Result<(), RigError> {
        Ok(())
    }

    /// What no sensor shows, where the rig is simulated.
    fn truth(&self) -> Option<Truth> {
        None
    }

    /// Asks for a transition between states; only a rig under supervision has any.
    ///
    /// # Errors
    /// [`RigError::Refused`] if there is no such transition.
    fn request(&mut self, request: Request) -> Result<State, RigError> {
        Err(Refused { state: State::Unconfigured, event: Event::Asked(request) }.into())
    }

    /// The fault that holds the motor at zero volts, as far as the rig knows it.
    fn latched_fault(&self) -> Option<FaultReport> {
        None
    }
}

impl<R: Rig + ?Sized> Rig for Box<R> {
    fn period(&self) -> f64 {
        (**self).period()
    }

    fn voltage_range(&self) -> f64 {
        (**self).voltage_range()
    }

    fn keeps_time(&self) -> bool {
        (**self).keeps_time()
    }

    fn wait(&mut self) -> Result<(), RigError> {
        (**self).wait()
    }

    fn activate(&mut self) -> Result<(), RigError> {
        (**self).activate()
    }

    fn tell_time(&mut self, now: f64) {
        (**self).tell_time(now);
    }

    fn measure(&mut self) -> Measurement {
        (**self).measure()
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        (**self).apply(volts)
    }

    fn halt(&mut self) -> Result<(), RigError> {
        (**self).halt()
    }

    fn clear(&mut self) -> Result<(), RigError> {
        (**self).clear()
    }

    fn deactivate(&mut self) -> Result<(), RigError> {
        (**self).deactivate()
    }

    fn emergency_stop(&mut self) -> Result<(), RigError> {
        (**self).emergency_stop()
    }

    fn truth(&self) -> Option<Truth> {
        (**self).truth()
    }

    fn request(&mut self, request: Request) -> Result<State, RigError> {
        (**self).request(request)
    }

    fn latched_fault(&self) -> Option<FaultReport> {
        (**self).latched_fault()
    }
}
