//! What the observer estimates, published.

use msgs::{friction_msgs::FrictionEstimate, topics};
use ros_node::{Participant, Publisher, RosNode, RosNodeError};

use crate::{Estimate, messages};

/// The node `/friction_observer` with its publisher.
pub struct ObserverNode {
    friction_estimate: Publisher<FrictionEstimate>,
    // Dropped last: publishers go before the node they belong to. None where somebody else holds
    // it.
    _node: Option<RosNode>,
}

impl ObserverNode {
    /// Joins the participant.
    ///
    /// # Errors
    /// [`RosNodeError`] if the middleware refuses the node or a publisher.
    pub fn new(participant: &Participant) -> Result<Self, RosNodeError> {
        let node = participant.node("friction_observer")?;
        let publishers = Self::on(&node)?;
        Ok(Self { _node: Some(node), ..publishers })
    }

    /// The publisher on a node that somebody else holds.
    ///
    /// # Errors
    /// [`RosNodeError`] if the middleware refuses the publisher.
    pub fn on(node: &RosNode) -> Result<Self, RosNodeError> {
        Ok(Self { friction_estimate: node.publisher(&topics::FRICTION_ESTIMATE)?, _node: None })
    }

    /// Publishes one cycle's estimate on `/friction_estimate`. It may wait for the network: never
    /// call it from a control thread.
    ///
    /// # Errors
    /// [`RosNodeError::Publish`] if the middleware does not take the message in time.
    pub fn publish(&self, stamp_ns: u64, estimate: &Estimate) -> Result<(), RosNodeError> {
        self.friction_estimate.publish(messages::friction_estimate(stamp_ns, estimate))
    }
}
