//! The rig as a ROS 2 node: what it measures, published.

use msgs::{friction_msgs::RigMeasurement, sensor_msgs::JointState, topics};
use ros_node::{Participant, Publisher, RosNode, RosNodeError};

use crate::{Measurement, messages};

/// The node `/rig_driver` with its publishers.
pub struct RigNode {
    joint_states: Publisher<JointState>,
    rig_measurement: Publisher<RigMeasurement>,
    // Dropped last: publishers go before the node they belong to.
    _node: RosNode,
}

impl RigNode {
    /// Joins the participant.
    ///
    /// # Errors
    /// [`RosNodeError`] if the middleware refuses the node or a publisher.
    pub fn new(participant: &Participant) -> Result<Self, RosNodeError> {
        let node = participant.node("rig_driver")?;
        Ok(Self {
            joint_states: node.publisher(&topics::JOINT_STATES)?,
            rig_measurement: node.publisher(&topics::RIG_MEASUREMENT)?,
            _node: node,
        })
    }

    /// Publishes one cycle's measurement on `/joint_states` and `/rig_measurement`. It may wait for the network: never
    /// call it from a control thread.
    ///
    /// # Errors
    /// [`RosNodeError::Publish`] if the middleware does not take the message in time.
    pub fn publish(&self, stamp_ns: u64, measurement: &Measurement) -> Result<(), RosNodeError> {
        self.joint_states.publish(messages::joint_state(stamp_ns, measurement))?;
        self.rig_measurement.publish(messages::rig_measurement(stamp_ns, measurement))
    }
}
