//! How the rig is opened, each time anew and always as the same one.

use rig_driver::registry::{Opened, RigDescription, RigSetup};
use rig_setup::{RigChoice, RigSetupError, require_device};

/// What the rig is opened with.
#[derive(Debug, Clone)]
pub(super) struct Opening {
    pub(super) rig: RigChoice,
    pub(super) setup: RigSetup,
    /// Only this device is driven.
    pub(super) expected: Option<RigDescription>,
    /// The encoder has nothing to be held against.
    pub(super) encoder_alone: bool,
}

impl Opening {
    /// The rig, at zero volts.
    ///
    /// # Errors
    /// What the rig says, or [`RigSetupError::OtherDevice`].
    pub(super) fn open(&self) -> Result<Opened, RigSetupError> {
        let mut opened = self.rig.open(&self.setup)?;
        if self.encoder_alone {
            opened.limits = opened.limits.before_calibration();
            opened.limits.sensors.frozen_cycles = None;
        }
        if let Some(expected) = &self.expected {
            require_device(expected, &self.rig, opened.description.as_ref())?;
        }
        Ok(opened)
    }

    /// Whether it may be opened once more by itself after its line failed.
    pub(super) fn comes_back(&self) -> bool {
        self.rig.comes_back()
    }
}
