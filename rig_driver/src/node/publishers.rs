//! What the rig measures, published.

use msgs::{friction_msgs::RigMeasurement, sensor_msgs::JointState, topics};
use ros_node::{Participant, Publisher, RosNode, RosNodeError};

use crate::{Measurement, messages};

/// The node `/rig_driver` with its publishers.
pub struct RigNode {
    joint_states: Publisher<JointState>,
    rig_measurement: Publisher<RigMeasurement>,
    // Dropped last: publishers go before the node they belong to. None where somebody else holds
    // it.
    _node: Option<RosNode>,
}

impl RigNode {
    /// Joins the participant.
    ///
    /// # Errors
    /// [`RosNodeError`] if the middleware refuses the node or a publisher.
    pub fn new(participant: &Participant) -> Result<Self, RosNodeError> {
        let node = participant.node("rig_driver")?;
        let publishers = Self::on(&node)?;
        Ok(Self { _node: Some(node), ..publishers })
    }

    /// The publishers on a node that somebody else holds.
    ///
    /// # Errors
    /// [`RosNodeError`] if the middleware refuses a publisher.
    pub fn on(node: &RosNode) -> Result<Self, RosNodeError> {
        Ok(Self {
            joint_states: node.publisher(&topics::JOINT_STATES)?,
            rig_measurement: node.publisher(&topics::RIG_MEASUREMENT)?,
            _node: None,
        })
    }

    /// Like [`publish`](Self::publish), with a friction torque [N m] that is not the torque
    /// sensor's.
    ///
    /// # Errors
    /// [`RosNodeError::Publish`] if the middleware does not take the message in time.
    pub fn publish_with_effort(
        &self,
        stamp_ns: u64,
        measurement: &Measurement,
        effort: f64,
    ) -> Result<(), RosNodeError> {
        let joint =
            JointState { effort: vec![effort], ..messages::joint_state(stamp_ns, measurement) };
        self.joint_states.publish(joint)?;
        self.rig_measurement.publish(messages::rig_measurement(stamp_ns, measurement))
    }

    /// Publishes one cycle's measurement on `/joint_states` and `/rig_measurement`. It may wait for
    /// the network: never call it from a control thread.
    ///
    /// # Errors
    /// [`RosNodeError::Publish`] if the middleware does not take the message in time.
    pub fn publish(&self, stamp_ns: u64, measurement: &Measurement) -> Result<(), RosNodeError> {
        self.joint_states.publish(messages::joint_state(stamp_ns, measurement))?;
        self.rig_measurement.publish(messages::rig_measurement(stamp_ns, measurement))
    }
}
