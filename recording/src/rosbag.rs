//! A recording from a bag of the laboratory's topics.
//!
//! The velocity is the tachometer's. The force is the friction torque of `/joint_states` (then
//! there is no inertia in it to be found), or the driving torque worked out from the voltage of
//! `/rig_measurement`: `(A Km / Ra) (u - A Km w)`, which drives inertia and friction together.

use std::collections::HashMap;
use std::path::Path;

use friction_model::Motor;
use msgs::friction_msgs::RigMeasurement;
use msgs::sensor_msgs::JointState;

use super::rig_clock::{self, RIG_MEASUREMENT};
use super::timing::Timing;
use super::{AxisKind, ChannelSource, RecordedStretch, Recording, RecordingError, Sources};
use crate::bag::BagReader;

const JOINT_STATES: &str = "/joint_states";

/// Reads a bag. With a `motor` the torque is worked out from the voltage, without it is the
/// measured friction. Time steps may deviate by `tolerance`, a fraction, from the usual one.
///
/// # Errors
/// [`RecordingError::Bag`] for what cannot be read, [`RecordingError::Message`] for messages
/// without the fields needed, and those of [`Timing::of`].
pub fn read(
    path: &Path,
    motor: Option<&Motor>,
    tolerance: f64,
) -> Result<Recording, RecordingError> {
    let channel = motor.map_or(BagChannel::Friction, |motor| BagChannel::Driving(*motor));
    let Track { topic, time, velocity, force } = track(path, channel)?;
    let place = |index: usize| format!("message {} of {topic}", index + 1);
    let timing = Timing::of(path, &time, tolerance, place)?.of_one_rate();
    let source = |field: &str| ChannelSource { name: format!("{topic} {field}"), scale: 1.0 };
    let names = match motor {
        Some(_) => ("tachometer_velocity", "voltage_applied (as torque)"),
        None => ("velocity", "effort"),
    };
    Ok(Recording {
        path: path.into(),
        time_step: timing.stretches[0].time_step,
        position: None,
        velocity: Some(super::all_stretches(&timing, &velocity, None)),
        force: super::all_stretches(&timing, &force, None),
        stretches: RecordedStretch::of(&timing, 0),
        irregularities: timing.irregularities,
        axis: Some(AxisKind::Rotary),
        friction_only: motor.is_none(),
        sources: Sources {
            time: source("header.stamp"),
            position: None,
            velocity: Some(source(names.0)),
            force: source(names.1),
        },
    })
}

/// Which channel of a bag is read beside the velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum BagChannel {
    /// Friction torque [N m].
    Friction,
    /// Voltage at the motor, the mean over the period before \[V\].
    Voltage,
    /// The torque that drives the axis, worked out from the voltage [N m].
    Driving(Motor),
}

/// What was recorded, at whatever times.
pub(super) struct Track {
    pub topic: &'static str,
    /// Times \[s\], by the rig's own clock where the bag has it.
    pub time: Vec<f64>,
    /// From the tachometer [rad/s].
    pub velocity: Vec<f64>,
    /// The channel that was asked for [N m or V].
    pub force: Vec<f64>,
}

/// Reads all messages.
pub(super) fn track(path: &Path, channel: BagChannel) -> Result<Track, RecordingError> {
    let bag = BagReader::open(path)?;
    let (topic, mut samples) = match channel {
        BagChannel::Friction => (JOINT_STATES, measured(path, &bag)?),
        BagChannel::Voltage => (RIG_MEASUREMENT, driven(path, &bag, |voltage, _| voltage)?),
        BagChannel::Driving(motor) => (
            RIG_MEASUREMENT,
            driven(path, &bag, |voltage, velocity| motor.driving_torque(voltage, velocity))?,
        ),
    };
    // A bag is in the order of its log; what counts is when the sample was taken.
    samples.sort_by_key(|sample| sample.stamp);
    let start = samples.first().map_or(0, |sample| sample.stamp);
    let since = |sample: &Sample| sample.stamp.saturating_sub(start) as f64 * 1e-9;
    let clock = rig_clock::of_bag(&bag)?;
    let by_rig = |clock: HashMap<u64, f64>| -> Option<Vec<f64>> {
        samples.iter().map(|sample| clock.get(&sample.stamp).copied()).collect()
    };
    let time = clock.and_then(by_rig).unwrap_or_else(|| samples.iter().map(since).collect());
    Ok(Track {
        topic,
        time,
        velocity: samples.iter().map(|sample| sample.velocity).collect(),
        force: samples.iter().map(|sample| sample.torque).collect(),
    })
}

struct Sample {
    stamp: u64,
    velocity: f64,
    torque: f64,
}

impl Sample {
    fn checked(
        path: &Path,
        topic: &'static str,
        index: usize,
        stamp: u64,
        velocity: f64,
        torque: f64,
    ) -> Result<Self, RecordingError> {
        if velocity.is_finite() && torque.is_finite() {
            Ok(Self { stamp, velocity, torque })
        } else {
            let detail = format!(
                "velocity {velocity} and torque {torque} are expected to be finite; cut the bag there"
            );
            Err(RecordingError::Message { path: path.into(), topic, index: index + 1, detail })
        }
    }
}

fn measured(path: &Path, bag: &BagReader) -> Result<Vec<Sample>, RecordingError> {
    let messages = bag.messages::<JointState>(JOINT_STATES)?;
    let sample = |(index, (_, state)): (usize, (u64, JointState))| match (
        state.velocity.first(),
        state.effort.first(),
    ) {
        (Some(&velocity), Some(&effort)) => Sample::checked(
            path,
            JOINT_STATES,
            index,
            state.header.stamp.to_nanos(),
            velocity,
            effort,
        ),
        _ => Err(RecordingError::NoEffort {
            path: path.into(),
            topic: JOINT_STATES,
            index: index + 1,
        }),
    };
    messages.into_iter().enumerate().map(sample).collect()
}

/// Samples of the rig's measurement, with what `value` makes of voltage \[V\] and velocity [rad/s].
fn driven(
    path: &Path,
    bag: &BagReader,
    value: impl Fn(f64, f64) -> f64,
) -> Result<Vec<Sample>, RecordingError> {
    let messages = bag.messages::<RigMeasurement>(RIG_MEASUREMENT)?;
    let sample = |(index, (_, rig)): (usize, (u64, RigMeasurement))| {
        let velocity = rig.tachometer_velocity;
        let torque = value(rig.voltage_applied, velocity);
        Sample::checked(path, RIG_MEASUREMENT, index, rig.header.stamp.to_nanos(), velocity, torque)
    };
    messages.into_iter().enumerate().map(sample).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bag::{BagOptions, BagWriter};
    use msgs::std_msgs::Header;

    #[test]
    fn reads_both_kinds_of_force() {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("bag");
        let mut bag = BagWriter::create(&dir, BagOptions::default()).unwrap();
        for i in 0..10u64 {
            let stamp = 1_600_000_000_000_000_000 + i * 1_000_000;
            let header = Header::at(stamp);
            let state = JointState {
                header: header.clone(),
                name: vec!["load_shaft".into()],
                position: vec![0.0],
                velocity: vec![i as f64],
                effort: vec![0.1],
            };
            bag.write(JOINT_STATES, stamp, &state).unwrap();
            let rig = RigMeasurement { header, voltage_applied: 1.0, ..RigMeasurement::default() };
            bag.write(RIG_MEASUREMENT, stamp, &rig).unwrap();
        }
        bag.finish().unwrap();
        let friction = read(&dir, None, 0.05).unwrap();
        assert!((friction.time_step - 1e-3).abs() < 1e-9);
        assert_eq!(friction.force, vec![0.1; 10]);
        assert_eq!(friction.velocity.as_ref().unwrap()[9], 9.0);
        assert!(friction.friction_only);
        let driven = read(&dir, Some(&Motor::SRV02), 0.05).unwrap();
        assert!((driven.force[0] - 0.2065).abs() < 1e-4 && !driven.friction_only);
    }
}
