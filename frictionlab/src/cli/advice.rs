//! What the command line adds to an error: the option or the command that mends it. The libraries
//! that found it know of neither.

use experiment_runner::run::RunError;
use identification::asked::mending::{self, of_bag, of_output};
use rig_driver::RigError;
use rig_setup::RigSetupError;

/// What to add to the error; nothing where it says all there is to say.
pub(super) fn advice(error: &anyhow::Error) -> String {
    let of = mending::mending(error)
        .or_else(|| error.downcast_ref().map(of_setup))
        .or_else(|| error.downcast_ref().map(of_run));
    #[cfg(feature = "ros")]
    let of = of
        .or_else(|| error.downcast_ref().map(ros::of_live))
        .or_else(|| error.downcast_ref().map(ros::of_record))
        .or_else(|| error.downcast_ref().map(ros::of_node));
    of.unwrap_or_default()
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
    use files::OutputError;
    use recording::RecordingError;
    use recording::bag::BagError;

    use super::*;

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
