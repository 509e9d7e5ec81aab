//! Recordings as inputs: a table of numbers or a bag becomes evenly sampled channels, or a clear
//! refusal.
//!
//! [`stretches`] reads recordings of friction, one or many runs in a file, from a torque sensor or
//! worked out of what drives the axis; [`drive_error`] is what the drive's constants then leave
//! uncertain. [`table`] reads CSV, [`rosbag`] reads MCAP bags, [`driven`] reads voltage and motion
//! from either, [`trajectory`] reads motions at any spacing, [`servo_log`] the JSON logs of a
//! position-controlled servo; [`sheet`] is how a table is written, [`mod@column`] how a person names
//! a column, [`units`] which units its name may tell, [`csv_table`] writes tables, [`timing`] makes
//! evenly sampled stretches of what was recorded, [`irregularities`] says what was uneven, and
//! [`remarks`] what is to be said of the values. The cycles of a bag stand at the times of the rig's
//! own clock. Whatever is returned has finite values, one length and SI units.

pub mod bag;
mod beside;
pub mod column;
pub mod column_options;
pub mod csv_table;
pub mod drive_error;
pub mod driven;
mod error;
pub mod grid;
pub mod irregularities;
mod joined;
pub mod joints;
pub mod layout;
pub mod overview;
#[cfg(feature = "ros")]
pub mod record;
pub mod remarks;
mod rig_clock;
pub mod rosbag;
pub mod servo_log;
pub mod sheet;
pub mod stiction_table;
pub mod stretches;
pub mod table;
pub mod timing;
pub mod trajectory;
pub mod units;

use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::Serialize;

pub use beside::Beside;
pub use column::Column;
pub use error::RecordingError;
pub use irregularities::Irregularities;
pub use joined::joined;
pub use remarks::Remarks;
use timing::Timing;

/// Whether a path is a bag: a file of one, or a folder that holds no tables.
#[must_use]
pub fn is_bag(path: &Path) -> bool {
    let ends = |file: &Path| {
        let name = file.to_string_lossy();
        bag::ENDINGS.iter().any(|ending| name.ends_with(ending))
    };
    if !path.is_dir() {
        return ends(path);
    }
    let mut inside = std::fs::read_dir(path).into_iter().flatten().flatten();
    let described =
        |file: &Path| file.file_name().is_some_and(|name| name == "metadata.yaml") || ends(file);
    inside.any(|file| described(&file.path())) || !sheet::has_tables(path)
}

/// Whether the axis moves along a line or turns; decides the units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum AxisKind {
    /// Metres, newtons, kilograms.
    Linear,
    /// Radians, newton metres, kilogram square metres.
    Rotary,
}

impl AxisKind {
    /// `force` or `torque`.
    pub fn force_word(self) -> &'static str {
        match self {
            Self::Linear => "force",
            Self::Rotary => "torque",
        }
    }

    /// Unit of a position.
    #[must_use]
    pub fn position_unit(self) -> &'static str {
        match self {
            Self::Linear => "m",
            Self::Rotary => "rad",
        }
    }

    /// Unit of the force.
    pub fn force_unit(self) -> &'static str {
        match self {
            Self::Linear => "N",
            Self::Rotary => "N m",
        }
    }

    /// Unit of the velocity.
    pub fn velocity_unit(self) -> &'static str {
        match self {
            Self::Linear => "m/s",
            Self::Rotary => "rad/s",
        }
    }

    /// Unit of the inertia.
    pub fn inertia_unit(self) -> &'static str {
        match self {
            Self::Linear => "kg",
            Self::Rotary => "kg m^2",
        }
    }

    /// Unit of viscous friction.
    pub fn viscous_unit(self) -> &'static str {
        match self {
            Self::Linear => "N s/m",
            Self::Rotary => "N m s/rad",
        }
    }
}

/// Where a channel came from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelSource {
    /// Column of a table, or topic and field of a bag.
    pub name: String,
    /// What its values were multiplied with.
    pub scale: f64,
}

/// The channels' sources.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sources {
    /// Time.
    pub time: ChannelSource,
    /// Position, where it was used.
    pub position: Option<ChannelSource>,
    /// Velocity, where it was used.
    pub velocity: Option<ChannelSource>,
    /// Force or torque.
    pub force: ChannelSource,
}

/// A stretch of a recording without a gap.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedStretch {
    /// Time of its first sample, counted from the first one of the recording \[s\].
    pub start: f64,
    /// Its samples among all of the recording.
    pub samples: Range<usize>,
    /// The file it comes from, with the time of that one's first sample \[s\], where several were
    /// joined.
    pub file: Option<(PathBuf, f64)>,
}

impl RecordedStretch {
    /// A recording that is all one stretch.
    #[must_use]
    pub fn whole(samples: usize) -> Vec<Self> {
        vec![Self { start: 0.0, samples: 0..samples, file: None }]
    }

    /// The stretches of `timing`, each without its last `less` samples.
    fn of(timing: &Timing, less: usize) -> Vec<Self> {
        let origin = timing.stretches.first().map_or(0.0, |first| first.start);
        let mut end = 0;
        let one = |stretch: &timing::EvenStretch| {
            let samples = end..end + stretch.len().saturating_sub(less);
            end = samples.end;
            Self { start: stretch.start - origin, samples, file: None }
        };
        timing.stretches.iter().map(one).collect()
    }
}

/// A recording of one axis, evenly sampled within each of its stretches.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// The file or folder.
    pub path: PathBuf,
    /// Sampling period \[s\].
    pub time_step: f64,
    /// Position \[m or rad\].
    pub position: Option<Vec<f64>>,
    /// Position as its sensor gave it \[m or rad\], where the samples were brought to another rate
    /// and `position` went through a low-pass for that: it shows where the axis sticks.
    pub readings: Option<Vec<f64>>,
    /// Velocity \[m/s or rad/s\]; used in place of the position where given.
    pub velocity: Option<Vec<f64>>,
    /// Force \[N\] or torque \[N m\].
    pub force: Vec<f64>,
    /// Stretches between gaps; one at least.
    pub stretches: Vec<RecordedStretch>,
    /// What was uneven.
    pub irregularities: Irregularities,
    /// Kind of axis as the column names tell it; none where they do not.
    pub axis: Option<AxisKind>,
    /// The force is friction alone, as a bag's friction torque is, and not what drives the axis.
    pub friction_only: bool,
    /// Where the channels came from.
    pub sources: Sources,
    /// Other joints that move in the same recording.
    pub beside: Vec<Beside>,
}

impl Recording {
    /// Samples in each channel.
    pub fn samples(&self) -> usize {
        self.force.len()
    }

    /// Time between the first and the last sample \[s\].
    pub fn duration(&self) -> f64 {
        let end = |stretch: &RecordedStretch| {
            stretch.start + self.time_step * stretch.samples.len().saturating_sub(1) as f64
        };
        self.stretches.last().map_or(0.0, end)
    }
}

/// The samples of all stretches of a channel, one stretch behind the other; `step` is that of a
/// quantiser.
fn all_stretches(timing: &Timing, recorded: &[f64], step: Option<f64>) -> Vec<f64> {
    timing.stretches.iter().flat_map(|stretch| stretch.channel(recorded, step)).collect()
}

/// The readings of a position on the even grid, where that is not what [`position_of`] gives.
fn readings_of(timing: &Timing, recorded: &[f64]) -> Option<Vec<f64>> {
    let of = timing.stretches.iter().map(|stretch| stretch.nearest(recorded));
    Some(of.collect::<Option<Vec<_>>>()?.concat())
}

/// A position on the even grid. That of an encoder keeps to its counts.
fn position_of(timing: &Timing, recorded: &[f64]) -> Vec<f64> {
    all_stretches(timing, recorded, friction_ident::quantiser::step_of(recorded))
}
