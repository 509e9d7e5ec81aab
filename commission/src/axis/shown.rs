//! A rig whose cycles are shown to whoever watches.

use rig_driver::{Measurement, Rig, RigError};

use super::turns::Watch;

/// Shows each cycle of a rig; all else is the rig's.
pub(super) struct Shown {
    pub(super) rig: Box<dyn Rig + Send>,
    pub(super) watch: Watch,
}

impl Rig for Shown {
    fn beneath(&self) -> Option<&dyn Rig> {
        Some(&self.rig)
    }

    fn beneath_mut(&mut self) -> Option<&mut dyn Rig> {
        Some(&mut self.rig)
    }

    fn period(&self) -> f64 {
        self.rig.period()
    }

    fn measure(&mut self) -> Measurement {
        let seen = self.rig.measure();
        self.watch.saw(&seen, None);
        seen
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        self.rig.apply(volts)
    }
}
