//! What the command line adds to an error: the option or the command that mends it. The libraries
//! that found it know of neither.

use experiment_runner::run::RunError;
use files::{OutputError, is_of_the_path};
use recording::RecordingError;
use recording::bag::BagError;
use recording::column::Channel;
use rig_driver::RigError;
use rig_setup::RigSetupError;

/// What to add to the error; nothing where it says all there is to say.
pub(super) fn advice(error: &anyhow::Error) -> String {
    let of = error
        .downcast_ref()
        .map(of_output)
        .or_else(|| error.downcast_ref().map(of_bag))
        .or_else(|| error.downcast_ref().map(of_recording))
        .or_else(|| error.downcast_ref().map(of_setup))
        .or_else(|| error.downcast_ref().map(of_run));
    #[cfg(feature = "ros")]
    let of = of
        .or_else(|| error.downcast_ref().map(ros::of_live))
        .or_else(|| error.downcast_ref().map(ros::of_record))
        .or_else(|| error.downcast_ref().map(ros::of_node));
    of.unwrap_or_default()
}

fn of_output(error: &OutputError) -> String {
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

fn of_bag(error: &BagError) -> String {
    match error {
        BagError::WriteMcap { .. } | BagError::Damaged { .. } => {
            "; `frictionlab bag recover` saves everything that is whole"
        }
        _ => "",
    }
    .to_owned()
}

fn of_recording(error: &RecordingError) -> String {
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

fn of_setup(error: &RigSetupError) -> String {
    match error {
        RigSetupError::Rig(RigError::OutOfRange { name: "max_volts", .. })
        | RigSetupError::DoesNotMove { .. }
        | RigSetupError::Undetermined { .. } => " (--max-volts)",
        RigSetupError::NotDriven(_) => " (--rig)",
        RigSetupError::OtherDevice { .. } => {
            ": `frictionlab rig calibrate --rig-file FILE` does both"
        }
        _ => "",
    }
    .to_owned()
}

fn of_run(error: &RunError) -> String {
    match error {
        RunError::Output(error) => of_output(error),
        RunError::Bag(error) => of_bag(error),
        RunError::Setup(error) => of_setup(error),
        RunError::Underway(error) => of_run(error),
        RunError::NoSensor { instead, .. } => format!(" (--torque-source {instead})"),
        RunError::ExcitedTooFar { .. } => {
            " (`frictionlab protocols drive-excitation > mine.yaml`, then --protocol mine.yaml; or --voltage-limit)"
                .to_owned()
        }
        _ => String::new(),
    }
}

#[cfg(feature = "ros")]
mod ros {
    use recording::record::RecordError;
    use ros_node::RosNodeError;
    use ros_node::security::SecurityError;

    use super::{of_bag, of_output, of_setup};
    use crate::live::LiveError;

    pub(super) fn of_live(error: &LiveError) -> String {
        match error {
            LiveError::Output(error) => of_output(error),
            LiveError::Bag(error) => of_bag(error),
            LiveError::Setup(error) => of_setup(error),
            LiveError::Ros(error) => of_node(error),
            _ => String::new(),
        }
    }

    pub(super) fn of_record(error: &RecordError) -> String {
        match error {
            RecordError::Ros(error) => of_node(error),
            RecordError::Bag(error) => of_bag(error),
            _ => String::new(),
        }
    }

    pub(super) fn of_node(error: &RosNodeError) -> String {
        match error {
            RosNodeError::NoAnswer { .. } => " `frictionlab doctor` lists who is there",
            RosNodeError::Security(SecurityError::NoKeystore) => {
                " (`frictionlab security init DIR`)"
            }
            RosNodeError::Security(SecurityError::Lacks { .. }) => {
                "; `frictionlab security check` shows what is there"
            }
            #[cfg(feature = "security")]
            RosNodeError::Security(SecurityError::Unusable { .. }) => {
                "; `frictionlab security check` looks at all enclaves, `frictionlab security init DIR` makes a new keystore"
            }
            _ => "",
        }
        .to_owned()
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
            assert!(advice(&error.into()).contains(option));
        }
    }

    #[test]
    fn the_option_is_named_behind_whatever_the_error_came_through() {
        let taken = || OutputError::NotEmpty("out".into());
        for error in [
            anyhow::Error::new(taken()),
            anyhow::Error::new(RunError::from(taken())),
            anyhow::Error::new(RunError::Underway(Box::new(taken().into()))),
        ] {
            assert!(advice(&error).contains("--force"), "{error}");
        }
        let cut = BagError::Damaged { path: "bag".into(), detail: "no end".to_owned() };
        assert!(advice(&RecordingError::from(cut).into()).contains("frictionlab bag recover"));
        assert_eq!(advice(&anyhow::anyhow!("the rig failed")), "");
    }
}
