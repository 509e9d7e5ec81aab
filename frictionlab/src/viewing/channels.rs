//! What nodes say, on channels: of this process where they publish it, of others over DDS.

use std::collections::BTreeMap;
use std::sync::Arc;

use msgs::rcl_interfaces::Log;
use msgs::topics::{self, Topic};
use msgs::{RosMessage, cdr};
use ros_node::{Inside, Listener, LogLevel, Named, Participant, RosNode, RosNodeError};
use serde_json::json;
use view::{Channel, ChannelId, Hub};

use super::clock::now_ns;
use super::topics::channel;

/// Lines of the log that who comes late gets.
const LINES: usize = 100;

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
    hub.keep(log, LINES);
    let known = offers.known;
    // Every node's lines come from there, those of this process too.
    let from_network = heard == Heard::Network && hear_log(node, hub, log).is_ok();
    // The permissions of a secured network may let nobody read there.
    let log = (!from_network).then_some(log);
    participant.listen_inside(listener(hub.clone(), known, log));
    Ok(())
}

/// Fills the log with what all nodes say.
fn hear_log(node: &RosNode, hub: &Hub, log: ChannelId) -> Result<(), RosNodeError> {
    let hub = hub.clone();
    node.subscribe(&topics::ROSOUT, move |line: Log| {
        let stamp_ns = line.stamp.to_nanos();
        // As the level of `foxglove.Log`.
        let level = (line.level / 10).clamp(1, 5);
        let told = logged(stamp_ns, level, &line.name, &line.msg);
        hub.publish(log, stamp_ns, told.as_bytes());
    })
}

/// A line of the log, as `foxglove.Log`.
fn logged(stamp_ns: u64, level: u8, name: &str, text: &str) -> String {
    json!({
        "timestamp": { "sec": stamp_ns / 1_000_000_000, "nsec": stamp_ns % 1_000_000_000 },
        "level": level,
        "message": text,
        "name": name,
        "file": "",
        "line": 0,
    })
    .to_string()
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

fn listener(hub: Hub, known: Known, log: Option<ChannelId>) -> Listener {
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
            let Some(log) = log else { return };
            let level = match level {
                LogLevel::Debug => 1,
                LogLevel::Info => 2,
                LogLevel::Warn => 3,
                LogLevel::Error => 4,
                LogLevel::Fatal => 5,
            };
            hub.publish(log, stamp_ns, logged(stamp_ns, level, node, text).as_bytes());
        }
    })
}
