//! A recording from a CSV file: a header with column names, then one line a sample.
//!
//! Columns are named on the command line, by name or by number, or recognised by their names; a
//! unit in a name is converted. [`sheet`](super::sheet) says how the text is read.

use std::path::Path;

use super::beside::Beside;
use super::column::Channel;
use super::grid::Input;
use super::layout::Layout;
use super::remarks::{self, Angle, Read, Remarks, Used};
use super::sheet::{Cells, Dialect, Found, Loaded, Missing, Sheet, load};
use super::timing::{Steps, Timing};
use super::{AxisKind, ChannelSource, Column, RecordedStretch, Recording, RecordingError, Sources};

/// What the column of the force holds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Measured {
    /// Force or torque.
    #[default]
    Force,
    /// Voltage of the motor.
    Voltage,
    /// Current of the motor.
    Current,
}

impl Measured {
    pub(super) const fn channel(self) -> Channel {
        match self {
            Self::Force => Channel::Force,
            Self::Voltage => Channel::DrivingVoltage,
            Self::Current => Channel::Current,
        }
    }
}

/// Which columns hold what; what is not named is recognised.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    /// Time.
    pub time: Option<Column>,
    /// Position.
    pub position: Option<Column>,
    /// Velocity; used in place of the position only where named, or where there is no position.
    pub velocity: Option<Column>,
    /// Force or torque, or what is measured in its place.
    pub force: Option<Column>,
    /// What that column holds.
    pub measured: Measured,
    /// What the table needs besides.
    pub layout: Layout,
}

/// Reads a table. `steps` says which time steps are even;
/// [`timing`](super::timing) says what becomes of others.
///
/// # Errors
/// [`RecordingError`], naming the file and, where there is one, the line and the column.
pub fn read<'a>(
    input: impl Into<Input<'a>>,
    columns: &Columns,
    steps: impl Into<Steps>,
) -> Result<Recording, RecordingError> {
    let input = input.into();
    parse(input.path(), load(input, &columns.layout)?, columns, steps)
}

/// The part of [`read`] that does not touch the disk.
fn parse<'a>(
    path: &Path,
    loaded: impl Into<Loaded<'a>>,
    columns: &Columns,
    steps: impl Into<Steps>,
) -> Result<Recording, RecordingError> {
    let rows = rows(path, &loaded.into(), columns, Motion::One)?;
    let timing = Timing::of(path, &rows.time, steps, |index| rows.place(index))?
        .of_one_rate()
        .written_as(rows.blank, rows.dialect);
    Ok(Recording {
        path: path.into(),
        time_step: timing.stretches[0].time_step,
        readings: rows.position.as_ref().and_then(|read| super::readings_of(&timing, read)),
        position: rows.position.map(|position| super::position_of(&timing, &position)),
        velocity: rows.velocity.map(|velocity| super::all_stretches(&timing, &velocity, None)),
        force: super::all_stretches(&timing, &rows.force, None),
        stretches: RecordedStretch::of(&timing, 0),
        irregularities: timing.irregularities.remarking(rows.remarks),
        axis: rows.axis,
        friction_only: false,
        sources: rows.sources,
        beside: rows.beside,
    })
}

/// Which of position and velocity are read where a table has both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    /// The position, unless the velocity was named.
    One,
    /// Both.
    Both,
}

/// The rows of a table, at whatever times.
pub(super) struct Rows {
    pub time: Vec<f64>,
    pub position: Option<Vec<f64>>,
    pub velocity: Option<Vec<f64>>,
    pub force: Vec<f64>,
    pub axis: Option<AxisKind>,
    pub sources: Sources,
    /// Other joints that move.
    pub beside: Vec<Beside>,
    /// Rows without a value in one of the columns, left out.
    pub blank: usize,
    /// How the table is written.
    pub dialect: Dialect,
    /// What is to be said of the values.
    pub remarks: Remarks,
    lines: Vec<u64>,
}

impl Rows {
    /// Where row `index` stands.
    pub fn place(&self, index: usize) -> String {
        self.dialect.place(self.lines.get(index).copied().unwrap_or(0))
    }
}

/// Reads all rows; one at least.
pub(super) fn rows(
    path: &Path,
    loaded: &Loaded<'_>,
    columns: &Columns,
    motion: Motion,
) -> Result<Rows, RecordingError> {
    let mut sheet = Sheet::open(path, loaded, &columns.layout, "t_s,position_m,force_N")?;
    let time = sheet.time(columns.time.as_ref())?;
    let velocity = sheet.optional(Channel::Velocity, columns.velocity.as_ref())?;
    let position = sheet.optional(Channel::Position, columns.position.as_ref())?;
    let (position, velocity) = sheet.or_guessed(position, velocity)?;
    let (position, velocity, unused) = match (position, velocity) {
        (None, None) => return Err(sheet.unrecognised(Channel::Position)),
        (Some(position), velocity @ Some(_))
            if motion == Motion::One && columns.velocity.is_none() =>
        {
            (Some(position), None, velocity)
        }
        (position, velocity) => (position, velocity, None),
    };
    let force = sheet.require(columns.measured.channel(), columns.force.as_ref())?;
    if let Some(motion) = velocity.as_ref().or(position.as_ref()) {
        sheet.check_axis(motion, &force)?;
    }
    let wanted: Vec<&Found> =
        [&force].into_iter().chain(&time).chain(&position).chain(&velocity).collect();
    let Cells { values, lines, rows, blank } =
        sheet.columns_beside(&wanted, Missing::LeftOut, &unused.iter().collect::<Vec<_>>())?;
    let mut values = values.into_iter();
    let mut next = || values.next().unwrap_or_default();
    let forces = next();
    let time_scaled = time.as_ref().and_then(|time| remarks::scale_of(&sheet, Channel::Time, time));
    let (times, time) = match time {
        Some(time) => {
            let times = next();
            sheet.check_seconds(&time, &times)?;
            (times, time.source)
        }
        None => (sheet.periods(&rows), ChannelSource { name: "--period".to_owned(), scale: 1.0 }),
    };
    let mut positions = position.as_ref().map(|_| next());
    let velocities = velocity.as_ref().map(|_| next());
    let moving = velocity.as_ref().or(position.as_ref());
    let axis = moving.and_then(|found| found.axis).or(force.axis);
    let other = unused.as_ref().map(|_| next());
    let mut remarks = Remarks::default();
    if let (Some(found), Some(values)) = (&position, &mut positions) {
        remarks.wrapped = remarks::unwrap(&times, values, Angle::of(found, axis));
    }
    remarks.time.scaled = time_scaled;
    let used = match (&unused, columns.velocity.is_some() && motion == Motion::One) {
        (Some(_), _) => Used::Position,
        (None, true) => Used::Velocity,
        (None, false) => Used::Both,
    };
    let read = Read {
        sheet: &sheet,
        time: &times,
        axis,
        position: position.as_ref().zip(positions.as_deref()),
        velocity: velocity
            .as_ref()
            .or(unused.as_ref())
            .zip(velocities.as_deref().or(other.as_deref())),
        used,
        all: false,
        force: Some((columns.measured.channel(), (&force, &forces))),
    };
    let remarks = read.remarks(remarks);
    let named = moving.and_then(|found| sheet.joint_of(found)).map(str::to_owned);
    Ok(Rows {
        time: times,
        position: positions,
        velocity: velocities,
        force: forces,
        axis,
        sources: Sources {
            time,
            position: position.map(|found| found.source),
            velocity: velocity.map(|found| found.source),
            force: force.source,
        },
        beside: beside(path, loaded, columns, named)?,
        blank,
        dialect: sheet.dialect,
        remarks,
        lines,
    })
}

/// The joints that move beside the one that was chosen, or whose columns were `named`.
///
/// Where columns were named, another that is called alike may be a second encoder of the same axis,
/// so that only what has a force or torque of its own counts as a joint.
fn beside(
    path: &Path,
    loaded: &Loaded<'_>,
    columns: &Columns,
    named: Option<String>,
) -> Result<Vec<Beside>, RecordingError> {
    let chosen = columns.layout.joint.clone();
    let Some(joint) = chosen.clone().or(named) else { return Ok(Vec::new()) };
    let mut sheet = Sheet::open(path, loaded, &columns.layout, "t_s,q1,tau1,q2,tau2")?;
    let driven = sheet.others(columns.measured.channel(), &joint);
    let is_driven = |label: &String| driven.iter().any(|(other, _)| other == label);
    let (names, found): (Vec<String>, Vec<Found>) = sheet
        .others(Channel::Position, &joint)
        .into_iter()
        .filter(|(label, _)| chosen.is_some() || is_driven(label))
        .unzip();
    if found.is_empty() {
        return Ok(Vec::new());
    }
    let Cells { values, .. } = sheet.columns(&found.iter().collect::<Vec<_>>(), Missing::AsNan)?;
    let of = |(name, values): (String, Vec<f64>)| Beside::of(&name, values.into_iter());
    Ok(names.into_iter().zip(values).filter_map(of).collect())
}

#[cfg(test)]
mod tests;
