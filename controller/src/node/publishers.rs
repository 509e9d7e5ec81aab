//! What the controller decides and why, published.

use msgs::{
    friction_msgs::{self, ControllerState, MotorVoltage},
    topics,
};
use ros_node::{Participant, Publisher, RosNode, RosNodeError};

use crate::{Command, Reference, messages};

/// The node `/controller` with its publishers.
pub struct ControllerNode {
    reference: Publisher<friction_msgs::Reference>,
    motor_voltage: Publisher<MotorVoltage>,
    controller_state: Publisher<ControllerState>,
    // Dropped last: publishers go before the node they belong to.
    _node: RosNode,
}

impl ControllerNode {
    /// Joins the participant.
    ///
    /// # Errors
    /// [`RosNodeError`] if the middleware refuses the node or a publisher.
    pub fn new(participant: &Participant) -> Result<Self, RosNodeError> {
        let node = participant.node("controller")?;
        Ok(Self {
            reference: node.publisher(&topics::REFERENCE)?,
            motor_voltage: node.publisher(&topics::MOTOR_VOLTAGE)?,
            controller_state: node.publisher(&topics::CONTROLLER_STATE)?,
            _node: node,
        })
    }

    /// Publishes one cycle's reference and command on `/reference`, `/motor_voltage` and `/controller_state`. It may wait
    /// for the network: never call it from a control thread.
    ///
    /// # Errors
    /// [`RosNodeError::Publish`] if the middleware does not take the message in time.
    pub fn publish(
        &self,
        stamp_ns: u64,
        reference: &Reference,
        command: &Command,
    ) -> Result<(), RosNodeError> {
        self.reference.publish(messages::reference(stamp_ns, reference))?;
        self.motor_voltage.publish(messages::motor_voltage(stamp_ns, command))?;
        self.controller_state.publish(messages::controller_state(stamp_ns, command))
    }
}
