//! The laboratory's topics: name, type and quality of service, once for publishers, subscribers and
//! bags.

use std::marker::PhantomData;

use crate::{
    RosMessage,
    diagnostic_msgs::DiagnosticArray,
    friction_msgs::{
        ControllerState, ExperimentStatus, FrictionEstimate, MotorVoltage, Reference,
        RigMeasurement,
    },
    rcl_interfaces::Log,
    sensor_msgs::JointState,
};

/// Quality of service a topic is offered with. Everything that is not said here is the default of
/// ROS 2; all topics of the laboratory are reliable, since a reliable writer serves best-effort
/// readers too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Qos {
    /// How many samples a writer keeps.
    pub depth: u32,
    /// A reader that comes late gets the kept samples.
    pub transient_local: bool,
}

impl Qos {
    /// A signal of every control cycle: at 1 kHz the history bridges a reader that is held up for a
    /// tenth of a second.
    pub const SIGNAL: Self = Self { depth: 100, transient_local: false };
    /// The default of ROS 2: a few samples, for those who are there.
    pub const DEFAULT: Self = Self { depth: 10, transient_local: false };
    /// A state that late-comers must see: the last sample, transient local.
    pub const LATCHED: Self = Self { depth: 1, transient_local: true };
}

/// A topic's name, type and quality of service.
#[derive(Debug)]
pub struct Topic<M> {
    /// Absolute name, before any remapping.
    pub name: &'static str,
    /// Quality of service it is offered with.
    pub qos: Qos,
    message: PhantomData<fn() -> M>,
}

impl<M: RosMessage> Topic<M> {
    const fn new(name: &'static str, qos: Qos) -> Self {
        Self { name, qos, message: PhantomData }
    }

    /// The name as a node says it: relative, so that the node's namespace comes before it. What all
    /// nodes share, such as `/diagnostics`, stays absolute.
    pub fn name_in_namespace(&self) -> &'static str {
        if [DIAGNOSTICS.name, ROSOUT.name].contains(&self.name) {
            self.name
        } else {
            self.name.trim_start_matches('/')
        }
    }
}

/// Position, velocity and friction torque of the joint `load_shaft`.
pub const JOINT_STATES: Topic<JointState> = Topic::new("/joint_states", Qos::SIGNAL);
/// Every channel of the rig.
pub const RIG_MEASUREMENT: Topic<RigMeasurement> = Topic::new("/rig_measurement", Qos::SIGNAL);
/// Where the axis should be.
pub const REFERENCE: Topic<Reference> = Topic::new("/reference", Qos::SIGNAL);
/// What the controller asks of the motor.
pub const MOTOR_VOLTAGE: Topic<MotorVoltage> = Topic::new("/motor_voltage", Qos::SIGNAL);
/// What the observer thinks of friction.
pub const FRICTION_ESTIMATE: Topic<FrictionEstimate> =
    Topic::new("/friction_estimate", Qos::SIGNAL);
/// What the controller saw and decided.
pub const CONTROLLER_STATE: Topic<ControllerState> = Topic::new("/controller_state", Qos::SIGNAL);
/// How far an experiment has come.
pub const EXPERIMENT_STATUS: Topic<ExperimentStatus> =
    Topic::new("/experiment_status", Qos::LATCHED);
/// Health of the nodes.
pub const DIAGNOSTICS: Topic<DiagnosticArray> = Topic::new("/diagnostics", Qos::DEFAULT);

/// What all nodes log.
pub const ROSOUT: Topic<Log> = Topic::new("/rosout", Qos { depth: 1000, transient_local: true });

/// Quality of service of the topic with that name; the default of ROS 2 for one the laboratory does
/// not know.
pub fn qos_of(name: &str) -> Qos {
    let known = [
        (JOINT_STATES.name, JOINT_STATES.qos),
        (RIG_MEASUREMENT.name, RIG_MEASUREMENT.qos),
        (REFERENCE.name, REFERENCE.qos),
        (MOTOR_VOLTAGE.name, MOTOR_VOLTAGE.qos),
        (FRICTION_ESTIMATE.name, FRICTION_ESTIMATE.qos),
        (CONTROLLER_STATE.name, CONTROLLER_STATE.qos),
        (EXPERIMENT_STATUS.name, EXPERIMENT_STATUS.qos),
        (DIAGNOSTICS.name, DIAGNOSTICS.qos),
    ];
    known.iter().find(|(known, _)| *known == name).map_or(Qos::DEFAULT, |(_, qos)| *qos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quality_is_found_by_name() {
        assert_eq!(qos_of("/experiment_status"), Qos::LATCHED);
        assert_eq!(qos_of("/joint_states"), Qos::SIGNAL);
        assert_eq!(qos_of("/somebody_else"), Qos::DEFAULT);
    }
}
