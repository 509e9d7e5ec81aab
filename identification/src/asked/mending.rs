//! What the options add to an error: the one that mends it. The libraries that found it know of
//! none.

use files::{OutputError, is_of_the_path};
use recording::RecordingError;
use recording::bag::BagError;
use recording::column::Channel;

/// What to add to the error of a result's place, a bag or a recording; none of any other, and an
/// empty text where the error says all there is to say.
#[must_use]
pub fn mending(error: &anyhow::Error) -> Option<String> {
    error
        .downcast_ref()
        .map(of_output)
        .or_else(|| error.downcast_ref().map(of_bag))
        .or_else(|| error.downcast_ref().map(of_recording))
}

/// The option that mends a place for results.
#[must_use]
pub fn of_output(error: &OutputError) -> String {
    match error {
        OutputError::NotEmpty(_) => " (--out DIR, --force)",
        OutputError::Exists(_) => " (--out FILE, --force)",
        OutputError::IsFolder(_) => " (--out FILE)",
        OutputError::NoFolder(_) => " (--out DIR)",
        OutputError::Write { source, .. } if is_of_the_path(source) => " (--out)",
        _ => "",
    }
    .to_owned()
}

/// The command that mends a bag.
#[must_use]
pub fn of_bag(error: &BagError) -> String {
    match error {
        BagError::WriteMcap { .. } | BagError::Damaged { .. } => {
            "; `frictionlab bag recover` saves everything that is whole"
        }
        _ => "",
    }
    .to_owned()
}

/// The option that mends how a recording is read.
#[must_use]
pub fn of_recording(error: &RecordingError) -> String {
    match error {
        RecordingError::NoColumn { channel, .. } => format!(" ({} NAME)", option(*channel)),
        RecordingError::Unrecognised { channel, .. } => {
            let option = option(*channel);
            let unit = channel.unit();
            let period = if *channel == Channel::Time {
                "; where there is none, --period SECONDS gives the time from row to row"
            } else {
                ""
            };
            format!(
                ": {option} NAME, or {option} NAME:SCALE where SCALE turns its values into {unit}{period}"
            )
        }
        RecordingError::TimeTwice { .. } => " (--period)".to_owned(),
        RecordingError::TwoAxes { force, .. } => format!(" (--force-column '{force}:FACTOR')"),
        RecordingError::CoarseTimes { .. } => {
            ": --time NAME names a finer one, and --period SECONDS gives the time from row to row of a table"
                .to_owned()
        }
        RecordingError::Form { form: "a JSON file", .. } => {
            " (`frictionlab identify-servo` reads it then)".to_owned()
        }
        RecordingError::Joined { .. } => " (--beside TABLE)".to_owned(),
        RecordingError::Unit { source, .. } => {
            format!(" ({} NAME:SCALE)", option(source.channel))
        }
        RecordingError::Irregular { rate, .. } => format!(" (--resample {rate})"),
        RecordingError::ResampleRate { .. } => " (--resample HZ)".to_owned(),
        RecordingError::SeveralJoints { .. } | RecordingError::NoJoint { .. } => {
            " (--joint NAME)".to_owned()
        }
        RecordingError::EffortMeaning { .. } => {
            " (--effort driving or --effort friction)".to_owned()
        }
        RecordingError::TimeUnit { column, scale, .. } => format!(" (--time {column}:{scale:e})"),
        RecordingError::NoEffort { voltage: true, .. } => " (--torque-from-voltage)".to_owned(),
        RecordingError::Bag(error) => of_bag(error),
        _ => String::new(),
    }
}

/// The option that chooses a column.
const fn option(channel: Channel) -> &'static str {
    match channel {
        Channel::Time => "--time",
        Channel::Position => "--position",
        Channel::Velocity => "--velocity",
        Channel::Force => "--force-column",
        Channel::Voltage => "--voltage",
        Channel::DrivingVoltage | Channel::Current => "--force-column",
        Channel::Friction => "--friction",
        Channel::Angle => "--angle",
        Channel::Pendulum => "--pendulum",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_voltage_in_place_of_a_force_is_named_by_the_option_of_the_force() {
        for (channel, option) in
            [(Channel::DrivingVoltage, "--force-column"), (Channel::Voltage, "--voltage")]
        {
            let (path, present) = ("run.csv".into(), "t, q".to_owned());
            let error = RecordingError::Unrecognised { path, channel, present };
            assert!(mending(&error.into()).unwrap().contains(option));
        }
    }
}
