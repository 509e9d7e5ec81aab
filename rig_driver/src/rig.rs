//! The one trait every rig is driven through.

use crate::fault::FaultReport;
use crate::lifecycle::{Event, Refused, Request, State};
use crate::{Measurement, RigError, Truth};

/// Voltage range of a rig whose description does not tell it \[V\]: that of the converters of the
/// thesis's card.
pub const VOLTAGE_RANGE: f64 = 10.0;

/// Highest voltage that any rig is driven with, whatever it says of itself \[V\]: the end of
/// extra-low direct voltage, which may be touched.
pub const HIGHEST_VOLTAGE: f64 = 60.0;

/// A servo axis that is measured and driven once a control cycle.
///
/// The simulated test bed is lock-step: `apply` advances its time by one period.
///
/// A layer around a rig, such as a calibration, names the rig [`beneath`](Self::beneath) it and says
/// what it changes. Whatever it does not say itself goes to that rig; no method can be forgotten.
pub trait Rig {
    /// The rig that this one is a layer around; none for a back end.
    fn beneath(&self) -> Option<&dyn Rig> {
        None
    }

    /// The same to be driven. A layer gives both or neither.
    fn beneath_mut(&mut self) -> Option<&mut dyn Rig> {
        None
    }

    /// Period of the control cycle \[s\].
    fn period(&self) -> f64;

    /// Largest magnitude of the motor voltage that the rig can put out, by its own description
    /// \[V\]. The safety layer takes no limit beyond it.
    fn voltage_range(&self) -> f64 {
        self.beneath().map_or(VOLTAGE_RANGE, Rig::voltage_range)
    }

    /// Whether the rig has a clock of its own, so that [`wait`](Self::wait) sets the pace and not
    /// the caller's clock.
    fn keeps_time(&self) -> bool {
        self.beneath().is_some_and(Rig::keeps_time)
    }

    /// Waits until the rig's next cycle has begun. A rig that is in lock-step with its caller does
    /// not wait.
    ///
    /// # Errors
    /// [`RigError`] if the cycle does not come: the rig is gone, hangs or has restarted.
    fn wait(&mut self) -> Result<(), RigError> {
        self.beneath_mut().map_or(Ok(()), Rig::wait)
    }

    /// Tells the time on the caller's clock at the beginning of a cycle \[s\]. Rigs in lock-step
    /// need not know it.
    fn tell_time(&mut self, now: f64) {
        if let Some(rig) = self.beneath_mut() {
            rig.tell_time(now);
        }
    }

    /// Readings of the present cycle.
    fn measure(&mut self) -> Measurement;

    /// Sets the motor voltage \[V\] for the coming period. A voltage beyond the limits is cut, and
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
        self.beneath_mut().map_or(Ok(()), Rig::activate)
    }

    /// Puts the motor at zero volts at once, between cycles too. A rig that has to be stopped by
    /// more than a voltage of zero does that.
    ///
    /// # Errors
    /// [`RigError`] if the rig refuses.
    fn halt(&mut self) -> Result<(), RigError> {
        match self.beneath_mut() {
            Some(rig) => rig.halt(),
            None => self.apply(0.0),
        }
    }

    /// Takes the motor's leave to move away: the opposite of [`activate`](Self::activate). Done
    /// when the motor is to rest, whether somebody asked for it or a fault latched. Zero volts are
    /// on the way before it returns; it does not wait for long, the control thread is in it.
    ///
    /// # Errors
    /// [`RigError`] if the rig refuses or is gone.
    fn deactivate(&mut self) -> Result<(), RigError> {
        match self.beneath_mut() {
            Some(rig) => rig.deactivate(),
            None => self.halt(),
        }
    }

    /// Stops the motor as strongly as the rig can: zero volts at once, and where the rig has a stop
    /// of its own that is latched too. `Ok` says that the rig did it, not only that it was told. It
    /// may be asked again while it holds.
    ///
    /// # Errors
    /// [`RigError`] if the rig refuses, is gone or does not say that it stopped.
    fn emergency_stop(&mut self) -> Result<(), RigError> {
        match self.beneath_mut() {
            Some(rig) => rig.emergency_stop(),
            None => self.halt(),
        }
    }

    /// Clears a fault of the back end, whose cause is mended. The motor stays at zero volts.
    ///
    /// # Errors
    /// [`RigError`] if the cause is still there.
    fn clear(&mut self) -> Result<(), RigError> {
        self.beneath_mut().map_or(Ok(()), Rig::clear)
    }

    /// What no sensor shows, where the rig is simulated.
    fn truth(&self) -> Option<Truth> {
        self.beneath().and_then(Rig::truth)
    }

    /// Asks for a transition between states; only a rig under supervision has any.
    ///
    /// # Errors
    /// [`RigError::Refused`] if there is no such transition.
    fn request(&mut self, request: Request) -> Result<State, RigError> {
        match self.beneath_mut() {
            Some(rig) => rig.request(request),
            None => {
                Err(Refused { state: State::Unconfigured, event: Event::Asked(request) }.into())
            }
        }
    }

    /// How far the winding is above ambient \[K\], where a safety layer watches it.
    fn winding_rise(&self) -> Option<f64> {
        self.beneath().and_then(Rig::winding_rise)
    }

    /// How long the device has run since it was switched on, by its own clock \[s\]: so long its
    /// encoder has counted without a break. None where it does not say.
    fn powered_for(&self) -> Option<f64> {
        self.beneath().and_then(Rig::powered_for)
    }

    /// Why the device holds the motor at zero volts until somebody clears that, in its own words:
    /// its emergency stop, or a fault of its own. None where it does not, or does not say.
    fn held_by(&self) -> Option<RigError> {
        self.beneath().and_then(Rig::held_by)
    }

    /// The fault that holds the motor at zero volts, as far as the rig knows it.
    fn latched_fault(&self) -> Option<FaultReport> {
        self.beneath().and_then(Rig::latched_fault)
    }
}

impl Rig for Box<dyn Rig + Send> {
    fn beneath(&self) -> Option<&dyn Rig> {
        Some(&**self)
    }

    fn beneath_mut(&mut self) -> Option<&mut dyn Rig> {
        Some(&mut **self)
    }

    fn period(&self) -> f64 {
        (**self).period()
    }

    fn measure(&mut self) -> Measurement {
        (**self).measure()
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        (**self).apply(volts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::safety::Fault;

    /// A back end that notes what it is asked.
    #[derive(Default)]
    struct Noting(Vec<&'static str>);

    impl Noting {
        fn note(&mut self, method: &'static str) -> Result<(), RigError> {
            self.0.push(method);
            Ok(())
        }
    }

    const FAULT: FaultReport =
        FaultReport { fault: Fault::CycleLost, time: 1.0, value: 2.0, limit: 3.0 };
    const TRUTH: Truth = Truth { position: 1.0, velocity: 2.0, friction: 3.0 };

    impl Rig for Noting {
        fn period(&self) -> f64 {
            0.002
        }

        fn voltage_range(&self) -> f64 {
            12.0
        }

        fn keeps_time(&self) -> bool {
            true
        }

        fn wait(&mut self) -> Result<(), RigError> {
            self.note("wait")
        }

        fn tell_time(&mut self, _: f64) {
            self.0.push("tell_time");
        }

        fn measure(&mut self) -> Measurement {
            self.0.push("measure");
            Measurement::default()
        }

        fn apply(&mut self, _: f64) -> Result<(), RigError> {
            self.note("apply")
        }

        fn activate(&mut self) -> Result<(), RigError> {
            self.note("activate")
        }

        fn halt(&mut self) -> Result<(), RigError> {
            self.note("halt")
        }

        fn deactivate(&mut self) -> Result<(), RigError> {
            self.note("deactivate")
        }

        fn emergency_stop(&mut self) -> Result<(), RigError> {
            self.note("emergency_stop")
        }

        fn clear(&mut self) -> Result<(), RigError> {
            self.note("clear")
        }

        fn truth(&self) -> Option<Truth> {
            Some(TRUTH)
        }

        fn request(&mut self, _: Request) -> Result<State, RigError> {
            self.note("request").map(|()| State::Inactive)
        }

        fn winding_rise(&self) -> Option<f64> {
            Some(4.0)
        }

        fn powered_for(&self) -> Option<f64> {
            Some(5.0)
        }

        fn held_by(&self) -> Option<RigError> {
            Some(RigError::LineGone)
        }

        fn latched_fault(&self) -> Option<FaultReport> {
            Some(FAULT)
        }
    }

    /// A layer that says as little as it may.
    struct Layer(Noting);

    impl Rig for Layer {
        fn beneath(&self) -> Option<&dyn Rig> {
            Some(&self.0)
        }

        fn beneath_mut(&mut self) -> Option<&mut dyn Rig> {
            Some(&mut self.0)
        }

        fn period(&self) -> f64 {
            self.0.period()
        }

        fn measure(&mut self) -> Measurement {
            self.0.measure()
        }

        fn apply(&mut self, volts: f64) -> Result<(), RigError> {
            self.0.apply(volts)
        }
    }

    #[test]
    fn what_a_layer_does_not_say_goes_to_the_rig_beneath_it() {
        let mut layer = Layer(Noting::default());
        layer.wait().unwrap();
        layer.tell_time(1.0);
        layer.measure();
        layer.apply(1.0).unwrap();
        layer.activate().unwrap();
        layer.halt().unwrap();
        layer.deactivate().unwrap();
        layer.emergency_stop().unwrap();
        layer.clear().unwrap();
        assert_eq!(layer.request(Request::Configure).unwrap(), State::Inactive);
        let told = [
            "wait",
            "tell_time",
            "measure",
            "apply",
            "activate",
            "halt",
            "deactivate",
            "emergency_stop",
            "clear",
            "request",
        ];
        assert_eq!(layer.0.0, told);
        assert_eq!(
            (layer.period(), layer.voltage_range(), layer.keeps_time()),
            (0.002, 12.0, true)
        );
        assert_eq!((layer.truth(), layer.latched_fault()), (Some(TRUTH), Some(FAULT)));
        assert_eq!((layer.winding_rise(), layer.powered_for()), (Some(4.0), Some(5.0)));
        assert_eq!(layer.held_by(), Some(RigError::LineGone));
        // Whoever adds a method to the trait adds it here: the ten told, the eight asked, and both
        // ways to the rig beneath.
        let source = include_str!("rig.rs");
        let (_, of_the_trait) = source.split_once("pub trait Rig {").expect("the trait");
        let (of_the_trait, _) = of_the_trait.split_once("\n}\n").expect("its end");
        assert_eq!(of_the_trait.matches("\n    fn ").count(), told.len() + 8 + 2);
    }
}
