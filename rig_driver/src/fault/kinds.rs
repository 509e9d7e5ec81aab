//! What can be wrong, and what the driver does about it: one table.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Something the supervisor does not let pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fault {
    /// More voltage than the limit was asked for.
    VoltageBeyondLimit,
    /// The voltage was to grow faster than the slew limit.
    VoltageTooSteep,
    /// A voltage that drives further out was asked for at the end of the travel.
    EndOfTravel,
    /// The last command is older than its age limit.
    CommandLate,
    /// The cycle before took too long.
    CycleLate,
    /// No command came for long.
    CommandLost,
    /// No cycle ran for long, or the clock went backwards.
    CycleLost,
    /// The voltage asked for is not a finite number.
    CommandNotFinite,
    /// The shaft turns faster than the limit.
    Overspeed,
    /// The shaft is beyond the end of the travel by more than the margin.
    TravelExceeded,
    /// The winding is too hot by the temperature model.
    MotorHot,
    /// A reading is not a finite number.
    ReadingNotFinite,
    /// Encoder and tachometer contradict each other.
    SensorsDisagree,
    /// The torque sensor is at the end of its range.
    TorqueSaturated,
    /// The tachometer shows the same value to the last bit.
    TachometerFrozen,
    /// The torque sensor shows the same value to the last bit.
    TorqueFrozen,
    /// The rig's own clock stands still.
    RigClockStopped,
    /// The safety layer is active, but the node is not.
    PermissionWithdrawn,
    /// The back end reports a fault or refuses a voltage.
    BackEnd,
    /// The shaft turns though the motor has had zero volts for long.
    MotionAtZero,
    /// The device obeys a command that this driver did not send.
    UnknownEcho,
    /// Somebody else writes to the device's line.
    ForeignFrames,
    /// The device refuses most of what it is sent.
    CommandsRefused,
    /// The motor has another voltage than the one asked for.
    VoltageDiffers,
    /// The device's cycles, its clock and the time here contradict each other.
    CycleJump,
    /// The device does not say that it stopped.
    StopNotAcknowledged,
}

/// What the driver does about a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reaction {
    /// The voltage is cut to what is allowed.
    Cut,
    /// Zero volts at once, until the cause is gone.
    ZeroWhileItLasts,
    /// Zero volts at once, and state faulted until somebody clears it.
    ZeroUntilCleared,
}

/// One line of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FaultRule {
    /// The fault.
    pub fault: Fault,
    /// Its name, as in documents and messages.
    pub name: &'static str,
    /// When it is one, in words; limits by the names of [`SafetyLimits`](crate::safety::SafetyLimits).
    pub when: &'static str,
    /// What is done.
    pub reaction: Reaction,
}

const fn rule(
    fault: Fault,
    name: &'static str,
    when: &'static str,
    reaction: Reaction,
) -> FaultRule {
    FaultRule { fault, name, when, reaction }
}

/// Every fault with what it does. No fault ramps the voltage down: a ramp needs a driver that still
/// works.
pub const FAULTS: [FaultRule; 26] = {
    use Fault as F;
    use Reaction::{Cut, ZeroUntilCleared, ZeroWhileItLasts};
    [
        rule(
            F::VoltageBeyondLimit,
            "voltage beyond limit",
            "the voltage asked for is above `voltage`",
            Cut,
        ),
        rule(
            F::VoltageTooSteep,
            "voltage too steep",
            "the voltage grows faster than `slew`; falling to zero is never slowed",
            Cut,
        ),
        rule(
            F::EndOfTravel,
            "end of travel",
            "outside `travel` a voltage drives further out; back is free",
            Cut,
        ),
        rule(
            F::CommandLate,
            "command late",
            "the last command is older than `command_age`",
            ZeroWhileItLasts,
        ),
        rule(
            F::CycleLate,
            "cycle late",
            "the cycle before took longer than `cycle_late`",
            ZeroWhileItLasts,
        ),
        rule(F::CommandLost, "command lost", "no command for `command_lost`", ZeroUntilCleared),
        rule(
            F::CycleLost,
            "cycle lost",
            "a cycle took longer than `cycle_lost`, or time ran backwards",
            ZeroUntilCleared,
        ),
        rule(
            F::CommandNotFinite,
            "command not finite",
            "a voltage or its time is not a finite number",
            ZeroUntilCleared,
        ),
        rule(
            F::Overspeed,
            "overspeed",
            "tachometer or encoder show more than `velocity` in three cycles running",
            ZeroUntilCleared,
        ),
        rule(
            F::TravelExceeded,
            "travel exceeded",
            "the encoder is outside `travel` by more than its `margin`",
            ZeroUntilCleared,
        ),
        rule(
            F::MotorHot,
            "motor hot",
            "the winding's model temperature is above `motor.limit`; cleared only 10 K below it",
            ZeroUntilCleared,
        ),
        rule(
            F::ReadingNotFinite,
            "reading not finite",
            "position, velocity, torque or current is not a finite number",
            ZeroUntilCleared,
        ),
        rule(
            F::SensorsDisagree,
            "sensors disagree",
            "means of tachometer and encoder velocity differ by more than `sensors.agreement` in two windows running",
            ZeroUntilCleared,
        ),
        rule(
            F::TorqueSaturated,
            "torque saturated",
            "the torque is at `sensors.torque_range` for ten cycles",
            ZeroUntilCleared,
        ),
        rule(
            F::TachometerFrozen,
            "tachometer frozen",
            "the same reading to the last bit for `sensors.frozen_cycles`",
            ZeroUntilCleared,
        ),
        rule(
            F::TorqueFrozen,
            "torque frozen",
            "the same reading to the last bit for `sensors.frozen_cycles`",
            ZeroUntilCleared,
        ),
        rule(
            F::RigClockStopped,
            "rig clock stopped",
            "the rig's time stands still for 20 cycles",
            ZeroUntilCleared,
        ),
        rule(
            F::PermissionWithdrawn,
            "permission withdrawn",
            "the safety layer is active, but the node is not: a request to it was given up, or the node leaves",
            ZeroUntilCleared,
        ),
        rule(
            F::BackEnd,
            "back end",
            "the back end reports a fault or refuses a voltage",
            ZeroUntilCleared,
        ),
        rule(
            F::MotionAtZero,
            "motion at zero volts",
            "zero volts for `standstill.after`, and from then on two windows of 0.1 s running with a mean speed above `standstill.velocity` that does not fall by a tenth",
            ZeroUntilCleared,
        ),
        rule(
            F::UnknownEcho,
            "unknown echo",
            "a serial device obeys a command whose number or voltage was not sent",
            ZeroUntilCleared,
        ),
        rule(
            F::ForeignFrames,
            "foreign frames",
            "a serial device heard more than two frames of another session or version within a second",
            ZeroUntilCleared,
        ),
        rule(
            F::CommandsRefused,
            "commands refused",
            "a serial device refused messages in more than half of the cycles of a second",
            ZeroUntilCleared,
        ),
        rule(
            F::VoltageDiffers,
            "voltage differs",
            "a serial device's motor had another voltage than the one asked for, by more than 5 % of its limit, in three cycles running",
            ZeroUntilCleared,
        ),
        rule(
            F::CycleJump,
            "cycle jump",
            "a serial device's cycles and clock differ by more than two periods and an eighth, or, after the first second, run ahead of the time here by more than 0.25 s at once",
            ZeroUntilCleared,
        ),
        rule(
            F::StopNotAcknowledged,
            "stop not acknowledged",
            "a serial device was told to stop or to rest, every 10 ms, and its measurements, 20 or more, did not say so within 0.1 s",
            ZeroUntilCleared,
        ),
    ]
};

impl Fault {
    /// Its line of the table.
    #[must_use]
    pub fn rule(self) -> &'static FaultRule {
        // Every fault stands in the table at its own place; a test says so.
        &FAULTS[self as usize]
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.rule().name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_stands_at_its_own_place_in_the_table() {
        for (place, rule) in FAULTS.iter().enumerate() {
            assert_eq!(rule.fault as usize, place, "{}", rule.name);
            assert_eq!(rule.fault.rule().name, rule.name);
        }
        assert_eq!(Fault::StopNotAcknowledged as usize + 1, FAULTS.len());
    }
}
