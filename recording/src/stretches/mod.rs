//! A recording of friction: stretches and steady points, from a CSV file or a bag.
//!
//! A file may hold many runs: it is cut at pauses, gaps and changes of the rate
//! ([`timing`](super::timing)). Runs at a constant velocity become steady points, without their
//! first fifth and last tenth, as in the thesis's experiment 1. A CSV file without a time column is
//! read as steady points.

use std::path::{Path, PathBuf};

use csv::StringRecord;
use friction_ident::quantiser::{Turn, between_counts, step_of};
use friction_ident::stretch::Before;
use friction_ident::zero_phase::{LowPass, decimate};
use friction_ident::{
    ChannelDeviations, ConstantError, DriveConstant, DriveConstants, DriveSignals, Hampel,
    IdentError, SavitzkyGolay, SteadyPoint, Stretch, TorqueSource, Uncertain, friction_torque,
};
use serde::Serialize;

use super::column::{Channel, axis_of};
use super::drive_error::DriveError;
use super::rosbag::{self, BagChannel};
use super::table::{self, Columns, Header, Motion, damaged};
use super::timing::{EvenStretch, TOLERANCE, Timing};
use super::{AxisKind, Irregularities, RecordingError};

mod pieces;

use pieces::{cropped, steady_part};

/// How motion is smoothed. The friction itself never is: that would flatten the steps it makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Smoothing {
    /// Savitzky-Golay, order 3 over 31 ms (31 samples at 1 kHz, five at least).
    #[default]
    #[value(name = "sg")]
    SavitzkyGolay,
    /// Butterworth, forwards and backwards.
    Butterworth,
    /// A measured velocity stays as it is; a position is differentiated by Savitzky-Golay.
    None,
}

/// How a recording becomes stretches.
#[derive(Debug, Clone, PartialEq)]
pub struct Preparation {
    /// How the motion is smoothed.
    pub smoothing: Smoothing,
    /// Cutoff of the Butterworth low-pass \[Hz\]; a tenth of the sampling rate, at most 100, where
    /// it is not given.
    pub cutoff: Option<f64>,
    /// Its order.
    pub order: usize,
    /// Every how many samples one is kept, after an anti-alias low-pass.
    pub decimate: usize,
    /// Which samples are not believed.
    pub outliers: Option<Hampel>,
    /// Where the friction comes from.
    pub torque: TorqueSource,
    /// The drive, for every source but a sensor.
    pub drive: Option<DriveConstants>,
    /// How far a time step may be from the usual one for its sample to be taken as it is, as a
    /// fraction.
    pub tolerance: f64,
}

impl Preparation {
    /// The drive's constants; without any the source's check refuses an inertia of zero.
    fn constants(&self) -> DriveConstants {
        self.drive.unwrap_or(DriveConstants::force_recorded(Uncertain::exact(0.0)))
    }

    /// No friction errors yet, one entry for each constant that enters.
    fn drive_errors(&self) -> Vec<DriveError> {
        DriveConstant::entering(self.torque)
            .iter()
            .map(|&constant| DriveError::new(constant))
            .collect()
    }
}

impl Default for Preparation {
    fn default() -> Self {
        Self {
            smoothing: Smoothing::default(),
            cutoff: None,
            order: 4,
            decimate: 1,
            outliers: None,
            torque: TorqueSource::default(),
            drive: None,
            tolerance: TOLERANCE,
        }
    }
}

/// A sample that was replaced.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outlier {
    /// Channel.
    pub channel: &'static str,
    /// When [s].
    pub time: f64,
    /// What was read.
    pub measured: f64,
    /// What it became.
    pub by: f64,
}

/// What a file says about friction.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionRecording {
    /// The file or folder.
    pub path: PathBuf,
    /// Steady points.
    pub points: Vec<SteadyPoint>,
    /// Everything else.
    pub stretches: Vec<Stretch>,
    /// Samples read.
    pub samples: usize,
    /// Kind of axis as the column names tell it.
    pub axis: Option<AxisKind>,
    /// Samples that were replaced.
    pub outliers: Vec<Outlier>,
    /// What the errors of the drive's constants do to the friction, constant by constant; empty
    /// with a torque sensor.
    pub drive_errors: Vec<DriveError>,
    /// What was uneven about the times.
    pub irregularities: Irregularities,
}

/// What was read, before it is cut.
struct Samples {
    time: Vec<f64>,
    position: Option<Vec<f64>>,
    /// Step of the encoder that the position comes from.
    step: Option<f64>,
    velocity: Option<Vec<f64>>,
    force: Vec<f64>,
}

/// Reads a CSV file, an `.mcap` file or a bag's folder.
///
/// # Errors
/// [`RecordingError`], naming the file and, where there is one, the line and the column.
pub fn read(
    path: &Path,
    columns: &Columns,
    how: &Preparation,
) -> Result<FrictionRecording, RecordingError> {
    let is_bag = path.is_dir() || path.extension().is_some_and(|extension| extension == "mcap");
    if is_bag {
        let channel = match how.torque {
            TorqueSource::Voltage => BagChannel::Voltage,
            _ => BagChannel::Friction,
        };
        let track = rosbag::track(path, channel)?;
        let samples = Samples {
            time: track.time,
            position: None,
            step: None,
            velocity: Some(track.velocity),
            force: track.force,
        };
        let place = |index: usize| format!("message {} of {}", index + 1, track.topic);
        return cut(path, &samples, Some(AxisKind::Rotary), how, place);
    }
    let bytes = files::input::table(path)
        .map_err(|source| RecordingError::Read { path: path.into(), source })?;
    parse(path, &bytes, columns, how)
}

fn parse(
    path: &Path,
    bytes: &[u8],
    columns: &Columns,
    how: &Preparation,
) -> Result<FrictionRecording, RecordingError> {
    if is_points(path, bytes, columns) {
        return points(path, bytes, columns, how);
    }
    let rows = table::rows(path, bytes, columns, Motion::Both)?;
    let samples = Samples {
        time: rows.time.clone(),
        step: rows.position.as_deref().and_then(step_of),
        position: rows.position.clone(),
        velocity: rows.velocity.clone(),
        force: rows.force.clone(),
    };
    cut(path, &samples, rows.axis, how, |index| rows.place(index))
}

/// Whether the file is a table of steady points: a velocity and a torque, and no time.
pub fn holds_points(path: &Path, columns: &Columns) -> bool {
    files::input::table(path).is_ok_and(|bytes| is_points(path, &bytes, columns))
}

fn is_points(path: &Path, bytes: &[u8], columns: &Columns) -> bool {
    let Ok((_, names)) = table::open(path, bytes, EXAMPLE) else { return false };
    let has = |channel: Channel, named: bool| named || channel.recognise(&names).is_some();
    !has(Channel::Time, columns.time.is_some())
        && has(Channel::Velocity, columns.velocity.is_some())
        && has(Channel::Force, columns.force.is_some())
}

const EXAMPLE: &str = "velocity_rad_s,torque_Nm";
/// Names of the standard deviation of a point's friction.
const DEVIATIONS: [&str; 4] =
    ["torque_deviation_Nm", "force_deviation_N", "torque_deviation", "deviation"];

/// Steady points: nothing is accelerated, and where there is no sensor friction is what drives.
fn points(
    path: &Path,
    bytes: &[u8],
    columns: &Columns,
    how: &Preparation,
) -> Result<FrictionRecording, RecordingError> {
    let (drive, source) = (how.constants(), how.torque);
    drive.check(source).map_err(|source| RecordingError::Unusable { path: path.into(), source })?;
    let mut drive_errors = how.drive_errors();
    let (mut reader, names) = table::open(path, bytes, EXAMPLE)?;
    let header = Header { path, names: &names };
    let velocity = header.require(Channel::Velocity, columns.velocity.as_ref())?;
    let force = header.require(Channel::Force, columns.force.as_ref())?;
    let deviation = names
        .iter()
        .position(|name| DEVIATIONS.iter().any(|known| known.eq_ignore_ascii_case(name)))
        .map(|index| table::Found {
            index,
            source: super::ChannelSource { name: names[index].clone(), scale: force.source.scale },
        });
    let mut points = Vec::new();
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(|error| damaged(path, &error))? {
        let line = record.position().map_or(0, csv::Position::line);
        let number = |found| header.number(&record, line, found);
        let (velocity, channel) = (number(&velocity)?, number(&force)?);
        for error in &mut drive_errors {
            error.points.push(drive.friction_error(source, error.constant, channel, velocity, 0.0));
        }
        points.push(SteadyPoint {
            velocity,
            torque: drive.friction(source, channel, velocity, 0.0),
            deviation: deviation.as_ref().map(number).transpose()?,
        });
    }
    if points.is_empty() {
        return Err(RecordingError::HeaderOnly { path: path.into() });
    }
    let axis = axis_of(&velocity.source.name).or_else(|| axis_of(&force.source.name));
    Ok(FrictionRecording {
        path: path.into(),
        samples: points.len(),
        points,
        stretches: Vec::new(),
        axis,
        outliers: Vec::new(),
        drive_errors,
        irregularities: Irregularities::default(),
    })
}

/// Samples below which a piece between two pauses is left out.
const SHORTEST: usize = 12;

fn cut(
    path: &Path,
    samples: &Samples,
    axis: Option<AxisKind>,
    how: &Preparation,
    place: impl Fn(usize) -> String,
) -> Result<FrictionRecording, RecordingError> {
    let timing =
        Timing::of(path, &samples.time, how.tolerance, place)?.longer_than(path, SHORTEST)?;
    let mut found = FrictionRecording {
        path: path.into(),
        points: Vec::new(),
        stretches: Vec::new(),
        samples: samples.time.len(),
        axis,
        outliers: Vec::new(),
        drive_errors: how.drive_errors(),
        irregularities: timing.irregularities,
    };
    for even in &timing.stretches {
        let (stretch, constants) = prepare(samples, even, how, &mut found)
            .map_err(|source| RecordingError::Unusable { path: path.into(), source })?;
        let steady = steady_part(&stretch);
        for (error, constant) in found.drive_errors.iter_mut().zip(constants) {
            match &steady {
                Some(part) => {
                    let torque = constant.torque.get(part.clone()).unwrap_or_default();
                    error.points.push(torque.iter().sum::<f64>() / torque.len().max(1) as f64);
                }
                None => error.stretches.push(constant.torque),
            }
        }
        match steady {
            Some(part) => found.points.push(cropped(&stretch, part).steady_point()),
            None => found.stretches.push(stretch),
        }
    }
    Ok(found)
}

fn prepare(
    samples: &Samples,
    even: &EvenStretch,
    how: &Preparation,
    found: &mut FrictionRecording,
) -> Result<(Stretch, Vec<ConstantError>), IdentError> {
    let dt = even.time_step;
    let mut clean = |channel: &'static str, values: &[f64]| -> Result<Vec<f64>, IdentError> {
        let Some(hampel) = how.outliers else { return Ok(values.to_vec()) };
        let cleaned = hampel.clean(values)?;
        found.outliers.extend(cleaned.replaced.iter().map(|replaced| Outlier {
            channel,
            time: even.start + replaced.index as f64 * dt,
            measured: replaced.measured,
            by: replaced.by,
        }));
        Ok(cleaned.signal)
    };
    let column = clean("force", &even.channel(&samples.force, None))?;
    let velocity = samples.velocity.as_ref().map(|values| even.channel(values, None));
    let velocity = velocity.map(|values| clean("velocity", &values)).transpose()?;
    let position = samples.position.as_ref().map(|values| even.channel(values, samples.step));
    let position = position.map(|values| clean("position", &values)).transpose()?;
    // An encoder's steps are no motion: beside a measured velocity such a position says little,
    // alone its path between the counts is used.
    let step = position.as_deref().and_then(step_of);
    let position = match (position, step, &velocity) {
        (Some(_), Some(_), Some(_)) => None,
        (Some(position), Some(step), None) => Some(between_steps(position, step)?),
        (position, ..) => position,
    };

    let filter = SavitzkyGolay::new(3, frame(dt, even.len()))?;
    let rate = 1.0 / dt;
    let smooth = |signal: &[f64]| -> Result<Vec<f64>, IdentError> {
        match how.smoothing {
            Smoothing::SavitzkyGolay => filter.smooth(signal),
            Smoothing::Butterworth => {
                let cutoff = how.cutoff.unwrap_or((rate / 10.0).min(100.0));
                LowPass::butterworth(how.order, cutoff, rate)?.filter(signal)
            }
            Smoothing::None => Ok(signal.to_vec()),
        }
    };
    let position = position.map(|position| smooth(&position)).transpose()?;
    let from_position = velocity.is_none();
    let measured = match (velocity, &position) {
        (Some(velocity), _) => velocity,
        (None, Some(position)) => filter.derivative(position, dt)?,
        (None, None) => return Err(IdentError::NoMotion),
    };
    let signals = DriveSignals {
        time_step: dt,
        velocity: &measured,
        torque: &column,
        voltage: &column,
        current: &column,
    };
    // What the scatter of the samples is, the residuals of the fit say.
    let friction =
        friction_torque(how.torque, &signals, &how.constants(), &ChannelDeviations::default())?;
    let velocity = if from_position { measured } else { smooth(&measured)? };
    let thin = |values: Vec<f64>| decimate(&values, how.decimate);
    let mut stretch = Stretch::new(
        dt * how.decimate as f64,
        thin(velocity)?,
        position.map(thin).transpose()?,
        thin(friction.torque)?,
    )?;
    // Experiment 2 begins at a fortieth of its fastest velocity, and has slid before.
    let fastest = stretch.velocity.iter().fold(0.0f64, |fastest, v| fastest.max(v.abs()));
    if stretch.velocity.first().is_some_and(|v| v.abs() < 0.01 * fastest) {
        stretch.before = Before::Rested;
    } else if even.after_gap {
        // The motion went on while nothing was recorded.
        stretch.before = Before::Slid;
    }
    let thinned = |error: ConstantError| Ok(ConstantError { torque: thin(error.torque)?, ..error });
    let errors = friction.constants.into_iter().map(thinned).collect::<Result<_, IdentError>>()?;
    Ok((stretch, errors))
}

/// The position between the counts of an encoder \[m or rad\]. One that hardly moved has no path
/// between its counts and stays as it is.
fn between_steps(position: Vec<f64>, step: f64) -> Result<Vec<f64>, IdentError> {
    let first = position.first().copied().unwrap_or(0.0);
    match between_counts(&position, step, Turn::Sharp) {
        Ok(path) => Ok(path.into_iter().map(|x| first + x).collect()),
        Err(IdentError::TooFewSamples { .. }) => Ok(position),
        Err(error) => Err(error),
    }
}

/// Samples of the thesis's 31 ms, odd, five at least and no more than there are.
fn frame(dt: f64, samples: usize) -> usize {
    let half = (0.0155 / dt).round().clamp(2.0, 15.0) as usize;
    (2 * half + 1).min(samples - (samples + 1) % 2)
}

#[cfg(test)]
mod tests;
