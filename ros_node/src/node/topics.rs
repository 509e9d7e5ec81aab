//! Publishers and subscriptions of a node.

use std::time::{Duration, Instant};

use futures::StreamExt;
use msgs::topics::{Qos, Topic};
use msgs::{RosMessage, descriptions};
use ros2_client::qos::{Durability, History, QosProfile};
use ros2_client::{Message, MessageInfo, MessageTypeName};

use super::{RosNode, parse, profile, since_epoch};
use crate::deadlines::now_ns;
use crate::inside::Told;
use crate::one_writer::WriterId;
use crate::{Named, Publisher, RosNodeError};

/// Shortest time between two warnings of one subscription.
const WARNINGS: Duration = Duration::from_secs(1);

impl RosNode {
    /// A publisher on a topic, with the topic's quality of service. The topic lies in the node's
    /// namespace.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn publisher<M: RosMessage + Message>(
        &self,
        topic: &Topic<M>,
    ) -> Result<Publisher<M>, RosNodeError> {
        self.publisher_on(topic.name_in_namespace(), topic.qos)
    }

    /// A publisher on the topic that the code calls `name`.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn publisher_on<M: RosMessage + Message>(
        &self,
        name: &str,
        qos: Qos,
    ) -> Result<Publisher<M>, RosNodeError> {
        self.types.uses(descriptions::message::<M>());
        let publisher = self.raw_publisher(name, M::DEFINITION.package, M::DEFINITION.name, qos)?;
        Ok(publisher.heard_inside(Told::new(self.shared.ears.clone())))
    }

    /// A publisher of a type that has no Rust type in `msgs`.
    pub(crate) fn raw_publisher<M: Message>(
        &self,
        name: &str,
        package: &str,
        kind: &str,
        qos: Qos,
    ) -> Result<Publisher<M>, RosNodeError> {
        let absolute = self.resolve(Named::Topic, name)?;
        self.types.uses_named(&format!("{package}/msg/{kind}"));
        let publisher = self.with_node("a publisher", &absolute, |node| {
            let qos = profile(qos);
            let topic = node
                .create_topic(&parse(&absolute)?, MessageTypeName::new(package, kind), &qos)
                .map_err(|e| e.to_string())?;
            node.create_publisher(&topic, Some(qos)).map_err(|e| e.to_string())
        })?;
        self.shared.lagging.publishes(&absolute, &self.logger);
        Ok(Publisher::new(absolute, publisher))
    }

    /// Calls `take` with every message on the topic, on a background thread: it should be short and
    /// may not panic. What is no message of the type is counted and told in the log. The
    /// subscription is best effort, so that any publisher fits and no repeat delays what is newer;
    /// `transient_local` topics are read reliably.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn subscribe<M: RosMessage + Message + Send + Sync + 'static>(
        &self,
        topic: &Topic<M>,
        take: impl FnMut(M) + Send + 'static,
    ) -> Result<(), RosNodeError> {
        self.subscribe_on(topic.name_in_namespace(), topic.qos, take)
    }

    /// Like [`subscribe`](Self::subscribe), and tells who sent each message and how long ago.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn subscribe_from<M: RosMessage + Message + Send + Sync + 'static>(
        &self,
        topic: &Topic<M>,
        take: impl FnMut(M, Sent) + Send + 'static,
    ) -> Result<(), RosNodeError> {
        self.listen(topic.name_in_namespace(), topic.qos, take)
    }

    /// Like [`subscribe`](Self::subscribe), on the topic that the code calls `name`.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn subscribe_on<M: RosMessage + Message + Send + Sync + 'static>(
        &self,
        name: &str,
        qos: Qos,
        mut take: impl FnMut(M) + Send + 'static,
    ) -> Result<(), RosNodeError> {
        self.listen(name, qos, move |message, _| take(message))
    }

    fn listen<M: RosMessage + Message + Send + Sync + 'static>(
        &self,
        name: &str,
        qos: Qos,
        mut take: impl FnMut(M, Sent) + Send + 'static,
    ) -> Result<(), RosNodeError> {
        let absolute = self.resolve(Named::Topic, name)?;
        self.types.uses(descriptions::message::<M>());
        let subscription = self.with_node("a subscription", &absolute, |node| {
            let qos = subscriber_profile(qos);
            let kind = MessageTypeName::new(M::DEFINITION.package, M::DEFINITION.name);
            let topic =
                node.create_topic(&parse(&absolute)?, kind, &qos).map_err(|e| e.to_string())?;
            node.create_subscription::<M>(&topic, Some(qos)).map_err(|e| e.to_string())
        })?;
        let logger = self.logger.clone();
        self.spawn(async move {
            let mut stream = std::pin::pin!(subscription.async_stream());
            let (mut refused, mut told) = (0u64, None::<Instant>);
            while let Some(next) = stream.next().await {
                match next {
                    Ok((message, info)) => take(message, Sent::read(&info)),
                    Err(error) => {
                        refused += 1;
                        if told.is_none_or(|told| told.elapsed() >= WARNINGS) {
                            told = Some(Instant::now());
                            logger.warn(&format!(
                                "{refused} messages on {absolute} were no {} and were dropped, the last one because: {error:?}",
                                M::type_name()
                            ));
                        }
                    }
                }
            }
        });
        Ok(())
    }
}

/// Who sent a message, and when.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sent {
    /// Who. It is what the message says: see [`one_writer`](crate::one_writer) for how far that is
    /// to be believed.
    pub writer: WriterId,
    /// How long ago, by the system's clocks on both sides; zero if its publisher did not say, or by
    /// a clock that is ahead.
    pub age: Duration,
    /// When it was taken from the middleware, by [`now_ns`](crate::deadlines::now_ns) \[ns\]; `age`
    /// was as it says then or later.
    pub taken_ns: u64,
}

impl Sent {
    fn read(info: &MessageInfo) -> Self {
        // First: a process may be stopped between the two, and a command that waited then is not
        // new when it goes on.
        let taken_ns = now_ns();
        let sent = sent_ns(info).map(Duration::from_nanos);
        let age = sent.map_or(Duration::ZERO, |sent| since_epoch().saturating_sub(sent));
        Self { writer: WriterId(info.publisher_gid().to_bytes16()), age, taken_ns }
    }
}

/// When a message was sent, by its publisher's clock \[ns since the epoch\].
pub(super) fn sent_ns(info: &MessageInfo) -> Option<u64> {
    info.source_timestamp().and_then(|sent| u64::try_from(sent.to_nanos()).ok())
}

fn subscriber_profile(qos: Qos) -> QosProfile {
    if qos.transient_local {
        return profile(qos);
    }
    QosProfile::publisher_default()
        .reliability_best_effort()
        .durability(Durability::Volatile)
        .history(History::KeepLast { depth: qos.depth as usize })
}
