//! The friction torque from voltage and velocity, through the inverse of the nominal drive.
//!
//! ```text
//! F = (u - (w_k - p w_(k-1)) / ((1 - p) K)) / r,    p = exp(-dt/T)
//! ```
//!
//! is the friction that takes the drive `T w' + w = K (u - r F)` from one sampled velocity to the
//! next under a held voltage: exact for friction that is constant over the period. It
//! differentiates: with 0.011 rad/s of noise at 1 ms on the SRV-02 a single value is 0.04 N m off.
//! Whoever uses it filters it.

use friction_model::TimeStep;

use crate::NominalDrive;
use crate::finite::believed;

/// The inverse of a drive at a fixed period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveInverse {
    decay: f64,
    volts_per_velocity: f64,
    newton_metres_per_volt: f64,
    before: Option<f64>,
}

impl DriveInverse {
    /// The inverse of `drive`, called once every `dt`.
    #[must_use]
    pub fn new(drive: &NominalDrive, dt: TimeStep) -> Self {
        let x = dt.seconds() / drive.time_constant;
        Self {
            decay: (-x).exp(),
            volts_per_velocity: -1.0 / ((-x).exp_m1() * drive.gain),
            newton_metres_per_volt: 1.0 / drive.volts_per_newton_metre,
            before: None,
        }
    }

    /// The friction \[N m\] since the last call, while `voltage` \[V\] was applied and the
    /// `velocity` \[rad/s\] went where it is now. `None` at the first call, and while a reading or
    /// the one before is not finite.
    #[inline]
    pub fn torque(&mut self, velocity: f64, voltage: f64) -> Option<f64> {
        let now = believed(velocity);
        let before = std::mem::replace(&mut self.before, now);
        let (now, before, voltage) = (now?, before?, believed(voltage)?);
        Some(
            (voltage - (now - self.decay * before) * self.volts_per_velocity)
                * self.newton_metres_per_volt,
        )
    }

    /// Forgets the velocity before.
    pub fn reset(&mut self) {
        self.before = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive under known friction, integrated exactly: the inverse gives the friction back.
    #[test]
    fn it_gives_the_friction_back_that_slowed_the_drive() {
        let drive = NominalDrive::SRV02;
        let dt = TimeStep::new(1e-3).unwrap();
        let mut inverse = DriveInverse::new(&drive, dt);
        let decay = (-1e-3 / drive.time_constant).exp();
        let mut w = 0.4;
        assert_eq!(inverse.torque(w, 0.0), None);
        for k in 0..1000 {
            let (u, friction) = ((0.01 * f64::from(k)).sin(), 0.1 * (0.023 * f64::from(k)).cos());
            w = decay * w
                + (1.0 - decay) * drive.gain * (u - drive.volts_per_newton_metre * friction);
            assert!((inverse.torque(w, u).unwrap() - friction).abs() < 1e-12);
        }
        assert_eq!(inverse.torque(f64::NAN, 0.0), None);
        assert_eq!(inverse.torque(w, 0.0), None, "there is nothing to compare with");
        assert!(inverse.torque(w, 0.0).is_some());
    }
}
