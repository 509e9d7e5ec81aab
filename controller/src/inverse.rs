//! The inverse of the drive: the voltage that a frictionless drive needs for the reference (thesis
//! eq. 5.40, `B(s)`).

use serde::{Deserialize, Serialize};

use crate::design::LinearDrive;
use crate::{ControllerError, Reference};

/// How much of the inverse `B(s) = (T s + 1) / K` is fed forward.
#[derive(
    Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, strum::EnumDiscriminants,
)]
#[serde(rename_all = "snake_case")]
#[strum_discriminants(
    name(PlantInverseName),
    doc = "Which part of the drive's inverse, without the drive.",
    derive(strum::EnumString, strum::IntoStaticStr, strum::VariantNames),
    strum(serialize_all = "snake_case")
)]
pub enum PlantInverse {
    /// Nothing.
    #[default]
    Off,
    /// Its gain at zero frequency, `1 / K`: for references whose acceleration is not known.
    Gain(LinearDrive),
    /// The whole inverse, with the reference's acceleration.
    Whole(LinearDrive),
}

impl PlantInverse {
    /// The voltage for `reference` \[V\].
    #[inline]
    #[must_use]
    pub fn volts(&self, reference: &Reference) -> f64 {
        match self {
            Self::Off => 0.0,
            Self::Gain(drive) => reference.velocity / drive.gain,
            Self::Whole(drive) => {
                (reference.velocity + drive.time_constant * reference.acceleration) / drive.gain
            }
        }
    }

    pub(crate) fn check(&self) -> Result<(), ControllerError> {
        match self {
            Self::Off => Ok(()),
            Self::Gain(drive) | Self::Whole(drive) => Ok(drive.check()?),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Feeding the inverse alone through `T w' + w = K u` gives back the reference.
    #[test]
    fn the_whole_inverse_makes_the_drive_follow() {
        let (drive, h) = (LinearDrive::THESIS, 1e-5);
        let inverse = PlantInverse::Whole(drive);
        let mut w = 0.0;
        for k in 0..200_000 {
            let t = f64::from(k) * h;
            // The reference is that of the middle of the step.
            let (sin, cos) = (3.0 * (t + 0.5 * h)).sin_cos();
            let u =
                inverse.volts(&Reference { position: 0.0, velocity: sin, acceleration: 3.0 * cos });
            w += h / drive.time_constant * (drive.gain * u - w);
            assert!((w - (3.0 * (t + h)).sin()).abs() < 1e-4, "{t}");
        }
    }

    #[test]
    fn the_gain_alone_leaves_the_acceleration_out() {
        let reference = Reference { position: 0.0, velocity: 1.863, acceleration: 100.0 };
        assert!((PlantInverse::Gain(LinearDrive::THESIS).volts(&reference) - 1.0).abs() < 1e-15);
        assert_eq!(PlantInverse::Off.volts(&reference), 0.0);
    }
}
