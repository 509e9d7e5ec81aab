//! Friction torque of a drive that has no torque sensor, with what is not known about it.
//!
//! The balance of torques at the load side of a geared DC motor (thesis appendix A) gives the friction:
//!
//! ```text
//! F = (k / R_a) (u - k w) - J w'        from the voltage
//! F = k i - J w'                        from the current,        k = A K_m
//! ```
//!
//! * `w` and `w'` come from the measured velocity through a zero-phase Butterworth low-pass ([`VELOCITY_CUTOFF`],
//!   second order in each direction), `w'` by central differences of the smoothed velocity.
//! * A voltage or current sample is the mean over the period that *ends* at its instant. Its value at the instant
//!   is the mean of this sample and the next; without this, half a period of delay would look like frictional lag.
//!
//! Two kinds of uncertainty are kept apart. Noise differs from sample to sample and averages out. An error of a drive
//! constant is the same throughout a recording and does not; it is kept as the torque error that one standard
//! error of each constant makes, sample by sample, so that whatever is computed linearly from the torque (a mean, a
//! loop area, a difference) can be computed from these errors too.

use serde::{Deserialize, Serialize};

use crate::uncertain::Uncertain;

use crate::IdentError;
use crate::zero_phase::LowPass;

/// Cutoff of the velocity's low-pass \[Hz\], or a fifth of the sampling rate where that is lower.
pub const VELOCITY_CUTOFF: f64 = 50.0;

/// Where the friction torque is taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TorqueSource {
    /// A torque sensor.
    #[default]
    Sensor,
    /// The motor's voltage and velocity.
    Voltage,
    /// The motor's current and velocity.
    Current,
}

impl TorqueSource {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Sensor, Self::Voltage, Self::Current];

    /// Name in files and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sensor => "sensor",
            Self::Voltage => "voltage",
            Self::Current => "current",
        }
    }
}

/// Constants of the drive at the load side, as far as they are known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveConstants {
    /// Torque constant k = A K_m \[N m/A\], equal to the back-EMF constant \[V s/rad\].
    pub torque_constant: Uncertain,
    /// Armature resistance R_a \[ohm\].
    pub armature_resistance: Uncertain,
    /// Inertia J at the load side \[kg m^2\].
    pub inertia: Uncertain,
}

/// One of the [`DriveConstants`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DriveConstant {
    /// k = A K_m.
    TorqueConstant,
    /// R_a.
    ArmatureResistance,
    /// J.
    Inertia,
}

/// Standard deviation of one sample of each channel: its noise and its rounding, step / sqrt(12), together.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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

/// What was recorded, all channels at the same instants and as long as `velocity`; those that `source` does not need may
/// be empty.
#[derive(Debug, Clone, Copy)]
pub struct DriveSignals<'a> {
    /// Sampling period \[s\].
    pub time_step: f64,
    /// Velocity w of the load \[rad/s\].
    pub velocity: &'a [f64],
    /// Torque sensor \[N m\].
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

    /// Standard deviation by the constants of a quantity that is linear in the torque: `quantity` is given the torque
    /// error of each constant in place of the torque.
    pub fn propagate(&self, quantity: impl Fn(&[f64]) -> f64) -> f64 {
        self.constants.iter().map(|error| quantity(&error.torque).powi(2)).sum::<f64>().sqrt()
    }
}

/// Friction torque from the chosen source.
///
/// # Errors
/// [`IdentError`] for a sampling period or a constant out of range, channels of different length, samples that are not finite,
/// and recordings too short for the velocity's low-pass.
pub fn friction_torque(
    source: TorqueSource,
    signals: &DriveSignals<'_>,
    drive: &DriveConstants,
    deviations: &ChannelDeviations,
) -> Result<FrictionTorque, IdentError> {
    let driving = match source {
        TorqueSource::Sensor => ("the torque", signals.torque),
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
    check_constants(drive)?;
    let smoothing = Smoothing::new(signals.time_step)?;
    let velocity = smoothing.filter.filter(signals.velocity)?;
    let acceleration = slopes(&velocity, signals.time_step);
    let at = at_instants(driving.1);
    let (k, r, j) = (drive.torque_constant, drive.armature_resistance, drive.inertia);
    let each = |value: &dyn Fn(f64, f64, f64) -> f64| -> Vec<f64> {
        let motion = velocity.iter().zip(&acceleration);
        at.iter().zip(motion).map(|(&drive, (&w, &slope))| value(drive, w, slope)).collect()
    };
    let error = |constant, torque| ConstantError { constant, torque };
    let inertia = error(DriveConstant::Inertia, each(&|_, _, slope| -j.standard_error * slope));
    let (torque, by_drive, by_velocity, constants) = match source {
        TorqueSource::Current => (
            each(&|i, _, slope| k.value * i - j.value * slope),
            k.value * deviations.current,
            0.0,
            vec![error(DriveConstant::TorqueConstant, each(&|i, _, _| k.standard_error * i)), inertia],
        ),
        _ => {
            let (k1, r1) = (k.value, r.value);
            (
                each(&|u, w, slope| k1 / r1 * (u - k1 * w) - j.value * slope),
                k1 / r1 * deviations.voltage,
                k1 * k1 / r1,
                vec![
                    error(
                        DriveConstant::TorqueConstant,
                        each(&|u, w, _| k.standard_error * (u - 2.0 * k1 * w) / r1),
                    ),
                    error(
                        DriveConstant::ArmatureResistance,
                        each(&|u, w, _| -r.standard_error * k1 * (u - k1 * w) / (r1 * r1)),
                    ),
                    inertia,
                ],
            )
        }
    };
    // The mean of two samples halves the variance.
    let drive_noise = by_drive * std::f64::consts::FRAC_1_SQRT_2;
    // The smoothed velocity and its slope come from the same noise but are orthogonal: even and odd weights.
    let velocity_noise =
        deviations.velocity * (by_velocity * smoothing.value_gain).hypot(j.value * smoothing.slope_gain);
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
        Ok(Self { filter, value_gain: norm(&response), slope_gain: norm(&slopes(&response, time_step)) })
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
        return Err(IdentError::UnequalLengths { channel: driving.0, found: driving.1.len(), expected });
    }
    for (channel, values) in [("the velocity", signals.velocity), driving] {
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(IdentError::NotFinite { channel, index, value: values[index] });
        }
    }
    Ok(())
}

fn check_constants(drive: &DriveConstants) -> Result<(), IdentError> {
    for (name, constant) in [
        ("torque_constant", drive.torque_constant),
        ("armature_resistance", drive.armature_resistance),
        ("inertia", drive.inertia),
    ] {
        let Uncertain { value, standard_error } = constant;
        if !(value > 0.0 && value.is_finite() && standard_error >= 0.0 && standard_error.is_finite()) {
            return Err(IdentError::DriveConstant { name, value, standard_error });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
