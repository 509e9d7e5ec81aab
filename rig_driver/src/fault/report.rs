//! A fault that happened, in words: what was seen, what is allowed, how to go on.

use std::fmt;

use serde::Serialize;

use super::Fault;

/// A fault that happened.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FaultReport {
    /// Which.
    pub fault: Fault,
    /// When, on the supervisor's clock \[s\].
    pub time: f64,
    /// What was seen, in the unit of the limit.
    pub value: f64,
    /// The limit that was passed, zero where there is none.
    pub limit: f64,
}

impl fmt::Display for FaultReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { fault, time, value, limit } = *self;
        write!(f, "{fault} at {time:.3} s: ")?;
        match fault {
            Fault::VoltageBeyondLimit => write!(f, "{value:.3} V asked for, {limit} V allowed"),
            Fault::VoltageTooSteep => {
                write!(f, "{value:.3} V asked for, {limit:.3} V allowed in this cycle")
            }
            Fault::EndOfTravel | Fault::TravelExceeded => write!(
                f,
                "the encoder is at {value:.4} rad, the travel ends at {limit} rad; turn the shaft back by hand, check the encoder's sign, then clear"
            ),
            Fault::CommandLate | Fault::CommandLost => write!(
                f,
                "the last command is {value:.4} s old, {limit} s are allowed; see whether the controller runs, then clear and activate"
            ),
            Fault::CycleLate | Fault::CycleLost => write!(
                f,
                "a cycle took {value:.4} s, {limit} s are allowed; give the loop real-time priority or a lower rate, then clear and activate"
            ),
            Fault::CommandNotFinite => {
                write!(
                    f,
                    "the voltage asked for or its time is {value}; mend the controller, then clear and activate"
                )
            }
            Fault::Overspeed => write!(
                f,
                "{value:.3} rad/s, {limit} rad/s are allowed; look for a loop with the wrong sign, then clear and activate"
            ),
            Fault::MotorHot => write!(
                f,
                "the winding is at {value:.1} degrees C by its model, {limit} are allowed; let it cool, then clear and activate"
            ),
            Fault::ReadingNotFinite => {
                write!(
                    f,
                    "a sensor reads {value}; check its wiring and scaling, then clear and activate"
                )
            }
            Fault::SensorsDisagree => write!(
                f,
                "tachometer and encoder differ by {value:.3} rad/s, {limit:.3} are allowed; calibrate signs and gain, then clear"
            ),
            Fault::TorqueSaturated => write!(
                f,
                "the torque sensor reads {value:.3} N m, the end of its range is {limit}; check its wiring and its load, then clear and activate"
            ),
            Fault::TachometerFrozen | Fault::TorqueFrozen => write!(
                f,
                "the reading {value} did not change by a bit in {limit:.0} cycles; check the channel's wiring, then clear and activate"
            ),
            Fault::RigClockStopped => {
                write!(
                    f,
                    "the rig's time stands at {value:.3} s; check its connection, then clear and activate"
                )
            }
            Fault::PermissionWithdrawn => {
                write!(
                    f,
                    "the motor was active while the node was not; see in the log which request was given up, then clear and activate"
                )
            }
            Fault::BackEnd => {
                write!(f, "the back end holds the motor at zero volts; its own message says why")
            }
            Fault::MotionAtZero => write!(
                f,
                "the shaft turns at {value:.3} rad/s with zero volts, {limit} rad/s are allowed; see what drives it (a load, a hand, a broken driver stage), take the motor's power away if nothing does, then clear and activate"
            ),
            Fault::UnknownEcho => write!(
                f,
                "the device obeyed command {value:.0}, which this driver did not send so (its last is {limit:.0}); somebody else writes to the line: end that (`fuser` names programs), then clear and activate"
            ),
            Fault::ForeignFrames => write!(
                f,
                "{value:.0} frames of another session or version within a second, {limit:.0} are allowed; somebody else writes to the line: end that (`fuser` names programs), then clear and activate"
            ),
            Fault::CommandsRefused => write!(
                f,
                "the device refused {value:.0} messages within a second, {limit:.0} are allowed; see whether the loop is late or the line loses frames, then clear and activate"
            ),
            Fault::VoltageDiffers => write!(
                f,
                "the voltage on the motor differs by {value:.3} V from the one asked for, {limit:.3} V are allowed; check the device's driver stage and supply, then clear and activate"
            ),
            Fault::CycleJump => write!(
                f,
                "the device's cycles and time contradict each other by {value:.4} s, {limit:.4} s are allowed; check the device's clock and firmware, then clear and activate"
            ),
            Fault::StopNotAcknowledged => write!(
                f,
                "the device did not say within {limit} s that it stopped; take the motor's power away if it moves, check the line, then clear and activate"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::{FAULTS, Reaction};

    #[test]
    fn a_latched_fault_says_what_was_seen_what_is_allowed_and_how_to_go_on() {
        for rule in FAULTS.iter().filter(|rule| rule.reaction == Reaction::ZeroUntilCleared) {
            let text =
                FaultReport { fault: rule.fault, time: 1.0, value: 3.25, limit: 2.0 }.to_string();
            assert!(text.starts_with(rule.name) && text.len() > 60, "{text}");
        }
    }
}
