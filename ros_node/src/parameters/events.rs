//! `/parameter_events`: what became of a node's parameters.
//!
//! The first event tells all of them. It waits for those who listen already when the node starts:
//! what was sent before they were found would not reach them. What changes meanwhile is told behind
//! it, in order.

use std::sync::{Arc, Mutex, PoisonError};

use msgs::topics::Qos;
use ros2_client::{Message, builtin_interfaces::Time, parameters::raw};
use serde::{Deserialize, Serialize};

use crate::{NodeClock, Publisher, RosNode, RosNodeError, hearing};

/// Events that are held back at most; the next one lets all of them go.
const MOST_HELD: usize = 100;

/// The event as it travels.
#[derive(Clone, Serialize, Deserialize)]
#[serde(transparent)]
struct Event(raw::ParameterEvent);

impl Message for Event {}

/// The events of one node.
pub(super) struct Events(Arc<Inner>);

struct Inner {
    publisher: Publisher<Event>,
    /// What waits for the first listeners, in order; none once it has been sent.
    held: Mutex<Option<Vec<Event>>>,
    node: String,
    clock: NodeClock,
}

impl Events {
    /// Of that node, which is called so and has these parameters.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub(super) fn begin(
        node: &RosNode,
        name: String,
        new_parameters: Vec<raw::Parameter>,
    ) -> Result<Self, RosNodeError> {
        let publisher = node.raw_publisher(
            hearing::PARAMETER_EVENTS,
            "rcl_interfaces",
            "ParameterEvent",
            Qos { depth: 1000, ..Qos::DEFAULT },
        )?;
        let topic = hearing::topic_of(publisher.topic());
        let clock = node.clock().clone();
        let held = Mutex::new(Some(Vec::new()));
        let events = Arc::new(Inner { publisher, held, node: name, clock });
        events.tell(events.event(Vec::new(), new_parameters));
        let (first, hearers) = (Arc::clone(&events), node.hearers());
        node.spawn(async move {
            hearers.until_listened_to(&topic, hearing::FOR_LISTENERS).await;
            first.release(&mut first.held.lock().unwrap_or_else(PoisonError::into_inner));
        });
        Ok(Self(events))
    }

    /// Tells that parameters have these values now.
    pub(super) fn tell_changed(&self, changed: Vec<raw::Parameter>) {
        self.0.tell(self.0.event(changed, Vec::new()));
    }
}

impl Inner {
    fn event(
        &self,
        changed_parameters: Vec<raw::Parameter>,
        new_parameters: Vec<raw::Parameter>,
    ) -> Event {
        Event(raw::ParameterEvent {
            stamp: Time::from_nanos(i64::try_from(self.clock.now_ns()).unwrap_or(i64::MAX)),
            node: self.node.clone(),
            new_parameters,
            changed_parameters,
            deleted_parameters: Vec::new(),
        })
    }

    fn tell(&self, event: Event) {
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        match held.as_mut() {
            None => self.send(event),
            Some(waiting) => {
                waiting.push(event);
                if waiting.len() > MOST_HELD {
                    self.release(&mut held);
                }
            }
        }
    }

    fn release(&self, held: &mut Option<Vec<Event>>) {
        held.take().into_iter().flatten().for_each(|event| self.send(event));
    }

    fn send(&self, event: Event) {
        // Nobody is harmed if an event is not heard.
        let _ = self.publisher.publish(event);
    }
}
