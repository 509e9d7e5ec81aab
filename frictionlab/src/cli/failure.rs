//! How an error ends the program: its exit code, and what a person is told.

use experiment_runner::run::RunError;
use experiment_runner::test_bed::TestBedError;
use files::OutputError;
use recording::RecordingError;
use recording::bag::BagError;
use rig_driver::RigError;
use rig_setup::RigSetupError;
use studies::monte_carlo::StudyError;
use work::{BadInput, Interrupted};

use super::advice::advice;
use crate::interruption;

/// What a person is told of an error: each cause once, and what mends it.
#[must_use]
pub fn told(error: &anyhow::Error) -> String {
    work::ending::told(error) + &advice(error)
}

/// The exit code of a program that ended with this error: 1 if it failed at its work, 2 for wrong
/// input, 128 plus its number after a signal.
#[must_use]
pub fn exit_code(error: &anyhow::Error) -> u8 {
    if error.is::<Interrupted>() {
        interruption::exit_code()
    } else if is_bad_input(error) {
        2
    } else {
        1
    }
}

/// Whether whoever typed the command can mend it. Each error says so itself; one that is not known
/// here is a failure of the work.
fn is_bad_input(error: &anyhow::Error) -> bool {
    macro_rules! any_says_so {
        ($($kind:ty),+ $(,)?) => {
            false $(|| error.downcast_ref::<$kind>().is_some_and(<$kind>::is_bad_input))+
        };
    }
    #[cfg(feature = "ros")]
    let of_ros = {
        use crate::launch::LaunchError;
        use crate::live::LiveError;
        use recording::record::RecordError;
        use ros_node::RosNodeError;
        any_says_so!(LaunchError, LiveError, RecordError, RosNodeError)
    };
    #[cfg(not(feature = "ros"))]
    let of_ros = false;
    #[cfg(feature = "security")]
    let of_security =
        any_says_so!(crate::security::NoKeystore, ros_node::security::keystore::KeystoreError);
    #[cfg(not(feature = "security"))]
    let of_security = false;
    error.is::<BadInput>()
        || of_ros
        || of_security
        || any_says_so!(
            BagError,
            OutputError,
            RecordingError,
            RigError,
            RigSetupError,
            RunError,
            StudyError,
            TestBedError,
        )
}

#[cfg(test)]
mod tests {
    use std::io::{Error, ErrorKind};

    use super::*;

    #[test]
    fn a_full_disk_is_a_failure_told_once_and_wrong_input_is_not() {
        let full = || Error::from(ErrorKind::StorageFull);
        let bag = || BagError::Write { path: "runs/all-1/bag".into(), source: full() };
        let output = || OutputError::Write { path: "a.csv".into(), source: full() };
        for error in [
            anyhow::Error::new(bag()),
            anyhow::Error::new(output()),
            anyhow::Error::new(RunError::from(bag())),
            anyhow::Error::new(RecordingError::from(bag())),
            anyhow::Error::new(RunError::from(output())).context("the report"),
        ] {
            assert_eq!(exit_code(&error), 1, "{error}");
            assert!(told(&error).matches("no space left").count() <= 1, "{}", told(&error));
        }
        let denied =
            OutputError::Write { path: "a.csv".into(), source: ErrorKind::PermissionDenied.into() };
        for error in [denied.into(), BadInput("no such model".to_owned()).into()] {
            assert_eq!(exit_code(&error), 2, "{error}");
        }
        assert_eq!(exit_code(&anyhow::anyhow!("the rig failed")), 1);
    }

    #[test]
    fn a_rig_that_cannot_be_is_wrong_input_and_one_that_is_lost_is_not() {
        let wrong = RigError::BeyondRange { limit: 20.0, range: 10.0 };
        let lost = RigError::Elsewhere("the emergency stop was pressed".to_owned());
        for (error, code) in [(wrong, 2), (lost, 1), (RigError::Stopped, 1)] {
            assert_eq!(exit_code(&RigSetupError::from(error.clone()).into()), code, "{error}");
            assert_eq!(exit_code(&TestBedError::from(error.clone()).into()), code, "{error}");
            assert_eq!(exit_code(&RunError::from(error.clone()).into()), code, "{error}");
        }
    }
}
