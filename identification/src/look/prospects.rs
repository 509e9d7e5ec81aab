//! What can be identified from a file, and what is missing for more.

use recording::column::Channel;
use recording::overview::{Moved, Overview};
use serde::Serialize;

/// A share of rest or of one direction below this is none.
const SOME: f64 = 0.02;

/// What can be identified from a file, and what is missing for more.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Prospects {
    /// What can be identified, each with its command.
    pub can: Vec<String>,
    /// What is missing, and for what.
    pub missing: Vec<String>,
}

/// Works out what can be identified.
#[must_use]
pub fn prospects(seen: &Overview) -> Prospects {
    let has = |channel: Channel| seen.channel(channel).is_some();
    let file = seen.path.display();
    let (mut can, mut missing) = (Vec::new(), Vec::new());
    let moves = has(Channel::Position) || has(Channel::Velocity);
    let resample = seen
        .times
        .as_ref()
        .and_then(|times| times.resample_to)
        .map_or_else(String::new, |rate| format!(" --resample {rate}"));
    let timed = seen.times.is_some();
    if timed && moves && has(Channel::Force) {
        can.push(format!(
            "inertia, viscous and Coulomb friction, if the force drives the axis: frictionlab identify {file}{resample}"
        ));
        can.push(format!(
            "friction models, with the inertia known: frictionlab identify {file} --model lugre --torque-source driving \
             --inertia J:SE{resample}"
        ));
    }
    let points = !timed && has(Channel::Velocity) && has(Channel::Force);
    if points {
        can.push(format!(
            "static friction models from steady points: frictionlab identify {file} --model coulomb_viscous,stribeck"
        ));
    }
    if timed && moves && has(Channel::Voltage) {
        can.push(format!("the drive's constants: frictionlab identify-drive {file}{resample}"));
    }
    if let Some(current) = seen.channel(Channel::Current).filter(|_| timed && moves) {
        can.push(format!(
            "the same as from a torque, with the torque constant KT: frictionlab identify {file} --force-column \
             '{}:KT'{resample}",
            current.name
        ));
    }
    if !(timed || points) {
        missing.push("no time is recognised: name its column with --time NAME, or say with --period SECONDS how far the rows are apart".to_owned());
    }
    if !moves {
        missing.push(
            "no motion is recognised: name it with --position NAME or --velocity NAME".to_owned(),
        );
    }
    if ![Channel::Force, Channel::Voltage, Channel::Current].into_iter().any(has) {
        missing.push(
            "nothing is recognised that drives the axis: name a force or torque with --force-column NAME".to_owned(),
        );
    }
    missing.extend(seen.motion.as_ref().into_iter().flat_map(of_motion));
    Prospects { can, missing }
}

/// What the motion does not show.
fn of_motion(motion: &Moved) -> Vec<String> {
    let mut missing = Vec::new();
    if motion.forwards < SOME || motion.backwards < SOME {
        missing.push(
            "the axis moves in one direction only: friction cannot be told from an offset"
                .to_owned(),
        );
    }
    if motion.one_speed.is_some() {
        missing.push(
            "the motion has one speed and its turns: how friction changes with speed hardly shows, nor does the inertia unless slow ramps lead up to that speed".to_owned(),
        );
    }
    if motion.reversals == 0 {
        missing.push("no reversal: stiffness and pre-sliding do not show".to_owned());
    }
    if motion.rest > 0.5 {
        missing.push(format!(
            "the axis rests for {:.0} % of the samples, which say little of friction in motion",
            100.0 * motion.rest
        ));
    }
    missing
}
