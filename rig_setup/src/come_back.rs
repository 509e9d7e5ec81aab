//! A rig whose line failed, waited for until it is there again.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, SystemTime};

use rig_driver::RigError;

use super::{NotReopened, Opened, RigSetupError};

/// Longest time in which a line that failed may come back \[s\].
pub const PATIENCE: f64 = 30.0;

/// Pause between two attempts to open it.
const RETRY: Duration = Duration::from_millis(100);

/// What a device has to have run for beyond the time in which it was not heard \[s\].
const SURE: f64 = 0.5;

/// Opens the rig by `reopen` once more, up to [`PATIENCE`] after it was `heard` last. Whoever drove
/// it has let it go before, at zero volts. A fault that is latched in the device is not cleared.
///
/// # Errors
/// [`NotReopened`] says why: it did not come back, another device came back, or `stop` was set.
pub fn come_back(
    reopen: impl Fn() -> Result<Opened, RigSetupError>,
    heard: SystemTime,
    stop: &AtomicBool,
) -> Result<Opened, NotReopened> {
    let not = |why: String| Err(NotReopened(why));
    // A program that was stopped, or slept with its machine, must not surprise who stands at the
    // rig by now.
    let too_late = || silence(heard) > PATIENCE;
    let opened = loop {
        if stop.load(Ordering::Relaxed) {
            return not(RigError::Stopped.to_string());
        }
        // One that answers, and measures nothing yet, is not there.
        match reopen().and_then(measuring) {
            Ok(opened) => break opened,
            Err(error @ RigSetupError::OtherDevice { .. }) => return not(error.to_string()),
            Err(error) if too_late() => {
                return not(format!("it did not come back within {PATIENCE} s: {error}"));
            }
            Err(_) => thread::sleep(RETRY),
        }
    };
    if too_late() {
        return not(format!(
            "it was not heard for more than {PATIENCE} s, and nobody knows who is at the rig by now"
        ));
    }
    Ok(opened)
}

/// The rig, once it has measured.
fn measuring(mut opened: Opened) -> Result<Opened, RigSetupError> {
    opened.rig.wait()?;
    Ok(opened)
}

/// Whether the encoder of a rig that was `heard` last then has counted on since: its device has run
/// for longer than that, so that it was not switched on meanwhile. Where that is so, a travel by the
/// rig's own count still holds.
///
/// # Errors
/// [`NotReopened`] where it began anew, or does not say how long it has run.
pub fn counted_on(opened: &Opened, heard: SystemTime) -> Result<(), NotReopened> {
    let look = "look where the shaft is, and begin again";
    let Ok(since) = heard.elapsed().map(|since| since.as_secs_f64()) else {
        return Err(NotReopened(format!(
            "its travel is limited, and the clock of this computer was set back, so that nobody knows whether its encoder counted on: {look}"
        )));
    };
    match opened.rig.powered_for() {
        Some(powered) if powered > since + SURE => Ok(()),
        Some(powered) => Err(NotReopened(format!(
            "its travel is limited, and its device started anew {powered:.0} s ago, so that its encoder did too: {look}"
        ))),
        None => Err(NotReopened(format!(
            "its travel is limited, and nobody knows whether its encoder counted on: {look}"
        ))),
    }
}

/// Time since the rig was heard \[s\]; 0 where the clock was set back.
pub(crate) fn silence(heard: SystemTime) -> f64 {
    heard.elapsed().map_or(0.0, |since| since.as_secs_f64())
}
