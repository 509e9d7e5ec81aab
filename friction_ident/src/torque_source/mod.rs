//! Friction torque of a drive that has no torque sensor, with what is not known about it.
//!
//! The balance of torques at the load side of a geared DC motor (thesis appendix A) gives the
//! friction:
//!
//! ```text
//! F = (k / R_a) (u - k w) - J w'        from the voltage
//! F = k i - J w'                        from the current,        k = A K_m
//! F = T - J w'                          from a recorded force T that drives the axis
//! ```
//!
//! * `w` and `w'` come from the measured velocity through a zero-phase Butterworth low-pass
//!   ([`VELOCITY_CUTOFF`], second order in each direction), `w'` by central differences of the
//!   smoothed velocity.
//! * A voltage or current sample is the mean over the period that *ends* at its instant. Its value
//!   at the instant is the mean of this sample and the next; without this, half a period of delay
//!   would look like frictional lag. A driving force counts as read at its instant.
//!
//! Two kinds of uncertainty are kept apart. Noise differs from sample to sample and averages out.
//! An error of a drive constant is the same throughout a recording and does not; it is kept as the
//! torque error that one standard error of each constant makes, sample by sample, so that whatever
//! is computed linearly from the torque (a mean, a loop area, a difference) can be computed from
//! these errors too.

pub use friction_model::TorqueSource;
use serde::{Deserialize, Serialize};

use crate::uncertain::Uncertain;

use crate::IdentError;
use crate::zero_phase::LowPass;

/// Cutoff of the velocity's low-pass \[Hz\], or a fifth of the sampling rate where that is lower.
pub const VELOCITY_CUTOFF: f64 = 50.0;

/// Constants of the drive at the load side, as far as they are known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveConstants {
    /// Torque constant k = A K_m \[N m/A\], equal to the back-EMF constant \[V s/rad\].
    pub torque_constant: Uncertain,
    /// Armature resistance R_a \[ohm\].
    pub armature_resistance: Uncertain,
    /// Inertia J at the load side \[kg m^2, or kg on a linear axis\].
    pub inertia: Uncertain,
}

impl DriveConstants {
    /// A drive whose force is recorded itself: torque constant and resistance are one, and only the
    /// inertia must be known.
    #[must_use]
    pub const fn force_recorded(inertia: Uncertain) -> Self {
        Self {
            torque_constant: Uncertain::exact(1.0),
            armature_resistance: Uncertain::exact(1.0),
            inertia,
        }
    }

    /// Friction \[N m or N\] at an instant: `channel` is what `source` names there \[V, A or N m\],
    /// beside the velocity \[rad/s\] and the acceleration \[rad/s^2\].
    #[must_use]
    pub fn friction(
        &self,
        source: TorqueSource,
        channel: f64,
        velocity: f64,
        acceleration: f64,
    ) -> f64 {
        let (k, r, j) =
            (self.torque_constant.value, self.armature_resistance.value, self.inertia.value);
        match source {
            TorqueSource::Sensor => channel,
            TorqueSource::Voltage => k / r * (channel - k * velocity) - j * acceleration,
            TorqueSource::Current => k * channel - j * acceleration,
            TorqueSource::Driving => channel - j * acceleration,
        }
    }

    /// What one standard error of `constant` adds to [`friction`](Self::friction) \[N m or N\], to
    /// first order and with its sign.
    #[must_use]
    pub fn friction_error(
        &self,
        source: TorqueSource,
        constant: DriveConstant,
        channel: f64,
        velocity: f64,
        acceleration: f64,
    ) -> f64 {
        let (k, r) = (self.torque_constant.value, self.armature_resistance.value);
        match (constant, source) {
            (_, TorqueSource::Sensor) => 0.0,
            (DriveConstant::Inertia, _) => -self.inertia.standard_error * acceleration,
            (DriveConstant::TorqueConstant, TorqueSource::Voltage) => {
                self.torque_constant.standard_error * (channel - 2.0 * k * velocity) / r
            }
            (DriveConstant::TorqueConstant, TorqueSource::Current) => {
                self.torque_constant.standard_error * channel
            }
            (DriveConstant::ArmatureResistance, TorqueSource::Voltage) => {
                -self.armature_resistance.standard_error * k * (channel - k * velocity) / (r * r)
            }
            (DriveConstant::TorqueConstant | DriveConstant::ArmatureResistance, _) => 0.0,
        }
    }

    /// Checks that the constants which `source` needs are above zero and their standard errors not
    /// below.
    ///
    /// # Errors
    /// [`IdentError::DriveConstant`], naming the one that is out of range.
    pub fn check(&self, source: TorqueSource) -> Result<(), IdentError> {
        for constant in DriveConstant::entering(source) {
            let Uncertain { value, standard_error } = match constant {
                DriveConstant::TorqueConstant => self.torque_constant,
                DriveConstant::ArmatureResistance => self.armature_resistance,
                DriveConstant::Inertia => self.inertia,
            };
            if !(value > 0.0
                && value.is_finite()
                && standard_error >= 0.0
                && standard_error.is_finite())
            {
                let name = constant.name();
                return Err(IdentError::DriveConstant { name, value, standard_error });
            }
        }
        Ok(())
    }
}

/// One of the [`DriveConstants`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum DriveConstant {
    /// k = A K_m.
    TorqueConstant,
    /// R_a.
    ArmatureResistance,
    /// J.
    Inertia,
}

impl DriveConstant {
    /// The constants that enter where the torque is taken from `source`.
    #[must_use]
    pub const fn entering(source: TorqueSource) -> &'static [Self] {
        match source {
            TorqueSource::Sensor => &[],
            TorqueSource::Voltage => {
                &[Self::TorqueConstant, Self::ArmatureResistance, Self::Inertia]
            }
            TorqueSource::Current => &[Self::TorqueConstant, Self::Inertia],
            TorqueSource::Driving => &[Self::Inertia],
        }
    }

    /// Name in files.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// Standard deviation of one sample of each channel: its noise and its rounding, step / sqrt(12),
/// together.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelDeviations {
    /// Torque sensor \[N m\].
    pub torque: f64,
    /// Velocity \[rad/s\].
    pub velocity: f64,
    /// Voltage at the motor \[V\]; zero where the rig reports exactly what it applied.
    pub voltage: f64,
    /// Current \[A\].
    pub current: f64,
}

/// What was recorded, all channels at the same instants and as long as `velocity`; those that
/// `source` does not need may be empty.
#[derive(Debug, Clone, Copy)]
pub struct DriveSignals<'a> {
    /// Sampling period \[s\].
    pub time_step: f64,
    /// Velocity w of the load \[rad/s\].
    pub velocity: &'a [f64],
    /// Torque sensor, or the torque that drives the axis \[N m\].
    pub torque: &'a [f64],
    /// Voltage u, the mean over the period that ends at the sample \[V\].
    pub voltage: &'a [f64],
    /// Current i, the mean over the period that ends at the sample \[A\].
    pub current: &'a [f64],
}

/// Torque error that one standard error of a constant makes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConstantError {
    /// Which constant.
    pub constant: DriveConstant,
    /// The error at each sample \[N m\], with its sign.
    pub torque: Vec<f64>,
}

/// Friction torque over time with its uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrictionTorque {
    /// Where it is from.
    pub source: TorqueSource,
    /// Friction torque at each sample \[N m\]; positive opposes positive velocity.
    pub torque: Vec<f64>,
    /// Standard deviation of one sample by noise \[N m\].
    pub noise: f64,
    /// Errors that do not average out, one entry for each constant that enters.
    pub constants: Vec<ConstantError>,
}

impl FrictionTorque {
    /// Standard deviation of sample `index` by the constants \[N m\]; zero beyond the end.
    pub fn systematic(&self, index: usize) -> f64 {
        self.propagate(|torque| torque.get(index).copied().unwrap_or(0.0))
    }

    /// Standard deviation by the constants of a quantity that is linear in the torque: `quantity`
    /// is given the torque error of each constant in place of the torque.
    pub fn propagate(&self, quantity: impl Fn(&[f64]) -> f64) -> f64 {
        self.constants.iter().map(|error| quantity(&error.torque).powi(2)).sum::<f64>().sqrt()
    }
}

/// Friction torque from the chosen source.
///
/// # Errors
/// [`IdentError`] for a sampling period or a constant out of range, channels of different length,
/// samples that are not finite, and recordings too short for the velocity's low-pass.
pub fn friction_torque(
    source: TorqueSource,
    signals: &DriveSignals<'_>,
    drive: &DriveConstants,
    deviations: &ChannelDeviations,
) -> Result<FrictionTorque, IdentError> {
    let driving = match source {
        TorqueSource::Sensor | TorqueSource::Driving => ("the torque", signals.torque),
        TorqueSource::Voltage => ("the voltage", signals.voltage),
        TorqueSource::Current => ("the current", signals.current),
    };
    check(signals, driving)?;
    if source == TorqueSource::Sensor {
        return Ok(FrictionTorque {
            source,
            torque: signals.torque.to_vec(),
            noise: deviations.torque,
            constants: Vec::new(),
        });
    }
    drive.check(source)?;
    let smoothing = Smoothing::new(signals.time_step)?;
    let velocity = smoothing.filter.filter(signals.velocity)?;
    let acceleration = slopes(&velocity, signals.time_step);
    let at =
        if source == TorqueSource::Driving { driving.1.to_vec() } else { at_instants(driving.1) };
    let each = |value: &dyn Fn(f64, f64, f64) -> f64| -> Vec<f64> {
        let motion = velocity.iter().zip(&acceleration);
        at.iter().zip(motion).map(|(&channel, (&w, &slope))| value(channel, w, slope)).collect()
    };
    let torque = each(&|channel, w, slope| drive.friction(source, channel, w, slope));
    let constants = DriveConstant::entering(source)
        .iter()
        .map(|&constant| ConstantError {
            constant,
            torque: each(&|channel, w, slope| {
                drive.friction_error(source, constant, channel, w, slope)
            }),
        })
        .collect();
    let (k, r) = (drive.torque_constant.value, drive.armature_resistance.value);
    // The mean of two samples halves the variance.
    let halved = std::f64::consts::FRAC_1_SQRT_2;
    let (drive_noise, by_velocity) = match source {
        TorqueSource::Voltage => (k / r * deviations.voltage * halved, k * k / r),
        TorqueSource::Current => (k * deviations.current * halved, 0.0),
        TorqueSource::Driving | TorqueSource::Sensor => (deviations.torque, 0.0),
    };
    // The smoothed velocity and its slope come from the same noise but are orthogonal: even and odd
    // weights.
    let velocity_noise = deviations.velocity
        * (by_velocity * smoothing.value_gain).hypot(drive.inertia.value * smoothing.slope_gain);
    Ok(FrictionTorque { source, torque, noise: drive_noise.hypot(velocity_noise), constants })
}

/// The low-pass of the velocity and what it leaves of white noise.
struct Smoothing {
    filter: LowPass,
    /// Standard deviation of the smoothed velocity for noise of one.
    value_gain: f64,
    /// Standard deviation of its slope for noise of one \[1/s\].
    slope_gain: f64,
}

impl Smoothing {
    fn new(time_step: f64) -> Result<Self, IdentError> {
        let rate = 1.0 / time_step;
        let filter = LowPass::butterworth(2, VELOCITY_CUTOFF.min(rate / 5.0), rate)?;
        let mut impulse = vec![0.0; 401];
        impulse[200] = 1.0;
        let response = filter.filter(&impulse)?;
        let norm = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>().sqrt();
        Ok(Self {
            filter,
            value_gain: norm(&response),
            slope_gain: norm(&slopes(&response, time_step)),
        })
    }
}

/// Values at the instants of means over the periods before them; the last keeps its own.
fn at_instants(means: &[f64]) -> Vec<f64> {
    let next = means.iter().skip(1).chain(means.last());
    means.iter().zip(next).map(|(&now, &next)| 0.5 * (now + next)).collect()
}

/// Central differences, one-sided at both ends.
fn slopes(values: &[f64], time_step: f64) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    (0..values.len())
        .map(|i| {
            let (before, after) = (i.saturating_sub(1), (i + 1).min(last));
            let span = (after - before).max(1) as f64;
            (values[after] - values[before]) / (span * time_step)
        })
        .collect()
}

fn check(signals: &DriveSignals<'_>, driving: (&'static str, &[f64])) -> Result<(), IdentError> {
    if !(signals.time_step > 0.0 && signals.time_step.is_finite()) {
        return Err(IdentError::TimeStep(signals.time_step));
    }
    let expected = signals.velocity.len();
    if driving.1.len() != expected {
        return Err(IdentError::UnequalLengths {
            channel: driving.0,
            found: driving.1.len(),
            expected,
        });
    }
    for (channel, values) in [("the velocity", signals.velocity), driving] {
        if let Some(index) = values.iter().position(|value| !crate::finite::usable(*value)) {
            return Err(IdentError::NotFinite { channel, index, value: values[index] });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
