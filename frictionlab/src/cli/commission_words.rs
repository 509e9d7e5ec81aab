//! What ends a commission, in the words of the command line.

use commission::CommissionError;
use rig_driver::RigError;
use rig_setup::RigSetupError;
use work::{BadInput, Interrupted};

/// An error where the command line has other words for it.
pub(super) fn worded(error: CommissionError) -> anyhow::Error {
    match error {
        CommissionError::Rig(RigSetupError::Stopped) => {
            Interrupted("stopped; the motor is at zero volts".to_owned()).into()
        }
        CommissionError::Rig(RigSetupError::Rig(RigError::BeyondRange { limit, range })) => {
            BadInput(super::run::beyond_range(limit, range)).into()
        }
        CommissionError::Rig(error) => error.into(),
        CommissionError::Output(error) => error.into(),
        error if error.is_bad_input() => BadInput(error.to_string()).into(),
        error => error.into(),
    }
}
