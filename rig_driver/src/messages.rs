//! Measurements as ROS 2 messages.

use msgs::{friction_msgs::RigMeasurement, sensor_msgs::JointState, std_msgs::Header};

use crate::Measurement;

/// Name of the one joint: the load side of the gear.
pub const JOINT: &str = "load_shaft";

/// The measurement as the joint `load_shaft`: position of the encoder \[rad\], velocity of the
/// tachometer [rad/s], effort = friction torque [N m]. `stamp_ns` is its time in nanoseconds since
/// the epoch.
#[must_use]
pub fn joint_state(stamp_ns: u64, measurement: &Measurement) -> JointState {
    JointState {
        header: Header::at(stamp_ns),
        name: vec![JOINT.to_owned()],
        position: vec![measurement.encoder_position],
        velocity: vec![measurement.tachometer_velocity],
        effort: vec![measurement.torque],
    }
}

/// Every channel of the measurement. `stamp_ns` is its time in nanoseconds since the epoch.
#[must_use]
pub fn rig_measurement(stamp_ns: u64, measurement: &Measurement) -> RigMeasurement {
    let &Measurement {
        cycle,
        time,
        encoder_counts,
        encoder_position,
        tachometer_velocity,
        potentiometer_position,
        torque,
        // The message has no field for it.
        motor_current: _,
        voltage_asked,
        voltage_applied,
        saturated,
        watchdog_expired,
        fault,
    } = measurement;
    RigMeasurement {
        header: Header::at(stamp_ns),
        cycle,
        rig_time: time,
        encoder_counts,
        encoder_position,
        tachometer_velocity,
        potentiometer_position,
        torque,
        voltage_asked,
        voltage_applied,
        saturated,
        watchdog_expired,
        fault,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_joint_carries_encoder_tachometer_and_torque_sensor() {
        let measurement = Measurement {
            encoder_position: 1.0,
            tachometer_velocity: 2.0,
            potentiometer_position: 3.0,
            torque: 4.0,
            ..Measurement::default()
        };
        let joint = joint_state(1_500_000_000, &measurement);
        assert_eq!(joint.header.stamp.to_nanos(), 1_500_000_000);
        assert_eq!(joint.name, ["load_shaft"]);
        assert_eq!(
            (joint.position, joint.velocity, joint.effort),
            (vec![1.0], vec![2.0], vec![4.0])
        );
    }
}
