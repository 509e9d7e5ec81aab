//! A recording of friction: stretches and steady points, from a CSV file or a bag.
//!
//! A file may hold many runs: it is cut at pauses, gaps and changes of the rate
//! ([`timing`](super::timing)). Runs at a constant velocity become steady points, without their
//! first fifth and last tenth, as in the thesis's experiment 1. A CSV file without a time column is
//! read as steady points.

mod pieces;
mod points;
mod prepare;

use std::path::{Path, PathBuf};

use friction_ident::quantiser::step_of;
use friction_ident::{
    DriveConstant, DriveConstants, Hampel, SteadyPoint, Stretch, TorqueSource, Uncertain,
};
use serde::Serialize;

use self::pieces::{cropped, steady_part};
use self::points::{is_points, points};
use self::prepare::prepare;
use super::drive_error::DriveError;
use super::grid::Input;
use super::joints::JointChoice;
use super::rosbag::{self, BagChannel};
use super::sheet::{Loaded, load};
use super::table::{self, Columns, Motion};
use super::timing::{Steps, TOLERANCE, Timing};
use super::{AxisKind, Irregularities, RecordingError};

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
    /// Rate to which uneven samples are brought \[Hz\].
    pub resample: Option<f64>,
    /// Which joint of a bag is read.
    pub joint: JointChoice,
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
            resample: None,
            joint: JointChoice::default(),
        }
    }
}

/// A sample that was replaced.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outlier {
    /// Channel.
    pub channel: &'static str,
    /// When \[s\].
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
pub fn read<'a>(
    input: impl Into<Input<'a>>,
    columns: &Columns,
    how: &Preparation,
) -> Result<FrictionRecording, RecordingError> {
    let input = input.into();
    let path = input.path();
    if input.is_bag() {
        let channel = match how.torque {
            TorqueSource::Voltage => BagChannel::Voltage,
            _ => BagChannel::Effort(how.joint.clone()),
        };
        let track = rosbag::track(path, &channel)?;
        let samples = Samples {
            time: track.time,
            step: track.position.as_deref().and_then(step_of),
            position: track.position,
            velocity: track.velocity,
            force: track.force,
        };
        let place = |index: usize| format!("message {} of {}", index + 1, track.topic);
        let without = |mut timing: Timing| {
            let irregularities = timing.irregularities.without(track.blank);
            timing.irregularities = irregularities.remarking(track.remarks);
            timing
        };
        return cut(path, &samples, Some(AxisKind::Rotary), how, place, without);
    }
    parse(path, load(input, &columns.layout)?, columns, how)
}

fn parse<'a>(
    path: &Path,
    loaded: impl Into<Loaded<'a>>,
    columns: &Columns,
    how: &Preparation,
) -> Result<FrictionRecording, RecordingError> {
    let loaded = &loaded.into();
    if is_points(path, loaded, columns) {
        return points(path, loaded, columns, how);
    }
    let rows = table::rows(path, loaded, columns, Motion::Both)?;
    let samples = Samples {
        time: rows.time.clone(),
        step: rows.position.as_deref().and_then(step_of),
        position: rows.position.clone(),
        velocity: rows.velocity.clone(),
        force: rows.force.clone(),
    };
    let written = |timing: Timing| {
        let mut timing = timing.written_as(rows.blank, rows.dialect);
        timing.irregularities = timing.irregularities.remarking(rows.remarks);
        timing
    };
    cut(path, &samples, rows.axis, how, |index| rows.place(index), written)
}

/// Whether the file is a table of steady points: a velocity and a torque, and no time.
pub fn holds_points<'a>(input: impl Into<Input<'a>>, columns: &Columns) -> bool {
    let input = input.into();
    !input.is_bag()
        && load(input, &columns.layout)
            .is_ok_and(|loaded| is_points(input.path(), &loaded, columns))
}

/// Samples below which a piece between two pauses is left out.
const SHORTEST: usize = 12;

fn cut(
    path: &Path,
    samples: &Samples,
    axis: Option<AxisKind>,
    how: &Preparation,
    place: impl Fn(usize) -> String,
    written: impl Fn(Timing) -> Timing,
) -> Result<FrictionRecording, RecordingError> {
    let steps = Steps { tolerance: how.tolerance, resample: how.resample };
    let timing = Timing::of(path, &samples.time, steps, place)?.longer_than(path, SHORTEST)?;
    let timing = written(timing);
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

#[cfg(test)]
mod tests;
