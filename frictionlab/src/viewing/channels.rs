//! What nodes say, on channels: of this process where they publish it, of others over DDS.

use std::collections::BTreeMap;
use std::sync::Arc;

use msgs::topics::{self, Topic};
use msgs::{RosMessage, cdr};
use ros_node::{Inside, Listener, LogLevel, Named, Participant, RosNode, RosNodeError};
use serde_json::json;
use view::{Channel, ChannelId, Hub};

use super::clock::now_ns;
use super::topics::channel;

/// Which nodes are heard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Heard {
    /// Those of this process, without the network.
    Inside,
    /// Those of any process.
    Network,
}

/// Offers all topics of the laboratory and the log, and fills them with what nodes say.
///
/// # Errors
/// [`RosNodeError`] if the middleware refuses.
pub(super) fn open(
    participant: &Participant,
    node: &RosNode,
    hub: &Hub,
    heard: Heard,
) -> Result<(), RosNodeError> {
    let mut offers = Offers { node, hub, heard, known: BTreeMap::new() };
    offers.offer(&topics::JOINT_STATES)?;
    offers.offer(&topics::RIG_MEASUREMENT)?;
    offers.offer(&topics::REFERENCE)?;
    offers.offer(&topics::MOTOR_VOLTAGE)?;
    offers.offer(&topics::FRICTION_ESTIMATE)?;
    offers.offer(&topics::CONTROLLER_STATE)?;
    offers.offer(&topics::EXPERIMENT_STATUS)?;
    offers.offer(&topics::DIAGNOSTICS)?;
    let log =
        hub.offer(Channel { latched: false, ..Channel::latched_json("/rosout", "foxglove.Log") });
    let known = offers.known;
    participant.listen_inside(listener(hub.clone(), known, log));
    Ok(())
}

/// Channels by their topics, and whether who comes late gets the last message.
type Known = BTreeMap<String, (ChannelId, bool)>;

struct Offers<'a> {
    node: &'a RosNode,
    hub: &'a Hub,
    heard: Heard,
    /// What is heard inside.
    known: Known,
}

impl Offers<'_> {
    fn offer<M: RosMessage + msgs::Payload>(
        &mut self,
        topic: &Topic<M>,
    ) -> Result<(), RosNodeError> {
        let name = self.node.resolve(Named::Topic, topic.name_in_namespace())?;
        let id = self.hub.offer(Channel { topic: name.clone(), ..channel(topic) });
        let latched = topic.qos.transient_local;
        if self.heard == Heard::Inside {
            self.known.insert(name, (id, latched));
            return Ok(());
        }
        let hub = self.hub.clone();
        self.node.subscribe(topic, move |message: M| {
            if (latched || hub.viewers() > 0)
                && let Ok(bytes) = cdr::encode(&message)
            {
                hub.publish(id, now_ns(), &bytes);
            }
        })
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
