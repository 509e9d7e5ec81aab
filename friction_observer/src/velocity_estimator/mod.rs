//! The velocity of the shaft from what the sensors of a drive deliver.
//!
//! * [`LowPass`]: the tachometer, smoothed.
//! * [`TrackingLoop`]: the encoder through a loop of second order, with two integrators.
//! * [`KalmanFilter`]: the encoder, or encoder and tachometer, with the drive and its voltage as
//!   the model.
//!
//! Differences of a quantised encoder are of no use at a short period: a step of 1.53 mrad in 1 ms
//! is 1.53 rad/s.

mod kalman;
mod low_pass;
mod steady_gain;
mod tracking_loop;

use friction_model::{MAX_SPEED, TimeStep};
use serde::{Deserialize, Serialize};

pub use kalman::KalmanFilter;
pub use low_pass::LowPass;
pub use tracking_loop::TrackingLoop;

use crate::error::{positive, within};
use crate::{NominalDrive, ObserverError, Seen};

/// Positions beyond this magnitude are not believed \[rad\].
const MAX_POSITION: f64 = 1e9;

/// Which velocity an estimator believes.
#[derive(
    Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, strum::EnumDiscriminants,
)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[strum_discriminants(
    name(VelocitySourceName),
    doc = "Which velocity an estimator believes, without its options.",
    derive(strum::EnumString, strum::IntoStaticStr, strum::VariantNames),
    strum(serialize_all = "snake_case")
)]
pub enum VelocitySource {
    /// The tachometer as it reads.
    #[default]
    Tachometer,
    /// The tachometer through a filter of first order.
    TachometerLowPass {
        /// Time constant \[s\], above 0 and at most 1.
        time_constant: f64,
    },
    /// The encoder through a tracking loop.
    EncoderTrackingLoop {
        /// Bandwidth \[rad/s\], from 1 to 1e4: both poles of the loop lie there.
        bandwidth: f64,
    },
    /// A Kalman filter on the encoder and the voltage.
    EncoderKalman {
        /// Step of the encoder \[rad\], from 1e-7 to 0.1; its rounding counts as even noise.
        encoder_step: f64,
        /// How fast friction may wander \[N m per square root of a second\], from 1e-4 to 1e3.
        friction_walk: f64,
    },
    /// A Kalman filter on encoder, tachometer and voltage.
    Fused {
        /// Step of the encoder \[rad\], from 1e-7 to 0.1; its rounding counts as even noise.
        encoder_step: f64,
        /// Standard deviation of a reading of the tachometer \[rad/s\], from 1e-6 to 10.
        tachometer_noise: f64,
        /// How fast friction may wander \[N m per square root of a second\], from 1e-4 to 1e3.
        friction_walk: f64,
    },
}

impl VelocitySource {
    /// Step of the thesis's encoder, 4096 counts a turn \[rad\].
    pub const ENCODER_STEP: f64 = std::f64::consts::TAU / 4096.0;

    /// A tracking loop for the thesis's test bed.
    pub const TRACKING_LOOP: Self = Self::EncoderTrackingLoop { bandwidth: 60.0 };

    /// A Kalman filter on the encoder of the thesis's test bed.
    pub const ENCODER_KALMAN: Self =
        Self::EncoderKalman { encoder_step: Self::ENCODER_STEP, friction_walk: 0.3 };

    /// A Kalman filter on encoder and tachometer of the thesis's test bed: 0.01 rad/s of noise and
    /// a converter step of 4.9 mrad/s.
    pub const FUSED: Self = Self::Fused {
        encoder_step: Self::ENCODER_STEP,
        tachometer_noise: 0.0101,
        friction_walk: 0.3,
    };

    /// Checks every field.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the field.
    pub fn check(&self) -> Result<(), ObserverError> {
        let step = |x| within("encoder_step", x, 1e-7..=0.1, "from 1e-7 to 0.1 rad");
        let walk = |x| {
            within(
                "friction_walk",
                x,
                1e-4..=1e3,
                "from 1e-4 to 1e3 N m per square root of a second",
            )
        };
        match *self {
            Self::Tachometer => Ok(()),
            Self::TachometerLowPass { time_constant } => {
                positive("time_constant", time_constant)?;
                within("time_constant", time_constant, 0.0..=1.0, "above 0 and at most 1 s")
            }
            Self::EncoderTrackingLoop { bandwidth } => {
                within("bandwidth", bandwidth, 1.0..=1e4, "from 1 to 1e4 rad/s")
            }
            Self::EncoderKalman { encoder_step, friction_walk } => {
                step(encoder_step)?;
                walk(friction_walk)
            }
            Self::Fused { encoder_step, tachometer_noise, friction_walk } => {
                step(encoder_step)?;
                within("tachometer_noise", tachometer_noise, 1e-6..=10.0, "from 1e-6 to 10 rad/s")?;
                walk(friction_walk)
            }
        }
    }
}

/// A running estimate of the velocity.
#[derive(Debug, Clone)]
pub enum VelocityEstimator {
    /// The tachometer as it reads.
    Tachometer,
    /// The tachometer, smoothed.
    LowPass(LowPass),
    /// The encoder through a loop.
    TrackingLoop(TrackingLoop),
    /// The encoder, or both, through the model of the drive.
    Kalman(KalmanFilter),
}

impl VelocityEstimator {
    /// An estimator that has seen nothing, called once every `dt`.
    ///
    /// # Errors
    /// [`ObserverError`] names the option that is out of range.
    pub fn new(
        source: VelocitySource,
        drive: &NominalDrive,
        dt: TimeStep,
    ) -> Result<Self, ObserverError> {
        source.check()?;
        drive.check()?;
        Ok(match source {
            VelocitySource::Tachometer => Self::Tachometer,
            VelocitySource::TachometerLowPass { time_constant } => {
                Self::LowPass(LowPass::new(time_constant, dt))
            }
            VelocitySource::EncoderTrackingLoop { bandwidth } => {
                Self::TrackingLoop(TrackingLoop::new(bandwidth, dt))
            }
            VelocitySource::EncoderKalman { encoder_step, friction_walk } => {
                Self::Kalman(KalmanFilter::new(drive, encoder_step, None, friction_walk, dt)?)
            }
            VelocitySource::Fused { encoder_step, tachometer_noise, friction_walk } => {
                Self::Kalman(KalmanFilter::new(
                    drive,
                    encoder_step,
                    Some(tachometer_noise),
                    friction_walk,
                    dt,
                )?)
            }
        })
    }

    /// The velocity now \[rad/s\]. Readings that are not finite are left out; where nothing is
    /// known of the velocity, it is not a number.
    #[inline]
    pub fn estimate(&mut self, seen: &Seen) -> f64 {
        let tachometer =
            seen.velocity.is_finite().then(|| seen.velocity.clamp(-MAX_SPEED, MAX_SPEED));
        let position = (seen.position.abs() <= MAX_POSITION).then_some(seen.position);
        match self {
            Self::Tachometer => seen.velocity,
            Self::LowPass(filter) => tachometer.map_or(f64::NAN, |velocity| filter.step(velocity)),
            Self::TrackingLoop(tracking) => {
                position.map_or(f64::NAN, |position| tracking.step(position))
            }
            Self::Kalman(filter) => filter.step(position, tachometer, seen.voltage),
        }
    }

    /// Forgets what it has seen.
    pub fn reset(&mut self) {
        match self {
            Self::Tachometer => {}
            Self::LowPass(filter) => filter.reset(),
            Self::TrackingLoop(tracking) => tracking.reset(),
            Self::Kalman(filter) => filter.reset(),
        }
    }
}

#[cfg(test)]
mod tests;
