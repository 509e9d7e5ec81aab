//! What nodes of this process say, on channels.

use std::collections::BTreeMap;
use std::sync::Arc;

use msgs::RosMessage;
use msgs::topics::{self, Topic};
use ros_node::{Inside, Listener, LogLevel, Named, Participant, RosNode, RosNodeError};
use serde_json::json;
use view::{Channel, ChannelId, Hub};

/// Channels by their topics.
type Known = BTreeMap<String, (ChannelId, bool)>;

/// Offers all topics of the laboratory and the log, and fills them with what this process says.
///
/// # Errors
/// [`RosNodeError::Name`] if a topic cannot be called so.
pub(super) fn open(
    participant: &Participant,
    node: &RosNode,
    hub: &Hub,
) -> Result<(), RosNodeError> {
    let mut known = Known::new();
    offer(hub, node, &topics::JOINT_STATES, &mut known)?;
    offer(hub, node, &topics::RIG_MEASUREMENT, &mut known)?;
    offer(hub, node, &topics::REFERENCE, &mut known)?;
    offer(hub, node, &topics::MOTOR_VOLTAGE, &mut known)?;
    offer(hub, node, &topics::FRICTION_ESTIMATE, &mut known)?;
    offer(hub, node, &topics::CONTROLLER_STATE, &mut known)?;
    offer(hub, node, &topics::EXPERIMENT_STATUS, &mut known)?;
    offer(hub, node, &topics::DIAGNOSTICS, &mut known)?;
    let log = hub.offer(Channel {
        topic: "/rosout".to_owned(),
        latched: false,
        ..Channel::latched_json("/rosout", "foxglove.Log")
    });
    participant.listen_inside(listener(hub.clone(), known, log));
    Ok(())
}

fn offer<M: RosMessage>(
    hub: &Hub,
    node: &RosNode,
    topic: &Topic<M>,
    known: &mut Known,
) -> Result<(), RosNodeError> {
    let name = node.resolve(Named::Topic, topic.name_in_namespace())?;
    let id = hub.offer(channel(&name, topic));
    known.insert(name, (id, topic.qos.transient_local));
    Ok(())
}

/// The channel of a topic.
pub(super) fn channel<M: RosMessage>(name: &str, topic: &Topic<M>) -> Channel {
    Channel {
        topic: name.to_owned(),
        encoding: "cdr".to_owned(),
        schema_name: M::type_name(),
        schema_encoding: "ros2msg".to_owned(),
        schema: M::schema(),
        latched: topic.qos.transient_local,
    }
}

fn listener(hub: Hub, known: Known, log: ChannelId) -> Listener {
    Arc::new(move |said: Inside<'_>| match said {
        Inside::Message { topic, stamp_ns, cdr, .. } => {
            let Some(&(channel, latched)) = known.get(topic) else { return };
            if (latched || hub.viewers() > 0)
                && let Some(bytes) = cdr()
            {
                hub.publish(channel, stamp_ns, &bytes);
            }
        }
        Inside::Line { node, level, stamp_ns, text } => {
            let line = json!({
                "timestamp": { "sec": stamp_ns / 1_000_000_000, "nsec": stamp_ns % 1_000_000_000 },
                "level": match level {
                    LogLevel::Debug => 1,
                    LogLevel::Info => 2,
                    LogLevel::Warn => 3,
                    LogLevel::Error => 4,
                    LogLevel::Fatal => 5,
                },
                "message": text,
                "name": node,
                "file": "",
                "line": 0,
            });
            hub.publish(log, stamp_ns, line.to_string().as_bytes());
        }
    })
}
