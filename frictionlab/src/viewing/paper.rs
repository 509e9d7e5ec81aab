//! How a commission stands, as a document for the page.

use serde_json::Value;
use view::{Channel, ChannelId, Hub};

use super::clock::now_ns;

/// The document, told where it differs from what was told before.
pub(super) struct Paper {
    hub: Hub,
    /// Offered with the first document.
    channel: Option<ChannelId>,
    told: String,
}

impl Paper {
    /// On that hub.
    pub(super) fn new(hub: &Hub) -> Self {
        Self { hub: hub.clone(), channel: None, told: String::new() }
    }

    /// Tells it.
    pub(super) fn tell(&mut self, document: &Value) {
        let text = document.to_string();
        if text == self.told {
            return;
        }
        let offer = || self.hub.offer(Channel::latched_json("/view/commission", "view.Commission"));
        let channel = *self.channel.get_or_insert_with(offer);
        self.hub.publish(channel, now_ns(), text.as_bytes());
        self.told = text;
    }
}
