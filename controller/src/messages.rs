//! References and commands as ROS 2 messages.

use msgs::{
    friction_msgs::{self, ControllerState, MotorVoltage},
    std_msgs::Header,
};

use crate::{Command, ControlMode, Reference};

/// The reference as a message. `stamp_ns` is the time it is for, in nanoseconds since the epoch.
#[must_use]
pub fn reference(stamp_ns: u64, reference: &Reference) -> friction_msgs::Reference {
    let &Reference { position, velocity, acceleration } = reference;
    friction_msgs::Reference { header: Header::at(stamp_ns), position, velocity, acceleration }
}

/// The command's sum. `stamp_ns` is the time of the measurement it answers to, in nanoseconds since
/// the epoch.
#[must_use]
pub fn motor_voltage(stamp_ns: u64, command: &Command) -> MotorVoltage {
    MotorVoltage { header: Header::at(stamp_ns), voltage: command.total }
}

/// The command in its parts. The message has no field for the impulses and the acceleration
/// feedback: the impulses are counted into its `dither`, the acceleration feedback into its
/// `friction`, so that its parts sum to its total where it is not saturated. `stamp_ns` is the time
/// of the measurement it answers to, in nanoseconds since the epoch.
#[must_use]
pub fn controller_state(stamp_ns: u64, command: &Command) -> ControllerState {
    let &Command { mode, reference, feedback, error, linear, inverse, total, saturated, .. } =
        command;
    ControllerState {
        header: Header::at(stamp_ns),
        mode: match mode {
            ControlMode::Velocity => ControllerState::VELOCITY,
            ControlMode::Position => ControllerState::POSITION,
        },
        reference,
        feedback,
        error,
        linear,
        inverse,
        friction: command.friction + command.acceleration,
        dither: command.dither + command.impulse,
        total,
        saturated,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_the_command_has_its_place() {
        let command = Command {
            mode: ControlMode::Position,
            reference: 1.0,
            feedback: 2.0,
            error: 3.0,
            linear: 4.0,
            inverse: 5.0,
            friction: 5.75,
            acceleration: 0.25,
            dither: 6.5,
            impulse: 0.5,
            total: 8.0,
            saturated: true,
            ..Command::default()
        };
        let state = controller_state(9, &command);
        assert_eq!(state.mode, ControllerState::POSITION);
        let parts = [
            state.reference,
            state.feedback,
            state.error,
            state.linear,
            state.inverse,
            state.friction,
            state.dither,
            state.total,
        ];
        assert_eq!(parts, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
        assert!(state.saturated);
        assert_eq!(motor_voltage(9, &command).voltage, 8.0);
    }
}
