//! Joint states and estimates over DDS.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use msgs::topics;
use ros_node::deadlines::now_ns;
use ros_node::queue::{Waker, queue};
use ros_node::stamps::{Follows, Forwards};
use ros_node::{Passes, RosNode, RosNodeError};

use super::WAITING;
use super::counts::{Counts, Gates};
use crate::node::friction::Friction;
use crate::node::plausible;
use crate::node::step::{Inputs, Joint};

/// Name of the joint that is looked for.
const JOINT: &str = "load_shaft";

/// Subscribes to what the thread is told.
pub(super) fn listen(
    node: &RosNode,
    waker: &Waker,
    counts: &Arc<Counts>,
    gates: &Gates,
) -> Result<Inputs, RosNodeError> {
    let (mut joints, for_joints) = queue(WAITING, waker);
    let (mut frictions, for_frictions) = queue(WAITING, waker);
    let unusable = counts.complainer(node);
    let gate = counts.watched(&gates.joints);
    let (mut forwards, counted, logger) =
        (Forwards::default(), Arc::clone(counts), node.logger().clone());
    node.subscribe_from(&topics::JOINT_STATES, move |message, sent| {
        let index = plausible::index_of(JOINT, &message.name);
        let of_joint = |values: &[f64]| index.and_then(|index| values.get(index).copied());
        let (Some(position), Some(velocity)) = (of_joint(&message.position), of_joint(&message.velocity))
        else {
            unusable(&format!("a joint state has no position or no velocity of {JOINT}"));
            return;
        };
        if plausible::is_beyond(position, velocity) {
            unusable("a joint state is beyond what a shaft does");
            return;
        }
        // Of another joint, or of no shaft: such a publisher is none of ours. Of the others one
        // counts.
        match gate.hear(sent.writer) {
            Passes::Yes { first: true } => forwards.reset(),
            Passes::Yes { first: false } => {}
            Passes::No => return,
        }
        let stamp_ns = message.header.stamp.to_nanos();
        if forwards.take(stamp_ns, now_ns()) != Follows::Fits {
            if counted.untimely.fetch_add(1, Ordering::Relaxed) == 0 {
                logger.warn("a joint state has a stamp from the past or the future; such are left out and counted in /diagnostics");
            }
            return;
        }
        // What is no number goes on: the controller counts it and stops after a few.
        joints.send(Joint { stamp_ns, position, velocity, cycle: None });
    })?;
    let unusable = counts.complainer(node);
    let gate = counts.watched(&gates.frictions);
    node.subscribe_from(&topics::FRICTION_ESTIMATE, move |message, sent| {
        if !message.torque.is_finite() {
            unusable("a friction estimate is no number");
        } else if gate.hear(sent.writer) != Passes::No {
            frictions.send(Friction {
                stamp_ns: message.header.stamp.to_nanos(),
                torque: message.torque,
            });
        }
    })?;
    Ok(Inputs {
        joints: for_joints,
        frictions: for_frictions,
        strange: Arc::clone(&counts.strange),
    })
}
