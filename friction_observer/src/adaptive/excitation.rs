//! When an adaptation may learn, and when it must stand still.

use serde::{Deserialize, Serialize};

use crate::ObserverError;
use crate::error::{positive, within};

/// What a motion must be like to learn friction from it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Excitation {
    /// Slowest smoothed speed that counts as sliding \[rad/s\], above zero; well above the noise of
    /// the velocity after the filter.
    pub slowest: f64,
    /// Smallest torque of the model from which a factor can be told \[N m\], zero or more.
    pub weakest: f64,
    /// Voltage from which the drive counts as saturated \[V\], above zero.
    pub saturation: f64,
    /// How long all conditions must have held \[s\], from 0 to 10: what the filters still remember
    /// of before must be gone.
    pub hold: f64,
}

impl Excitation {
    /// For the thesis's test bed.
    pub const SRV02: Self = Self { slowest: 0.03, weakest: 0.02, saturation: 5.95, hold: 0.1 };

    /// Checks every field.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the field.
    pub fn check(&self) -> Result<(), ObserverError> {
        positive("slowest", self.slowest)?;
        within("weakest", self.weakest, 0.0..=1e3, "from 0 to 1e3 N m")?;
        positive("saturation", self.saturation)?;
        within("hold", self.hold, 0.0..=10.0, "from 0 to 10 s")
    }

    /// Whether this moment has all it takes.
    #[inline]
    #[must_use]
    pub fn is_rich(&self, smoothed_velocity: f64, model_torque: f64, voltage: f64) -> bool {
        smoothed_velocity.abs() >= self.slowest
            && model_torque.abs() >= self.weakest
            && voltage.abs() < self.saturation
            && smoothed_velocity * model_torque > 0.0
    }
}
