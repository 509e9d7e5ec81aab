//! One joint of `/joint_states`: every field of it, found by its name.
//!
//! A message may hold many joints, in any order, and not each message every joint. What `effort`
//! is, a bag does not say: a robot's driver publishes the torque that drives the joint, this
//! laboratory's the friction torque.

use std::path::Path;

use msgs::RosMessage;
use msgs::sensor_msgs::JointState;
use serde::Serialize;

use super::RecordingError;
use super::beside::Beside;
use super::rig_clock::RIG_MEASUREMENT;
use crate::bag::BagReader;

/// The topic, if no robot is named before it.
pub(super) const JOINT_STATES: &str = "/joint_states";

/// The topic of the joint states of a bag: `/joint_states`, or the only one with such messages, as
/// `/robot/joint_states`.
pub(super) fn topic(bag: &BagReader) -> &str {
    let mut alike = bag.topics().iter().filter(|topic| topic.type_name == JointState::type_name());
    let usual = bag.topics().iter().any(|topic| topic.name == JOINT_STATES);
    match (usual, alike.next(), alike.next()) {
        (false, Some(only), None) => &only.name,
        _ => JOINT_STATES,
    }
}

/// The only joint of this laboratory's rigs.
const OURS: &str = "load_shaft";

/// What the effort of a joint is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Effort {
    /// The torque that drives the joint: inertia, friction and load.
    Driving,
    /// Friction alone, as this laboratory's rigs publish it.
    Friction,
}

/// Which joint of a bag is read, and what its effort is.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct JointChoice {
    /// Its name; none where the bag has only one.
    pub name: Option<String>,
    /// What its effort is; none for a bag of this laboratory.
    pub effort: Option<Effort>,
}

/// One message.
#[derive(Debug, Clone, Copy)]
pub(super) struct JointSample {
    /// When the state was \[ns\].
    pub stamp: u64,
    pub position: Option<f64>,
    pub velocity: Option<f64>,
    pub effort: Option<f64>,
}

/// All messages of one joint.
pub(super) struct Joint {
    /// Its name; none where the messages have none.
    pub name: Option<String>,
    pub samples: Vec<JointSample>,
    /// What its effort is.
    pub effort: Effort,
    /// The others that move.
    pub beside: Vec<Beside>,
}

/// The names of the joints of a bag, in the order in which they first come.
///
/// # Errors
/// [`RecordingError::Bag`].
pub fn names(bag: &BagReader) -> Result<Vec<String>, RecordingError> {
    let messages = bag.messages::<JointState>(topic(bag))?;
    Ok(names_in(messages.iter().map(|(_, state)| state)))
}

fn names_in<'a>(states: impl Iterator<Item = &'a JointState>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in states.flat_map(|state| &state.name) {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names
}

/// Reads the joint that was chosen.
pub(super) fn read(
    path: &Path,
    bag: &BagReader,
    choice: &JointChoice,
) -> Result<Joint, RecordingError> {
    let topic = topic(bag);
    let messages = bag.messages::<JointState>(topic)?;
    for (index, (_, state)) in messages.iter().enumerate() {
        check(path, topic, index + 1, state)?;
    }
    let names = names_in(messages.iter().map(|(_, state)| state));
    let name = chosen(path, &names, choice.name.as_deref())?;
    let effort = meaning(path, bag, name, choice.effort)?;
    let samples = messages.iter().filter_map(|(_, state)| {
        let index = match name {
            Some(name) => state.name.iter().position(|other| other == name)?,
            None => 0,
        };
        let field = |values: &[f64]| values.get(index).copied().filter(|value| value.is_finite());
        Some(JointSample {
            stamp: state.header.stamp.to_nanos(),
            position: field(&state.position),
            velocity: field(&state.velocity),
            effort: field(&state.effort),
        })
    });
    let positions = |other: &str| {
        let of = |(_, state): &(_, JointState)| {
            let index = state.name.iter().position(|name| name == other)?;
            state.position.get(index).copied()
        };
        messages.iter().filter_map(of).collect::<Vec<f64>>()
    };
    let others = names.iter().filter(|other| Some(other.as_str()) != name);
    let beside = others.filter_map(|other| Beside::of(other, positions(other).into_iter()));
    let beside = beside.collect();
    Ok(Joint { name: name.map(str::to_owned), samples: samples.collect(), effort, beside })
}

/// Refuses a message that does not say which joint its values are of.
fn check(path: &Path, topic: &str, index: usize, state: &JointState) -> Result<(), RecordingError> {
    let JointState { name, position, velocity, effort, .. } = state;
    let joints = [position, velocity, effort].map(Vec::len).into_iter().max().unwrap_or(0);
    if name.is_empty() && joints > 1 {
        let (path, topic) = (path.into(), topic.to_owned());
        return Err(RecordingError::NoJointNames { path, topic, index, joints });
    }
    let twice = name.iter().enumerate().find(|(k, one)| name[..*k].contains(one));
    match twice {
        Some((_, name)) => Err(RecordingError::JointTwice {
            path: path.into(),
            topic: topic.to_owned(),
            index,
            name: name.clone(),
        }),
        None => Ok(()),
    }
}

/// One value of a sample, where it has one.
pub(super) type Field = fn(&JointSample) -> Option<f64>;

/// Whether most of the samples have a value.
pub(super) fn has(samples: &[JointSample], of: Field) -> bool {
    let there = samples.iter().filter(|sample| of(sample).is_some()).count();
    2 * there > samples.len()
}

/// The joint that is meant.
fn chosen<'a>(
    path: &Path,
    names: &'a [String],
    wanted: Option<&str>,
) -> Result<Option<&'a str>, RecordingError> {
    let present = || names.join(", ");
    match (wanted, names) {
        (None, []) => Ok(None),
        (None, [only]) => Ok(Some(only)),
        (None, _) => Err(RecordingError::SeveralJoints { path: path.into(), present: present() }),
        (Some(wanted), _) => {
            let found = names.iter().find(|name| *name == wanted).map(String::as_str);
            found.map(Some).ok_or_else(|| RecordingError::NoJoint {
                path: path.into(),
                name: wanted.to_owned(),
                present: present(),
            })
        }
    }
}

/// What the effort is: what was said, or friction in a bag of this laboratory.
fn meaning(
    path: &Path,
    bag: &BagReader,
    name: Option<&str>,
    said: Option<Effort>,
) -> Result<Effort, RecordingError> {
    let ours =
        || name == Some(OURS) || bag.topics().iter().any(|topic| topic.name == RIG_MEASUREMENT);
    match said {
        Some(effort) => Ok(effort),
        None if ours() => Ok(Effort::Friction),
        None => Err(RecordingError::EffortMeaning {
            path: path.into(),
            joint: name.unwrap_or("without a name").to_owned(),
        }),
    }
}
