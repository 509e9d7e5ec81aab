//! The fit: with a measured friction torque by linear least squares, without it by the axis model
//! with the voltage as its force.

use serde::Serialize;

use super::constants::Calibration;
use super::fitted::Fitted;
use super::report::Report;
use super::with_torque::with_torque;
use super::{Breakaway, breakaways};
use crate::IdentError;
use crate::axis_structure::{AxisStructure, AxisUnits, fit_structure};
use crate::conditioning::{Conditioned, Conditioning, Signals, condition_stretches};
use crate::estimate::Estimates;

/// What was recorded of a drive without a gap, all channels at the same instants. A voltage that is
/// held over a sample stands at its beginning.
#[derive(Debug, Clone, Copy)]
pub struct DriveRecording<'a> {
    /// Time of the first sample \[s\].
    pub start: f64,
    /// Sampling period \[s\].
    pub time_step: f64,
    /// Motor voltage \[V\].
    pub voltage: &'a [f64],
    /// Position \[m or rad\].
    pub position: Option<&'a [f64]>,
    /// Velocity \[m/s or rad/s\]; the position is not used where this is given.
    pub velocity: Option<&'a [f64]>,
    /// Friction torque \[N m\] or force \[N\] from a sensor.
    pub friction: Option<&'a [f64]>,
}

/// A drive that was identified.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriveFit {
    /// `gain` K, `time_constant` T, `delay`, `inertia` and whatever else was known or found; see
    /// the module.
    pub estimates: Estimates,
    /// Starts of motion out of rest.
    pub breakaways: Vec<Breakaway>,
    /// `100 |residual| / |voltage|` \[%\].
    pub relative_error: f64,
    /// Share of the residual's samples that count as independent.
    pub effective_share: f64,
    /// Time of the kept samples \[s\].
    pub time: Vec<f64>,
    /// Voltage there \[V\].
    pub measured: Vec<f64>,
    /// What the drive's equation says \[V\].
    pub predicted: Vec<f64>,
    /// What must be known to read the numbers right.
    pub notes: Vec<String>,
}

/// Identifies a drive from the stretches of a recording, all of one sampling period; neither
/// filters nor the delay reach across the gaps between them.
///
/// # Errors
/// [`IdentError`] for recordings that are too short, not finite, without motion, or that do not
/// excite the drive.
pub fn fit_drive<'a>(
    recording: &[DriveRecording<'a>],
    how: &Conditioning,
    calibration: Option<&Calibration>,
    units: &AxisUnits,
) -> Result<DriveFit, IdentError> {
    let signals = |stretch: &DriveRecording<'a>| {
        let DriveRecording { start, time_step, voltage, position, velocity, .. } = *stretch;
        (start, Signals { time_step, position, readings: None, velocity, force: voltage })
    };
    let conditioned = condition_stretches(&recording.iter().map(signals).collect::<Vec<_>>(), how)?;
    let friction: Option<Vec<&[f64]>> = recording.iter().map(|stretch| stretch.friction).collect();
    let sensor = friction.is_some();
    let fitted = match friction {
        Some(friction) => with_torque(&conditioned, &friction)?,
        None => without_torque(&conditioned)?,
    };
    let found = breakaways(&conditioned);
    let report = Report::of(&fitted.estimates, units, sensor);
    let (made, notes) = report.filled(calibration, &found);
    let (correlation, covariance) = (Vec::new(), Vec::new());
    let Fitted { estimates, time, measured, predicted, share } = fitted;
    let error: f64 = measured.iter().zip(&predicted).map(|(a, b)| (a - b).powi(2)).sum();
    let power: f64 = measured.iter().map(|u| u * u).sum();
    Ok(DriveFit {
        estimates: Estimates { parameters: made, correlation, covariance, ..estimates },
        breakaways: found,
        relative_error: 100.0 * (error / power).sqrt(),
        effective_share: share,
        time,
        measured,
        predicted,
        notes,
    })
}

fn without_torque(recording: &Conditioned) -> Result<Fitted, IdentError> {
    let structure = AxisStructure { stribeck: true, delay: true, ..AxisStructure::ASYMMETRIC };
    let fit = fit_structure(recording, structure, &AxisUnits::ROTARY)?;
    let prediction = fit.predict(recording)?;
    Ok(Fitted {
        share: fit.effective_share,
        estimates: fit.estimates,
        time: prediction.time,
        measured: prediction.measured,
        predicted: prediction.predicted,
    })
}
