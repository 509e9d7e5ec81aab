//! A recording from a bag.
//!
//! From `/joint_states` come position, velocity and effort of one joint ([`joints`]);
//! the effort is friction (then there is no inertia in it to be found) or the driving torque. From
//! `/rig_measurement` of this laboratory comes the tachometer's velocity, with the driving torque
//! worked out from the voltage: `(A Km / Ra) (u - A Km w)`.

use std::collections::HashMap;
use std::path::Path;

use friction_model::Motor;
use msgs::friction_msgs::RigMeasurement;

use super::beside::Beside;
use super::joints::{self, Effort, Joint, JointChoice};
use super::remarks::{self, Angle, Both, Remarks, Used, Watched};
use super::rig_clock::{self, RIG_MEASUREMENT};
use super::timing::{Steps, Timing};
use super::{AxisKind, ChannelSource, RecordedStretch, Recording, RecordingError, Sources};
use crate::bag::BagReader;

/// Reads a bag. With a `motor` the torque is worked out from the voltage, without it is the effort
/// of the joint that was chosen. `steps` says which time steps are even.
///
/// # Errors
/// [`RecordingError::Bag`] for what cannot be read, [`RecordingError::Message`] for messages
/// without the fields needed, [`RecordingError::SeveralJoints`], [`RecordingError::NoJoint`] and
/// [`RecordingError::EffortMeaning`] for a choice that is missing, and those of [`Timing::of`].
pub fn read(
    path: &Path,
    motor: Option<&Motor>,
    joint: &JointChoice,
    steps: impl Into<Steps>,
) -> Result<Recording, RecordingError> {
    let channel = motor
        .map_or_else(|| BagChannel::Effort(joint.clone()), |motor| BagChannel::Driving(*motor));
    let track = track(path, &channel)?;
    let Track { topic, joint, blank, beside, .. } = &track;
    let place = |index: usize| format!("message {} of {topic}", index + 1);
    let timing = Timing::of(path, &track.time, steps, place)?.of_one_rate();
    let of = joint.as_ref().map_or_else(String::new, |name| format!(" of {name}"));
    let source = |field: &str| ChannelSource { name: format!("{topic} {field}"), scale: 1.0 };
    let (velocity, force) = match motor {
        Some(_) => ("tachometer_velocity".to_owned(), "voltage_applied (as torque)".to_owned()),
        None => (format!("velocity{of}"), format!("effort{of}")),
    };
    let position = track.position.as_ref().map(|position| super::position_of(&timing, position));
    let readings = track.position.as_ref().and_then(|read| super::readings_of(&timing, read));
    let moved = track.velocity.as_ref();
    Ok(Recording {
        path: path.into(),
        time_step: timing.stretches[0].time_step,
        velocity: moved.map(|values| super::all_stretches(&timing, values, None)),
        force: super::all_stretches(&timing, &track.force, None),
        stretches: RecordedStretch::of(&timing, 0),
        irregularities: timing.irregularities.without(*blank).remarking(track.remarks),
        axis: Some(AxisKind::Rotary),
        friction_only: track.friction_only,
        sources: Sources {
            time: source("header.stamp"),
            position: position.as_ref().map(|_| source(&format!("position{of}"))),
            velocity: moved.map(|_| source(&velocity)),
            force: source(&force),
        },
        position,
        readings,
        beside: beside.clone(),
    })
}

/// Which channel of a bag is read beside the motion.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum BagChannel {
    /// Effort of a joint [N m].
    Effort(JointChoice),
    /// Voltage at the motor, the mean over the period before \[V\].
    Voltage,
    /// The torque that drives the axis, worked out from the voltage [N m].
    Driving(Motor),
}

/// What was recorded, at whatever times.
pub(super) struct Track {
    pub topic: String,
    /// The joint, where it has a name.
    pub joint: Option<String>,
    /// Times \[s\], by the rig's own clock where the bag has it.
    pub time: Vec<f64>,
    /// Position [rad], where the bag has it.
    pub position: Option<Vec<f64>>,
    /// Velocity [rad/s]; none only where there is a position.
    pub velocity: Option<Vec<f64>>,
    /// The channel that was asked for [N m or V].
    pub force: Vec<f64>,
    /// It is friction alone.
    pub friction_only: bool,
    /// Other joints that move.
    pub beside: Vec<Beside>,
    /// Messages without a number where one is needed, left out.
    pub blank: usize,
    /// What is to be said of the values.
    pub remarks: Remarks,
}

/// Reads all messages.
pub(super) fn track(path: &Path, channel: &BagChannel) -> Result<Track, RecordingError> {
    let bag = BagReader::open(path)?;
    match channel {
        BagChannel::Effort(choice) => of_joint(path, &bag, choice),
        BagChannel::Voltage => of_rig(path, &bag, |voltage, _| voltage),
        BagChannel::Driving(motor) => {
            of_rig(path, &bag, |voltage, velocity| motor.driving_torque(voltage, velocity))
        }
    }
}

/// Times \[s\] of stamps \[ns\] that are in order: the rig's own where the bag tells them, those
/// of the stamps else.
fn times(bag: &BagReader, stamps: &[u64]) -> Result<Vec<f64>, RecordingError> {
    let clock = rig_clock::of_bag(bag)?;
    let by_rig = |clock: HashMap<u64, f64>| -> Option<Vec<f64>> {
        stamps.iter().map(|stamp| clock.get(stamp).copied()).collect()
    };
    let start = stamps.first().copied().unwrap_or(0);
    let since = |stamp: &u64| stamp.saturating_sub(start) as f64 * 1e-9;
    Ok(clock.and_then(by_rig).unwrap_or_else(|| stamps.iter().map(since).collect()))
}

fn of_joint(path: &Path, bag: &BagReader, choice: &JointChoice) -> Result<Track, RecordingError> {
    let Joint { name, mut samples, effort, beside } = joints::read(path, bag, choice)?;
    // A bag is in the order of its log; what counts is when the sample was taken.
    samples.sort_by_key(|sample| sample.stamp);
    let topic = joints::topic(bag).to_owned();
    let [position, velocity, force]: [joints::Field; 3] =
        [|sample| sample.position, |sample| sample.velocity, |sample| sample.effort];
    let (placed, moved) = (joints::has(&samples, position), joints::has(&samples, velocity));
    let drives = joints::has(&samples, force);
    if !(drives && (placed || moved)) && !samples.is_empty() {
        let lacks = if drives { "position and no velocity" } else { "effort" };
        let missing = |sample: &&joints::JointSample| match drives {
            true => position(sample).or(velocity(sample)).is_none(),
            false => force(sample).is_none(),
        };
        return Err(RecordingError::NoEffort {
            path: path.into(),
            without: samples.iter().filter(missing).count(),
            all: samples.len(),
            voltage: bag.topics().iter().any(|other| other.name == RIG_MEASUREMENT),
            topic,
            joint: name,
            lacks,
        });
    }
    // A message without a number that most have, as drivers send at their start, is left out.
    let all = samples.len();
    samples.retain(|sample| {
        force(sample).is_some()
            && (position(sample).is_some() || !placed)
            && (velocity(sample).is_some() || !moved)
    });
    let of = |of: joints::Field| -> Vec<f64> { samples.iter().filter_map(of).collect() };
    // A position that stands still beside a velocity was not measured.
    let position = Some(of(position)).filter(|_| placed);
    let stands = |position: &Vec<f64>| position.windows(2).all(|pair| pair[0] == pair[1]);
    let stamps: Vec<u64> = samples.iter().map(|sample| sample.stamp).collect();
    let time = times(bag, &stamps)?;
    let mut position = position.filter(|position| !(moved && stands(position)));
    let mut remarks = Remarks::default();
    if let Some(position) = &mut position {
        remarks.wrapped = remarks::unwrap(&time, position, Angle::RADIANS);
    }
    let (velocity, force) = (Some(of(velocity)).filter(|_| moved), of(force));
    let remarks = told(remarks, &time, [position.as_deref(), velocity.as_deref(), Some(&force)]);
    Ok(Track {
        topic,
        joint: name,
        time,
        position,
        velocity,
        force,
        friction_only: effort == Effort::Friction,
        beside,
        blank: all - samples.len(),
        remarks,
    })
}

/// With what is to be said of the position, the velocity and the effort of a joint.
pub(super) fn told(mut found: Remarks, time: &[f64], channels: [Option<&[f64]>; 3]) -> Remarks {
    let of = |name, unit| move |values| Watched { name, scale: 1.0, unit, values };
    let [position, velocity, force] = channels;
    let position = position.map(of("position", "rad"));
    let velocity = velocity.map(of("velocity", "rad/s"));
    if let Some(force) = force {
        found = found.of_force(time, of("effort", "N m")(force));
    }
    if let Some(position) = position {
        found = found.of_position(time, position);
    }
    if let Some(velocity) = velocity {
        found = found.of_velocity(time, velocity, force);
    }
    if let (Some(position), Some(velocity)) = (position, velocity) {
        found = found.compared(time, Both { position, velocity, used: Used::Message });
    }
    found
}

/// The rig's measurement, with what `value` makes of voltage \[V\] and velocity [rad/s].
fn of_rig(
    path: &Path,
    bag: &BagReader,
    value: impl Fn(f64, f64) -> f64,
) -> Result<Track, RecordingError> {
    let mut messages = bag.messages::<RigMeasurement>(RIG_MEASUREMENT)?;
    for (index, (_, rig)) in messages.iter().enumerate() {
        let (velocity, voltage) = (rig.tachometer_velocity, rig.voltage_applied);
        if !(velocity.is_finite() && voltage.is_finite()) {
            let detail = format!(
                "velocity {velocity} and voltage {voltage} are expected to be finite; cut the bag there"
            );
            let (path, topic) = (path.into(), RIG_MEASUREMENT.to_owned());
            return Err(RecordingError::Message { path, topic, index: index + 1, detail });
        }
    }
    messages.sort_by_key(|(_, rig)| rig.header.stamp.to_nanos());
    let stamps: Vec<u64> = messages.iter().map(|(_, rig)| rig.header.stamp.to_nanos()).collect();
    let velocity: Vec<f64> = messages.iter().map(|(_, rig)| rig.tachometer_velocity).collect();
    let force = messages.iter().map(|(_, rig)| value(rig.voltage_applied, rig.tachometer_velocity));
    Ok(Track {
        topic: RIG_MEASUREMENT.to_owned(),
        joint: None,
        time: times(bag, &stamps)?,
        position: None,
        force: force.collect(),
        velocity: Some(velocity),
        friction_only: false,
        beside: vec![],
        blank: 0,
        remarks: Remarks::default(),
    })
}

#[cfg(test)]
mod tests;
