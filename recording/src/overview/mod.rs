//! What a file holds, before anything is fitted: its columns and units, its times, gaps, rest and
//! ranges. A column that cannot be used is told, and the others are shown.

use std::path::{Path, PathBuf};

use friction_ident::one_speed::one_speed;
use friction_ident::quantiser::step_of;
use friction_ident::statistics::upper_median;
use serde::Serialize;

use super::column::Channel;
use super::grid::Input;
use super::joints::{self, Effort, JointChoice};
use super::remarks::{self, Angle, Read, Remarks, Used};
use super::sheet::{Dialect, Found, Loaded, Missing, Sheet, load};
use super::table::Columns;
use super::{RecordingError, rosbag, timing};
use crate::bag::BagReader;

/// Steps longer than so many usual ones are gaps.
const GAP: f64 = 3.0;
/// Below this fraction of the fastest motion an axis is taken to rest.
const REST: f64 = 0.01;

/// What a file holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Overview {
    /// The file or folder.
    pub path: PathBuf,
    /// How a table is written; none for a bag.
    pub dialect: Option<Dialect>,
    /// Names of all columns of a table, or of the topics of a bag.
    pub names: Vec<String>,
    /// Joints of a bag, or of a table whose columns stand for several.
    pub joints: Vec<String>,
    /// Samples with a value in every channel.
    pub samples: usize,
    /// Rows without a value in some channel.
    pub blank: usize,
    /// Its times; none where it has none.
    pub times: Option<Times>,
    /// The channels that were understood.
    pub channels: Vec<Seen>,
    /// What the axis does; none where no motion was understood.
    pub motion: Option<Moved>,
    /// What could not be understood, in sentences.
    pub problems: Vec<String>,
}

/// Times of the samples.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Times {
    /// Times from the first one \[s\].
    #[serde(skip)]
    pub values: Vec<f64>,
    /// From the first to the last \[s\].
    pub duration: f64,
    /// One by the median step \[Hz\].
    pub rate: f64,
    /// Shortest step \[s\].
    pub shortest: f64,
    /// Longest step \[s\].
    pub longest: f64,
    /// Steps longer than three usual ones.
    pub gaps: usize,
    /// Steps that do not go forwards.
    pub not_forwards: usize,
    /// Rate to which samples at irregular times would be brought \[Hz\]; none where they are even.
    pub resample_to: Option<f64>,
}

/// A channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Seen {
    /// What it holds.
    pub channel: Channel,
    /// Column, or field of a joint.
    pub name: String,
    /// The unit in its name; none where it is taken to be in SI units.
    pub unit: Option<String>,
    /// It is a time that is written as dates or times of day.
    pub dated: bool,
    /// Factor to SI units.
    pub scale: f64,
    /// Least value, in SI units.
    pub least: f64,
    /// Greatest value, in SI units.
    pub greatest: f64,
    /// Step of a quantiser that it comes from, in SI units.
    pub step: Option<f64>,
    /// All values, in SI units.
    #[serde(skip)]
    pub values: Vec<f64>,
}

/// What the axis does.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Moved {
    /// Share of the samples at rest: below a hundredth of the fastest motion.
    pub rest: f64,
    /// Share of the samples that move in the positive direction.
    pub forwards: f64,
    /// Share of the samples that move in the negative direction.
    pub backwards: f64,
    /// Changes of the direction.
    pub reversals: usize,
    /// Greatest speed \[m/s or rad/s\].
    pub fastest: f64,
    /// The speed, where the motion has only one and its turns \[m/s or rad/s\].
    pub one_speed: Option<f64>,
}

impl Overview {
    /// The channel, if it was understood.
    #[must_use]
    pub fn channel(&self, channel: Channel) -> Option<&Seen> {
        self.channels.iter().find(|seen| seen.channel == channel)
    }

    fn with_motion(mut self) -> Self {
        self.motion = self.moved();
        self
    }

    fn moved(&self) -> Option<Moved> {
        let velocity = match (self.channel(Channel::Velocity), self.channel(Channel::Position)) {
            (Some(velocity), _) => velocity.values.clone(),
            (None, Some(position)) => slopes(&self.times.as_ref()?.values, &position.values),
            (None, None) => return None,
        };
        let fastest = velocity.iter().fold(0.0f64, |most, v| most.max(v.abs()));
        let share = |is: &dyn Fn(f64) -> bool| {
            velocity.iter().filter(|v| is(**v)).count() as f64 / velocity.len().max(1) as f64
        };
        let slow = REST * fastest;
        let moving: Vec<f64> = velocity.iter().copied().filter(|v| v.abs() > slow).collect();
        Some(Moved {
            rest: share(&|v| v.abs() <= slow),
            forwards: share(&|v| v > slow),
            backwards: share(&|v| v < -slow),
            reversals: moving.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count(),
            fastest,
            one_speed: one_speed(&velocity),
        })
    }
}

/// Slopes over some fifty samples, so that the steps of an encoder are no motion.
fn slopes(time: &[f64], position: &[f64]) -> Vec<f64> {
    let n = time.len().min(position.len());
    let half = (n / 200).clamp(1, 25);
    (0..n)
        .map(|k| {
            let (from, to) = (k.saturating_sub(half), (k + half).min(n - 1));
            let seconds = time[to] - time[from];
            if seconds > 0.0 { (position[to] - position[from]) / seconds } else { 0.0 }
        })
        .collect()
}

/// Looks at a CSV file, an `.mcap` file or a bag's folder.
///
/// # Errors
/// [`RecordingError`] for a file that cannot be read, a row that is not as long as the others, and
/// a column or joint that was named and is not there.
pub fn look<'a>(
    input: impl Into<Input<'a>>,
    columns: &Columns,
    joint: &JointChoice,
) -> Result<Overview, RecordingError> {
    let input = input.into();
    let path = input.path();
    if input.is_bag() {
        return bag(path, joint);
    }
    table(path, load(input, &columns.layout)?, columns)
}

fn table<'a>(
    path: &Path,
    loaded: impl Into<Loaded<'a>>,
    columns: &Columns,
) -> Result<Overview, RecordingError> {
    let loaded = loaded.into();
    let mut sheet = Sheet::open(path, &loaded, &columns.layout, "t_s,position_m,force_N")?;
    let mut problems = sheet.left_out().to_vec();
    let mut found: Vec<(Channel, Found)> = Vec::new();
    let joints = sheet.joints();
    let (mut several, mut missing) = (false, Vec::new());
    for (channel, named) in [
        (Channel::Time, columns.time.as_ref()),
        (Channel::Position, columns.position.as_ref()),
        (Channel::Velocity, columns.velocity.as_ref()),
        (Channel::Force, columns.force.as_ref()),
        (Channel::Voltage, None),
        (Channel::Current, None),
        (Channel::Friction, None),
    ] {
        match sheet.optional(channel, named) {
            Ok(Some(column)) => found.push((channel, column)),
            Ok(None) => missing.push(channel),
            Err(error @ (RecordingError::NoColumn { .. } | RecordingError::NoJoint { .. })) => {
                return Err(error);
            }
            Err(RecordingError::SeveralJoints { .. }) => several = true,
            Err(error) => problems.push(error.to_string()),
        }
    }
    // As they are read: a motion is guessed where neither position nor velocity has a usual name.
    let lacks = |channel: Channel| missing.contains(&channel);
    let still = lacks(Channel::Position) && lacks(Channel::Velocity);
    for channel in missing.iter().copied() {
        let wanted = match channel {
            Channel::Time => columns.layout.period.is_none(),
            Channel::Position | Channel::Velocity => still,
            _ => true,
        };
        match sheet.guessed(channel) {
            Ok(Some(column)) if wanted => found.push((channel, column)),
            Err(error) if wanted => problems.push(error.to_string()),
            _ => {}
        }
    }
    found.sort_by_key(|(channel, _)| *channel as usize);
    if several {
        let (path, present) = (path.into(), joints.join(", "));
        problems.push(RecordingError::SeveralJoints { path, present }.to_string());
    }
    if let (Some((_, time)), Some(period)) =
        (found.iter().find(|(channel, _)| *channel == Channel::Time), columns.layout.period)
    {
        let (path, column) = (path.into(), time.source.name.clone());
        return Err(RecordingError::TimeTwice { path, column, period });
    }
    let of = |wanted: Channel| {
        found.iter().find(|(channel, _)| *channel == wanted).map(|(_, column)| column)
    };
    if let (Some(motion), Some(force)) =
        (of(Channel::Velocity).or(of(Channel::Position)), of(Channel::Force))
        && let Err(error) = sheet.check_axis(motion, force)
    {
        problems.push(error.to_string());
    }
    if found.is_empty() && sheet.dialect.headerless {
        problems.push(sheet.no_header().to_string());
    }
    let wanted: Vec<&Found> = found.iter().map(|(_, found)| found).collect();
    let read = sheet.columns(&wanted, Missing::LeftOut)?;
    let mut times = columns.layout.period.map(|_| times_of(&sheet.periods(&read.rows)));
    let axis = of(Channel::Velocity).or(of(Channel::Position)).and_then(|found| found.axis);
    let axis = axis.or(of(Channel::Force).and_then(|force| force.axis));
    let mut remarks = Remarks::default();
    let mut values = read.values;
    for ((channel, column), values) in found.iter().zip(&mut values) {
        match (channel, &times) {
            (Channel::Time, _) => {
                remarks.time.scaled = remarks::scale_of(&sheet, *channel, column);
                match sheet.check_seconds(column, values) {
                    Ok(()) => times = Some(times_of(values)),
                    Err(error) => problems.push(error.to_string()),
                }
            }
            (Channel::Position, Some(times)) => {
                let angle = Angle::of(column, axis);
                remarks.wrapped = remarks::unwrap(&times.values, values, angle);
            }
            _ => {}
        }
    }
    if let Some(times) = &times {
        let column = |wanted: Channel| {
            let all = found.iter().zip(&values);
            all.filter(|((channel, _), _)| *channel == wanted)
                .map(|((_, column), values)| (column, &values[..]))
                .next()
        };
        let driving = [Channel::Force, Channel::Friction, Channel::Current].into_iter();
        let read = Read {
            sheet: &sheet,
            time: &times.values,
            axis,
            position: column(Channel::Position),
            velocity: column(Channel::Velocity),
            used: if columns.velocity.is_some() { Used::Velocity } else { Used::Position },
            all: true,
            force: driving.filter_map(|channel| Some((channel, column(channel)?))).next(),
        };
        remarks = read.remarks(remarks);
    }
    let mut channels = Vec::new();
    for ((channel, column), values) in found.into_iter().zip(values) {
        let Found { source, written, .. } = column;
        let dated = channel == Channel::Time && sheet.has_dates();
        channels.push(Seen { dated, ..seen(channel, source.name, written, source.scale, values) });
    }
    let said = remarks.doubts().into_iter().chain(remarks.sentences());
    problems.extend(said.map(|said| format!("{said}.")));
    Ok(Overview {
        path: path.into(),
        dialect: Some(sheet.dialect),
        names: sheet.names,
        joints,
        samples: read.lines.len(),
        blank: read.blank,
        times,
        channels,
        motion: None,
        problems,
    }
    .with_motion())
}

fn bag(path: &Path, choice: &JointChoice) -> Result<Overview, RecordingError> {
    let bag = BagReader::open(path)?;
    let mut overview = Overview {
        path: path.into(),
        dialect: None,
        names: bag.topics().iter().map(|topic| topic.name.clone()).collect(),
        joints: Vec::new(),
        samples: 0,
        blank: 0,
        times: None,
        channels: Vec::new(),
        motion: None,
        problems: Vec::new(),
    };
    overview.joints = joints::names(&bag)?;
    if let Err(error @ RecordingError::EffortMeaning { .. }) = joints::read(path, &bag, choice) {
        overview.problems.push(error.to_string());
    }
    // It is shown whatever it is.
    let shown = JointChoice {
        name: choice.name.clone(),
        effort: Some(choice.effort.unwrap_or(Effort::Driving)),
    };
    let mut samples = match joints::read(path, &bag, &shown) {
        Ok(joint) => joint.samples,
        Err(error @ RecordingError::SeveralJoints { .. }) => {
            overview.problems.push(error.to_string());
            return Ok(overview);
        }
        Err(error) => return Err(error),
    };
    if samples.is_empty() {
        overview.problems.push(format!("{} has no message", joints::topic(&bag)));
        return Ok(overview);
    }
    samples.sort_by_key(|sample| sample.stamp);
    let fields: [(Channel, &str, joints::Field); 3] = [
        (Channel::Position, "position", |sample| sample.position),
        (Channel::Velocity, "velocity", |sample| sample.velocity),
        (Channel::Force, "effort", |sample| sample.effort),
    ];
    let (there, missing): (Vec<_>, Vec<_>) =
        fields.into_iter().partition(|(_, _, of)| joints::has(&samples, *of));
    for (_, name, of) in missing {
        let without = samples.iter().filter(|sample| of(sample).is_none()).count();
        overview.problems.push(format!(
            "{without} of {} messages have no {name} that is a number",
            samples.len()
        ));
    }
    // As they are left out when they are read.
    let all = samples.len();
    samples.retain(|sample| there.iter().all(|(_, _, of)| of(sample).is_some()));
    overview.blank = all - samples.len();
    let start = samples.first().map_or(0, |sample| sample.stamp);
    let since: Vec<f64> =
        samples.iter().map(|sample| sample.stamp.saturating_sub(start) as f64 * 1e-9).collect();
    overview.samples = samples.len();
    overview.times = Some(times_of(&since));
    let mut remarks = Remarks::default();
    for (channel, name, of) in there {
        let mut values: Vec<f64> = samples.iter().filter_map(of).collect();
        if channel == Channel::Position {
            remarks.wrapped = remarks::unwrap(&since, &mut values, Angle::RADIANS);
        }
        overview.channels.push(seen(channel, name.to_owned(), None, 1.0, values));
    }
    let of = |channel| overview.channel(channel).map(|seen| &seen.values[..]);
    let channels = [Channel::Position, Channel::Velocity, Channel::Force].map(of);
    let remarks = rosbag::told(remarks, &since, channels);
    let said = remarks.doubts().into_iter().chain(remarks.sentences());
    overview.problems.extend(said.map(|said| format!("{said}.")));
    Ok(overview.with_motion())
}

fn seen(
    channel: Channel,
    name: String,
    unit: Option<String>,
    scale: f64,
    values: Vec<f64>,
) -> Seen {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let step = (channel == Channel::Position).then(|| step_of(&values)).flatten();
    Seen { channel, name, unit, dated: false, scale, least, greatest, step, values }
}

fn times_of(time: &[f64]) -> Times {
    let start = time.first().copied().unwrap_or(0.0);
    let steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut forwards: Vec<f64> = steps.iter().copied().filter(|step| *step > 0.0).collect();
    let usual = upper_median(&mut forwards).unwrap_or(f64::NAN);
    Times {
        values: time.iter().map(|t| t - start).collect(),
        duration: time.last().map_or(0.0, |last| last - start),
        rate: 1.0 / usual,
        shortest: forwards.iter().copied().fold(f64::INFINITY, f64::min),
        longest: forwards.iter().copied().fold(0.0, f64::max),
        gaps: steps.iter().filter(|step| **step > GAP * usual).count(),
        not_forwards: steps.iter().filter(|step| **step <= 0.0).count(),
        resample_to: timing::rate_for(time),
    }
}

#[cfg(test)]
mod tests;
