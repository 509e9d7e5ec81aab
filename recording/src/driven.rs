//! A recording of a drive: voltage, motion and, where there is one, the friction torque; from a CSV
//! file or a bag.

use std::path::{Path, PathBuf};

use msgs::friction_msgs::RigMeasurement;

use super::column::Channel;
use super::layout::Layout;
use super::remarks::{self, Angle, Read, Remarks, Used};
use super::rig_clock::{self, RIG_MEASUREMENT};
use super::sheet::{Cells, Found, Loaded, Missing, Sheet, load};
use super::timing::{Steps, Timing};
use super::{AxisKind, Column, Irregularities, RecordedStretch, RecordingError, is_bag};
use crate::bag::BagReader;

/// A recording of a drive, evenly sampled within each of its stretches. A voltage held over a
/// sample stands at its beginning.
#[derive(Debug, Clone, PartialEq)]
pub struct DrivenRecording {
    /// The file or folder.
    pub path: PathBuf,
    /// Sampling period \[s\].
    pub time_step: f64,
    /// Voltage \[V\].
    pub voltage: Vec<f64>,
    /// Position \[m or rad\].
    pub position: Option<Vec<f64>>,
    /// Velocity \[m/s or rad/s\]; used in place of the position where given.
    pub velocity: Option<Vec<f64>>,
    /// Friction force \[N\] or torque \[N m\].
    pub friction: Option<Vec<f64>>,
    /// Stretches between gaps; one at least.
    pub stretches: Vec<RecordedStretch>,
    /// What was uneven.
    pub irregularities: Irregularities,
    /// The recording keeps one control cycle in so many; one where it keeps all, or does not tell.
    pub one_cycle_in: u64,
    /// Kind of axis as the names tell it.
    pub axis: Option<AxisKind>,
}

/// Which columns hold what; what is not named is recognised.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DrivenColumns {
    /// Time.
    pub time: Option<Column>,
    /// Voltage.
    pub voltage: Option<Column>,
    /// Position.
    pub position: Option<Column>,
    /// Velocity; used in place of the position only where named, or where there is no position.
    pub velocity: Option<Column>,
    /// Friction force or torque from a sensor.
    pub friction: Option<Column>,
    /// What the table needs besides.
    pub layout: Layout,
}

/// Reads a CSV file, an MCAP file or a bag folder. `steps` says which time steps
/// are even.
///
/// # Errors
/// [`RecordingError`], naming the file and, where there is one, the line, column or message.
pub fn read(
    path: &Path,
    columns: &DrivenColumns,
    steps: impl Into<Steps>,
) -> Result<DrivenRecording, RecordingError> {
    if is_bag(path) {
        return from_bag(path, steps);
    }
    from_table(path, load(path, &columns.layout)?, columns, steps)
}

fn from_table<'a>(
    path: &Path,
    loaded: impl Into<Loaded<'a>>,
    columns: &DrivenColumns,
    steps: impl Into<Steps>,
) -> Result<DrivenRecording, RecordingError> {
    let loaded = loaded.into();
    let mut sheet = Sheet::open(path, &loaded, &columns.layout, "t_s,voltage_V,position_rad")?;
    let timed = sheet.time(columns.time.as_ref())?;
    let voltage = sheet.require(Channel::Voltage, columns.voltage.as_ref())?;
    let position = sheet.optional(Channel::Position, columns.position.as_ref())?;
    let velocity = sheet.optional(Channel::Velocity, columns.velocity.as_ref())?;
    let (mut position, mut velocity) = sheet.or_guessed(position, velocity)?;
    let friction = sheet.optional(Channel::Friction, columns.friction.as_ref())?;
    let (mut used, mut unused) = (Used::Position, None);
    match (&position, &velocity) {
        (None, None) => return Err(sheet.unrecognised(Channel::Position)),
        (Some(_), Some(_)) if columns.velocity.is_none() => unused = velocity.take(),
        (Some(_), Some(_)) => (used, unused) = (Used::Velocity, position.take()),
        _ => {}
    }
    let axis = position.as_ref().or(velocity.as_ref()).and_then(|found| found.axis);
    let wanted: Vec<&Found> = [&voltage]
        .into_iter()
        .chain(&timed)
        .chain(&position)
        .chain(&velocity)
        .chain(&friction)
        .collect();
    let Cells { values, lines, rows, blank } =
        sheet.columns_beside(&wanted, Missing::LeftOut, &unused.iter().collect::<Vec<_>>())?;
    let mut values = values.into_iter();
    let mut next = || values.next().unwrap_or_default();
    let voltages = next();
    let mut remarks = Remarks::default();
    let time = match timed {
        Some(timed) => {
            let time = next();
            sheet.check_seconds(&timed, &time)?;
            remarks.time.scaled = remarks::scale_of(&sheet, Channel::Time, &timed);
            time
        }
        None => sheet.periods(&rows),
    };
    let mut positions = position.as_ref().map(|_| next());
    let velocities = velocity.as_ref().map(|_| next());
    let frictions = friction.as_ref().map(|_| next());
    let mut others = unused.as_ref().map(|_| next());
    // The position that is used, or the one beside a velocity.
    let place = position.as_ref().or(unused.as_ref().filter(|_| used == Used::Velocity));
    let places = if position.is_some() { &mut positions } else { &mut others };
    if let (Some(found), Some(values)) = (place, places.as_mut()) {
        let wrapped = remarks::unwrap(&time, values, Angle::of(found, axis));
        remarks.wrapped = wrapped.filter(|_| position.is_some());
    }
    let motion = |own: bool| if own { positions.as_deref() } else { others.as_deref() };
    let speed = velocity.as_ref().or(unused.as_ref().filter(|_| used == Used::Position));
    let read = Read {
        sheet: &sheet,
        time: &time,
        axis,
        position: place.zip(motion(position.is_some())),
        velocity: speed.zip(velocities.as_deref().or(others.as_deref())),
        used,
        all: false,
        force: friction.as_ref().zip(frictions.as_deref()).map(|read| (Channel::Friction, read)),
    };
    remarks = read.remarks(remarks);
    let timing = Timing::of(path, &time, steps, |index| sheet.place(lines[index]))?
        .of_one_rate()
        .written_as(blank, sheet.dialect);
    let channel = |values: Vec<f64>| super::all_stretches(&timing, &values, None);
    Ok(DrivenRecording {
        path: path.into(),
        time_step: timing.stretches[0].time_step,
        voltage: channel(voltages),
        position: positions.map(|position| super::position_of(&timing, &position)),
        velocity: velocities.map(channel),
        friction: frictions.map(channel),
        axis,
        stretches: RecordedStretch::of(&timing, 0),
        irregularities: timing.irregularities.remarking(remarks),
        one_cycle_in: 1,
    })
}

/// The tachometer's velocity, the torque sensor, and the voltage moved to the beginning of the
/// cycle over which it was applied: a message carries that of the cycle before.
fn from_bag(path: &Path, steps: impl Into<Steps>) -> Result<DrivenRecording, RecordingError> {
    let bag = BagReader::open(path)?;
    let mut messages = bag.messages::<RigMeasurement>(RIG_MEASUREMENT)?;
    for (index, (_, rig)) in messages.iter().enumerate() {
        let finite = [rig.tachometer_velocity, rig.voltage_applied, rig.torque]
            .iter()
            .all(|v| v.is_finite());
        if !finite {
            let detail =
                "velocity, voltage and torque are expected to be finite; cut the bag there"
                    .to_owned();
            let (path, topic) = (path.into(), RIG_MEASUREMENT.to_owned());
            return Err(RecordingError::Message { path, topic, index: index + 1, detail });
        }
    }
    // A bag is in the order of its log; what counts is when the sample was taken.
    messages.sort_by_key(|(_, rig)| rig.header.stamp.to_nanos());
    let start = messages.first().map_or(0, |(_, rig)| rig.header.stamp.to_nanos());
    let since =
        |rig: &RigMeasurement| rig.header.stamp.to_nanos().saturating_sub(start) as f64 * 1e-9;
    let cycles: Vec<(u64, f64)> =
        messages.iter().map(|(_, rig)| (rig.header.stamp.to_nanos(), rig.rig_time)).collect();
    let time = rig_clock::times(&cycles)
        .unwrap_or_else(|| messages.iter().map(|(_, rig)| since(rig)).collect());
    let place = |index: usize| format!("message {} of {RIG_MEASUREMENT}", index + 1);
    let timing = Timing::of(path, &time, steps, place)?.of_one_rate();
    // The voltage of a sample stands in the next one of its own stretch; the last one has none.
    let channel = |of: fn(&RigMeasurement) -> f64, later: usize| -> Vec<f64> {
        let recorded: Vec<f64> = messages.iter().map(|(_, rig)| of(rig)).collect();
        let own = |stretch: &super::timing::EvenStretch| {
            let even = stretch.channel(&recorded, None);
            even[later..even.len() - 1 + later].to_vec()
        };
        timing.stretches.iter().flat_map(own).collect()
    };
    Ok(DrivenRecording {
        path: path.into(),
        time_step: timing.stretches[0].time_step,
        voltage: channel(|rig| rig.voltage_applied, 1),
        position: None,
        velocity: Some(channel(|rig| rig.tachometer_velocity, 0)),
        friction: Some(channel(|rig| rig.torque, 0)),
        axis: Some(AxisKind::Rotary),
        stretches: RecordedStretch::of(&timing, 1),
        irregularities: timing.irregularities,
        one_cycle_in: one_cycle_in(&messages, &timing),
    })
}

/// How many control cycles lie between two samples of the rate that is used, by the number of the
/// cycle.
fn one_cycle_in(messages: &[(u64, RigMeasurement)], timing: &Timing) -> u64 {
    let mut steps: Vec<u64> = timing
        .stretches
        .iter()
        .filter_map(|stretch| {
            let (first, next) = stretch.first_two()?;
            Some(messages.get(next)?.1.cycle.saturating_sub(messages.get(first)?.1.cycle))
        })
        .collect();
    steps.sort_unstable();
    steps.get(steps.len() / 2).copied().unwrap_or(1).max(1)
}
