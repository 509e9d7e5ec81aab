//! Whether a device is the one that a profile describes.

use rig_driver::registry::RigDescription;

use super::{RigChoice, RigSetupError};

/// Refuses a device that is not the `described` one: calibration and limits would be those of
/// another.
///
/// # Errors
/// [`RigSetupError::OtherDevice`] says in what it differs.
pub fn require_device(
    described: &RigDescription,
    rig: &RigChoice,
    device: Option<&RigDescription>,
) -> Result<(), RigSetupError> {
    match device.and_then(|device| described.differs_from(device)) {
        None => Ok(()),
        Some(what) => Err(RigSetupError::OtherDevice { rig: rig.to_string(), what }),
    }
}
